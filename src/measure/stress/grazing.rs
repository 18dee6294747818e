//! G5: thin triangles, hit at a grazing angle from far away.

use glam::DVec3;

use super::{CaseStats, case::Case, random::Random};
use crate::geometry::{Ray, triangle};
use crate::measure::oracle;

/// The heights of the triangles over their base.
const ASPECTS: [f64; 5] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4];
/// The angles between the rays and the triangles, in radians.
const ANGLES: [f64; 5] = ASPECTS;
/// The distances of the rays' origins, in bases of the triangles.
const DISTANCES: [f64; 3] = [10.0, 100.0, 1000.0];
/// The largest error of a barycentric weight that passes: four units in the last place of 1.
const MAX_WEIGHT_ERROR: f64 = 4.0 * f64::EPSILON;

/// A check of a triangle and a ray against the oracle.
type Check = fn([DVec3; 3], &Ray, &mut CaseStats);

/// The methods that are tested, with the largest errors that pass: in ulp, and relative.
const METHODS: [(&str, f64, f64, Check); 2] =
    [("certified", 0.5, 0.0, check_certified), ("fast: t of the plane", 0.0, 1e-10, check_fast)];

/// Returns the cases.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (aspect, angle) in ASPECTS.into_iter().flat_map(|a| ANGLES.map(|b| (a, b))) {
        for (method, max_ulp, max_relative, check) in METHODS {
            let name = format!("aspect {aspect:.0e}, angle {angle:.0e}");
            let case = Case::new(name, method, move |sampler| {
                Ok(sampler.for_each_ray(|index, random, stats| {
                    let distance = DISTANCES[index as usize % DISTANCES.len()];
                    let (corners, ray) = sample_ray(aspect, angle, distance, random);
                    check(corners, &ray, stats);
                }))
            });
            cases.push(Case { kinds: DISTANCES.len() as u64, max_ulp, max_relative, ..case });
        }
    }
    cases
}

/// Returns a triangle of base 1 and height `aspect` about the origin, and a ray toward a point in it
/// or close to its border.
fn sample_ray(aspect: f64, angle: f64, distance: f64, random: &mut Random) -> ([DVec3; 3], Ray) {
    let rotation = random.rotation();
    let apex = DVec3::new(random.range(-0.5, 0.5), aspect, 0.0);
    let corners = [DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.5, 0.0, 0.0), apex];
    // The barycentric weights of the target; half of the rays are at any small distance from the
    // border.
    let mut weights: [f64; 3] = std::array::from_fn(|_| random.range(-0.2, 1.0));
    if random.coin() {
        weights[random.below(3)] = random.pick(&[1.0, -1.0]) * random.power_of_ten(-16.0, -2.0);
    }
    // Weights that nearly cancel are not divided by their sum: the target would be far away.
    let sum = weights.iter().sum::<f64>();
    let sum = if sum.abs() < 0.1 { 1.0 } else { sum };
    let target: DVec3 = corners.iter().zip(weights).map(|(c, w)| *c * (w / sum)).sum();
    // The direction, at this angle to the plane and from either side of it.
    let heading = random.range(0.0, std::f64::consts::TAU);
    let flat = DVec3::new(heading.cos(), heading.sin(), 0.0) * angle.cos();
    let direction = flat + DVec3::Z * (angle.sin() * random.pick(&[1.0, -1.0]));
    let origin = target - direction * distance;
    let ray = Ray::new(rotation * origin, rotation * direction * random.power_of_ten(-2.0, 2.0));
    (corners.map(|c| rotation * c), ray)
}

/// Checks the certified crossing and the error bound of its estimate against the oracle.
fn check_certified(corners: [DVec3; 3], ray: &Ray, stats: &mut CaseStats) {
    let exact = oracle::triangle(corners, ray);
    let found = triangle::certified::crossing(corners, ray.origin, ray.direction, ray.tmax);
    // The estimate, with its bound, must allow for the exact distance.
    if let Some(exact) = &exact {
        let estimate = triangle::certified::estimate(corners, ray.origin, ray.direction);
        stats.count_wrong(estimate.is_outside(exact.t.to_f64().next_up()));
    }
    // The crossing itself: hit or miss, the distance and the weights.
    match (&exact, found) {
        (None, None) => {}
        (Some(exact), Some(found)) => {
            stats.count_ulp(exact.t.ulps_from(found.t));
            let error = (exact.u - found.u).abs().max((exact.v - found.v).abs());
            stats.count_wrong(error > MAX_WEIGHT_ERROR);
        }
        _ => stats.misclassified += 1,
    }
    // The formula of precision `fast`, for comparison.
    let plucker = triangle::intersect(corners, ray.origin, ray.direction)
        .filter(|hit| hit.t > 0.0 && hit.t < ray.tmax);
    stats.count_fast(match (&exact, plucker) {
        (None, None) => Some(0.0),
        (Some(exact), Some(found)) => Some(exact.t.ulps_from(found.t)),
        _ => None,
    });
}

/// Checks the t of a hit in precision `fast` against that of the triangle's plane.
fn check_fast(corners: [DVec3; 3], ray: &Ray, stats: &mut CaseStats) {
    let Some(found) = triangle::intersect(corners, ray.origin, ray.direction) else { return };
    // The exact plane of the corners, whose normal f64 cannot represent.
    match oracle::triangle_plane(corners, ray) {
        Some(exact) => {
            let exact = exact.to_f64();
            stats.count_relative(((found.t - exact) / exact).abs());
        }
        None => stats.misclassified += 1,
    }
}
