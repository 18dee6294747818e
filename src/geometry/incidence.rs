//! The incidence of points and surfaces: whether a point lies within a distance of a surface, and
//! whether a surface through a point separates two directions there. All of it is decided exactly: by
//! bounds in f64, and by integers where these leave it open.
//!
//! In the bounds u = 2⁻⁵³. A difference of two coordinates is off by u, relatively, however much cancels
//! in it; a sum of three products of such numbers is off by at most 5u of the sum of their absolute
//! values.

use std::cmp::Ordering::{self, Equal, Greater, Less};

use glam::DVec3;
use num_bigint::BigInt;

use crate::geometry::double_double::U;
use crate::geometry::integer::{Scale, cross, dot, minus, sign};

/// True if the distance of `point` from the plane through `on` with a `normal` of any length is at most
/// `distance`.
#[inline]
pub fn near_plane(on: DVec3, normal: DVec3, point: DVec3, distance: f64) -> bool {
    let offset = point - on;
    let height = normal.dot(offset).abs();
    let height_error = 8.0 * U * normal.abs().dot(offset.abs());
    let limit = distance * normal.length();
    decide(height, height_error, limit, 8.0 * U * limit).unwrap_or_else(|| {
        let lengths = lengths([on, point], distance);
        let normal = Scale::common(normal.to_array()).vector(normal);
        let offset = minus(&lengths.vector(point), &lengths.vector(on));
        within(&dot(&normal, &offset), &lengths.integer(distance), &normal)
    })
}

/// True if the distance of `point` from the plane of a triangle is at most `distance`; true also for a
/// triangle without a plane, whose vertices lie on a line.
#[inline]
pub fn near_triangle_plane(triangle: [DVec3; 3], point: DVec3, distance: f64) -> bool {
    let [a, b, c] = triangle;
    let (offset, (normal, terms)) = (point - a, triangle_normal(triangle));
    let height = normal.dot(offset).abs();
    let height_error = 16.0 * U * terms.dot(offset.abs());
    let limit = distance * normal.length();
    decide(height, height_error, limit, 8.0 * U * distance * terms.length()).unwrap_or_else(|| {
        let lengths = lengths([a, b, c, point], distance);
        let corner = TriangleInIntegers::new(triangle, point, &lengths);
        within(&dot(&corner.normal, &corner.offset(0)), &lengths.integer(distance), &corner.normal)
    })
}

/// True if the distance of `point` from a sphere is at most `distance`.
#[inline]
pub fn near_sphere(center: DVec3, radius: f64, point: DVec3, distance: f64) -> bool {
    let square = (point - center).length_squared();
    let (inner, outer) = (radius - distance, radius + distance);
    let inner = if inner > 0.0 { inner * inner } else { 0.0 };
    let outer = outer * outer;
    let error = |x: f64| 8.0 * U * x;
    let is_outside = decide(square, error(square), outer, error(outer)).map(|within| !within);
    let is_inside = decide(inner, error(inner), square, error(square)).map(|beyond| !beyond);
    match (is_outside, is_inside) {
        (Some(true), _) | (_, Some(true)) => false,
        (Some(false), Some(false)) => true,
        _ => {
            let lengths = lengths([center, point, DVec3::X * radius], distance);
            let offset: [BigInt; 3] = minus(&lengths.vector(point), &lengths.vector(center));
            let [radius, distance]: [BigInt; 2] = [radius, distance].map(|x| lengths.integer(x));
            let square = dot(&offset, &offset);
            let (inner, outer) = (&radius - &distance, &radius + &distance);
            square <= outer.pow(2) && (sign(&inner) != Greater || square >= inner.pow(2))
        }
    }
}

/// True if a ray from `point`, which lies within `distance` of a sphere, goes into it: its chord there is
/// longer than twice the distance.
#[inline]
pub fn goes_into_sphere(center: DVec3, point: DVec3, direction: DVec3, distance: f64) -> bool {
    let offset = point - center;
    let depth = -offset.dot(direction);
    let depth_error = 8.0 * U * offset.abs().dot(direction.abs());
    let limit = distance * direction.length();
    let is_short = decide(depth, depth_error, limit, 8.0 * U * limit);
    !is_short.unwrap_or_else(|| {
        let lengths = lengths([center, point], distance);
        let direction = Scale::common(direction.to_array()).vector(direction);
        let depth = dot(&minus(&lengths.vector(center), &lengths.vector(point)), &direction);
        sign(&depth) != Greater || within(&depth, &lengths.integer(distance), &direction)
    })
}

/// The normal of a triangle, and the sums of the absolute values of the products that its components are
/// made of: these are off by at most 4u of those.
#[inline(always)]
fn triangle_normal([a, b, c]: [DVec3; 3]) -> (DVec3, DVec3) {
    let (first, second) = (b - a, c - a);
    let [e, g] = [first.abs(), second.abs()];
    let terms = DVec3::new(e.y * g.z + e.z * g.y, e.z * g.x + e.x * g.z, e.x * g.y + e.y * g.x);
    (first.cross(second), terms)
}

/// True if x ≤ y, false if x > y, and `None` if their errors leave it open.
#[inline(always)]
fn decide(x: f64, x_error: f64, y: f64, y_error: f64) -> Option<bool> {
    // The least normal number makes up for what underflows, and the factor for these very sums.
    let error = (x_error + y_error) * (1.0 + 8.0 * U) + 64.0 * f64::MIN_POSITIVE;
    if x + error < y {
        Some(true)
    } else if x - error > y && x < f64::INFINITY {
        Some(false)
    } else {
        None
    }
}

/// The common scale of coordinates and a distance.
fn lengths<const N: usize>(points: [DVec3; N], distance: f64) -> Scale {
    Scale::common(points.into_iter().flat_map(|p| p.to_array()).chain([distance]))
}

/// True if |x| ≤ `distance`·|v|.
fn within(x: &BigInt, distance: &BigInt, v: &[BigInt; 3]) -> bool {
    x.pow(2) <= distance.pow(2) * dot(v, v)
}

/// A triangle and a point in integers.
struct TriangleInIntegers {
    vertices: [[BigInt; 3]; 3],
    normal: [BigInt; 3],
    point: [BigInt; 3],
}

impl TriangleInIntegers {
    fn new(triangle: [DVec3; 3], point: DVec3, lengths: &Scale) -> Self {
        let [a, b, c] = triangle.map(|p| lengths.vector(p));
        let normal = cross(&minus(&b, &a), &minus(&c, &a));
        Self { vertices: [a, b, c], normal, point: lengths.vector(point) }
    }

    /// The point relative to vertex `i`.
    fn offset(&self, i: usize) -> [BigInt; 3] {
        minus(&self.point, &self.vertices[i])
    }
}

/// True if bounds in f64 prove that two directions go to one side of a plane. The components of its normal
/// are off by at most 4u of `terms`.
#[inline(always)]
pub fn are_on_one_side(normal: DVec3, terms: DVec3, a: DVec3, b: DVec3) -> bool {
    let slope_and_error =
        |d: DVec3| (normal.dot(d), 16.0 * U * terms.dot(d.abs()) + f64::MIN_POSITIVE);
    let ((a, a_error), (b, b_error)) = (slope_and_error(a), slope_and_error(b));
    ((a > a_error) & (b > b_error)) | ((a < -a_error) & (b < -b_error))
}

/// The directions of a shading point: toward the viewer, along the ray that leaves it.
///
/// A point on several surfaces lies on one side of each. That is the viewer's side: the point counts as
/// moved by an infinitesimal step toward the viewer, and by far smaller ones along x, y and z, in this
/// order (where the viewer looks along a surface, the tie rule of triangles moves the viewer's line
/// so). One displacement serves all surfaces; so a ray from the point to the other side of a closed mesh
/// crosses the mesh, be it at the point itself.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// The shading point.
    pub point: DVec3,
    /// The direction toward the viewer, of any length.
    pub viewer: DVec3,
    /// The direction of the ray that leaves the point, of any length.
    pub direction: DVec3,
    /// The distance up to which the point lies on a surface.
    pub distance: f64,
}

impl Corner {
    /// True if the plane with this normal, through the point, separates the ray from the viewer.
    #[inline]
    pub fn plane_separates(&self, normal: DVec3) -> bool {
        !are_on_one_side(normal, normal.abs(), self.viewer, self.direction) && {
            let normal = Scale::common(normal.to_array()).vector(normal);
            self.separates(&normal, &self.in_integers())
        }
    }

    /// True if the sphere around this centre, on which the point lies, separates the ray from the
    /// viewer.
    #[inline]
    pub fn sphere_separates(&self, center: DVec3) -> bool {
        let normal = self.point - center;
        !are_on_one_side(normal, normal.abs(), self.viewer, self.direction) && {
            let lengths = lengths([center, self.point], 0.0);
            let normal = minus(&lengths.vector(self.point), &lengths.vector(center));
            self.separates(&normal, &self.in_integers())
        }
    }

    /// True if a triangle on which the point lies separates the ray from the viewer: if the ray of the
    /// displaced point crosses the triangle, edges and vertices included.
    #[inline]
    pub fn triangle_separates(&self, triangle: [DVec3; 3]) -> bool {
        let (normal, terms) = triangle_normal(triangle);
        !are_on_one_side(normal, terms, self.viewer, self.direction)
            && self.triangle_separates_exactly(triangle)
    }

    #[cold]
    fn triangle_separates_exactly(&self, triangle: [DVec3; 3]) -> bool {
        let [a, b, c] = triangle;
        let lengths = lengths([a, b, c, self.point], self.distance);
        let triangle = TriangleInIntegers::new(triangle, self.point, &lengths);
        let directions = self.in_integers();
        if !self.separates(&triangle.normal, &directions) {
            return false;
        }
        let distance = lengths.integer(self.distance);
        (0..3).all(|i| {
            // The point lies on the inner side of the edge, on its outer side, or on the edge itself.
            let edge = minus(&triangle.vertices[(i + 1) % 3], &triangle.vertices[i]);
            let inward = cross(&triangle.normal, &edge);
            let height = dot(&inward, &triangle.offset(i));
            if !within(&height, &distance, &inward) {
                return sign(&height) == Greater;
            }
            // On the edge the displaced ray decides: with the displacement q it crosses the plane at
            // q − d (n·q)/(n·d) from the point.
            let slope = dot(&triangle.normal, &directions.direction);
            let side = directions.first_sign(|q| {
                let along = dot(&triangle.normal, q);
                let crossing =
                    [0, 1, 2].map(|i| &q[i] * &slope - &directions.direction[i] * &along);
                dot(&inward, &crossing)
            });
            if sign(&slope) == Less { side.reverse() != Less } else { side != Less }
        })
    }

    /// True if the displaced point and the ray lie on different sides of a plane through the point.
    fn separates(&self, normal: &[BigInt; 3], directions: &CornerDirections) -> bool {
        let of_ray = sign(&dot(normal, &directions.direction));
        of_ray != Equal && directions.first_sign(|q| dot(normal, q)) == of_ray.reverse()
    }

    fn in_integers(&self) -> CornerDirections {
        let [viewer, direction] =
            [self.viewer, self.direction].map(|d| Scale::common(d.to_array()).vector(d));
        CornerDirections { viewer, direction }
    }
}

/// The directions of a corner in integers.
struct CornerDirections {
    viewer: [BigInt; 3],
    direction: [BigInt; 3],
}

impl CornerDirections {
    /// The sign of a linear function of the displacement: at the viewer, and where it is 0 there, at x,
    /// y and z.
    fn first_sign(&self, function: impl Fn(&[BigInt; 3]) -> BigInt) -> Ordering {
        let axis = |i: usize| [0, 1, 2].map(|j| BigInt::from(i32::from(i == j)));
        let of = |q: &[BigInt; 3]| sign(&function(q));
        (0..3).fold(of(&self.viewer), |found, i| found.then_with(|| of(&axis(i))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const UNIT: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn a_point_at_the_very_distance_is_near_and_one_ulp_beyond_is_not() {
        let distance = 0.1;
        for (at, is_near) in [(distance, true), (f64::next_up(distance), false)] {
            let point = DVec3::new(3e7, -1e9, at);
            assert_eq!(near_plane(DVec3::X * 1e15, DVec3::Z * 3.0, point, distance), is_near);
            assert_eq!(near_triangle_plane(UNIT, point, distance), is_near);
        }
        let beside = |x: f64| near_sphere(DVec3::ZERO, 1.0, DVec3::X * x, 0.25);
        assert_eq!([0.75, 1.25].map(beside), [true; 2]);
        assert_eq!([f64::next_down(0.75), f64::next_up(1.25)].map(beside), [false; 2]);
        assert!(near_sphere(DVec3::ZERO, 1.0, DVec3::ZERO, 1.0));
    }

    #[test]
    fn flat_caps_are_far_from_points_above_them() {
        for height in [1e-9, 1e-12, 1e-15] {
            let cap = [DVec3::ZERO, DVec3::X * 2.0, DVec3::new(1.0, height, 0.0)];
            assert!(!near_triangle_plane(cap, DVec3::new(1.0, 0.0, 1e-13), 2e-14));
            assert!(near_triangle_plane(cap, DVec3::new(1.0, 0.0, 1e-14), 2e-14));
        }
    }

    #[test]
    fn a_ray_goes_into_a_sphere_if_its_chord_is_longer_than_twice_the_distance() {
        let into = |y: f64| goes_into_sphere(DVec3::ZERO, DVec3::X, DVec3::new(-y, 1.0, 0.0), 1e-3);
        assert_eq!([-1.0, 0.0, 1e-4, 1e-2, 1.0].map(into), [false, false, false, true, true]);
    }

    /// The corner of the cube [0, 1]³ or of what is outside it, seen by a viewer.
    fn crossed_faces(point: DVec3, viewer: DVec3, direction: DVec3) -> usize {
        let corners = |fixed: usize, at: f64| {
            let mut square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[u, v]| {
                let mut p = [0.0; 3];
                (p[fixed], p[(fixed + 1) % 3], p[(fixed + 2) % 3]) = (at, u, v);
                DVec3::from(p)
            });
            if at == 0.0 {
                square.reverse();
            }
            [[square[0], square[1], square[2]], [square[0], square[2], square[3]]]
        };
        let faces = (0..3).flat_map(|axis| [0.0, 1.0].map(|at| corners(axis, at))).flatten();
        let corner = Corner { point, viewer, direction, distance: 1e-14 };
        faces
            .filter(|&face| near_triangle_plane(face, point, 1e-14))
            .filter(|&face| corner.triangle_separates(face))
            .count()
    }

    #[test]
    fn a_cube_hides_its_inside_from_points_on_its_edges_and_vertices() {
        let inside = DVec3::new(0.3, 0.4, 0.6);
        for point in [DVec3::X, DVec3::new(1.0, 0.0, 0.25), DVec3::new(0.5, 0.5, 0.0)] {
            let away = point - inside;
            for viewer in [DVec3::new(2.0, -3.0, 4.0), DVec3::Y, DVec3::X, away] {
                // Along an edge or a face the displacement along the axes decides.
                let near = point + viewer * 1e-6 + DVec3::new(1e-9, 1e-11, 1e-13);
                let is_outside = near != near.clamp(DVec3::ZERO, DVec3::ONE);
                let crossed = crossed_faces(point, viewer, inside - point);
                assert_eq!(crossed > 0, is_outside, "{point} {viewer}");
            }
        }
        // From inside, light within is seen, and light outside is not.
        let (edge, viewer) = (DVec3::new(1.0, 0.0, 0.5), DVec3::new(-1.0, 1.0, 0.1));
        assert_eq!(crossed_faces(edge, viewer, DVec3::new(-0.5, 0.1, -0.2)), 0);
        assert!(crossed_faces(edge, viewer, DVec3::new(1.0, 0.5, 0.0)) > 0);
        // A convex edge hides nothing that lies before either of its faces.
        assert_eq!(crossed_faces(edge, DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, -1.0, 0.0)), 0);
    }

    proptest! {
        /// From a random point of a face, edge or vertex of the cube, seen from anywhere, toward
        /// anywhere: the ray crosses the cube at the point exactly if it and the viewer lie on different
        /// sides there.
        #[test]
        fn the_faces_at_a_point_separate_inside_from_outside(
            on in prop::array::uniform3(prop_oneof![Just(0.0), Just(1.0), 0.1..0.9f64]),
            viewer in prop::array::uniform3(-1.0..1.0f64),
            direction in prop::array::uniform3(-1.0..1.0f64),
        ) {
            let point = DVec3::from(on);
            prop_assume!(on.iter().any(|&x| x == 0.0 || x == 1.0));
            let is_inside = |d: [f64; 3]| {
                let p = point + DVec3::from(d) * 1e-6;
                p == p.clamp(DVec3::ZERO, DVec3::ONE)
            };
            let expected = is_inside(viewer) != is_inside(direction);
            let crossed = crossed_faces(point, viewer.into(), direction.into());
            // Between two outsides a ray may pass through the solid: two faces are then crossed.
            prop_assert_eq!(crossed % 2 == 1, expected, "{}", crossed);
        }
    }
}
