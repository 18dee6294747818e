//! The intersection of a ray with an infinite plane.
//!
//! ```
//! use envers::internals::plane;
//! use glam::DVec3;
//!
//! // From 3 above the ground straight down, at 2 units of length per unit of t.
//! let t = plane::intersect(DVec3::ZERO, DVec3::Y, DVec3::Y * 3.0, -DVec3::Y * 2.0);
//! assert_eq!(t, Some(1.5));
//! ```

pub mod certified;

use glam::DVec3;

use crate::geometry::double_double::{self, difference};

/// The t at which the line `origin + t·direction` crosses the plane through `point` with normal
/// `normal` (of any length); `None` for a line parallel to the plane or within it.
///
/// `t` may have either sign.
#[inline]
pub fn intersect(point: DVec3, normal: DVec3, origin: DVec3, direction: DVec3) -> Option<f64> {
    Some(quotient(point, normal, origin, direction)).filter(|t| t.is_finite())
}

/// The t of [`intersect`], but infinite or NaN for a line that is parallel to the plane.
#[inline(always)]
pub fn quotient(point: DVec3, normal: DVec3, origin: DVec3, direction: DVec3) -> f64 {
    normal.dot(point - origin) / normal.dot(direction)
}

/// The height of `position` over the plane, in units of the length of `normal`, right to 14 ε of the
/// largest coordinate of `position`, for a normal of length 1: the plane's point may lie far away.
#[inline(always)]
pub fn height(point: DVec3, normal: DVec3, position: DVec3) -> f64 {
    if is_far(point, position) {
        double_double::dot(difference(position, point), normal.to_array()).hi
    } else {
        normal.dot(position - point)
    }
}

/// True if a plane's point is so far away that [`height`] needs more than f64: farther from the origin of
/// coordinates than `position`.
#[inline(always)]
pub fn is_far(point: DVec3, position: DVec3) -> bool {
    point.abs().max_element() > position.abs().max_element()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hits_the_plane_below() {
        let t = intersect(DVec3::ZERO, DVec3::Y, DVec3::new(1.0, 3.0, 0.0), -DVec3::Y * 2.0);
        assert_eq!(t, Some(1.5));
    }

    #[test]
    fn misses_a_parallel_plane() {
        assert_eq!(intersect(DVec3::ZERO, DVec3::Y, DVec3::Y, DVec3::X), None);
    }

    #[test]
    fn the_height_over_a_plane_does_not_depend_on_where_its_point_lies() {
        for far in [0.0, 1e9, 1e15] {
            let point = DVec3::new(far, -far, 7.0 * far);
            let normal = DVec3::new(0.5, 0.5, 0.0);
            assert_eq!(height(point, normal, DVec3::new(0.1, 0.2, 3.0)), 0.5 * 0.1 + 0.5 * 0.2);
        }
    }

    #[test]
    fn plane_behind_has_a_negative_t() {
        assert_eq!(intersect(DVec3::ZERO, DVec3::Y, DVec3::Y, DVec3::Y), Some(-1.0));
    }
}
