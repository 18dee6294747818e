//! The axis-aligned bounding box.

use glam::{DAffine3, DVec3};

/// An axis-aligned box in f64; empty when `lower` exceeds `upper`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The least corner.
    pub lower: DVec3,
    /// The greatest corner.
    pub upper: DVec3,
}

impl Bounds {
    /// The box that contains nothing.
    pub const EMPTY: Self = Self { lower: DVec3::INFINITY, upper: DVec3::NEG_INFINITY };

    /// The smallest box around some points.
    pub fn from_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::union_point)
    }

    /// The smallest box around this one and a point.
    #[inline]
    fn union_point(self, point: DVec3) -> Self {
        Self { lower: self.lower.min(point), upper: self.upper.max(point) }
    }

    /// The smallest box around both.
    #[inline]
    pub fn union(self, other: Self) -> Self {
        Self { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }

    /// True if the box contains no point.
    pub fn is_empty(&self) -> bool {
        !self.lower.cmple(self.upper).all()
    }

    /// The centre; not meaningful for an empty box.
    pub fn center(&self) -> DVec3 {
        self.lower * 0.5 + self.upper * 0.5
    }

    /// The lengths of the sides; negative or infinite for an empty box.
    pub fn size(&self) -> DVec3 {
        self.upper - self.lower
    }

    /// The length of the diagonal; 0 for an empty box.
    pub fn diagonal(&self) -> f64 {
        if self.is_empty() { 0.0 } else { self.size().length() }
    }

    /// Half the surface area, for the surface-area heuristic; 0 for an empty box.
    #[inline]
    pub fn half_area(&self) -> f64 {
        let s = self.size().max(DVec3::ZERO);
        s.x * s.y + s.y * s.z + s.z * s.x
    }

    /// The box enlarged by `margin` on each side.
    #[inline]
    pub fn padded(self, margin: f64) -> Self {
        Self { lower: self.lower - margin, upper: self.upper + margin }
    }

    /// The largest absolute coordinate of any point of the box; 0 for an empty box.
    pub fn max_abs(&self) -> f64 {
        if self.is_empty() { 0.0 } else { self.lower.abs().max(self.upper.abs()).max_element() }
    }

    /// The t at which a line enters the box and leaves it; it passes the box where the first is greater.
    #[cfg(feature = "embree")]
    #[inline(always)]
    pub(crate) fn crossing(&self, origin: DVec3, direction: DVec3) -> (f64, f64) {
        let (a, b) = ((self.lower - origin) / direction, (self.upper - origin) / direction);
        // `min` and `max` pass over the NaN of 0/0.
        (a.min(b).max_element(), a.max(b).min_element())
    }

    /// The smallest box around the transformed box.
    pub fn transformed(&self, transform: &DAffine3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::from_points((0..8).map(|i| {
            let pick = |bit: usize, low: f64, high: f64| if i & bit == 0 { low } else { high };
            transform.transform_point3(DVec3::new(
                pick(1, self.lower.x, self.upper.x),
                pick(2, self.lower.y, self.upper.y),
                pick(4, self.lower.z, self.upper.z),
            ))
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_box_has_no_diagonal_and_no_area() {
        assert_eq!((Bounds::EMPTY.diagonal(), Bounds::EMPTY.half_area()), (0.0, 0.0));
    }

    #[test]
    fn transformed_box_holds_the_rotated_corners() {
        let unit = Bounds { lower: DVec3::ZERO, upper: DVec3::ONE };
        let quarter = DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_2);
        let turned = unit.transformed(&quarter);
        assert!((turned.lower - DVec3::new(-1.0, 0.0, 0.0)).length() < 1e-15);
    }
}
