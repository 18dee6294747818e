//! The return of light by its own way: a path through mirrors and glass is worth the same from
//! either end.

use glam::{DVec3, Vec3};
use proptest::prelude::*;

use super::bodies::InteriorList;
use super::follow::{PathState, SpawnedRay};
use super::shade::SpecularHit;
use super::{Integrator, Tiling};
use crate::film::View;
use crate::geometry::{PrimitiveId, Ray};
use crate::intersect::{BruteForce, Coherence, Precision};
use crate::scene::{Camera, Material, Plane, Projection, Scene, Sphere};
use crate::surface::{RayCone, Surface};

/// A path: the surfaces that it met, whether it went through each, its share of the light, and
/// where it came out.
#[derive(Clone, Debug)]
struct Walk {
    met: Vec<(PrimitiveId, bool)>,
    throughput: DVec3,
    position: DVec3,
    direction: DVec3,
    /// The bodies at its end.
    inside: InteriorList,
    /// A point farther on, with nothing in between.
    end: DVec3,
}

/// Follows light from `origin` along `direction` over as many surfaces as there are choices: to go
/// through, or to be reflected. Where there is but one way, it takes that.
fn walk(
    integrator: &Integrator<'_>,
    origin: DVec3,
    direction: DVec3,
    inside: InteriorList,
    choices: &[bool],
) -> Option<Walk> {
    let mut ray = Ray::new(origin, direction);
    let mut path =
        PathState { sample: 0, depth: 0, throughput: DVec3::ONE, inside, cone: RayCone::default() };
    let mut met = Vec::new();
    let mut position = origin;
    for &through in choices {
        let (surface, hit) = loop {
            let mut hit = [None];
            integrator.intersector.closest(&[ray], Coherence::Incoherent, &mut hit);
            let hit = hit[0]?;
            path.throughput *= integrator.absorbed(&ray, hit.t, &path.inside);
            let surface = Surface::new(integrator.scene, &ray, &hit);
            let around = integrator.bodies.around(hit.id, surface.side, &path.inside);
            let material = &integrator.scene.materials[surface.material.0 as usize];
            if !integrator.is_clear(material, &material.shading_params(), &around) {
                break (surface, hit);
            }
            ray = ray.continue_past(&hit, surface.side.opposite());
            path.inside = around.behind;
        };
        // Of the two rays at most: the share that goes the chosen way, of all that goes there.
        let mut sent: Vec<SpawnedRay> = Vec::new();
        let finish = integrator.finish_at(&ray, &hit, &surface, &path.cone);
        let bounce = SpecularHit { ray: 0, surface, finish };
        integrator.send_on(&ray, &hit, &bounce, &path, &mut |next| sent.push(next));
        let chosen = sent.iter().position(|next| next.is_refracted == through).unwrap_or(0);
        let next = (!sent.is_empty()).then(|| sent.swap_remove(chosen))?;
        met.push((bounce.surface.id, next.is_refracted));
        position = bounce.surface.position;
        (ray, path) = (next.ray, next.path);
    }
    let mut next = [None];
    integrator.intersector.closest(&[ray], Coherence::Incoherent, &mut next);
    let end = ray.position((ray.start_t() + next[0]?.t) * 0.5);
    let (direction, throughput, inside) = (ray.direction.normalize(), path.throughput, path.inside);
    Some(Walk { met, throughput, position, direction, inside, end })
}

/// Mirrors, glass of three kinds, a pane and water, about the origin.
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

/// By how much the relative change of a path exceeds that of its start, at least 1: what rounding
/// at its start grows to.
fn condition(integrator: &Integrator<'_>, walked: &Walk, origin: DVec3, to: DVec3) -> Option<f64> {
    let choices: Vec<bool> = walked.met.iter().map(|(_, through)| *through).collect();
    let inside = integrator.bodies.holding(origin, integrator.scene, integrator.intersector);
    let mut worst: f64 = 1.0;
    for nudge in [DVec3::X, DVec3::Y, DVec3::Z] {
        let direction = to + nudge * (1e-8 * to.length());
        let other = walk(integrator, origin, direction, inside.clone(), &choices)?;
        let change = (other.throughput / walked.throughput - 1.0).abs().max_element();
        let turned = (other.direction - walked.direction).length();
        worst = worst.max(change.max(turned) * 1e8);
    }
    Some(worst)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, max_global_rejects: 10_000, ..ProptestConfig::default() })]
    #[test]
    fn a_path_is_worth_the_same_from_either_end(
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
        let holding = |point| integrator.bodies.holding(point, &scene, &intersector);
        let there = walk(&integrator, origin, to, holding(origin), &choices);
        prop_assume!(there.is_some());
        let Some(there) = there else { unreachable!() };
        prop_assume!(there.throughput.min_element() > 1e-6);
        // Mirrors that bulge spread light, and rounding with it; so do angles near the critical one,
        // on the way that leads to them. About ten ulp at each of seven surfaces, a hundredfold,
        // are 8e-13.
        let there_by = condition(&integrator, &there, origin, to);
        prop_assume!(there_by.is_some_and(|c| c < 100.0));
        // Back from a point beyond the last surface, within the same bodies.
        let end = there.end;
        prop_assume!(holding(end) == there.inside);
        let beyond = integrator.absorbed(&Ray::segment(there.position, end), 1.0, &there.inside);
        let ways: Vec<bool> = there.met.iter().rev().map(|(_, through)| *through).collect();
        let back = walk(&integrator, end, -there.direction, holding(end), &ways).unwrap();
        let condition = condition(&integrator, &back, end, -there.direction);
        prop_assume!(condition.is_some_and(|c| c < 100.0));
        let mut met = back.met.clone();
        met.reverse();
        prop_assert_eq!(&met, &there.met);
        // From its last surface the way back goes on to the origin.
        let rest = integrator.absorbed(&Ray::segment(back.position, origin), 1.0, &back.inside);
        let ratio = (back.throughput * rest) / (there.throughput * beyond);
        let off = (ratio - 1.0).abs().max_element();
        prop_assert!(off < 1e-12, "{off:e} over {:?}", there.met);
    }
}
