//! The resolution of hits in precision `certified`: which candidates count, by their bounds, and
//! exactly where these overlap.

use crate::geometry::{Estimate, Geometry, Hit, PrimitiveId};
use crate::intersect::embree::certified::primitives::{CertifiedPrimitive, Shape};
use crate::intersect::embree::packet::QueryContext;

/// The estimates of the hits of a packet on a primitive.
struct Estimates<const W: usize> {
    hits: [Estimate; W],
    /// True for each ray that left a surface and may start on the primitive.
    may_start: [bool; W],
    /// True for each shadow ray that the primitive may block at its origin.
    may_block: [bool; W],
}

impl<const W: usize> QueryContext<'_, W> {
    /// Records the primitive as the hit of those active rays that it is the closest hit of.
    #[inline(always)]
    pub fn keep_closest(
        &mut self,
        primitive: &CertifiedPrimitive<impl Shape>,
        active: &[i32; W],
        tfar: &mut [f32; W],
    ) {
        let Some(estimates) = self.estimates(primitive, active) else { return };
        for i in 0..W {
            if active[i] == 0 {
                continue;
            }
            let e = estimates.hits[i];
            // The next hit of a continuation ray is not always the first root, and a shadow ray may be
            // blocked at its origin.
            if self.departures.any_continuation || estimates.may_block[i] {
                self.resolve_exactly(i, primitive.id);
                tfar[i] = self.closest_tfar(i).min(tfar[i]);
                continue;
            }
            if e.is_outside(self.hits.upper(i)) {
                continue;
            }
            if self.departures.any && self.is_departure(i, primitive.id) {
                continue;
            }
            // Keep what is certainly ahead and closer; decide exactly about the rest.
            let closer = e.upper() < self.hits.t[i] - self.hits.error[i];
            let certain = e.lower() > 0.0 && closer;
            if !certain
                || primitive.is_masked
                || (estimates.may_start[i] && primitive.shape.may_start_on(self, i))
                || self.may_end_on(&primitive.shape, i)
            {
                self.resolve_exactly(i, primitive.id);
            } else {
                self.hits.set(i, e, primitive.id);
            }
            tfar[i] = self.closest_tfar(i).min(tfar[i]);
        }
    }

    /// Sets `tfar` of each active ray that the primitive occludes to minus infinity.
    #[inline(always)]
    pub fn mark_occluded(
        &mut self,
        primitive: &CertifiedPrimitive<impl Shape>,
        active: &[i32; W],
        tfar: &mut [f32; W],
    ) {
        let Some(estimates) = self.estimates(primitive, active) else { return };
        for i in 0..W {
            let e = estimates.hits[i];
            let may_start = estimates.may_start[i];
            if active[i] == 0 || (e.is_outside(self.rays.tmax[i]) && !estimates.may_block[i]) {
                continue;
            }
            if self.departures.any && self.is_departure(i, primitive.id) {
                continue;
            }
            let within = e.lower() > 0.0 && e.upper() < self.rays.tmax[i];
            let has_plain_hit = !self.departures.any_continuation && !primitive.is_masked;
            let starts_apart = !(may_start && primitive.shape.may_start_on(self, i));
            let certain =
                within && has_plain_hit && starts_apart && !self.may_end_on(&primitive.shape, i);
            if certain || self.exact_hit(i, primitive.id).is_some() {
                tfar[i] = f32::NEG_INFINITY;
            }
        }
    }

    /// Notes for each active ray that it may cross a primitive that lets light through.
    #[inline(always)]
    pub fn note_crossings(&self, primitive: &CertifiedPrimitive<impl Shape>, active: &[i32; W]) {
        let Some(estimates) = self.estimates(primitive, active) else { return };
        for i in 0..W {
            let misses = estimates.hits[i].is_outside(self.rays.tmax[i]);
            if active[i] != 0 && (!misses || estimates.may_block[i]) {
                self.note_crossing(i, primitive.id);
            }
        }
    }

    /// True if the ray in `lane` left this very primitive, and so does not hit it again, except a sphere
    /// that it went into.
    #[inline(always)]
    fn is_departure(&self, lane: usize, id: PrimitiveId) -> bool {
        if id.geometry == Geometry::Spheres {
            return self.departures.outward[lane] == id.primitive;
        }
        self.packet.departure(lane).is_some_and(|departure| departure.id == id)
    }

    /// The estimates for the rays of a packet; `None` if all active ones certainly miss.
    #[inline(always)]
    fn estimates(
        &self,
        primitive: &CertifiedPrimitive<impl Shape>,
        active: &[i32; W],
    ) -> Option<Estimates<W>> {
        // A shadow ray may be blocked by what it starts on, beside its line.
        let distance = if self.are_shadow_rays { self.departures.corner_distance } else { 0.0 };
        let mut any = false;
        for i in 0..W {
            let (origin, direction) = self.rays.origin_and_direction(i);
            let inverse = self.rays.inverse_length_squared[i];
            any |= (active[i] != 0)
                & primitive.shape.may_pass_within(distance, origin, direction, inverse);
        }
        if !any {
            return None;
        }
        let mut estimates =
            Estimates { hits: [Estimate::MISS; W], may_start: [false; W], may_block: [false; W] };
        for i in 0..W {
            let (origin, direction) = self.rays.origin_and_direction(i);
            let inverse = self.rays.inverse_length_squared[i];
            estimates.hits[i] = primitive.shape.estimate(origin, direction, inverse);
        }
        // Whether its origin lies on the primitive matters for few. A corner reaches farther than rounding; one
        // distance for both finds a few more, which are decided exactly.
        let tolerance = self.departures.tolerance;
        if self.are_shadow_rays {
            let mut may_any_start = false;
            for i in 0..W {
                let origin = self.rays.origin_and_direction(i).0;
                estimates.may_start[i] = primitive.shape.may_contain(origin, distance);
                may_any_start |= estimates.may_start[i];
            }
            if may_any_start {
                for i in 0..W {
                    let (origin, direction) = self.rays.origin_and_direction(i);
                    let may_separate =
                        primitive.shape.may_separate(origin, self.viewer(i), direction);
                    estimates.may_block[i] = estimates.may_start[i] & may_separate;
                }
            }
        } else if self.departures.any {
            for i in 0..W {
                let origin = self.rays.origin_and_direction(i).0;
                estimates.may_start[i] = primitive.shape.may_contain(origin, tolerance);
            }
        }
        Some(estimates)
    }

    /// True if the shadow ray in `lane` may end on the primitive, which then does not block its light. Only
    /// rays that seem to be blocked need to know.
    #[inline(always)]
    fn may_end_on(&self, shape: &impl Shape, lane: usize) -> bool {
        let (origin, direction) = self.rays.origin_and_direction(lane);
        let tmax = self.rays.tmax[lane];
        // A directional light is nowhere.
        self.are_shadow_rays
            && tmax < f64::INFINITY
            && shape.may_contain(origin + direction * tmax, self.departures.tolerance)
    }

    /// The exact hit of the ray in `lane` on a primitive.
    pub fn exact_hit(&self, lane: usize, id: PrimitiveId) -> Option<Hit> {
        if lane >= self.packet.count {
            return None;
        }
        let ray = self.packet.ray(lane);
        self.query.primitives().with_ray(&ray).primitive(id)
    }

    /// Decides exactly whether `id` is the closest hit of the ray in `lane`.
    #[cold]
    #[inline(never)]
    pub fn resolve_exactly(&mut self, lane: usize, id: PrimitiveId) {
        let Some(hit) = self.exact_hit(lane, id) else { return };
        // Make the distance of the hit so far exact, too.
        let best = self.hits.id(self.scene, lane);
        if let Some(best) = best
            && self.hits.error[lane] != 0.0
            && let Some(exact) = self.exact_hit(lane, best)
        {
            self.hits.t[lane] = exact.t;
            self.hits.error[lane] = 0.0;
        }
        let t = self.hits.t[lane];
        let is_before = |best| {
            let best = Hit { t, u: 0.0, v: 0.0, id: best };
            self.query.primitives().with_ray(&self.packet.ray(lane)).is_before(&hit, &best)
        };
        // Without a hit so far `t` is the ray's end, which the exact test knows.
        if best.is_none_or(is_before) {
            self.hits.set(lane, Estimate { t: hit.t, error: 0.0 }, id);
        }
    }

    /// Decides exactly about every triangle of an instance, for the ray in `lane`.
    pub fn resolve_instance(&mut self, lane: usize, instance: u32) {
        for id in self.instance_triangles(instance) {
            self.resolve_exactly(lane, id);
        }
    }

    /// Notes the triangles of an instance that the ray in `lane` crosses.
    pub fn note_instance(&self, lane: usize, instance: u32) {
        let crossed = |&id: &PrimitiveId| self.exact_hit(lane, id).is_some();
        self.instance_triangles(instance)
            .filter(crossed)
            .for_each(|id| self.note_crossing(lane, id));
    }

    /// True if the ray in `lane` hits any triangle of an instance.
    pub fn hits_instance(&self, lane: usize, instance: u32) -> bool {
        self.instance_triangles(instance).any(|id| self.exact_hit(lane, id).is_some())
    }

    fn instance_triangles(&self, instance: u32) -> impl Iterator<Item = PrimitiveId> + use<W> {
        #[cfg(test)]
        crate::intersect::embree::packet::BRUTE_FORCED.with(|count| count.set(count.get() + 1));
        let scene = self.scene;
        let mesh = scene.instances[instance as usize].mesh.0;
        let count = scene.meshes[mesh as usize].triangles.len() as u32;
        (0..count).map(move |triangle| PrimitiveId::triangle(mesh, triangle, instance))
    }
}
