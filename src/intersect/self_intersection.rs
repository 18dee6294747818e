//! The avoidance of self-intersection, without an epsilon.
//!
//! One rule: a spawned ray does not hit, at its own origin, a surface on which that origin lies
//! to within rounding. The surface it left is one of them, and is known by its identity. Others
//! are faces that share an edge or a vertex with it, coplanar or coincident faces, a plane in a
//! floor, a sphere that touches it. A line leaves a plane once, so that triangles and planes are
//! passed over; of a sphere the root at the origin is passed over, and the far one counts where
//! the ray goes into it.
//!
//! # What rounding means here
//!
//! Let S be the largest absolute coordinate of the origin, of the surface that was left and of the
//! one in question (for a sphere |centre| + radius), and ε = 2⁻⁵². To first order in ε, the
//! position of a hit lies off the surface that was hit by
//! - 3 √3 ε S on a triangle: a + (b − a) u + (c − a) v rounds differences of up to 2 S, their
//!   products and two sums;
//! - 4 ε S on a sphere (the length of the normal, its product with the radius, the sum) and 8 ε S
//!   on a plane (the height that is taken off, and taking it off).
//!
//! Two faces that coincide may have been baked by different transforms, each of which rounds a
//! vertex by at most 6 √3 ε S as long as no greater numbers cancel in it. All in all 3 √3 + 2 · 6 √3
//! = 26, and 32 ε S is what is allowed. The height of the origin over a triangle is itself rounded;
//! that is bounded where it is computed.
//!
//! Surfaces that are farther apart than that are two, such as a vertex stored in f32 and a plane at
//! the same decimal number.

use glam::DVec3;

#[cfg(feature = "embree")]
use crate::geometry::Bounds;
use crate::geometry::{Geometry, PrimitiveId, Ray, Side};
use crate::scene::{Scene, Sphere};

/// The distance from a surface up to which a point lies on it to within rounding, in units of ε S.
const ROUNDING: f64 = 32.0;

/// The way in which a ray leaves a sphere, if it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SphereDeparture {
    /// A ray that does not start on the sphere: its first root counts.
    No,
    /// A ray that starts on the sphere and goes away from it, and so does not hit it.
    Outward,
    /// A ray that starts on the sphere and goes into it: only the far root counts.
    Inward,
}

/// Returns how `ray` leaves sphere `index`: the one it was spawned on, or one on which its origin lies
/// to within rounding.
///
/// # Panics
/// When the sphere, or what the ray left, is not in the scene.
#[inline]
pub fn sphere_departure(scene: &Scene, index: u32, ray: &Ray) -> SphereDeparture {
    let Some(departure) = ray.departure else { return SphereDeparture::No };
    if departure.id == PrimitiveId::sphere(index) {
        return match departure.side {
            Side::Front => SphereDeparture::Outward,
            Side::Back => SphereDeparture::Inward,
        };
    }
    let s = &scene.spheres[index as usize];
    let tolerance = tolerance(scene, ray, departure.id, sphere_extent(s));
    let f = ray.origin - s.center;
    // ||f| − r| <= tolerance, without the square root.
    let off = (f.length_squared() - s.radius * s.radius).abs();
    if off > tolerance * (2.0 * s.radius + tolerance) {
        return SphereDeparture::No;
    }
    // A chord shorter than twice the tolerance begins and ends at the origin, to within rounding.
    let inward = f.dot(ray.direction) < -tolerance * ray.direction.length();
    if inward { SphereDeparture::Inward } else { SphereDeparture::Outward }
}

/// The greatest tolerance for rays and surfaces whose coordinates are all at most `max_coordinate`; so
/// [`sphere_departure`] need be asked only about a sphere whose |f|² − r², f from its centre to the ray's
/// origin, is at most tolerance·(2r + tolerance).
#[cfg(feature = "embree")]
pub(in crate::intersect) fn max_tolerance(max_coordinate: f64) -> f64 {
    // Twice, for what the sums that lead to `max_coordinate` and to the comparison round.
    2.0 * ROUNDING * f64::EPSILON * max_coordinate
}

/// The largest absolute coordinate of any surface of the scene, whose finite surfaces lie within
/// `bounds`; of a plane, that of its point.
#[cfg(feature = "embree")]
pub(in crate::intersect) fn max_coordinate(scene: &Scene, bounds: &Bounds) -> f64 {
    let planes = scene.planes.iter().map(|p| p.point.abs().max_element());
    planes.fold(bounds.max_abs(), f64::max)
}

/// True if `ray` was spawned in plane `index`, to within rounding, and so does not hit it.
///
/// # Panics
/// When the plane, or what the ray left, is not in the scene.
#[inline]
pub fn starts_on_plane(scene: &Scene, index: u32, ray: &Ray) -> bool {
    let Some(departure) = ray.departure else { return false };
    let plane = &scene.planes[index as usize];
    let height = plane.normal.dot(ray.origin - plane.point).abs();
    departure.id == PrimitiveId::plane(index)
        || height <= tolerance(scene, ray, departure.id, plane.point.abs().max_element())
}

/// True if `ray` was spawned in the plane of the triangle with these vertices, to within rounding,
/// and so does not hit it.
///
/// # Panics
/// When what the ray left is not in the scene.
#[inline]
pub fn starts_on_triangle(scene: &Scene, vertices: [DVec3; 3], ray: &Ray) -> bool {
    let Some(departure) = ray.departure else { return false };
    let [a, b, c] = from_longest_side(vertices);
    let (e, g, w) = (b - a, c - a, ray.origin - a);
    let normal = e.cross(g);
    let height = normal.dot(w).abs();
    // To first order the cross product is off by 2 √2 ε |e||g|, which the offset w magnifies, and
    // w and the dot product by 2 ε |e||g||w|. In a triangle with a very flat angle that is more
    // than the rounding of the origin.
    let computed = 5.0 * f64::EPSILON * e.length() * g.length() * w.length();
    height
        <= tolerance(scene, ray, departure.id, triangle_extent(vertices)) * normal.length()
            + computed
}

/// Returns the vertices, beginning with the one opposite the longest side: so the two sides that span
/// the triangle are its shorter ones, and a needle's are at a wide angle.
#[inline]
fn from_longest_side([a, b, c]: [DVec3; 3]) -> [DVec3; 3] {
    let [opposite_a, opposite_b, opposite_c] = [c - b, a - c, b - a].map(DVec3::length_squared);
    if opposite_a >= opposite_b.max(opposite_c) {
        [a, b, c]
    } else if opposite_b >= opposite_c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// The tolerance, 32 ε S, for a ray that left `departure` and a surface whose largest coordinate is `other`.
#[inline]
fn tolerance(scene: &Scene, ray: &Ray, departure: PrimitiveId, other: f64) -> f64 {
    let index = departure.primitive as usize;
    let left = match departure.geometry {
        Geometry::Spheres => sphere_extent(&scene.spheres[index]),
        Geometry::Planes => scene.planes[index].point.abs().max_element(),
        Geometry::Mesh(_) => triangle_extent(scene.triangle_vertices(departure)),
    };
    ROUNDING * f64::EPSILON * left.max(other).max(ray.origin.abs().max_element())
}

/// The largest absolute coordinate of the vertices of a triangle.
fn triangle_extent(vertices: [DVec3; 3]) -> f64 {
    vertices.iter().fold(0.0, |largest, c| c.abs().max_element().max(largest))
}

/// The largest absolute coordinate of a sphere.
fn sphere_extent(sphere: &Sphere) -> f64 {
    sphere.center.abs().max_element() + sphere.radius
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Departure;
    use crate::scene::{Instance, MaterialId, Mesh, Plane};
    use glam::DAffine3;

    /// A level floor of two triangles, which plane 0 lies in, and a ball of radius 1 on it.
    fn scene() -> Scene {
        let mut scene = Scene::default();
        let mesh = scene.add_mesh(Mesh {
            positions: vec![[-9., 0., -9.], [-9., 0., 9.], [9., 0., 9.], [9., 0., -9.]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        });
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, MaterialId(0)));
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, MaterialId(0)));
        scene.spheres.push(Sphere::new(DVec3::Y, 1.0, MaterialId(0)));
        scene
    }

    fn from(id: PrimitiveId, side: Side, origin: DVec3, direction: DVec3) -> Ray {
        Ray { departure: Some(Departure { id, side }), ..Ray::new(origin, direction) }
    }

    fn from_floor(origin: DVec3, direction: DVec3) -> Ray {
        from(PrimitiveId::triangle(0, 0, 0), Side::Front, origin, direction)
    }

    #[test]
    fn a_ray_without_departure_starts_on_nothing() {
        let (scene, ray) = (scene(), Ray::new(DVec3::ZERO, DVec3::Y));
        let corners = scene.triangle_vertices(PrimitiveId::triangle(0, 0, 0));
        assert_eq!(sphere_departure(&scene, 0, &ray), SphereDeparture::No);
        assert!(!starts_on_triangle(&scene, corners, &ray) && !starts_on_plane(&scene, 0, &ray));
    }

    #[test]
    fn plane_in_the_floor_is_left_with_it() {
        let off = |height: f64| from_floor(DVec3::new(5.0, height, 0.1), DVec3::Y);
        assert!(starts_on_plane(&scene(), 0, &off(3e-15)));
        assert!(!starts_on_plane(&scene(), 0, &off(1e-9)));
    }

    #[test]
    fn coplanar_triangle_is_left_though_no_vertex_is_shared() {
        let beside = [DVec3::X, DVec3::Z, DVec3::new(3.0, 0.0, 4.0)];
        let off = |height: f64| from_floor(DVec3::new(5.0, height, 0.1), DVec3::Y);
        assert!(starts_on_triangle(&scene(), beside, &off(3e-15)));
        assert!(!starts_on_triangle(&scene(), beside, &off(1e-9)));
    }

    #[test]
    fn a_needle_is_left_no_farther_off_than_any_triangle() {
        let needle = [DVec3::ZERO, DVec3::new(9.0, 0.0, 1e-7), DVec3::new(9.0, 0.0, -1e-7)];
        for turn in 0..3 {
            let mut corners = needle;
            corners.rotate_left(turn);
            let off = |height: f64| from_floor(DVec3::new(5.0, height, 0.0), DVec3::Y);
            assert!(starts_on_triangle(&scene(), corners, &off(3e-15)));
            assert!(!starts_on_triangle(&scene(), corners, &off(1e-12)));
        }
    }

    #[test]
    fn ball_that_touches_is_met_at_its_far_side_or_not_at_all() {
        let (scene, up) = (scene(), DVec3::new(1e-3, 1.0, 0.0));
        let toward = |d: DVec3| sphere_departure(&scene, 0, &from_floor(DVec3::ZERO, d));
        assert_eq!(
            (toward(up), toward(DVec3::X)),
            (SphereDeparture::Inward, SphereDeparture::Outward)
        );
    }

    #[test]
    fn ball_above_the_origin_is_not_left() {
        let ray = from_floor(DVec3::new(0.0, -1e-9, 0.0), DVec3::Y);
        assert_eq!(sphere_departure(&scene(), 0, &ray), SphereDeparture::No);
    }

    #[test]
    fn concentric_shell_at_a_billionth_of_the_radius_is_not_left() {
        let mut scene = scene();
        for (i, radius) in [1e-6, 1e6].into_iter().enumerate() {
            let at = 2 * i as u32 + 1;
            scene.spheres.push(Sphere::new(DVec3::ZERO, radius, MaterialId(0)));
            scene.spheres.push(Sphere::new(DVec3::ZERO, radius * (1.0 + 1e-9), MaterialId(0)));
            let normal = DVec3::new(0.48, 0.6, 0.64);
            let ray = from(PrimitiveId::sphere(at), Side::Front, normal * radius, normal);
            assert_eq!(sphere_departure(&scene, at + 1, &ray), SphereDeparture::No);
        }
    }

    #[test]
    fn what_was_left_is_known_by_its_identity_however_far_off_it_is() {
        let scene = scene();
        let far = DVec3::splat(0.3);
        let on = |side| from(PrimitiveId::sphere(0), side, far, DVec3::X);
        assert_eq!(sphere_departure(&scene, 0, &on(Side::Front)), SphereDeparture::Outward);
        assert_eq!(sphere_departure(&scene, 0, &on(Side::Back)), SphereDeparture::Inward);
        let plane = from(PrimitiveId::plane(0), Side::Front, far, DVec3::X);
        assert!(starts_on_plane(&scene, 0, &plane));
    }
}
