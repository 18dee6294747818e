//! G1: the distance to a sphere is the exact one, correctly rounded; none is missed or made up.

use glam::DVec3;

use super::cell::Cell;
use super::naive;
use super::random::Random;
use super::report::{Beside, Tally};
use crate::geometry::{Ray, sphere};
use crate::measure::oracle;

/// Distances in radii: of the eye from the sphere, or of the sphere from the world's origin.
pub const DISTANCES: [f64; 10] = [2.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10];
const RADII: [f64; 5] = [1e-6, 1e-3, 1.0, 1e3, 1e6];

/// A way to find the first distance to a sphere.
pub type Method = fn(DVec3, f64, &Ray) -> Option<f64>;

/// The method that is tested.
pub fn certified(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
    sphere::certified::first_root(center, radius, ray.origin, ray.direction, ray.tmax, false)
}

/// The formula of precision `fast`.
pub fn fast(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
    let inverse = sphere::inverse_length_squared(ray.direction);
    let roots = sphere::roots(center, radius, ray.origin, ray.direction, inverse)?;
    sphere::first_root(roots, ray.tmax, false)
}

/// Where the rays of a cell start and go.
#[derive(Clone, Copy)]
enum Kind {
    Outside,
    AnyLength,
    Inside,
    OnSurface,
    Away,
}

/// The cells, for the certified distance or one that is to fail.
pub fn cells(method: Method) -> Vec<Cell> {
    let kinds = [
        (Kind::Outside, "outside"),
        (Kind::AnyLength, "outside, |d| 1e±150"),
        (Kind::Inside, "inside, |d| 1e±150"),
        (Kind::OnSurface, "on the surface, |d| 1e±150"),
        (Kind::Away, "pointing away, |d| 1e±150"),
    ];
    let mut cells = Vec::new();
    for (kind, name) in kinds {
        for distance in DISTANCES {
            let name = format!("{name}, D/R {distance:.0e}");
            cells.push(Cell {
                kinds: RADII.len() as u64,
                max_ulp: 0.5,
                ..Cell::new(name, "certified", move |draw| {
                    Ok(draw.each(|index, random, tally| {
                        let radius = RADII[index as usize % RADII.len()];
                        let (center, ray) = aim(kind, radius, distance * radius, random);
                        judge(method, center, radius, &ray, tally);
                    }))
                })
            });
        }
    }
    cells
}

fn aim(kind: Kind, radius: f64, distance: f64, random: &mut Random) -> (DVec3, Ray) {
    let center = random.direction() * distance;
    let length = match kind {
        Kind::Outside => 1.0,
        _ => random.power_of_ten(-150.0, 150.0),
    };
    let (origin, direction) = match kind {
        Kind::Outside | Kind::AnyLength | Kind::Away => {
            let toward = random.direction();
            let origin = center - toward * distance;
            let beside = random.across(toward) * (1.1 * radius * random.unit().sqrt());
            let direction = center + beside - origin;
            (origin, if matches!(kind, Kind::Away) { -direction } else { direction })
        }
        Kind::Inside => (center + random.in_ball() * (0.999 * radius), random.direction()),
        Kind::OnSurface => (center + random.direction() * radius, random.direction()),
    };
    (center, Ray::new(origin, direction.normalize_or(DVec3::X) * length))
}

/// Holds the method, the estimate before it, and the lesser formulas against the oracle.
pub fn judge(method: Method, center: DVec3, radius: f64, ray: &Ray, tally: &mut Tally) {
    let exact = oracle::sphere(center, radius, ray, false);
    let error = |found: Option<f64>| match (&exact, found) {
        (Some(exact), Some(t)) => Some(exact.ulps_from(t)),
        (None, None) => Some(0.0),
        _ => None,
    };
    match error(method(center, radius, ray)) {
        Some(error) => tally.ulp(error),
        None => tally.misclassified += 1,
    }
    if let Some(exact) = &exact {
        let t = exact.to_f64();
        // The ends are strict: a ray that ends at the hit, to the last bit, or just beyond it.
        for tmax in [t, t.next_up()] {
            let ray = Ray { tmax, ..*ray };
            let hit = oracle::sphere(center, radius, &ray, false).is_some();
            tally.wrong_if(method(center, radius, &ray).is_some() != hit);
        }
        let inverse = sphere::inverse_length_squared(ray.direction);
        let estimate =
            sphere::certified::estimate(center, radius, ray.origin, ray.direction, inverse);
        tally.wrong_if(estimate.is_outside(t.next_up()));
    }
    tally.fast.get_or_insert_with(Beside::default).count(error(fast(center, radius, ray)));
    let naive = naive::sphere(center, radius, ray);
    tally.naive.get_or_insert_with(Beside::default).count(error(naive));
}
