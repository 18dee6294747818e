//! The intersection of a ray with a sphere as exact arithmetic finds it.
//!
//! There are three stages, each of which passes on what it cannot decide: [`QuadraticBound`] bounds t
//! in f64, [`round`] takes one Newton step with a double-double residual, and `exact` computes with
//! integers.
//!
//! ```
//! use envers::internals::sphere::certified::first_root;
//! use glam::DVec3;
//!
//! // A tangent is a hit, and one ulp less of radius a miss.
//! let (center, direction) = (DVec3::X * 5.0, DVec3::new(4.0, 3.0, 0.0));
//! let t = |radius| first_root(center, radius, DVec3::ZERO, direction, f64::INFINITY, false);
//! assert_eq!((t(3.0), t(3f64.next_down())), (Some(0.8), None));
//! ```

mod exact;
mod newton;
mod quadratic_bound;
#[cfg(test)]
mod tests;

pub use newton::{RoundedRoot, round};
pub use quadratic_bound::QuadraticBound;

use glam::DVec3;

use crate::geometry::Estimate;
use crate::geometry::sphere::inverse_length_squared;

/// The first t > 0 at which the ray hits the sphere, in f64 with a bound on its error.
///
/// `inverse_length_squared` is that of the direction, by [`inverse_length_squared`].
#[inline(always)]
pub fn estimate(
    center: DVec3,
    radius: f64,
    origin: DVec3,
    direction: DVec3,
    inverse_length_squared: f64,
) -> Estimate {
    QuadraticBound::new(center, radius, origin, direction, inverse_length_squared).estimate()
}

/// The first t at which the ray hits the sphere, with 0 < t < `tmax`; correctly rounded.
///
/// The arguments count as exact numbers, and the comparisons are those of the exact t; the result
/// is the f64 nearest to it (ties to even), but neither 0 nor infinite. A tangent is a hit. With
/// `leaving_inward` only the far root counts. A ray without a direction, or one that is not finite,
/// misses.
pub fn first_root(
    center: DVec3,
    radius: f64,
    origin: DVec3,
    direction: DVec3,
    tmax: f64,
    leaving_inward: bool,
) -> Option<f64> {
    // Bounds in f64 rule out most misses.
    let inverse = inverse_length_squared(direction);
    let quadratic = QuadraticBound::new(center, radius, origin, direction, inverse);
    if !quadratic.may_cross() {
        return None;
    }
    let estimate = quadratic.estimate();
    if !leaving_inward && (estimate == Estimate::MISS || estimate.lower() >= tmax) {
        return None;
    }
    // Newton steps decide nearly all others. Where the rounded t is tmax itself, the exact one may
    // lie on either side.
    let rounded = newton::round_with_retries(&quadratic, leaving_inward);
    if rounded.is_certain && rounded.t != tmax {
        return (rounded.t < tmax).then_some(rounded.t);
    }
    // Integers decide the rest.
    exact::first_root(center, radius, origin, direction, leaving_inward)
        .filter(|t| t.is_below(tmax))
        .map(|t| t.nearest)
}
