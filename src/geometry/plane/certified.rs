//! Ray and infinite plane, proven: the answer of exact arithmetic.

use glam::DVec3;

/// Where the ray meets the plane with 0 < t < `tmax`, exactly, correctly rounded.
pub fn crossing(
    point: DVec3,
    normal: DVec3,
    origin: DVec3,
    direction: DVec3,
    tmax: f64,
) -> Option<f64> {
    super::intersect(point, normal, origin, direction).filter(|&t| t > 0.0 && t < tmax)
}
