//! G11: rays that were spawned near a flat cap or a plane do not pass through it, however flat the cap
//! and however far away the point that gives the plane.

use glam::{DAffine3, DVec3};

use super::backends::{BothPrecisions, on_each_backend};
use super::case::{Case, RaySampler};
use super::meshes::pyramid;
use super::self_shadow::incident_light;
use super::{CaseStats, random::Random};
use crate::error::Result;
use crate::geometry::{Departure, PrimitiveId, Ray, Side};
use crate::intersect::{Backend, Coherence::Incoherent};
use crate::measure::oracle::{self, Oracle};
use crate::measure::trace::closest;
use crate::scene::{Instance, Material, Plane, Scene};
use crate::surface::Surface;

/// The heights of the caps: closed pyramids over a square of side 2.
const HEIGHTS: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];
/// The distances of the points that give the planes.
const FAR: [f64; 3] = [1e9, 1e12, 1e14];
/// The powers of ten between which the rays' origins are away from the surface: beyond rounding.
const NEAREST: [f64; 2] = [-13.0, -1.0];

/// Returns the cases.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for height in HEIGHTS {
        let name = format!("cap of height {height:.0e}, from beside it");
        cases.extend(on_each_backend(&name, move |sampler, backend| {
            check_beside_cap(height, backend, sampler)
        }));
        let name = format!("cap of height {height:.0e}, from its faces");
        cases.extend(on_each_backend(&name, move |sampler, backend| {
            check_on_cap(height, backend, sampler)
        }));
    }
    for (distance, is_level) in FAR.into_iter().flat_map(|d| [(d, true), (d, false)]) {
        let kind = if is_level { "level" } else { "tilted" };
        let name = format!("{kind} plane by a point {distance:.0e} away");
        cases.extend(on_each_backend(&name, move |sampler, backend| {
            check_plane(distance, is_level, backend, sampler)
        }));
    }
    cases
}

/// Returns a scene with an upright wall, the plane z = 0, that rays leave.
fn walled() -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Z, material));
    scene
}

fn cap(scene: &mut Scene, height: f64) {
    let (mesh, material) = (scene.add_mesh(pyramid(height)), scene.planes[0].material);
    scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
}

/// Returns a ray that leaves the wall of [`walled`] at a point, toward another.
fn from_wall(origin: DVec3, target: DVec3) -> Ray {
    let side = if target.z > 0.0 { Side::Front } else { Side::Back };
    let departure = Some(Departure { id: PrimitiveId::plane(0), side });
    Ray { departure, ..Ray::segment(origin, target) }
}

/// Returns the far end of a ray: within 0.9 of the middle, and well above or below.
fn beyond(sign: f64, random: &mut Random) -> DVec3 {
    let [x, z] = [0; 2].map(|_| random.range(-0.9, 0.9));
    DVec3::new(x, sign * random.range(0.1, 2.0), z)
}

/// Checks the rays' hits by the oracle, and that each hits something.
fn count_hits(
    intersectors: &BothPrecisions<'_>,
    oracle: &Oracle<'_>,
    rays: &[Ray],
    stats: &mut CaseStats,
) {
    let expected = closest(oracle, rays, Incoherent);
    expected.iter().for_each(|hit| stats.count_wrong(hit.is_none()));
    intersectors.count_hits(rays, &expected, stats);
}

/// Checks rays that start just above or below a cap, on the wall that it stands in.
fn check_beside_cap(height: f64, backend: Backend, sampler: &RaySampler) -> Result<CaseStats> {
    let mut scene = walled();
    cap(&mut scene, height);
    let (intersectors, oracle) = (BothPrecisions::build(&scene, backend)?, Oracle::new(&scene));
    let ray = |random: &mut Random| {
        let off = random.power_of_ten(NEAREST[0], NEAREST[1]);
        let x = random.range(-0.9, 0.9);
        // The cap's own height there.
        let top = scene.meshes[0].positions.at(4).y;
        let (sign, y) =
            if random.coin() { (1.0, -off) } else { (-1.0, top * (1.0 - x.abs()) + off) };
        from_wall(DVec3::new(x, y, 0.0), beyond(sign, random))
    };
    Ok(sampler.for_each_batch(ray, |rays, stats| count_hits(&intersectors, &oracle, rays, stats)))
}

/// Checks that points of a cap are not lit from its other side.
fn check_on_cap(height: f64, backend: Backend, sampler: &RaySampler) -> Result<CaseStats> {
    let mut scene = walled();
    cap(&mut scene, height);
    scene.planes.clear();
    let intersectors = BothPrecisions::build(&scene, backend)?;
    let ray = |random: &mut Random| {
        let sign = random.pick(&[1.0, -1.0]);
        let (eye, target) =
            (beyond(sign, random), beyond(sign, random) * DVec3::new(1.0, 0.0, 1.0));
        (Ray::new(eye, target - eye), beyond(-sign, random))
    };
    Ok(sampler.for_each_batch(ray, |rays, stats| {
        let (rays, lamps): (Vec<Ray>, Vec<DVec3>) = rays.iter().copied().unzip();
        let mut shadow = Vec::new();
        let hits = closest(&*intersectors.certified, &rays, Incoherent);
        for ((ray, lamp), hit) in rays.iter().zip(lamps).zip(hits) {
            let Some(hit) = hit else {
                stats.count_wrong(true); // The ray is aimed at its inside.
                continue;
            };
            let surface = Surface::new(&scene, ray, &hit);
            let toward = lamp - surface.position;
            shadow.push(surface.shadow_ray(ray.direction, &incident_light(toward)));
        }
        intersectors.count_occluded(&shadow, &vec![true; shadow.len()], stats);
    }))
}

/// Checks rays that start just above or below a plane that a far point gives.
fn check_plane(
    distance: f64,
    is_level: bool,
    backend: Backend,
    sampler: &RaySampler,
) -> Result<CaseStats> {
    let mut random = sampler.shared_random();
    let mut scene = walled();
    let normal = if is_level { DVec3::Y } else { DVec3::Y + random.in_ball() * 0.3 };
    // A direction in the plane, to within rounding.
    let along = normal.cross(DVec3::Z).normalize();
    scene.planes.push(Plane::new(along * distance, normal, scene.planes[0].material));
    let Plane { point, normal, .. } = scene.planes[1];
    let (intersectors, oracle) = (BothPrecisions::build(&scene, backend)?, Oracle::new(&scene));
    let ray = |random: &mut Random| {
        // The height of the plane over a point of the wall, by an upright ray.
        let x = random.range(-0.9, 0.9);
        let low = DVec3::new(x, -4.0, 0.0);
        let upright = Ray::new(low, DVec3::Y);
        let height = oracle::plane(point, normal, &upright).map_or(f64::NAN, |t| t.to_f64() - 4.0);
        // From above or below, well beyond the rounding of that height.
        let off = random.power_of_ten(NEAREST[0], NEAREST[1]);
        let sign = random.pick(&[1.0, -1.0]);
        from_wall(DVec3::new(x, height - sign * off, 0.0), beyond(8.0 * sign, random))
    };
    Ok(sampler.for_each_batch(ray, |rays, stats| count_hits(&intersectors, &oracle, rays, stats)))
}
