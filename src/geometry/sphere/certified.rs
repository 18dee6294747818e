//! Ray and sphere, proven: the answer of exact arithmetic.

use glam::DVec3;

use crate::geometry::Estimate;

/// The first t > 0 at which the ray meets the sphere, as f64 arithmetic can bound it.
#[inline(always)]
pub fn estimate(
    _center: DVec3,
    _radius: f64,
    _origin: DVec3,
    _direction: DVec3,
    _inverse_length_squared: f64,
) -> Estimate {
    Estimate::UNKNOWN
}

/// The first t with 0 < t < `tmax`, exactly, correctly rounded.
pub fn first_root(
    center: DVec3,
    radius: f64,
    origin: DVec3,
    direction: DVec3,
    tmax: f64,
    leaving_inward: bool,
) -> Option<f64> {
    let inverse = 1.0 / direction.length_squared();
    let roots = super::roots(center, radius, origin, direction, inverse)?;
    super::first_root(roots, tmax, leaving_inward)
}
