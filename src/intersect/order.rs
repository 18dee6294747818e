//! The order of the hits of one ray, which decides between hits at the same distance.
//!
//! Hits are ordered by distance, and only at the same distance by the id of the primitive. Where
//! rounding may decide, distances are compared exactly: in precision `certified` those that round
//! alike, in `fast` those of flat surfaces that are nearly alike. So of faces that coincide both precisions
//! show the same one.

use std::cmp::Ordering;

use crate::geometry::exact_order::{CrossedSurface, compare};
use crate::geometry::{Geometry, Hit, PrimitiveId, Ray, Side};
use crate::intersect::Precision;
use crate::intersect::primitive::{ORIGIN_T, Primitives, RayTests, SphereDeparture};

/// The relative difference of two distances below which the rounding of `fast` may have reversed them.
/// Far more than a plane or a triangle that is not flat is off by.
pub(super) const NEAR_TIE: f64 = 1.0 / (1u64 << 32) as f64;

impl Primitives<'_> {
    /// The hits of a ray on these primitives, one on each that it hits, in their order along the ray.
    pub fn hits_in_order(&self, ray: &Ray, ids: &[PrimitiveId]) -> Vec<Hit> {
        let tests = self.with_ray(ray);
        let mut hits: Vec<Hit> = ids.iter().filter_map(|&id| tests.primitive(id)).collect();
        hits.sort_by(|a, b| {
            // What is nearly alike in `fast` has no order that sorting could rely on.
            let is_exact = self.precision == Precision::Certified && a.t == b.t && a.id != b.id;
            if is_exact {
                return if tests.is_before(a, b) { Ordering::Less } else { Ordering::Greater };
            }
            a.t.total_cmp(&b.t).then(a.id.cmp(&b.id))
        });
        hits
    }
}

impl RayTests<'_> {
    /// True if hit `a` of the ray comes before its hit `b`.
    #[inline(always)]
    pub fn is_before(&self, a: &Hit, b: &Hit) -> bool {
        if self.may_tie(a.t, b.t) { self.breaks_tie(a, b) } else { a.t < b.t }
    }

    /// True if the exact distances may be in another order than these, or equal.
    #[inline(always)]
    fn may_tie(&self, a: f64, b: f64) -> bool {
        match self.precision {
            Precision::Fast => (a - b).abs() <= NEAR_TIE * b,
            Precision::Certified => a == b,
        }
    }

    /// True if only the exact distances tell the order of two primitives that may tie at `t`.
    fn needs_exact_order(&self, t: f64, a: PrimitiveId, b: PrimitiveId) -> bool {
        match self.precision {
            // What `fast` finds on a sphere the exact line may miss.
            Precision::Fast => [a, b].iter().all(|id| id.geometry != Geometry::Spheres),
            // Hits at the very origin have no crossings.
            Precision::Certified => t != ORIGIN_T,
        }
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
        if !self.may_tie(t, continuation.t) {
            return t < continuation.t;
        }
        let crossed = continuation.crossed;
        if !self.needs_exact_order(t, id, crossed.id) {
            return t.total_cmp(&continuation.t).then(id.cmp(&crossed.id)).is_le();
        }
        // A sphere that the ray left was crossed at its far root.
        let last = self.surface(crossed.id, crossed.side == Side::Front);
        let order = compare(&self.surface(id, far), &last, self.ray.origin, self.ray.direction);
        order.then(id.cmp(&crossed.id)).is_le()
    }

    /// True if hit `a` comes before hit `b`, at distances that may tie.
    #[cold]
    #[inline(never)]
    fn breaks_tie(&self, a: &Hit, b: &Hit) -> bool {
        let order = if self.needs_exact_order(a.t, a.id, b.id) {
            let [first, second] = [a.id, b.id].map(|id| self.surface(id, self.hits_far_root(id)));
            compare(&first, &second, self.ray.origin, self.ray.direction)
        } else {
            a.t.total_cmp(&b.t)
        };
        order.then(a.id.cmp(&b.id)).is_lt()
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
