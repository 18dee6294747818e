//! Ray and infinite plane.

pub mod certified;

use glam::DVec3;

/// Where the line `origin + t·direction` meets the plane through `point` with normal `normal`
/// (of any length), or `None` when it is parallel to it.
///
/// `t` may have either sign; a line within the plane does not meet it.
#[inline]
pub fn intersect(point: DVec3, normal: DVec3, origin: DVec3, direction: DVec3) -> Option<f64> {
    Some(quotient(point, normal, origin, direction)).filter(|t| t.is_finite())
}

/// As [`intersect`], but infinite or not a number where the ray is parallel to the plane.
#[inline(always)]
pub fn quotient(point: DVec3, normal: DVec3, origin: DVec3, direction: DVec3) -> f64 {
    normal.dot(point - origin) / normal.dot(direction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meets_the_plane_below() {
        let t = intersect(DVec3::ZERO, DVec3::Y, DVec3::new(1.0, 3.0, 0.0), -DVec3::Y * 2.0);
        assert_eq!(t, Some(1.5));
    }

    #[test]
    fn misses_a_parallel_plane() {
        assert_eq!(intersect(DVec3::ZERO, DVec3::Y, DVec3::Y, DVec3::X), None);
    }

    #[test]
    fn plane_behind_has_a_negative_t() {
        assert_eq!(intersect(DVec3::ZERO, DVec3::Y, DVec3::Y, DVec3::Y), Some(-1.0));
    }
}
