//! G1: the distance to a sphere is exact, correctly rounded, and hit and miss are never confused.

use glam::DVec3;

use super::{CaseStats, case::Case, random::Random, textbook};
use crate::geometry::{Ray, sphere};
use crate::measure::oracle;

/// The distances in radii: of the ray's origin from the sphere, or of the sphere from the world's
/// origin.
const DISTANCES: [f64; 10] = [2.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10];
const RADII: [f64; 5] = [1e-6, 1e-3, 1.0, 1e3, 1e6];

/// A method that computes the distance of a ray's first hit of a sphere.
pub type Method = fn(DVec3, f64, &Ray) -> Option<f64>;

/// Computes the distance as in precision `certified`: the method that is tested.
pub fn certified(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
    sphere::certified::first_root(center, radius, ray.origin, ray.direction, ray.tmax, false)
}

/// Computes the distance as in precision `fast`.
pub fn fast(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
    let inverse = sphere::inverse_length_squared(ray.direction);
    let roots = sphere::roots(center, radius, ray.origin, ray.direction, inverse)?;
    sphere::first_root(roots, ray.tmax, false)
}

/// The origins and directions of the rays of a case.
#[derive(Clone, Copy)]
enum Kind {
    Outside,
    AnyLength,
    Inside,
    OnSurface,
    Away,
}

/// Returns the cases, for the certified method or one that should fail.
pub fn cases(method: Method) -> Vec<Case> {
    let kinds = [
        (Kind::Outside, "outside"),
        (Kind::AnyLength, "outside, |d| 1e±150"),
        (Kind::Inside, "inside, |d| 1e±150"),
        (Kind::OnSurface, "on the surface, |d| 1e±150"),
        (Kind::Away, "pointing away, |d| 1e±150"),
    ];
    let mut cases = Vec::new();
    for (kind, name) in kinds {
        for distance in DISTANCES {
            let name = format!("{name}, D/R {distance:.0e}");
            let case = case(name, method, move |index, random| {
                let radius = RADII[index as usize % RADII.len()];
                let (center, ray) = sample_ray(kind, radius, distance * radius, random);
                (center, radius, ray)
            });
            cases.push(Case { kinds: RADII.len() as u64, ..case });
        }
    }
    cases
}

/// Returns the case of the spheres (centre and radius) and rays that `sample` gives for an index and
/// random numbers.
pub fn case(
    name: impl Into<String>,
    method: Method,
    sample: impl Fn(u64, &mut Random) -> (DVec3, f64, Ray) + Sync + 'static,
) -> Case {
    let case = Case::new(name, "certified", move |sampler| {
        Ok(sampler.for_each_ray(|index, random, stats| {
            let (center, radius, ray) = sample(index, random);
            check(method, center, radius, &ray, stats);
        }))
    });
    Case { max_ulp: 0.5, ..case }
}

/// Returns the centre of a random sphere, and a ray.
fn sample_ray(kind: Kind, radius: f64, distance: f64, random: &mut Random) -> (DVec3, Ray) {
    let center = random.direction() * distance;
    // Only the first kind has directions of length 1; the others come close to overflow and underflow.
    let length = match kind {
        Kind::Outside => 1.0,
        _ => random.power_of_ten(-150.0, 150.0),
    };
    let (origin, direction) = match kind {
        Kind::Outside | Kind::AnyLength | Kind::Away => {
            // Aimed at a disc a little larger than the sphere, so that some rays miss.
            let toward = random.direction();
            let origin = center - toward * distance;
            let offset = random.perpendicular(toward) * (1.1 * radius * random.unit().sqrt());
            let direction = center + offset - origin;
            (origin, if matches!(kind, Kind::Away) { -direction } else { direction })
        }
        Kind::Inside => (center + random.in_ball() * (0.999 * radius), random.direction()),
        Kind::OnSurface => (center + random.direction() * radius, random.direction()),
    };
    (center, Ray::new(origin, direction.normalize_or(DVec3::X) * length))
}

/// Checks the method, the error bound of its estimate, and the baselines against the oracle.
fn check(method: Method, center: DVec3, radius: f64, ray: &Ray, stats: &mut CaseStats) {
    let exact = oracle::sphere(center, radius, ray, false);
    let error = |found: Option<f64>| match (&exact, found) {
        (Some(exact), Some(t)) => Some(exact.ulps_from(t)),
        (None, None) => Some(0.0),
        _ => None,
    };
    // The method itself.
    match error(method(center, radius, ray)) {
        Some(error) => stats.count_ulp(error),
        None => stats.misclassified += 1,
    }
    if let Some(exact) = &exact {
        let t = exact.to_f64();
        // The end of a ray is exclusive: test rays that end at the hit, to the last bit, or just
        // beyond it.
        for tmax in [t, t.next_up()] {
            let ray = Ray { tmax, ..*ray };
            let hit = oracle::sphere(center, radius, &ray, false).is_some();
            stats.count_wrong(method(center, radius, &ray).is_some() != hit);
        }
        // The estimate, with its bound, must allow for the exact distance.
        let inverse = sphere::inverse_length_squared(ray.direction);
        let estimate =
            sphere::certified::estimate(center, radius, ray.origin, ray.direction, inverse);
        stats.count_wrong(estimate.is_outside(t.next_up()));
    }
    // The baselines, whose errors are reported and not tested.
    stats.count_fast(error(fast(center, radius, ray)));
    let textbook = error(textbook::sphere(center, radius, ray));
    stats.textbook.get_or_insert_default().count(textbook);
}
