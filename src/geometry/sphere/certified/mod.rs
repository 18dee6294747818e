//! Ray and sphere, proven: the answer of exact arithmetic.
//!
//! Three stages, each passing on what it cannot decide: [`QuadraticBound`] bounds t in f64, [`round`] takes
//! one Newton step with a double-double residual, and `exact` computes with integers.

mod exact;
mod line;
mod newton;
#[cfg(test)]
mod tests;

pub use line::QuadraticBound;
pub use newton::{RoundedRoot, round};

use glam::DVec3;

use crate::geometry::Estimate;
use crate::geometry::sphere::inverse_length_squared;

/// The first t > 0 at which the ray meets the sphere, as f64 arithmetic can bound it.
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

/// The first t with 0 < t < `tmax`, exactly, correctly rounded.
///
/// The numbers given are taken as they stand and the comparisons are those of the exact t; what
/// is returned is the nearest f64 (ties to even), but neither 0 nor infinite. A tangent is a hit.
/// With `leaving_inward` only the far root counts. A ray without a direction, or one that is not
/// finite, meets nothing.
pub fn first_root(
    center: DVec3,
    radius: f64,
    origin: DVec3,
    direction: DVec3,
    tmax: f64,
    leaving_inward: bool,
) -> Option<f64> {
    let inverse = inverse_length_squared(direction);
    let line = QuadraticBound::new(center, radius, origin, direction, inverse);
    if !line.may_cross() {
        return None;
    }
    let estimate = line.estimate();
    if !leaving_inward && (estimate == Estimate::MISS || estimate.lower() >= tmax) {
        return None;
    }
    let rounded = newton::round_with_retries(&line, leaving_inward);
    // Where the rounded t is tmax itself, the exact one may lie on either side.
    if rounded.is_certain && rounded.t != tmax {
        return (rounded.t < tmax).then_some(rounded.t);
    }
    exact::first_root(center, radius, origin, direction, leaving_inward)
        .filter(|t| t.is_below(tmax))
        .map(|t| t.nearest)
}
