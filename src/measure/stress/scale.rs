//! G12: hits do not change with the scale of the scene, by a power of two.

use glam::{DAffine3, DVec3};

use super::backends::{BothPrecisions, on_each_backend};
use super::case::{Case, RaySampler};
use super::meshes::{icosphere, torus};
use super::self_shadow::incident_light;
use super::{CaseStats, random::Random};
use crate::error::Result;
use crate::geometry::{Hit, Ray};
use crate::intersect::{Backend, Coherence::Incoherent, Intersector};
use crate::measure::trace::{closest, occluded};
use crate::scene::{Instance, Material, Plane, Scene, Sphere};
use crate::surface::Surface;

/// The exponents of the powers of two by which everything is scaled: up to coordinates of 1e15.
const EXPONENTS: [i32; 14] =
    [-300, -250, -200, -150, -100, -60, -46, -43, -40, -20, 20, 40, 43, 47];
/// The greatest exponent, up or down, for which `fast` is measured: 1e14.
const FAST_EXPONENT: i32 = 47;
/// Half the side of the cube that contains the scene.
const SIZE: f64 = 3.0;

/// Returns the cases.
pub fn cases() -> Vec<Case> {
    EXPONENTS
        .into_iter()
        .flat_map(|k| {
            let by = f64::powi(2.0, k);
            let name = format!("scaled by 2^{k}, {by:.0e}");
            on_each_backend(&name, move |sampler, backend| check_scale(k, backend, sampler))
        })
        .collect()
}

/// Compares closest hits, and shadows there, with those at scale 1.
fn check_scale(k: i32, backend: Backend, sampler: &RaySampler) -> Result<CaseStats> {
    let by = f64::powi(2.0, k);
    let scene = scene(&mut sampler.shared_random());
    let mut scaled = scene.clone();
    scale_geometry(&mut scaled, by);
    let (original, large) =
        (BothPrecisions::build(&scene, backend)?, BothPrecisions::build(&scaled, backend)?);
    let ray = |random: &mut Random| {
        let [origin, target, lamp] = [1.5, 1.0, 1.5].map(|reach| random.in_ball() * (SIZE * reach));
        (Ray::new(origin, target - origin), lamp)
    };
    Ok(sampler.for_each_batch(ray, |samples, stats| {
        let certified = trace(&scene, &*original.certified, 1.0, samples);
        let scaled_certified = trace(&scaled, &*large.certified, by, samples);
        stats.count_different(&scaled_certified, &certified);
        if k.abs() <= FAST_EXPONENT {
            let fast = trace(&scene, &*original.fast, 1.0, samples);
            let scaled_fast = trace(&scaled, &*large.fast, by, samples);
            for (found, expected) in scaled_fast.iter().zip(&fast) {
                stats.count_fast((found == expected).then_some(0.0));
            }
        }
    }))
}

/// Traces rays, each with a lamp, in a scene that is this many times as large: returns what each hits
/// and at which t, in units of the scale, and whether it is in shadow there.
fn trace(
    scene: &Scene,
    intersector: &dyn Intersector,
    by: f64,
    samples: &[(Ray, DVec3)],
) -> Vec<Option<(Hit, bool)>> {
    // Directions keep their length, as those of a camera do.
    let scaled = |ray: &Ray| Ray::new(ray.origin * by, ray.direction);
    let rays: Vec<Ray> = samples.iter().map(|(ray, _)| scaled(ray)).collect();
    let hits = closest(intersector, &rays, Incoherent);
    let shadow = |ray: &Ray, hit: &Hit, lamp: DVec3| {
        let surface = Surface::new(scene, ray, hit);
        surface.shadow_ray(ray.direction, &incident_light(lamp * by - surface.position))
    };
    let lamps = samples.iter().map(|(_, lamp)| *lamp);
    let traced = rays.iter().zip(&hits).zip(lamps);
    let shadows: Vec<Ray> =
        traced.filter_map(|((ray, hit), lamp)| Some(shadow(ray, hit.as_ref()?, lamp))).collect();
    let mut in_shadow = occluded(intersector, &shadows, Incoherent).into_iter();
    // The weights of a hit are not promised to the last bit.
    let bare = |hit: Hit| Hit { t: hit.t / by, u: 0.0, v: 0.0, ..hit };
    hits.into_iter().map(|hit| Some(bare(hit?)).zip(in_shadow.next())).collect()
}

/// Returns a scene of spheres, a plane, and meshes with one instance and with several.
fn scene(random: &mut Random) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    for _ in 0..12 {
        let radius = random.power_of_ten(-2.0, 0.0);
        scene.spheres.push(Sphere::new(random.in_ball() * SIZE, radius, material));
    }
    scene.planes.push(Plane::new(DVec3::Y * -2.0, DVec3::Y + random.in_ball() * 0.2, material));
    let (single, several) = (scene.add_mesh(torus(12, 8)), scene.add_mesh(icosphere(1)));
    for mesh in [single, several, several] {
        let stretch = DVec3::from_array(std::array::from_fn(|_| random.range(0.5, 1.5)));
        let at = random.in_ball() * (SIZE - 1.5);
        let transform = DAffine3::from_scale_rotation_translation(stretch, random.rotation(), at);
        scene.instances.push(Instance::new(mesh, transform, material));
    }
    scene
}

/// Multiplies every length of the surfaces of a scene.
pub fn scale_geometry(scene: &mut Scene, by: f64) {
    for sphere in &mut scene.spheres {
        sphere.center *= by;
        sphere.radius *= by;
    }
    for plane in &mut scene.planes {
        plane.point *= by;
    }
    for instance in &mut scene.instances {
        instance.transform.matrix3 *= by;
        instance.transform.translation *= by;
    }
}
