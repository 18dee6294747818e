//! G5: thin triangles, met at a small angle from far away.

use glam::DVec3;

use super::cell::Cell;
use super::random::Random;
use super::report::{Beside, Tally};
use crate::geometry::{Ray, triangle};
use crate::measure::oracle;

const ASPECTS: [f64; 5] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4];
const ANGLES: [f64; 5] = ASPECTS;
const DISTANCES: [f64; 3] = [10.0, 100.0, 1000.0];
/// How far the weights may be off: four units in the last place of 1.
const WEIGHT: f64 = 4.0 * f64::EPSILON;

/// The cells.
pub fn cells() -> Vec<Cell> {
    let mut cells = Vec::new();
    for (aspect, angle) in ASPECTS.into_iter().flat_map(|a| ANGLES.map(|b| (a, b))) {
        let name = format!("aspect {aspect:.0e}, angle {angle:.0e}");
        let kinds = DISTANCES.len() as u64;
        cells.push(Cell {
            kinds,
            max_ulp: 0.5,
            ..Cell::new(name.clone(), "certified", move |draw| {
                Ok(draw.each(|index, random, tally| {
                    let distance = DISTANCES[index as usize % DISTANCES.len()];
                    let (corners, ray) = graze(aspect, angle, distance, random);
                    certified(corners, &ray, tally);
                }))
            })
        });
        cells.push(Cell {
            kinds,
            max_relative: 1e-10,
            ..Cell::new(name, "fast: t of the plane", move |draw| {
                Ok(draw.each(|index, random, tally| {
                    let distance = DISTANCES[index as usize % DISTANCES.len()];
                    let (corners, ray) = graze(aspect, angle, distance, random);
                    fast(corners, &ray, tally);
                }))
            })
        });
    }
    cells
}

/// A triangle of base 1 and height `aspect` about the origin, and a ray toward a point in or just
/// beside it.
fn graze(aspect: f64, angle: f64, distance: f64, random: &mut Random) -> ([DVec3; 3], Ray) {
    let turn = random.turn();
    let apex = DVec3::new(random.range(-0.5, 0.5), aspect, 0.0);
    let corners = [DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.5, 0.0, 0.0), apex];
    // Weights around the triangle: half of the rays near its border, by any distance.
    let mut weights: [f64; 3] = std::array::from_fn(|_| random.range(-0.2, 1.0));
    if random.coin() {
        weights[random.below(3)] = random.pick(&[1.0, -1.0]) * random.power_of_ten(-16.0, -2.0);
    }
    let sum = weights.iter().sum::<f64>();
    let sum = if sum.abs() < 0.1 { 1.0 } else { sum };
    let target: DVec3 = corners.iter().zip(weights).map(|(c, w)| *c * (w / sum)).sum();
    let heading = random.range(0.0, std::f64::consts::TAU);
    let flat = DVec3::new(heading.cos(), heading.sin(), 0.0) * angle.cos();
    let direction = flat + DVec3::Z * (angle.sin() * random.pick(&[1.0, -1.0]));
    let origin = target - direction * distance;
    let ray = Ray::new(turn * origin, turn * direction * random.power_of_ten(-2.0, 2.0));
    (corners.map(|c| turn * c), ray)
}

fn certified(corners: [DVec3; 3], ray: &Ray, tally: &mut Tally) {
    let exact = oracle::triangle(corners, ray);
    let found = triangle::certified::crossing(corners, ray.origin, ray.direction, ray.tmax);
    if let Some(exact) = &exact {
        let estimate = triangle::certified::estimate(corners, ray.origin, ray.direction);
        tally.wrong_if(estimate.is_outside(exact.t.to_f64().next_up()));
    }
    match (&exact, found) {
        (None, None) => {}
        (Some(exact), Some(found)) => {
            tally.ulp(exact.t.ulps_from(found.t));
            let off = (exact.u - found.u).abs().max((exact.v - found.v).abs());
            tally.wrong_if(off > WEIGHT);
        }
        _ => tally.misclassified += 1,
    }
    let plucker = triangle::intersect(corners, ray.origin, ray.direction)
        .filter(|hit| hit.t > 0.0 && hit.t < ray.tmax);
    tally.fast.get_or_insert_with(Beside::default).count(match (&exact, plucker) {
        (None, None) => Some(0.0),
        (Some(exact), Some(found)) => Some(exact.t.ulps_from(found.t)),
        _ => None,
    });
}

/// Where precision `fast` reports a hit, its t is that of the exact plane.
fn fast(corners: [DVec3; 3], ray: &Ray, tally: &mut Tally) {
    let Some(found) = triangle::intersect(corners, ray.origin, ray.direction) else { return };
    // The plane through the corners exactly, which no normal in f64 describes.
    match oracle::plane_of(corners, ray) {
        Some(exact) => {
            let exact = exact.to_f64();
            tally.relative(((found.t - exact) / exact).abs());
        }
        None => tally.misclassified += 1,
    }
}
