//! The intersection of a ray with a triangle.
//!
//! The edge functions are the scalar triple products of Plücker's test, taken from vertices
//! relative to the ray's origin: the sign of d·(p × q) says on which side of the edge pq the ray
//! passes. Two triangles that share an edge compute exactly opposite values for it (a product of
//! floats commutes and a difference changes its sign exactly), so that away from exact zeros no
//! ray slips between them. Compare Woop, Benthin and Wald, *Watertight Ray/Triangle Intersection*
//! (JCGT 2013).
//!
//! ```
//! use envers::internals::triangle;
//! use glam::DVec3;
//!
//! let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
//! let hit = triangle::intersect(corners, DVec3::new(0.25, 0.5, 3.0), -DVec3::Z).unwrap();
//! assert_eq!((hit.t, hit.u, hit.v), (3.0, 0.25, 0.5));
//! ```

pub mod certified;

use glam::DVec3;

/// The crossing of a line and a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// The distance in units of |direction|, of either sign.
    pub t: f64,
    /// The barycentric weight of the second vertex.
    pub u: f64,
    /// The barycentric weight of the third vertex.
    pub v: f64,
}

/// The edge functions of a line and a triangle, and the distance to its plane.
#[derive(Clone, Copy, Debug)]
pub struct EdgeFunctions {
    /// The functions of the edges opposite the first, second and third vertex; all of one sign (or 0)
    /// when the line crosses.
    pub values: [f64; 3],
    /// The distance to the plane in units of |direction|; not finite when the line runs along it.
    pub t: f64,
    /// True if `t` may have lost more than half of its digits, because the triangle is thin and the
    /// line nearly parallel to it: then [`certified::round`] gives a better one.
    pub is_flat: bool,
}

/// The square of the share of |b − a||c − a||d| below which the determinant of the three counts as
/// flat. The normal is off by a few 2⁻⁵³ of the first two; divided by 2⁻²⁰, that is 1e-10 of the
/// size of the triangle, and of t if the triangle is not nearer than it is large.
const FLAT_SQUARED: f64 = 1.0 / (1u64 << 40) as f64;

/// The edge functions d·(p × q) of a triangle whose vertices are relative to the line's origin.
#[inline(always)]
fn edge_functions([a, b, c]: [DVec3; 3], direction: DVec3) -> [f64; 3] {
    [direction.dot(b.cross(c)), direction.dot(c.cross(a)), direction.dot(a.cross(b))]
}

impl EdgeFunctions {
    /// Evaluates the edge functions for the line `origin + t·direction`.
    #[inline(always)]
    pub fn new(triangle: [DVec3; 3], origin: DVec3, direction: DVec3) -> Self {
        let (a, b, c) = (triangle[0] - origin, triangle[1] - origin, triangle[2] - origin);
        let (first, second) = (b - a, c - a);
        let normal = first.cross(second);
        let toward = normal.dot(direction);
        let sides = first.length_squared() * second.length_squared() * direction.length_squared();
        Self {
            values: edge_functions([a, b, c], direction),
            t: normal.dot(a) / toward,
            is_flat: toward * toward <= FLAT_SQUARED * sides,
        }
    }

    /// True if the line crosses the triangle; an edge or a vertex counts.
    #[inline(always)]
    pub fn crosses(&self) -> bool {
        let [a, b, c] = self.values;
        let inside = (a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0);
        inside && a + b + c != 0.0 && self.t.is_finite()
    }

    /// The barycentric weights of the second and third vertex, clamped to the triangle.
    #[inline(always)]
    pub fn weights(&self) -> (f64, f64) {
        let [a, b, c] = self.values;
        let inverse = 1.0 / (a + b + c);
        let w = [a, b, c].map(|f| (f * inverse).max(0.0));
        let inverse = 1.0 / (w[0] + w[1] + w[2]);
        (w[1] * inverse, w[2] * inverse)
    }
}

/// The crossing of the line `origin + t·direction` and the triangle, if there is one, at any `t`.
///
/// A line in the triangle's own plane misses it, and so does any line a degenerate triangle.
#[inline(always)]
pub fn intersect(triangle: [DVec3; 3], origin: DVec3, direction: DVec3) -> Option<TriangleHit> {
    let edges = EdgeFunctions::new(triangle, origin, direction);
    if !edges.crosses() {
        return None;
    }
    let (u, v) = edges.weights();
    let t = if edges.is_flat { certified::round(triangle, origin, direction).t } else { edges.t };
    Some(TriangleHit { t, u, v })
}

/// The point of a triangle with barycentric weights `u` and `v`.
#[inline]
pub fn point(triangle: [DVec3; 3], u: f64, v: f64) -> DVec3 {
    let [a, b, c] = triangle;
    a + (b - a) * u + (c - a) * v
}

/// The barycentric weights of the second and third vertex at a point of a triangle, clamped to \[0, 1\].
#[inline]
pub fn weights(triangle: [DVec3; 3], point: DVec3) -> (f64, f64) {
    let [a, b, c] = triangle;
    let (normal, offset) = (area_normal(triangle), point - a);
    let inverse = 1.0 / normal.length_squared();
    let weight = |x: f64| (x * inverse).clamp(0.0, 1.0);
    (weight(offset.cross(c - a).dot(normal)), weight((b - a).cross(offset).dot(normal)))
}

/// The normal of a triangle by the right-hand rule; its length is twice the area, 0 for a degenerate
/// triangle.
#[inline]
pub fn area_normal(triangle: [DVec3; 3]) -> DVec3 {
    let [a, b, c] = triangle;
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const UNIT: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn weights_belong_to_the_second_and_third_vertex() {
        let hit = intersect(UNIT, DVec3::new(0.25, 0.5, 3.0), -DVec3::Z).unwrap();
        assert_eq!((hit.t, hit.u, hit.v), (3.0, 0.25, 0.5));
    }

    #[test]
    fn the_weights_of_a_point_give_back_the_point() {
        let corners =
            [DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 5.0, -1.0), DVec3::new(0.0, 1.0, 4.0)];
        let (u, v) = weights(corners, point(corners, 0.25, 0.5));
        assert!((u - 0.25).abs() < 1e-14 && (v - 0.5).abs() < 1e-14, "{u} {v}");
    }

    #[test]
    fn is_hit_from_both_sides() {
        assert!(intersect(UNIT, DVec3::new(0.2, 0.2, -1.0), DVec3::Z).is_some());
    }

    #[test]
    fn line_in_its_plane_misses() {
        assert_eq!(intersect(UNIT, DVec3::new(-1.0, 0.2, 0.0), DVec3::X), None);
    }

    #[test]
    fn degenerate_triangle_is_missed() {
        let flat = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
        assert_eq!(intersect(flat, DVec3::new(0.5, 0.0, 1.0), -DVec3::Z), None);
    }

    proptest! {
        #[test]
        fn a_ray_near_a_shared_edge_hits_one_of_the_two(
            corners in prop::array::uniform4(prop::array::uniform2(-1.0..1.0f64)),
            along in 0.01..0.99f64,
            origin in prop::array::uniform3(-5.0..5.0f64),
        ) {
            // A fold along the edge from p to q, one wing on each side.
            let [p, q, r, s] = corners;
            let (p, q) = (DVec3::new(p[0], p[1], 0.0), DVec3::new(q[0], q[1], 0.0));
            prop_assume!((q - p).length() > 1e-3);
            let out = (q - p).cross(DVec3::Z).normalize();
            let wing = |w: [f64; 2], sign: f64| p.lerp(q, w[0]) + out * sign * (w[1].abs() + 0.1);
            let origin = DVec3::from(origin) + DVec3::Z * 6.0;
            let direction = p.lerp(q, along) - origin;
            let left = intersect([p, q, wing(r, 1.0)], origin, direction);
            let right = intersect([q, p, wing(s, -1.0)], origin, direction);
            prop_assert!(left.is_some() || right.is_some());
        }

        #[test]
        fn crossing_lies_on_the_line_and_in_the_triangle(
            corners in prop::array::uniform3(prop::array::uniform3(-1.0..1.0f64)),
            weights in (0.05..0.9f64, 0.05..0.9f64),
            origin in prop::array::uniform3(-9.0..9.0f64),
        ) {
            let triangle = corners.map(DVec3::from);
            let (u, v) = (weights.0, weights.1 * (1.0 - weights.0));
            let target = point(triangle, u, v);
            let origin = DVec3::from(origin);
            let normal = area_normal(triangle);
            let sine = normal.normalize_or_zero().dot((target - origin).normalize_or_zero()).abs();
            prop_assume!(normal.length() > 1e-2 && sine > 1e-2);
            let hit = intersect(triangle, origin, target - origin);
            prop_assume!(v > 1e-9 && u + v < 1.0 - 1e-9);
            let hit = hit.expect("aimed at the inside");
            prop_assert!((hit.t - 1.0).abs() < 1e-11);
            prop_assert!((point(triangle, hit.u, hit.v) - target).length() < 1e-9);
        }
    }
}
