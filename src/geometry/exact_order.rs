//! The exact order of two crossings on one line: which comes first, where the distances round alike.
//!
//! A distance is (p ± √q)/a with integers: q = 0 and a quotient for planes and triangles, a root of
//! the quadratic equation for spheres. The sign of the difference of two of them follows from signs of
//! integers, by squaring away one root after the other.

use std::cmp::Ordering::{self, Equal, Greater, Less};

use glam::DVec3;
use num_bigint::BigInt;

use crate::geometry::integer::{Scale, cross, dot, minus, sign};

/// The surface that a line crosses, and which of its crossings is meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CrossedSurface {
    /// A sphere, crossed at its first root above 0, or with `far` at the far one.
    Sphere {
        /// The centre.
        center: DVec3,
        /// The radius.
        radius: f64,
        /// True if the far root is meant, whichever is the first above 0.
        far: bool,
    },
    /// An infinite plane.
    Plane {
        /// A point of it.
        point: DVec3,
        /// Its normal, of any length.
        normal: DVec3,
    },
    /// The plane of a triangle.
    Triangle([DVec3; 3]),
}

/// Compares the exact distances at which the line `origin + t·direction` crosses two surfaces.
///
/// All arguments must be finite, and the line must cross both surfaces.
#[cold]
pub fn compare(
    first: &CrossedSurface,
    second: &CrossedSurface,
    origin: DVec3,
    direction: DVec3,
) -> Ordering {
    // Copies at one place are crossed at the same point.
    if first == second {
        return Ordering::Equal;
    }
    // On one scale for all lengths the distances are numbers in one unit.
    let lengths = origin.to_array().into_iter().chain(first.lengths()).chain(second.lengths());
    let lengths = Scale::common(lengths);
    let direction = Scale::common(direction.to_array()).vector(direction);
    let line = Line { origin: lengths.vector(origin), direction, lengths };
    let [a, b] = [first, second].map(|surface| line.distance(surface));

    // The sign of a − b, times both denominators.
    let rational = &a.rational * &b.denominator - &b.rational * &a.denominator;
    let first_root = Root { radicand: a.root.radicand * b.denominator.pow(2), ..a.root };
    let second_root =
        Root { radicand: b.root.radicand * a.denominator.pow(2), is_negative: !b.root.is_negative };
    sign_with_two_roots(rational, first_root, second_root)
}

impl CrossedSurface {
    /// The coordinates and lengths that share a scale with those of the line.
    fn lengths(&self) -> Vec<f64> {
        match self {
            Self::Sphere { center, radius, .. } => vec![center.x, center.y, center.z, *radius],
            Self::Plane { point, .. } => point.to_array().to_vec(),
            Self::Triangle(vertices) => vertices.iter().flat_map(DVec3::to_array).collect(),
        }
    }
}

/// A line in integers, with the scale of all lengths.
struct Line {
    origin: [BigInt; 3],
    direction: [BigInt; 3],
    lengths: Scale,
}

/// The number ±√radicand.
struct Root {
    radicand: BigInt,
    is_negative: bool,
}

/// The number (rational + root) / denominator, with a denominator above 0.
struct Distance {
    rational: BigInt,
    root: Root,
    denominator: BigInt,
}

impl Line {
    /// The distance of a crossing, in the unit that the scales of lengths and directions give.
    fn distance(&self, surface: &CrossedSurface) -> Distance {
        let relative = |p: DVec3| minus(&self.lengths.vector(p), &self.origin);
        match *surface {
            CrossedSurface::Sphere { center, radius, far } => {
                let to_center = relative(center);
                let radius: BigInt = self.lengths.integer(radius);
                let a = dot(&self.direction, &self.direction);
                let b = dot(&to_center, &self.direction);
                let c = dot(&to_center, &to_center) - &radius * &radius;
                // From outside the first root is the near one, and from inside the far one.
                let is_near = !far && sign(&c) == Greater;
                let radicand = &b * &b - &a * &c;
                let root = Root { radicand, is_negative: is_near };
                Distance { rational: b, root, denominator: a }
            }
            CrossedSurface::Plane { point, normal } => {
                let normal = Scale::common(normal.to_array()).vector(normal);
                self.quotient(&normal, &relative(point))
            }
            CrossedSurface::Triangle(vertices) => {
                let [a, b, c] = vertices.map(relative);
                self.quotient(&cross(&minus(&b, &a), &minus(&c, &a)), &a)
            }
        }
    }

    /// The distance of a plane: n·p / n·d, with p from the origin to a point of it.
    fn quotient(&self, normal: &[BigInt; 3], to_point: &[BigInt; 3]) -> Distance {
        let (mut rational, mut denominator) = (dot(normal, to_point), dot(normal, &self.direction));
        if sign(&denominator) == Less {
            (rational, denominator) = (-rational, -denominator);
        }
        let root = Root { radicand: BigInt::ZERO, is_negative: false };
        Distance { rational, root, denominator }
    }
}

impl Root {
    fn sign(&self) -> Ordering {
        let sign = sign(&self.radicand);
        if self.is_negative { sign.reverse() } else { sign }
    }
}

/// The sign of `rational + root`.
fn sign_with_root(rational: &BigInt, root: &Root) -> Ordering {
    larger_sign(sign(rational), root.sign(), || (rational * rational).cmp(&root.radicand))
}

/// The sign of `rational + first + second`.
fn sign_with_two_roots(rational: BigInt, first: Root, second: Root) -> Ordering {
    larger_sign(sign_with_root(&rational, &first), second.sign(), || {
        // (k ± √p)² − q = (k² + p − q) ± √(4k²p).
        let square = &rational * &rational;
        let rest = &square + &first.radicand - &second.radicand;
        let is_negative = (sign(&rational) == Less) != first.is_negative;
        sign_with_root(&rest, &Root { radicand: 4 * square * first.radicand, is_negative })
    })
}

/// The sign of a sum of two terms by their signs, and where these differ by the order of their squares.
fn larger_sign(a: Ordering, b: Ordering, compare_squares: impl FnOnce() -> Ordering) -> Ordering {
    match (a, b) {
        (Equal, sign) | (sign, Equal) => sign,
        (a, b) if a == b => a,
        (a, b) => match compare_squares() {
            Greater => a,
            Equal => Equal,
            Less => b,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sphere(radius: f64, far: bool) -> CrossedSurface {
        CrossedSurface::Sphere { center: DVec3::ZERO, radius, far }
    }

    fn wall(x: f64) -> CrossedSurface {
        CrossedSurface::Plane { point: DVec3::X * x, normal: DVec3::new(-3.0, 0.0, 0.0) }
    }

    /// Two surfaces by the x axis, which the line runs along from −`distance` on.
    fn along_x(a: CrossedSurface, b: CrossedSurface, distance: f64) -> Ordering {
        let order = compare(&a, &b, DVec3::X * -distance, DVec3::X * 7.0);
        assert_eq!(compare(&b, &a, DVec3::X * -distance, DVec3::X * 7.0), order.reverse());
        order
    }

    #[test]
    fn surfaces_whose_distances_round_alike_keep_their_order() {
        let shell = 1.0 + f64::EPSILON;
        for distance in [4.0, 1e9, 1e15] {
            assert_eq!(along_x(sphere(shell, false), sphere(1.0, false), distance), Less);
            assert_eq!(along_x(sphere(shell, true), sphere(1.0, true), distance), Greater);
            assert_eq!(along_x(wall(-shell), sphere(1.0, false), distance), Less);
            assert_eq!(along_x(wall(1.0), sphere(shell, true), distance), Less);
            assert_eq!(along_x(wall(1.0), wall(shell), distance), Less);
        }
    }

    #[test]
    fn surfaces_that_touch_are_at_the_same_distance() {
        let [up, side] = [DVec3::Y, DVec3::Z];
        let triangle = CrossedSurface::Triangle([DVec3::X + up, DVec3::X - up, DVec3::X + side]);
        for other in [sphere(1.0, true), wall(1.0), triangle] {
            assert_eq!(along_x(triangle, other, 1e9), Equal);
        }
        // The tangent point of two spheres, by a line through both centres.
        let other = CrossedSurface::Sphere { center: DVec3::X * 3.0, radius: 2.0, far: false };
        assert_eq!(along_x(sphere(1.0, true), other, 1e9), Equal);
    }

    #[test]
    fn the_first_root_from_inside_is_the_far_one() {
        assert_eq!(along_x(sphere(2.0, false), wall(1.5), 1.0), Greater);
        assert_eq!(along_x(sphere(2.0, false), sphere(2.0, true), 1.0), Equal);
    }

    proptest! {
        #[test]
        fn distances_that_round_apart_are_in_the_order_of_the_rounded(
            center in prop::array::uniform3(-1.0..1.0f64),
            radius in 3.0..6.0f64,
            plane in -9.0..9.0f64,
            target in prop::array::uniform3(-0.5..0.5f64),
        ) {
            use crate::geometry::{plane as planes, sphere as spheres};
            let (center, origin) = (DVec3::from(center), DVec3::new(-10.0, 1.0, 2.0));
            let direction = DVec3::from(target) - origin;
            let ball = CrossedSurface::Sphere { center, radius, far: false };
            let t = spheres::certified::first_root(
                center, radius, origin, direction, f64::INFINITY, false,
            ).unwrap();
            let (point, normal) = (DVec3::X * plane, DVec3::new(1.0, 0.25, 0.0));
            let crossing =
                planes::certified::crossing(point, normal, origin, direction, f64::INFINITY);
            prop_assume!(crossing.is_some_and(|other| other != t));
            let order = compare(&ball, &CrossedSurface::Plane { point, normal }, origin, direction);
            prop_assert_eq!(Some(order), t.partial_cmp(&crossing.unwrap()));
        }
    }
}
