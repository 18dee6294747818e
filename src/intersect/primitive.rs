//! The tests of one ray against one primitive, in f64 and in world space: what every backend means by a
//! hit.
//!
//! A ray does not hit, at its ends, surfaces on which these lie; see [`RayEnds`].

use glam::DVec3;

use crate::geometry::triangle::TriangleHit;
use crate::geometry::{
    Bounds, Continuation, Geometry, Hit, PrimitiveId, Ray, Side, plane, sphere, triangle,
};
use crate::intersect::Precision;
pub use crate::intersect::ray_ends::SphereDeparture;
use crate::intersect::ray_ends::{RayEnds, max_corner_distance};
use crate::scene::Scene;

/// The primitives of a scene, with the precision in which they are tested.
#[derive(Clone, Copy, Debug)]
pub struct Primitives<'s> {
    /// The scene.
    pub scene: &'s Scene,
    /// The precision.
    pub precision: Precision,
}

impl<'s> Primitives<'s> {
    /// The tests of one ray against these primitives.
    #[inline(always)]
    pub fn with_ray<'a>(&self, ray: &'a Ray) -> RayTests<'a>
    where
        's: 'a,
    {
        let Primitives { scene, precision } = *self;
        let inverse_length_squared = sphere::inverse_length_squared(ray.direction);
        RayTests { scene, precision, ray, ends: RayEnds::new(scene, ray), inverse_length_squared }
    }
}

/// The t of a hit at the very origin of a shadow ray: the least there is.
pub(super) const ORIGIN_T: f64 = f64::from_bits(1);

/// The tests of one ray against the primitives of a scene.
#[derive(Clone, Debug)]
pub struct RayTests<'a> {
    pub(super) scene: &'a Scene,
    pub(super) precision: Precision,
    pub(super) ray: &'a Ray,
    pub(super) ends: RayEnds<'a>,
    /// The reciprocal 1 / |direction|².
    inverse_length_squared: f64,
}

impl RayTests<'_> {
    /// The hit on sphere `index`. A hit beyond `limit` may be left out.
    #[inline]
    pub fn sphere(&self, index: u32, limit: f64) -> Option<Hit> {
        let hit = self.sphere_crossing(index, limit);
        if self.ray.shadow.is_none() {
            return hit;
        }
        let is_blocked = self.is_certified() && self.ends.is_blocked_by_sphere(index);
        self.between_ends(PrimitiveId::sphere(index), is_blocked, hit)
    }

    /// The hit on plane `index`.
    #[inline]
    pub fn plane(&self, index: u32) -> Option<Hit> {
        let hit = self.plane_crossing(index);
        if self.ray.shadow.is_none() {
            return hit;
        }
        let is_blocked = self.is_certified() && self.ends.is_blocked_by_plane(index);
        self.between_ends(PrimitiveId::plane(index), is_blocked, hit)
    }

    /// The hit on the triangle `id`. A hit beyond `limit` may be left out.
    #[inline]
    pub fn triangle(&self, id: PrimitiveId, limit: f64) -> Option<Hit> {
        let Ray { origin, direction, tmax, departure, shadow, .. } = *self.ray;
        if departure.is_some_and(|departure| departure.id == id) {
            return None;
        }
        let vertices = self.scene.triangle_vertices(id);
        let (mut is_blocked, crossing) = match self.precision {
            Precision::Fast => {
                let crossing = triangle::intersect(vertices, origin, direction);
                (false, crossing.filter(|hit| hit.t > 0.0 && hit.t < tmax))
            }
            Precision::Certified => {
                use triangle::certified::{EdgeBounds, crossing};
                let edges = EdgeBounds::new(vertices, origin, direction);
                let may_block =
                    shadow.is_some() && edges.may_start_in_plane(self.ends.departure_size());
                let is_outside = edges.estimate().is_outside(limit);
                (
                    may_block,
                    if is_outside { None } else { crossing(vertices, origin, direction, tmax) },
                )
            }
        };
        let hit = crossing.and_then(|crossing| self.triangle_hit(id, vertices, crossing));
        if shadow.is_none() {
            return hit;
        }
        is_blocked = is_blocked && self.ends.is_blocked_by_triangle(id, vertices);
        self.between_ends(id, is_blocked, hit)
    }

    /// The greatest distance from the ray's line at which a triangle within `bounds` may be hit.
    #[inline]
    pub(super) fn corner_distance(&self, bounds: Bounds) -> f64 {
        if self.ray.shadow.is_none() || !self.is_certified() {
            return 0.0;
        }
        max_corner_distance(self.ends.departure_size().max(bounds.max_abs()))
    }

    /// The hit on any primitive.
    pub fn primitive(&self, id: PrimitiveId) -> Option<Hit> {
        match id.geometry {
            Geometry::Spheres => self.sphere(id.primitive, f64::INFINITY),
            Geometry::Planes => self.plane(id.primitive),
            Geometry::Mesh(_) => self.triangle(id, f64::INFINITY),
        }
    }

    /// The hit of a shadow ray on a primitive: at the origin if the primitive blocks it there, and none at
    /// the light if the light lies on the primitive.
    #[inline]
    fn between_ends(&self, id: PrimitiveId, is_blocked: bool, hit: Option<Hit>) -> Option<Hit> {
        let blocked = if is_blocked { self.hit_at_origin(id) } else { None };
        blocked.or_else(|| hit.filter(|hit| !self.ends.ends_at(hit)))
    }

    fn is_certified(&self) -> bool {
        self.precision == Precision::Certified
    }

    /// The hit on a surface that blocks a shadow ray at its origin, at the least t; none if the ray has
    /// passed the surface there, or a mask cuts a hole.
    #[cold]
    fn hit_at_origin(&self, id: PrimitiveId) -> Option<Hit> {
        let Self { scene, ray, .. } = self;
        let (mut u, mut v) = (0.0, 0.0);
        if let Geometry::Mesh(_) = id.geometry {
            (u, v) = triangle::weights(scene.triangle_vertices(id), ray.origin);
            if scene.is_cut_out(id, u, v) {
                return None;
            }
        }
        let is_ahead = |c: Continuation| c.t == ORIGIN_T && c.crossed.id < id;
        ray.continuation.is_none_or(is_ahead).then_some(Hit { t: ORIGIN_T, u, v, id })
    }

    /// The crossing with sphere `index` that a ray hits, whatever surface its end lies on.
    #[inline(always)]
    fn sphere_crossing(&self, index: u32, limit: f64) -> Option<Hit> {
        let Some(continuation) = self.ray.continuation else {
            return self.sphere_root(index, limit, false);
        };
        let id = PrimitiveId::sphere(index);
        if continuation.crossed.id != id {
            let ahead = |far| {
                self.sphere_root(index, limit, far).filter(|hit| !self.has_passed(hit.t, id, far))
            };
            return ahead(false).or_else(|| ahead(true));
        }
        // A sphere that the ray entered is hit at its far side, which rounding may put at the same t.
        if continuation.crossed.side == Side::Front {
            return None;
        }
        self.sphere_root(index, limit, true).filter(|hit| hit.t >= continuation.t)
    }

    /// The hit at the first root that counts, or at the far one.
    #[inline(always)]
    pub(super) fn sphere_root(&self, index: u32, limit: f64, far: bool) -> Option<Hit> {
        let s = &self.scene.spheres[index as usize];
        let Ray { origin, direction, tmax, .. } = *self.ray;
        let inverse = self.inverse_length_squared;
        let t = match self.precision {
            Precision::Fast => {
                let roots = sphere::roots(s.center, s.radius, origin, direction, inverse)?;
                let t = sphere::first_root(roots, tmax, false)?;
                match self.ends.sphere_departure(index) {
                    SphereDeparture::Outward => return None,
                    SphereDeparture::No if !far => t,
                    _ => sphere::first_root(roots, tmax, true)?,
                }
            }
            Precision::Certified => {
                use sphere::certified::{estimate, first_root};
                // Where the first root lies outside, so does the far one.
                if estimate(s.center, s.radius, origin, direction, inverse).is_outside(limit) {
                    return None;
                }
                let inward = match self.ends.sphere_departure(index) {
                    SphereDeparture::Outward => return None,
                    SphereDeparture::No => far,
                    SphereDeparture::Inward => true,
                };
                first_root(s.center, s.radius, origin, direction, tmax, inward)?
            }
        };
        Some(Hit { t, u: 0.0, v: 0.0, id: PrimitiveId::sphere(index) })
    }

    /// The crossing with plane `index` that a ray hits, whatever surface its end lies on.
    #[inline(always)]
    fn plane_crossing(&self, index: u32) -> Option<Hit> {
        let p = &self.scene.planes[index as usize];
        let Ray { origin, direction, tmax, .. } = *self.ray;
        let t = match self.precision {
            Precision::Fast => plane::intersect(p.point, p.normal, origin, direction)
                .filter(|&t| t > 0.0 && t < tmax)?,
            Precision::Certified => {
                use plane::certified::{certainly_misses, crossing};
                // A ray that leaves the plane nearly hits it, which is expensive to decide.
                if certainly_misses(p.point, p.normal, origin, direction, tmax)
                    || self.ends.starts_on_plane(index)
                {
                    return None;
                }
                crossing(p.point, p.normal, origin, direction, tmax)?
            }
        };
        let id = PrimitiveId::plane(index);
        if self.ends.starts_on_plane(index) || self.has_passed_flat(t, id) {
            return None;
        }
        Some(Hit { t, u: 0.0, v: 0.0, id })
    }

    /// The hit at a crossing with the triangle `id`, unless the ray starts on it or has passed it, or a
    /// mask cuts a hole.
    #[inline(always)]
    fn triangle_hit(
        &self,
        id: PrimitiveId,
        vertices: [DVec3; 3],
        TriangleHit { t, u, v }: TriangleHit,
    ) -> Option<Hit> {
        let excluded = self.ends.starts_on_triangle(id, vertices)
            || self.has_passed_flat(t, id)
            || self.scene.is_cut_out(id, u, v);
        (!excluded).then_some(Hit { t, u, v, id })
    }

    /// Merges the infinite planes into a hit on finite primitives: they are in no tree, since nothing
    /// infinite can be bounded.
    #[inline]
    pub fn merge_planes(&self, best: &mut Option<Hit>) {
        for index in 0..self.scene.planes.len() as u32 {
            if let Some(hit) = self.plane(index) {
                self.keep_closest(best, hit);
            }
        }
    }

    /// True if a plane that blocks light is hit by the ray.
    #[inline]
    pub fn planes_occlude(&self) -> bool {
        (0..self.scene.planes.len() as u32)
            .any(|i| self.scene.blocks_light(PrimitiveId::plane(i)) && self.plane(i).is_some())
    }

    /// True if a continuation ray has passed a surface that its line crosses once, at `t`.
    #[inline(always)]
    fn has_passed_flat(&self, t: f64, id: PrimitiveId) -> bool {
        let crossed_it = |c: Continuation| c.crossed.id == id || self.has_passed(t, id, false);
        self.ray.continuation.is_some_and(crossed_it)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Departure;
    use crate::scene::{Instance, MaterialId, Mesh, Plane, Sphere};
    use glam::{DAffine3, DVec3};

    fn fast(scene: &Scene) -> Primitives<'_> {
        Primitives { scene, precision: Precision::Fast }
    }

    fn roof() -> Scene {
        // Two triangles that share the edge x = 0 and rise away from it: a valley.
        let mut scene = Scene::default();
        let mesh = scene.add_mesh(Mesh {
            positions: vec![[0., 0., -1.], [0., 0., 1.], [1., 1., 0.], [-1., 1., 0.]].into(),
            triangles: vec![[0, 1, 2], [1, 0, 3]],
            ..Mesh::default()
        });
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, MaterialId(0)));
        scene
    }

    fn spawned(origin: DVec3, direction: DVec3, id: PrimitiveId, side: Side) -> Ray {
        Ray { departure: Some(Departure { id, side }), ..Ray::new(origin, direction) }
    }

    #[test]
    fn a_ray_does_not_hit_the_triangle_it_left() {
        let scene = roof();
        let id = PrimitiveId::triangle(0, 0, 0);
        let origin = DVec3::new(0.5, 0.5 + 1e-17, 0.0);
        let ray = spawned(origin, DVec3::new(1.0, -1.0, 0.0), id, Side::Back);
        assert_eq!(fast(&scene).with_ray(&ray).triangle(id, f64::INFINITY), None);
    }

    #[test]
    fn a_ray_from_the_shared_edge_does_not_hit_the_neighbour() {
        let scene = roof();
        let ray = spawned(
            DVec3::new(1e-17, 0.0, 0.25),
            DVec3::new(-1.0, 1.0 - 1e-15, 0.0),
            PrimitiveId::triangle(0, 0, 0),
            Side::Front,
        );
        assert_eq!(
            fast(&scene).with_ray(&ray).triangle(PrimitiveId::triangle(0, 1, 0), f64::INFINITY),
            None
        );
    }

    #[test]
    fn a_ray_across_the_valley_hits_the_neighbour() {
        let scene = roof();
        let ray = spawned(
            DVec3::new(0.25, 0.25, 0.0),
            DVec3::NEG_X,
            PrimitiveId::triangle(0, 0, 0),
            Side::Front,
        );
        let hit = fast(&scene)
            .with_ray(&ray)
            .triangle(PrimitiveId::triangle(0, 1, 0), f64::INFINITY)
            .unwrap();
        assert_eq!(hit.t, 0.5);
    }

    #[test]
    fn a_sphere_left_outward_is_not_hit_again() {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, MaterialId(0)));
        let inside = DVec3::X * (1.0 - 1e-16);
        let ray = spawned(inside, DVec3::new(1e-9, 1.0, 0.0), PrimitiveId::sphere(0), Side::Front);
        assert_eq!(fast(&scene).with_ray(&ray).sphere(0, f64::INFINITY), None);
    }

    #[test]
    fn a_sphere_left_inward_is_hit_at_its_far_side() {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, MaterialId(0)));
        let ray = spawned(DVec3::X, -DVec3::X, PrimitiveId::sphere(0), Side::Back);
        assert_eq!(fast(&scene).with_ray(&ray).sphere(0, f64::INFINITY).unwrap().t, 2.0);
    }

    #[test]
    fn a_plane_merges_before_a_farther_hit_and_behind_a_closer_one() {
        let mut scene = Scene::default();
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, MaterialId(0)));
        let ray = Ray::new(DVec3::Y * 2.0, -DVec3::Y);
        for (t, expected) in [(1.0, 1.0), (3.0, 2.0)] {
            let mut best = Some(Hit { t, u: 0.0, v: 0.0, id: PrimitiveId::triangle(0, 0, 0) });
            fast(&scene).with_ray(&ray).merge_planes(&mut best);
            assert_eq!(best.unwrap().t, expected);
        }
    }

    #[test]
    fn the_end_of_a_segment_is_not_hit() {
        let mut scene = Scene::default();
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, MaterialId(0)));
        assert!(!fast(&scene).with_ray(&Ray::segment(DVec3::Y, DVec3::ZERO)).planes_occlude());
        assert!(fast(&scene).with_ray(&Ray::segment(DVec3::Y, -DVec3::Y)).planes_occlude());
    }
}
