//! G2: rays that all but touch a sphere, or touch it.

use glam::DVec3;

use super::cell::Cell;
use super::random::Random;
use super::spheres::{Method, judge};
use crate::geometry::Ray;

/// The cells, for the certified distance or one that is to fail.
pub fn cells(method: Method) -> Vec<Cell> {
    let beside = (20..=52).map(|k| Cell {
        max_ulp: 0.5,
        ..Cell::new(format!("impact R (1 ± 4·2^-{k})"), "certified", move |draw| {
            Ok(draw.each(|_, random, tally| {
                let (center, radius, ray) = almost_touching(k, random);
                judge(method, center, radius, &ray, tally);
            }))
        })
    });
    let touching = Cell {
        max_ulp: 0.5,
        ..Cell::new("impact R exactly", "certified", move |draw| {
            Ok(draw.each(|_, random, tally| {
                let (center, radius, ray) = touching(random);
                judge(method, center, radius, &ray, tally);
            }))
        })
    };
    beside.chain([touching]).collect()
}

/// A ray whose line passes the centre at R (1 ± 4·2⁻ᵏ), up to what the coordinates round: half of
/// them along an axis, where they round next to nothing.
fn almost_touching(k: i32, random: &mut Random) -> (DVec3, f64, Ray) {
    let radius = random.range(0.5, 2.0);
    let sign = random.pick(&[1.0, -1.0]);
    let impact = radius * (1.0 + sign * 4.0 * f64::powi(2.0, -k));
    let way = random.range(1.5, 16.0);
    let (along, beside) = if random.coin() {
        let axis = random.below(3);
        (DVec3::AXES[axis], DVec3::AXES[(axis + 1) % 3])
    } else {
        let along = random.direction();
        (along, random.across(along))
    };
    let ray = Ray::new(DVec3::ZERO, along * random.power_of_ten(-3.0, 3.0));
    (along * way + beside * impact, radius, ray)
}

/// A ray that touches exactly: (p, q) along it and (−q, p) across it have the length of a
/// Pythagorean triple, and every coordinate is a whole number, times a power of two.
fn touching(random: &mut Random) -> (DVec3, f64, Ray) {
    let (p, q, length) =
        random.pick(&[(3.0, 4.0, 5.0), (5.0, 12.0, 13.0), (8.0, 15.0, 17.0), (20.0, 21.0, 29.0)]);
    let whole = |random: &mut Random, n: usize| 1.0 + random.below(n) as f64;
    let (way, size) = (whole(random, 1 << 20), whole(random, 1 << 10));
    let scale = f64::powi(2.0, random.below(41) as i32 - 20);
    let axis = random.below(3);
    let place = |x: f64, y: f64| {
        let mut v = [0.0; 3];
        (v[axis], v[(axis + 1) % 3]) = (x * scale, y * scale);
        DVec3::from(v)
    };
    let away: [f64; 3] = std::array::from_fn(|_| whole(random, 1 << 20) * scale);
    let away = DVec3::from(away);
    let center = away + place(p, q) * way + place(-q, p) * size;
    (center, length * size * scale, Ray::new(away, place(p, q)))
}
