//! The ends of rays that lie on surfaces, without an epsilon.
//!
//! One rule for the near end: a spawned ray does not hit, at its own origin, a surface on which that
//! origin lies to within rounding. The surface it left is one of them, and is known by its identity.
//! Others are faces that share an edge or a vertex with it, coplanar or coincident faces, a plane in a
//! floor, a sphere that touches it. A line leaves a plane once, so that triangles and planes are
//! passed over; of a sphere the root at the origin is passed over, and the far one counts where
//! the ray goes into it.
//!
//! The same rule for the far end of a shadow ray: it does not hit a surface on which the light lies to
//! within rounding, at the light.
//!
//! At an edge or a vertex, where several surfaces are passed over, a shadow ray may go into the solid
//! that they bound. There a surface blocks it that separates the light from the viewer; see
//! [`Corner`].
//!
//! # What rounding means here
//!
//! Let S be the largest absolute coordinate of the end of the ray, of the surface that was left and of
//! the one in question (for a triangle, of its vertices; for a sphere |centre| + radius; a plane has
//! none), and ε = 2⁻⁵². To first order in ε, the position of a hit lies off the surface that was hit by
//! - 3 √3 ε S on a triangle: a + (b − a) u + (c − a) v rounds differences of up to 2 S, their
//!   products and two sums;
//! - 4 ε S on a sphere (the length of the normal, its product with the radius, the sum);
//! - 16 ε S on a plane (the height that is taken off, and taking it off), wherever the plane's point
//!   lies: the height over a plane with a far point is computed in double-double numbers.
//!
//! Two faces that coincide may have been baked by different transforms, each of which rounds a
//! vertex by at most 6 √3 ε S as long as no greater numbers cancel in it. All in all that is at most
//! 3 √3 + 2 · 6 √3 = 26 from a triangle and 16 + 6 √3 = 27 from a plane, and 32 ε S is what is allowed. Whether an end lies within that of a surface is decided exactly,
//! also over flat triangles, whose normals lose their digits.
//!
//! Surfaces that are farther apart than that are two, such as a vertex stored in f32 and a plane at
//! the same decimal number.

use std::cell::OnceCell;

use glam::DVec3;

#[cfg(feature = "embree")]
use crate::geometry::Bounds;
use crate::geometry::incidence::{
    Corner, goes_into_sphere, near_plane, near_sphere, near_triangle_plane,
};
use crate::geometry::{Geometry, Hit, PrimitiveId, Ray, Side};
use crate::scene::{Scene, Sphere};

/// The distance from a surface up to which a point lies on it to within rounding, in units of ε S.
const ROUNDING: f64 = 32.0;
/// The distance up to which a triangle counts as part of the corner that a shadow ray starts from, in
/// units of that of rounding.
///
/// The faces at a vertex must be judged together. A point somewhat farther from the vertex than rounding
/// lies on the planes of some faces and not on those of others; if each is judged by itself, a ray may
/// pass under one and over the next. How many directions do so falls with the distance from the vertex, and
/// a hit at a vertex is rarely computed farther from it than the rounding.
const CORNER_REACH: f64 = 16.0;

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

/// The ends of a ray in a scene: the surfaces on which they lie to within rounding.
#[derive(Clone, Debug)]
pub struct RayEnds<'a> {
    scene: &'a Scene,
    ray: &'a Ray,
    /// The largest absolute coordinate of the origin and of the surface that was left, once somebody
    /// has asked for it.
    departure_size: OnceCell<f64>,
}

impl<'a> RayEnds<'a> {
    /// Makes the ends of a ray. What it left must be in the scene.
    #[inline(always)]
    pub fn new(scene: &'a Scene, ray: &'a Ray) -> Self {
        Self { scene, ray, departure_size: OnceCell::new() }
    }

    /// Returns how the ray leaves sphere `index`: the one it was spawned on, or one on which its origin
    /// lies.
    #[inline]
    pub fn sphere_departure(&self, index: u32) -> SphereDeparture {
        let id = PrimitiveId::sphere(index);
        let Some(departure) = self.ray.departure else { return SphereDeparture::No };
        if departure.id == id {
            return match departure.side {
                Side::Front => SphereDeparture::Outward,
                Side::Back => SphereDeparture::Inward,
            };
        }
        let (Ray { origin, direction, .. }, distance) = (*self.ray, self.distance(id));
        let Sphere { center, radius, .. } = self.scene.spheres[index as usize];
        if !near_sphere(center, radius, origin, distance) {
            return SphereDeparture::No;
        }
        // A chord shorter than twice the tolerance begins and ends at the origin, to within rounding.
        if goes_into_sphere(center, origin, direction, distance) {
            SphereDeparture::Inward
        } else {
            SphereDeparture::Outward
        }
    }

    /// True if the ray was spawned in plane `index`, and so does not hit it.
    #[inline]
    pub fn starts_on_plane(&self, index: u32) -> bool {
        let id = PrimitiveId::plane(index);
        let plane = &self.scene.planes[index as usize];
        self.ray.departure.is_some_and(|departure| {
            departure.id == id
                || near_plane(plane.point, plane.normal, self.ray.origin, self.distance(id))
        })
    }

    /// True if the ray was spawned in the plane of the triangle `id` with these vertices, and so does
    /// not hit it.
    #[inline]
    pub fn starts_on_triangle(&self, id: PrimitiveId, vertices: [DVec3; 3]) -> bool {
        self.ray.departure.is_some_and(|departure| {
            departure.id == id || near_triangle_plane(vertices, self.ray.origin, self.distance(id))
        })
    }

    /// True if sphere `index` blocks a shadow ray at its origin: the ray starts on it, has left another
    /// surface, and the sphere separates the light from the viewer there.
    #[inline]
    pub fn is_blocked_by_sphere(&self, index: u32) -> bool {
        let Sphere { center, radius, .. } = self.scene.spheres[index as usize];
        self.corner(PrimitiveId::sphere(index), 1.0).is_some_and(|corner| {
            near_sphere(center, radius, corner.point, corner.distance)
                && corner.sphere_separates(center)
        })
    }

    /// True if plane `index` blocks a shadow ray at its origin.
    #[inline]
    pub fn is_blocked_by_plane(&self, index: u32) -> bool {
        let plane = &self.scene.planes[index as usize];
        self.corner(PrimitiveId::plane(index), 1.0).is_some_and(|corner| {
            near_plane(plane.point, plane.normal, corner.point, corner.distance)
                && corner.plane_separates(plane.normal)
        })
    }

    /// True if the triangle `id` with these vertices blocks a shadow ray at its origin.
    #[cold]
    pub fn is_blocked_by_triangle(&self, id: PrimitiveId, vertices: [DVec3; 3]) -> bool {
        self.corner(id, CORNER_REACH).is_some_and(|corner| {
            near_triangle_plane(vertices, corner.point, corner.distance)
                && corner.triangle_separates(vertices)
        })
    }

    /// The corner at the origin of a shadow ray, for a primitive other than the one that it left, on which
    /// points lie up to `reach` times the distance of rounding.
    #[inline(always)]
    fn corner(&self, id: PrimitiveId, reach: f64) -> Option<Corner> {
        let Ray { origin: point, direction, departure, shadow, .. } = *self.ray;
        let viewer = shadow?.viewer;
        let is_other = departure.is_some_and(|departure| departure.id != id);
        is_other.then(|| Corner { point, viewer, direction, distance: reach * self.distance(id) })
    }

    /// True if the surface that was hit is one on which a shadow ray ends, since the light lies on it:
    /// then it does not block the light. Of a sphere this is the far root, or both if the chord before
    /// the light is shorter than rounding.
    #[inline]
    pub fn ends_at(&self, hit: &Hit) -> bool {
        let Self { scene, ray, .. } = self;
        if ray.shadow.is_none() || ray.tmax == f64::INFINITY {
            return false;
        }
        let (id, end) = (hit.id, ray.position(ray.tmax));
        let size = ray.origin.abs().max(end.abs()).max_element().max(extent(scene, id));
        let distance = tolerance(size);
        match id.geometry {
            Geometry::Spheres => {
                let Sphere { center, radius, .. } = scene.spheres[id.primitive as usize];
                if !near_sphere(center, radius, end, distance) {
                    return false;
                }
                // Seen from the light the near root is the far one, which counts like that of a ray
                // that goes into the sphere.
                let is_far = (ray.position(hit.t) - center).dot(ray.direction) > 0.0;
                is_far || !goes_into_sphere(center, end, -ray.direction, distance)
            }
            Geometry::Planes => {
                let plane = &scene.planes[id.primitive as usize];
                near_plane(plane.point, plane.normal, end, distance)
            }
            Geometry::Mesh(_) => near_triangle_plane(scene.triangle_vertices(id), end, distance),
        }
    }

    /// The distance up to which the origin lies on a surface.
    #[inline(always)]
    fn distance(&self, id: PrimitiveId) -> f64 {
        tolerance(self.departure_size().max(extent(self.scene, id)))
    }

    /// The largest absolute coordinate of the origin and of the surface that was left.
    #[inline(always)]
    pub fn departure_size(&self) -> f64 {
        *self.departure_size.get_or_init(|| {
            let left = self.ray.departure.map_or(0.0, |from| extent(self.scene, from.id));
            self.ray.origin.abs().max_element().max(left)
        })
    }
}

/// The greatest tolerance for rays and surfaces whose coordinates are all at most `max_coordinate`; so
/// [`RayEnds`] need be asked only about a sphere whose |f|² − r², f from its centre to the ray's origin,
/// is at most tolerance·(2r + tolerance).
#[cfg(feature = "embree")]
pub(in crate::intersect) fn max_tolerance(max_coordinate: f64) -> f64 {
    // Twice, for what the sums that lead to `max_coordinate` and to the comparison round.
    2.0 * tolerance(max_coordinate)
}

/// The greatest distance from the line of a shadow ray at which a surface may block it at its origin, where
/// all coordinates are at most `max_coordinate`.
pub(in crate::intersect) fn max_corner_distance(max_coordinate: f64) -> f64 {
    2.0 * CORNER_REACH * tolerance(max_coordinate)
}

/// The largest absolute coordinate of any surface of the scene, whose finite surfaces lie within
/// `bounds`; of a plane, that of its point.
#[cfg(feature = "embree")]
pub(in crate::intersect) fn max_coordinate(scene: &Scene, bounds: &Bounds) -> f64 {
    let planes = scene.planes.iter().map(|p| p.point.abs().max_element());
    planes.fold(bounds.max_abs(), f64::max)
}

/// The tolerance for ends and surfaces whose largest coordinate is `size`: 32 ε S.
#[inline]
fn tolerance(size: f64) -> f64 {
    ROUNDING * f64::EPSILON * size
}

/// The largest absolute coordinate of a surface that the rounding of its points depends on.
#[inline]
fn extent(scene: &Scene, id: PrimitiveId) -> f64 {
    match id.geometry {
        Geometry::Spheres => {
            let sphere = &scene.spheres[id.primitive as usize];
            sphere.center.abs().max_element() + sphere.radius
        }
        Geometry::Planes => 0.0,
        Geometry::Mesh(_) => {
            let vertices = scene.triangle_vertices(id);
            vertices.iter().fold(0.0, |largest, c| c.abs().max_element().max(largest))
        }
    }
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
            positions: vec![[-9., 0., -9.], [-9., 0., 9.], [9., 0., 9.], [9., 0., -9.]].into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        });
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, MaterialId(0)));
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, MaterialId(0)));
        scene.spheres.push(Sphere::new(DVec3::Y, 1.0, MaterialId(0)));
        scene
    }

    const OTHER: PrimitiveId = PrimitiveId::triangle(0, 1, 0);

    fn from(id: PrimitiveId, side: Side, origin: DVec3, direction: DVec3) -> Ray {
        Ray { departure: Some(Departure { id, side }), ..Ray::new(origin, direction) }
    }

    fn from_floor(origin: DVec3, direction: DVec3) -> Ray {
        from(PrimitiveId::triangle(0, 0, 0), Side::Front, origin, direction)
    }

    #[test]
    fn a_ray_without_departure_starts_on_nothing() {
        let (scene, ray) = (scene(), Ray::new(DVec3::ZERO, DVec3::Y));
        let id = PrimitiveId::triangle(0, 1, 0);
        let corners = scene.triangle_vertices(id);
        assert_eq!(RayEnds::new(&scene, &ray).sphere_departure(0), SphereDeparture::No);
        let ends = RayEnds::new(&scene, &ray);
        assert!(!ends.starts_on_triangle(id, corners) && !ends.starts_on_plane(0));
    }

    #[test]
    fn plane_in_the_floor_is_left_with_it() {
        let off = |height: f64| from_floor(DVec3::new(5.0, height, 0.1), DVec3::Y);
        assert!(RayEnds::new(&scene(), &off(3e-15)).starts_on_plane(0));
        assert!(!RayEnds::new(&scene(), &off(1e-9)).starts_on_plane(0));
    }

    #[test]
    fn coplanar_triangle_is_left_though_no_vertex_is_shared() {
        let beside = [DVec3::X, DVec3::Z, DVec3::new(3.0, 0.0, 4.0)];
        let off = |height: f64| from_floor(DVec3::new(5.0, height, 0.1), DVec3::Y);
        assert!(RayEnds::new(&scene(), &off(3e-15)).starts_on_triangle(OTHER, beside));
        assert!(!RayEnds::new(&scene(), &off(1e-9)).starts_on_triangle(OTHER, beside));
    }

    #[test]
    fn a_needle_is_left_no_farther_off_than_any_triangle() {
        let needle = [DVec3::ZERO, DVec3::new(9.0, 0.0, 1e-7), DVec3::new(9.0, 0.0, -1e-7)];
        for turn in 0..3 {
            let mut corners = needle;
            corners.rotate_left(turn);
            let off = |height: f64| from_floor(DVec3::new(5.0, height, 0.0), DVec3::Y);
            assert!(RayEnds::new(&scene(), &off(3e-15)).starts_on_triangle(OTHER, corners));
            assert!(!RayEnds::new(&scene(), &off(1e-12)).starts_on_triangle(OTHER, corners));
        }
    }

    #[test]
    fn ball_that_touches_is_met_at_its_far_side_or_not_at_all() {
        let (scene, up) = (scene(), DVec3::new(1e-3, 1.0, 0.0));
        let toward =
            |d: DVec3| RayEnds::new(&scene, &from_floor(DVec3::ZERO, d)).sphere_departure(0);
        assert_eq!(
            (toward(up), toward(DVec3::X)),
            (SphereDeparture::Inward, SphereDeparture::Outward)
        );
    }

    #[test]
    fn ball_above_the_origin_is_not_left() {
        let ray = from_floor(DVec3::new(0.0, -1e-9, 0.0), DVec3::Y);
        assert_eq!(RayEnds::new(&scene(), &ray).sphere_departure(0), SphereDeparture::No);
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
            assert_eq!(RayEnds::new(&scene, &ray).sphere_departure(at + 1), SphereDeparture::No);
        }
    }

    #[test]
    fn what_was_left_is_known_by_its_identity_however_far_off_it_is() {
        let scene = scene();
        let far = DVec3::splat(0.3);
        let on = |side| from(PrimitiveId::sphere(0), side, far, DVec3::X);
        assert_eq!(
            RayEnds::new(&scene, &on(Side::Front)).sphere_departure(0),
            SphereDeparture::Outward
        );
        assert_eq!(
            RayEnds::new(&scene, &on(Side::Back)).sphere_departure(0),
            SphereDeparture::Inward
        );
        let plane = from(PrimitiveId::plane(0), Side::Front, far, DVec3::X);
        assert!(RayEnds::new(&scene, &plane).starts_on_plane(0));
    }
}
