//! The order of the hits of one ray, which decides between hits at the same distance.
//!
//! Hits are ordered by distance, and only at the same distance by the id of the primitive. In
//! precision `certified` distances that round alike are compared exactly.

use std::cmp::Ordering;

use crate::geometry::exact_order::{CrossedSurface, compare};
use crate::geometry::{Geometry, Hit, PrimitiveId, Side};
use crate::intersect::Precision;
use crate::intersect::primitive::{ORIGIN_T, RayTests, SphereDeparture};

impl RayTests<'_> {
    /// True if hit `a` of the ray comes before its hit `b`.
    #[inline(always)]
    pub fn is_before(&self, a: &Hit, b: &Hit) -> bool {
        if a.t != b.t { a.t < b.t } else { self.breaks_tie(a, b.id) }
    }

    /// Replaces `best` by `candidate`, another hit of the ray, if that comes first.
    #[inline(always)]
    pub fn keep_closest(&self, best: &mut Option<Hit>, candidate: Hit) {
        if best.is_none_or(|best| self.is_before(&candidate, &best)) {
            *best = Some(candidate);
        }
    }

    /// True if a continuation ray has passed its crossing with primitive `id` at `t`; at the far root
    /// of a sphere if `far`.
    #[inline(always)]
    pub fn has_passed(&self, t: f64, id: PrimitiveId, far: bool) -> bool {
        let Some(continuation) = self.ray.continuation else { return false };
        if t != continuation.t {
            return t < continuation.t;
        }
        let crossed = continuation.crossed;
        if self.precision == Precision::Fast || t == ORIGIN_T {
            return id <= crossed.id;
        }
        // A sphere that the ray left was crossed at its far root.
        let last = self.surface(crossed.id, crossed.side == Side::Front);
        let order = compare(&self.surface(id, far), &last, self.ray.origin, self.ray.direction);
        order.then(id.cmp(&crossed.id)).is_le()
    }

    /// True if the hit on `a` comes before that on `b`, at distances that round alike.
    #[cold]
    #[inline(never)]
    fn breaks_tie(&self, a: &Hit, b: PrimitiveId) -> bool {
        let order = match self.precision {
            Precision::Certified if a.t != ORIGIN_T => {
                let [first, second] = [a.id, b].map(|id| self.surface(id, self.hits_far_root(id)));
                compare(&first, &second, self.ray.origin, self.ray.direction)
            }
            // Hits at the very origin have no crossings.
            _ => Ordering::Equal,
        };
        order.then(a.id.cmp(&b)).is_lt()
    }

    /// True if the hit of a ray on a primitive is that at the far root of a sphere, also when the near
    /// one lies ahead of the ray's origin.
    fn hits_far_root(&self, id: PrimitiveId) -> bool {
        if id.geometry != Geometry::Spheres {
            return false;
        }
        let departs_inward = self.ends.sphere_departure(id.primitive) == SphereDeparture::Inward;
        let has_passed_first = || {
            let Some(continuation) = self.ray.continuation else { return false };
            let first = self.sphere_root(id.primitive, f64::INFINITY, false);
            continuation.crossed.id == id
                || first.is_none_or(|first| self.has_passed(first.t, id, false))
        };
        departs_inward || has_passed_first()
    }

    /// The surface of a primitive; if `far`, a sphere crossed at its far root.
    fn surface(&self, id: PrimitiveId, far: bool) -> CrossedSurface {
        let index = id.primitive as usize;
        match id.geometry {
            Geometry::Spheres => {
                let sphere = &self.scene.spheres[index];
                CrossedSurface::Sphere { center: sphere.center, radius: sphere.radius, far }
            }
            Geometry::Planes => {
                let plane = &self.scene.planes[index];
                CrossedSurface::Plane { point: plane.point, normal: plane.normal }
            }
            Geometry::Mesh(_) => CrossedSurface::Triangle(self.scene.triangle_vertices(id)),
        }
    }
}
