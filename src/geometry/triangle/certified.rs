//! Ray and triangle, proven: the answer of exact arithmetic.

use glam::DVec3;

use crate::geometry::Estimate;
use crate::geometry::triangle::Crossing;

/// Where the ray crosses the triangle, as f64 arithmetic can bound it.
#[inline(always)]
pub fn estimate(_triangle: [DVec3; 3], _origin: DVec3, _direction: DVec3) -> Estimate {
    Estimate::UNKNOWN
}

/// Where the ray crosses the triangle with 0 < t < `tmax`, exactly; t correctly rounded.
pub fn crossing(
    triangle: [DVec3; 3],
    origin: DVec3,
    direction: DVec3,
    tmax: f64,
) -> Option<Crossing> {
    super::intersect(triangle, origin, direction).filter(|hit| hit.t > 0.0 && hit.t < tmax)
}
