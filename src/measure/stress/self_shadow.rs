//! G6: no sphere shadows itself, hit from outside or from inside, and no occluder close to its surface
//! is missed.

use glam::{DVec3, Vec3};

use super::backends::{intersector_names, intersectors};
use super::case::{Case, RaySampler};
use super::{CaseStats, random::Random};
use crate::error::Result;
use crate::geometry::Ray;
use crate::intersect::{Coherence::Incoherent, Precision};
use crate::measure::oracle;
use crate::measure::trace::{closest, occluded};
use crate::scene::{IncidentLight, Material, Scene, Sphere};
use crate::surface::Surface;

/// The radii of the spheres.
const RADII: [f64; 5] = [1e-6, 1e-3, 1.0, 1e3, 1e6];
/// The distances of the centre from the world's origin, in radii.
const OFFSETS: [f64; 4] = [0.0, 10.0, 1e3, 1e5];
/// The gap between the sphere and the shell around it, in radii.
const GAP: f64 = 1e-9;

/// Returns the cases.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for precision in [Precision::Fast, Precision::Certified] {
        let method = format!("{}, {}", precision.name(), intersector_names());
        for (radius, offset) in RADII.into_iter().flat_map(|r| OFFSETS.map(|o| (r, o))) {
            let name = format!("R {radius:.0e}, centre {offset:.0e} R");
            cases.push(Case {
                max_relative: 1e-12,
                ..Case::new(name, &*method, move |sampler| {
                    check_sphere(radius, offset, precision, sampler)
                })
            });
        }
        for radius in RADII {
            let name = format!("shell {GAP:.0e} R above, R {radius:.0e}");
            cases.push(Case::new(name, &*method, move |sampler| {
                check_shell(radius, precision, sampler)
            }));
        }
    }
    cases
}

/// Returns a scene of spheres, given by their centres and radii.
fn scene(spheres: &[(DVec3, f64)]) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let sphere = |&(center, radius): &_| Sphere::new(center, radius, material);
    scene.spheres.extend(spheres.iter().map(sphere));
    scene
}

/// Returns the light of a source at a finite distance, given as a vector toward it.
pub fn incident_light(toward: DVec3) -> IncidentLight {
    IncidentLight { toward, is_bounded: true, intensity: Vec3::ONE }
}

/// Checks hits of a sphere from both sides, and shadow rays from there to lights on both sides.
fn check_sphere(
    radius: f64,
    offset: f64,
    precision: Precision,
    sampler: &RaySampler,
) -> Result<CaseStats> {
    let center = sampler.shared_random().direction() * (offset * radius);
    let scene = scene(&[(center, radius)]);
    let intersectors = intersectors(&scene, precision)?;
    // Rays at the sphere from inside or outside, each with a light inside it or anywhere near.
    let ray = |random: &mut Random| {
        let reach = if random.coin() { 0.9 } else { random.range(1.5, 20.0) };
        let origin = center + random.direction() * (radius * reach);
        let target = center + random.in_ball() * (0.99 * radius);
        let light = random.in_ball() * (radius * random.pick(&[0.99, 20.0])) + center;
        (Ray::new(origin, target - origin), light)
    };
    Ok(sampler.for_each_batch(ray, |rays, stats| {
        let (rays, lights): (Vec<Ray>, Vec<DVec3>) = rays.iter().copied().unzip();
        for intersector in &intersectors {
            // The primary rays: all must hit, at the right point.
            let (mut shadow, mut expected) = (Vec::new(), Vec::new());
            let hits = closest(&**intersector, &rays, Incoherent);
            for ((ray, light), hit) in rays.iter().zip(&lights).zip(hits) {
                let Some(hit) = hit else {
                    stats.misclassified += 1; // The ray is aimed at the inside.
                    continue;
                };
                let surface = Surface::new(&scene, ray, &hit);
                let exact = oracle::sphere(center, radius, ray, false);
                let error = exact.map_or(f64::NAN, |exact| {
                    // The rounding of this point is a thousandth of the error that passes.
                    surface.position.distance(ray.position(exact.to_f64()))
                });
                stats.count_relative(error / (radius + center.length()));
                let toward = *light - surface.position;
                shadow.push(surface.shadow_ray(ray.direction, &incident_light(toward)));
                // Only the far side of the sphere blocks light, from outside toward a point inside.
                let inward = surface.geometric_normal.dot(toward) <= 0.0;
                expected.push(inward && light.distance(center) > radius);
            }
            // The shadow rays from these hits.
            stats.count_different(&occluded(&**intersector, &shadow, Incoherent), &expected);
        }
    }))
}

/// Checks that a shell just above a sphere blocks every shadow ray from the sphere to the outside.
fn check_shell(radius: f64, precision: Precision, sampler: &RaySampler) -> Result<CaseStats> {
    // Primary rays see the sphere alone; its shell is there for shadow rays only.
    let (sphere, shell) = ((DVec3::ZERO, radius), (DVec3::ZERO, radius * (1.0 + GAP)));
    let (inner, both) = (scene(&[sphere]), scene(&[sphere, shell]));
    let (primary, shadow) = (intersectors(&inner, precision)?, intersectors(&both, precision)?);
    let ray = |random: &mut Random| {
        let origin = random.direction() * (radius * random.range(1.5, 20.0));
        let light = random.direction() * (radius * random.range(1.5, 20.0));
        (Ray::new(origin, random.in_ball() * (0.99 * radius) - origin), light)
    };
    Ok(sampler.for_each_batch(ray, |rays, stats| {
        let (rays, lights): (Vec<Ray>, Vec<DVec3>) = rays.iter().copied().unzip();
        for (primary, shadow) in primary.iter().zip(&shadow) {
            let mut shadow_rays = Vec::new();
            let hits = closest(&**primary, &rays, Incoherent);
            for ((ray, light), hit) in rays.iter().zip(&lights).zip(hits) {
                let Some(hit) = hit else {
                    stats.misclassified += 1;
                    continue;
                };
                let surface = Surface::new(&inner, ray, &hit);
                shadow_rays.push(
                    surface.shadow_ray(ray.direction, &incident_light(*light - surface.position)),
                );
            }
            for is_occluded in occluded(&**shadow, &shadow_rays, Incoherent) {
                stats.count_wrong(!is_occluded);
            }
        }
    }))
}
