//! The intersection of a ray with an infinite plane as exact arithmetic finds it.
//!
//! ```
//! use envers::internals::plane::certified::crossing;
//! use glam::DVec3;
//!
//! let t = |tmax| crossing(DVec3::ZERO, DVec3::Y, DVec3::Y, -DVec3::Y, tmax);
//! assert_eq!((t(1.0), t(1f64.next_up())), (None, Some(1.0)));
//! ```

use std::cmp::Ordering::Equal;

use glam::DVec3;
use num_bigint::BigInt;

use crate::geometry::double_double::{self, DoubleDouble, OMEGA, difference, in_range};
use crate::geometry::integer::{Rounded, Scale, dot, minus, sign};

/// The t at which the ray crosses the plane, with 0 < t < `tmax`; correctly rounded.
///
/// The arguments count as exact numbers, and the comparisons are those of the exact t; the result
/// is the f64 nearest to it (ties to even), but neither 0 nor infinite. A ray within the plane or
/// parallel to it misses, and so does one that is not finite.
pub fn crossing(
    point: DVec3,
    normal: DVec3,
    origin: DVec3,
    direction: DVec3,
    tmax: f64,
) -> Option<f64> {
    let (t, is_certain) = round(point, normal, origin, direction);
    // Where the rounded t is tmax itself, the exact one may lie on either side.
    if is_certain && t != tmax {
        return (t > 0.0 && t < tmax).then_some(t);
    }
    exact_crossing(point, normal, origin, direction).filter(|t| t.is_below(tmax)).map(|t| t.nearest)
}

/// The t of [`crossing`], of either sign, in double-double numbers, and whether it is certain.
#[inline(always)]
pub fn round(point: DVec3, normal: DVec3, origin: DVec3, direction: DVec3) -> (f64, bool) {
    // Each operation has the relative error ω, so that a sum of three products of components of
    // at most α and β is off by 3ωαβ in its terms and 5ωαβ in its sums: 8ωαβ, doubled here.
    let to_point = difference(point, origin);
    let [x, y, z] = to_point.map(|x| x.hi.abs());
    // α for the vector to the plane's point, and β for the normal and the direction.
    let (distance, normal_size) = (x.max(y).max(z), normal.abs().max_element());
    let direction_size = direction.abs().max_element();
    let n = normal.to_array();
    let d = direction.to_array().map(|hi| DoubleDouble { hi, lo: 0.0 });
    let (divisor, bound) = (double_double::dot(d, n), 16.0 * OMEGA * normal_size);
    let divisor_error = bound * direction_size;
    let (t, error) =
        double_double::dot(to_point, n).quotient(bound * distance, divisor, divisor_error);
    let is_certain = (2.0 * bound * direction_size <= divisor.hi.abs())
        & t.rounds_to_hi(error)
        & in_range(distance)
        & in_range(normal_size)
        & in_range(direction_size);
    (t.hi, is_certain)
}

/// True if f64 arithmetic proves that [`crossing`] finds nothing at or before `limit`, a distance that
/// was itself rounded.
///
/// The quotient's two dot products take a difference, three products and two sums. Each operation
/// rounds by half an ε of at most 3 N (P + O) in the numerator and 3 N D in the denominator, with N,
/// P, O and D the largest components of the normal, the point, the origin and the direction. Six
/// operations give 9 ε; 16 ε is allowed, and as many of the least normal numbers for what underflows.
#[inline(always)]
pub fn certainly_misses(
    point: DVec3,
    normal: DVec3,
    origin: DVec3,
    direction: DVec3,
    limit: f64,
) -> bool {
    let largest = |v: DVec3| v.abs().max_element();
    let (numerator, denominator) = (normal.dot(point - origin), normal.dot(direction));
    let error = |size: f64| 16.0 * f64::EPSILON * largest(normal) * size + 16.0 * f64::MIN_POSITIVE;
    let numerator_error = error(largest(point) + largest(origin));
    let denominator_error = error(largest(direction));
    // A NaN compares as false, and is left to `crossing`.
    let behind = (numerator * denominator < 0.0)
        & (numerator.abs() > numerator_error)
        & (denominator.abs() > denominator_error);
    let slack = 1.0 + 8.0 * f64::EPSILON;
    let beyond =
        numerator.abs() - numerator_error > limit * (denominator.abs() + denominator_error) * slack;
    behind | beyond
}

/// The crossing at any t > 0 in integer arithmetic.
#[cold]
fn exact_crossing(point: DVec3, normal: DVec3, origin: DVec3, direction: DVec3) -> Option<Rounded> {
    if ![point, normal, origin, direction].into_iter().all(DVec3::is_finite) {
        return None;
    }
    let positions = Scale::common(point.to_array().into_iter().chain(origin.to_array()));
    let directions = Scale::common(direction.to_array());
    let n = Scale::common(normal.to_array()).vector::<BigInt>(normal);
    let to_point = minus(&positions.vector(point), &positions.vector(origin));
    let (numerator, divisor) = (dot(&n, &to_point), dot(&n, &directions.vector(direction)));
    if sign(&numerator) == Equal || sign(&numerator) != sign(&divisor) {
        return None;
    }
    let exponent = i64::from(positions.exponent) - i64::from(directions.exponent);
    Some(Rounded::quotient(&numerator, &divisor, exponent))
}

#[cfg(test)]
mod tests {
    use std::cmp::Ordering::{self, Equal, Less};

    use proptest::prelude::*;

    use super::*;
    use crate::geometry::dyadic::{self, Dyadic, vector, zip};

    /// The crossing by bisection of the exact quotient.
    fn reference(
        point: DVec3,
        normal: DVec3,
        origin: DVec3,
        direction: DVec3,
        tmax: f64,
    ) -> Option<f64> {
        let n = vector(normal);
        let numerator = dyadic::dot(&n, &zip(&vector(point), &vector(origin), |p, o| p - o));
        let divisor = dyadic::dot(&n, &vector(direction));
        if numerator.sign() == Equal || numerator.sign() != divisor.sign() {
            return None;
        }
        let compare_quotient = |x: &Dyadic| -> Ordering {
            let order = numerator.cmp(&(divisor.clone() * x.clone()));
            if divisor.sign() == Less { order.reverse() } else { order }
        };
        let below = tmax == f64::INFINITY || compare_quotient(&Dyadic::new(tmax)) == Less;
        (below && tmax > 0.0).then(|| dyadic::round(compare_quotient))
    }

    #[test]
    fn both_ends_of_the_ray_are_left_out() {
        let t = |origin, tmax| crossing(DVec3::ZERO, DVec3::Y, origin, -DVec3::Y, tmax);
        assert_eq!(t(DVec3::Y, f64::INFINITY), Some(1.0));
        assert_eq!(t(DVec3::Y, 1.0), None);
        assert_eq!(t(DVec3::ZERO, f64::INFINITY), None);
    }

    #[test]
    fn parallel_ray_misses() {
        let t = |origin| crossing(DVec3::ZERO, DVec3::Y, origin, DVec3::X, f64::INFINITY);
        assert_eq!((t(DVec3::Y), t(DVec3::ZERO)), (None, None));
    }

    #[test]
    fn ray_that_is_not_finite_hits_nothing() {
        let t = |direction| crossing(DVec3::ZERO, DVec3::Y, DVec3::Y, direction, f64::INFINITY);
        assert_eq!((t(DVec3::ZERO), t(DVec3::NAN)), (None, None));
        assert_eq!(t(DVec3::NEG_INFINITY), None);
    }

    fn any_float() -> impl Strategy<Value = f64> {
        prop_oneof![
            -1.0..1.0f64,
            any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |x| x.is_finite()),
            (-4i8..=4).prop_map(f64::from),
        ]
    }

    fn any_vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(any_float()).prop_map(DVec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3_000))]

        #[test]
        fn distances_are_the_nearest_to_the_exact_ones(
            point in any_vector(),
            normal in any_vector(),
            origin in any_vector(),
            direction in any_vector(),
            short in any::<bool>(),
        ) {
            let at = |tmax| reference(point, normal, origin, direction, tmax);
            let tmax = match at(f64::INFINITY) {
                Some(t) if short => t,
                _ => f64::INFINITY,
            };
            prop_assert_eq!(crossing(point, normal, origin, direction, tmax), at(tmax));
        }
    }
}
