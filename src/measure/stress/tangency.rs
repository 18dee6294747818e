//! G2: tangents of spheres, and rays close to a tangent.

use glam::DVec3;

use super::{Method, case::Case, random::Random, sphere_distance::case};
use crate::geometry::Ray;

/// Returns the cases, for the certified method or one that should fail.
pub fn cases(method: Method) -> Vec<Case> {
    let near_tangents = (20..=52).map(|k| {
        let name = format!("impact R (1 ± 4·2^-{k})");
        case(name, method, move |_, random| near_tangent(k, random))
    });
    let tangents = case("impact R exactly", method, |_, random| tangent(random));
    near_tangents.chain([tangents]).collect()
}

/// Returns a sphere and a ray whose line passes the centre at R (1 ± 4·2⁻ᵏ), up to the rounding of
/// the coordinates. Half of the rays are along an axis, where this rounding is least.
fn near_tangent(k: i32, random: &mut Random) -> (DVec3, f64, Ray) {
    let radius = random.range(0.5, 2.0);
    let sign = random.pick(&[1.0, -1.0]);
    let impact = radius * (1.0 + sign * 4.0 * f64::powi(2.0, -k));
    let distance = random.range(1.5, 16.0);
    // The direction of the ray, and one across it to the sphere's centre.
    let (along, across) = if random.coin() {
        let axis = random.below(3);
        (DVec3::AXES[axis], DVec3::AXES[(axis + 1) % 3])
    } else {
        let along = random.direction();
        (along, random.perpendicular(along))
    };
    let ray = Ray::new(DVec3::ZERO, along * random.power_of_ten(-3.0, 3.0));
    (along * distance + across * impact, radius, ray)
}

/// Returns a sphere and a ray that is exactly a tangent: (p, q) along it and (−q, p) across it have the
/// length of a Pythagorean triple, and every coordinate is an integer times a power of two.
fn tangent(random: &mut Random) -> (DVec3, f64, Ray) {
    let (p, q, length) =
        random.pick(&[(3.0, 4.0, 5.0), (5.0, 12.0, 13.0), (8.0, 15.0, 17.0), (20.0, 21.0, 29.0)]);
    // Integers so small that all products below are exact in f64.
    let integer = |random: &mut Random, n: usize| 1.0 + random.below(n) as f64;
    let (distance, size) = (integer(random, 1 << 20), integer(random, 1 << 10));
    let scale = f64::powi(2.0, random.below(41) as i32 - 20);
    // The triple lies in a plane of two axes, so that the third coordinate of ray and sphere is the same.
    let axis = random.below(3);
    let in_plane = |x: f64, y: f64| {
        let mut v = [0.0; 3];
        (v[axis], v[(axis + 1) % 3]) = (x * scale, y * scale);
        DVec3::from(v)
    };
    let origin: [f64; 3] = std::array::from_fn(|_| integer(random, 1 << 20) * scale);
    let origin = DVec3::from(origin);
    let center = origin + in_plane(p, q) * distance + in_plane(-q, p) * size;
    (center, length * size * scale, Ray::new(origin, in_plane(p, q)))
}
