//! G6: no sphere shadows itself, seen from outside or from inside, and nothing close above it is
//! passed over.

use glam::{DVec3, Vec3};

use super::cell::{Cell, Draw};
use super::random::Random;
use super::report::Tally;
use super::shapes::{INTERSECTORS, closest, intersectors, occluded};
use crate::error::Result;
use crate::geometry::Ray;
use crate::intersect::Precision;
use crate::measure::oracle;
use crate::scene::{IncidentLight, Material, Scene, Sphere};
use crate::surface::Surface;

const RADII: [f64; 5] = [1e-6, 1e-3, 1.0, 1e3, 1e6];
/// Of the centre from the world's origin, in radii.
const OFFSETS: [f64; 4] = [0.0, 10.0, 1e3, 1e5];
/// The shell's gap, in radii.
const GAP: f64 = 1e-9;

/// The cells.
pub fn cells() -> Vec<Cell> {
    let mut cells = Vec::new();
    for precision in [Precision::Fast, Precision::Certified] {
        let method = format!("{}, {INTERSECTORS}", precision.name());
        for (radius, offset) in RADII.into_iter().flat_map(|r| OFFSETS.map(|o| (r, o))) {
            let name = format!("R {radius:.0e}, centre {offset:.0e} R");
            cells.push(Cell {
                max_relative: 1e-12,
                ..Cell::new(name, &*method, move |draw| itself(radius, offset, precision, draw))
            });
        }
        for radius in RADII {
            let name = format!("shell {GAP:.0e} R above, R {radius:.0e}");
            cells.push(Cell::new(name, &*method, move |draw| shell(radius, precision, draw)));
        }
    }
    cells
}

fn arrival(toward: DVec3) -> IncidentLight {
    IncidentLight { toward, is_bounded: true, intensity: Vec3::ONE }
}

/// Hits a sphere from both sides, and asks from there for lights on both sides.
fn itself(radius: f64, offset: f64, precision: Precision, draw: &Draw) -> Result<Tally> {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let center = draw.shared().direction() * (offset * radius);
    scene.spheres.push(Sphere::new(center, radius, material));
    let intersectors = intersectors(&scene, precision)?;
    let ray = |_, random: &mut Random| {
        let reach = if random.coin() { 0.9 } else { random.range(1.5, 20.0) };
        let origin = center + random.direction() * (radius * reach);
        let target = center + random.in_ball() * (0.99 * radius);
        let light = random.in_ball() * (radius * random.pick(&[0.99, 20.0])) + center;
        (Ray::new(origin, target - origin), light)
    };
    Ok(draw.batch(ray, |rays, tally| {
        let (rays, lights): (Vec<Ray>, Vec<DVec3>) = rays.iter().copied().unzip();
        for who in &intersectors {
            let (mut shadow, mut expected) = (Vec::new(), Vec::new());
            for ((ray, light), hit) in rays.iter().zip(&lights).zip(closest(&**who, &rays)) {
                let Some(hit) = hit else {
                    tally.misclassified += 1; // Aimed at the inside.
                    continue;
                };
                let surface = Surface::new(&scene, ray, &hit);
                let exact = oracle::sphere(center, radius, ray, false);
                let moved = exact.map_or(f64::NAN, |exact| {
                    // f64 holds this point to a thousandth of what is allowed.
                    surface.position.distance(ray.position(exact.to_f64()))
                });
                tally.relative(moved / (radius + center.length()));
                let toward = *light - surface.position;
                shadow.push(surface.shadow_ray(&arrival(toward)));
                // Only its own far side may block: on the way inward to a light outside.
                let inward = surface.geometric_normal.dot(toward) <= 0.0;
                expected.push(inward && light.distance(center) > radius);
            }
            for (found, expected) in occluded(&**who, &shadow).into_iter().zip(expected) {
                tally.wrong_if(found != expected);
            }
        }
    }))
}

/// From the sphere through a shell just above it: the shell is always seen.
fn shell(radius: f64, precision: Precision, draw: &Draw) -> Result<Tally> {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    scene.spheres.push(Sphere::new(DVec3::ZERO, radius, material));
    let inner = scene.clone();
    scene.spheres.push(Sphere::new(DVec3::ZERO, radius * (1.0 + GAP), material));
    let (hitting, asked) = (intersectors(&inner, precision)?, intersectors(&scene, precision)?);
    let ray = |_, random: &mut Random| {
        let origin = random.direction() * (radius * random.range(1.5, 20.0));
        let light = random.direction() * (radius * random.range(1.5, 20.0));
        (Ray::new(origin, random.in_ball() * (0.99 * radius) - origin), light)
    };
    Ok(draw.batch(ray, |rays, tally| {
        let (rays, lights): (Vec<Ray>, Vec<DVec3>) = rays.iter().copied().unzip();
        for (hitting, asked) in hitting.iter().zip(&asked) {
            let mut shadow = Vec::new();
            for ((ray, light), hit) in rays.iter().zip(&lights).zip(closest(&**hitting, &rays)) {
                let Some(hit) = hit else {
                    tally.misclassified += 1;
                    continue;
                };
                let surface = Surface::new(&inner, ray, &hit);
                shadow.push(surface.shadow_ray(&arrival(*light - surface.position)));
            }
            for blocked in occluded(&**asked, &shadow) {
                tally.wrong_if(!blocked);
            }
        }
    }))
}
