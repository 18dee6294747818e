//! Tests of reciprocity: a path through mirrors and glass has the same throughput from either end.

use glam::{DVec3, Vec3};
use proptest::prelude::*;

use super::nested_dielectrics::InteriorList;
use super::null_interfaces::is_null_interface;
use super::secondary_rays::spawn_at_hit;
use super::surface_evaluation::shading_params_at;
use super::wave::PathState;
use super::wave_surfaces::SpecularHit;
use super::{Integrator, Tiling};
use crate::film::View;
use crate::geometry::{PrimitiveId, Ray};
use crate::intersect::{BruteForce, Coherence, Precision};
use crate::scene::{Camera, Material, Plane, Projection, Scene, Sphere};
use crate::surface::{RayCone, Surface};

/// A path of light: the surfaces that it hit, its throughput, and its end.
#[derive(Clone, Debug)]
struct LightPath {
    /// The primitives, each with true if the path went through it.
    hits: Vec<(PrimitiveId, bool)>,
    throughput: DVec3,
    position: DVec3,
    direction: DVec3,
    /// The dielectrics that contain its end.
    interior: InteriorList,
    /// A point farther on, with nothing in between.
    end: DVec3,
}

/// Traces light from `origin` along `direction` over as many surfaces as there are choices: to be
/// refracted, or to be reflected. Where only one is possible, that one is taken.
fn trace_path(
    integrator: &Integrator<'_>,
    origin: DVec3,
    direction: DVec3,
    interior: InteriorList,
    choices: &[bool],
) -> Option<LightPath> {
    let mut ray = Ray::new(origin, direction);
    let mut path = PathState {
        sample: 0,
        depth: 0,
        layers: 0,
        throughput: DVec3::ONE,
        interior,
        cone: RayCone::default(),
        roughness: 0.0,
    };
    let dielectrics = &integrator.media.dielectrics;
    let mut hits = Vec::new();
    let mut position = origin;
    for &refract in choices {
        let (surface, hit) = loop {
            let mut hit = [None];
            integrator.intersector.closest(&[ray], Coherence::Incoherent, &mut hit);
            let hit = hit[0]?;
            path.throughput *= dielectrics.transmittance(&ray, hit.t, &path.interior);
            let surface = Surface::new(integrator.scene, &ray, &hit);
            let media = dielectrics.interface(hit.id, surface.side, &path.interior);
            let material = &integrator.scene.materials[surface.material.0 as usize];
            if !is_null_interface(integrator, material, &material.shading_params(), &media) {
                break (surface, hit);
            }
            ray = ray.continue_past(&hit, surface.side.opposite());
            path.interior = media.transmitted;
        };
        // The chosen one of at most two secondary rays.
        let params = shading_params_at(integrator, &ray, &hit, &surface, &path.cone);
        let specular = SpecularHit { ray: 0, surface, params };
        let mut spawned = Vec::new();
        spawn_at_hit(integrator, &ray, &hit, &specular, None, &path, |ray, is_refracted, path| {
            spawned.push((is_refracted, *ray, path));
        });
        spawned.sort_by_key(|&(is_refracted, ..)| is_refracted != refract);
        let (is_refracted, next_ray, next_path) = spawned.into_iter().next()?;
        hits.push((surface.id, is_refracted));
        position = surface.position;
        (ray, path) = (next_ray, next_path);
    }
    let mut next = [None];
    integrator.intersector.closest(&[ray], Coherence::Incoherent, &mut next);
    let end = ray.position((ray.start_t() + next[0]?.t) * 0.5);
    let direction = ray.direction.normalize();
    let (throughput, interior) = (path.throughput, path.interior);
    Some(LightPath { hits, throughput, position, direction, interior, end })
}

/// Returns mirrors, glass of three kinds, a pane and water, about the origin.
fn scene() -> Scene {
    let mut scene = Scene::default();
    let black = || Material { diffuse: Vec3::ZERO, ..Material::default() };
    let share = Vec3::new(0.9, 0.8, 0.7);
    let mut add = |material| scene.add_material(material);
    let mirror = add(Material { reflect: share, ..black() });
    let glass = |ior: f64, a: f32| Material {
        transmit: Vec3::new(1.0, 0.9, 0.8),
        ior,
        absorption: Vec3::new(a, 2.0 * a, 0.0),
        ..black()
    };
    let [crown, flint, air] = [glass(1.5, 0.1), glass(1.8, 0.3), glass(1.0, 0.0)].map(&mut add);
    let half = add(Material { reflect: Vec3::splat(0.3), transmit: Vec3::splat(0.6), ..black() });
    let water = add(glass(1.33, 0.05));
    let pane = add(Material { thin: true, ..glass(1.5, 0.0) });
    for (center, radius, material) in [
        ([0.0, 0.0, 0.0], 1.0, crown),
        ([0.2, 0.1, 0.0], 0.5, air),
        ([0.9, 0.3, 0.4], 0.8, flint),
        ([-1.8, 0.5, 0.3], 0.7, half),
        ([-0.5, -1.2, 0.6], 0.9, crown),
        ([0.3, 2.4, -0.8], 1.0, mirror),
        ([2.6, -0.4, -1.5], 1.1, mirror),
        ([0.0, 0.0, 0.0], 9.0, mirror),
    ] {
        scene.spheres.push(Sphere::new(DVec3::from(center), radius, material));
    }
    scene.planes.push(Plane::new(DVec3::NEG_Y * 1.1, DVec3::new(0.1, 1.0, 0.0), water));
    scene.planes.push(Plane::new(DVec3::X * -2.9, DVec3::new(1.0, 0.1, 0.2), pane));
    let lens = Projection::FovY(1.0);
    scene.cameras.push(Camera::look_at(DVec3::Z * 4.0, DVec3::ZERO, DVec3::Y, lens).unwrap());
    scene
}

/// Returns the condition number of a path, at least 1: the ratio of its relative change to that of its
/// start, by which rounding at its start grows.
fn condition(
    integrator: &Integrator<'_>,
    path: &LightPath,
    origin: DVec3,
    to: DVec3,
) -> Option<f64> {
    let choices: Vec<bool> = path.hits.iter().map(|(_, through)| *through).collect();
    let interior =
        integrator.media.dielectrics.interior_at(origin, integrator.scene, integrator.intersector);
    let mut worst: f64 = 1.0;
    for nudge in [DVec3::X, DVec3::Y, DVec3::Z] {
        let direction = to + nudge * (1e-8 * to.length());
        let other = trace_path(integrator, origin, direction, interior.clone(), &choices)?;
        let change = (other.throughput / path.throughput - 1.0).abs().max_element();
        let turned = (other.direction - path.direction).length();
        worst = worst.max(change.max(turned) * 1e8);
    }
    Some(worst)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, max_global_rejects: 10_000, ..ProptestConfig::default() })]
    #[test]
    fn a_path_has_the_same_throughput_from_either_end(
        origin in prop::array::uniform3(-4.0..4.0f64),
        target in prop::array::uniform3(-1.5..1.5f64),
        choices in prop::collection::vec(any::<bool>(), 1..7),
    ) {
        let scene = scene();
        let intersector = BruteForce::new(&scene, Precision::Certified);
        let camera = &scene.cameras[0];
        let integrator =
            Integrator::new(&scene, &intersector, camera, View::Beauty, Tiling::default());
        let origin = DVec3::from(origin);
        let to = DVec3::from(target) - origin;
        prop_assume!(to.length() > 0.1);
        let dielectrics = &integrator.media.dielectrics;
        let interior_at = |point| dielectrics.interior_at(point, &scene, &intersector);
        let there = trace_path(&integrator, origin, to, interior_at(origin), &choices);
        prop_assume!(there.is_some());
        let Some(there) = there else { unreachable!() };
        prop_assume!(there.throughput.min_element() > 1e-6);
        // Mirrors that bulge spread light, and rounding with it; so do angles near the critical one,
        // on the way that leads to them. About ten ulp at each of seven surfaces, a hundredfold,
        // are 8e-13.
        let there_by = condition(&integrator, &there, origin, to);
        prop_assume!(there_by.is_some_and(|c| c < 100.0));
        // Back from a point beyond the last surface, within the same dielectrics.
        let end = there.end;
        prop_assume!(interior_at(end) == there.interior);
        let beyond = dielectrics.transmittance(&Ray::segment(there.position, end), 1.0, &there.interior);
        let ways: Vec<bool> = there.hits.iter().rev().map(|(_, through)| *through).collect();
        let back = trace_path(&integrator, end, -there.direction, interior_at(end), &ways).unwrap();
        let condition = condition(&integrator, &back, end, -there.direction);
        prop_assume!(condition.is_some_and(|c| c < 100.0));
        let mut hits = back.hits.clone();
        hits.reverse();
        prop_assert_eq!(&hits, &there.hits);
        // From its last surface the way back goes on to the origin.
        let rest = dielectrics.transmittance(&Ray::segment(back.position, origin), 1.0, &back.interior);
        let ratio = (back.throughput * rest) / (there.throughput * beyond);
        let off = (ratio - 1.0).abs().max_element();
        prop_assert!(off < 1e-12, "{off:e} over {:?}", there.hits);
    }
}
