//! Precision `certified`, in a packet: which candidates count, by their bounds, and exactly where
//! these overlap.

use crate::geometry::{Estimate, Hit, PrimitiveId};
use crate::intersect::Precision;
use crate::intersect::embree::certified::callbacks::Shape;
use crate::intersect::embree::ffi::records::QueryContext;
use crate::intersect::primitive::Primitives;

impl<const W: usize> QueryContext<'_, W> {
    /// The exact answer for one ray and one primitive.
    pub fn test(&self, lane: usize, id: PrimitiveId) -> Option<Hit> {
        let primitives = Primitives { scene: self.scene, precision: Precision::Certified };
        primitives.test(id, &self.rays.get(lane)?)
    }

    /// What f64 says of each valid ray and the primitive; `None` when all certainly miss.
    #[inline(always)]
    fn estimates(&self, shape: &impl Shape, valid: &[i32; W]) -> Option<[Estimate; W]> {
        let mut any = false;
        for i in 0..W {
            let (origin, direction) = self.exact.line(i);
            let inverse = self.exact.inverse_length_squared[i];
            any |= (valid[i] != 0) & shape.may_cross(origin, direction, inverse);
        }
        if !any {
            return None;
        }
        let mut estimates = [Estimate::MISS; W];
        for i in 0..W {
            let (origin, direction) = self.exact.line(i);
            let inverse = self.exact.inverse_length_squared[i];
            estimates[i] = shape.estimate(origin, direction, inverse);
        }
        Some(estimates)
    }

    /// Keeps the primitive for those rays that it is the nearest of.
    #[inline(always)]
    pub fn offer(&mut self, shape: &impl Shape, valid: &[i32; W], tfar: &mut [f32; W]) {
        let Some(estimates) = self.estimates(shape, valid) else { return };
        for i in 0..W {
            let e = estimates[i];
            // What is ahead of a ray that went through surfaces is not the first root.
            if self.goes_on && valid[i] != 0 {
                self.settle(i, shape.id());
                tfar[i] = self.exact.clip.narrow(i, self.nearest.upper(i)).min(tfar[i]);
                continue;
            }
            if valid[i] == 0 || e.is_outside(self.nearest.upper(i)) {
                continue;
            }
            if self.leaves && shape.is_left(self, i) {
                continue;
            }
            let nearer = e.upper() < self.nearest.t[i] - self.nearest.error[i];
            let clear = e.lower() > 0.0 && nearer;
            if !clear || shape.is_masked() || (self.leaves && shape.may_be_left(self, i)) {
                self.settle(i, shape.id());
            } else {
                self.nearest.set(i, e, shape.id());
            }
            tfar[i] = self.exact.clip.narrow(i, self.nearest.upper(i)).min(tfar[i]);
        }
    }

    /// Decides exactly whether `id` is the nearest of one ray.
    #[cold]
    #[inline(never)]
    pub fn settle(&mut self, lane: usize, id: PrimitiveId) {
        let Some(hit) = self.test(lane, id) else { return };
        let best = self.nearest.id(self.scene, lane);
        if let Some(best) = best
            && self.nearest.error[lane] != 0.0
            && let Some(exact) = self.test(lane, best)
        {
            self.nearest.t[lane] = exact.t;
            self.nearest.error[lane] = 0.0;
        }
        let t = self.nearest.t[lane];
        // Without a hit so far `t` is the ray's end, which the exact test knows.
        if best.is_none_or(|best| hit.is_before(&Hit { t, u: 0.0, v: 0.0, id: best })) {
            self.nearest.set(lane, Estimate { t: hit.t, error: 0.0 }, id);
        }
    }

    /// Decides exactly about every triangle of an instance, for one ray.
    pub fn settle_all(&mut self, lane: usize, instance: u32) {
        let mesh = self.scene.instances[instance as usize].mesh.0;
        for triangle in 0..self.scene.meshes[mesh as usize].triangles.len() as u32 {
            self.settle(lane, PrimitiveId::triangle(mesh, triangle, instance));
        }
    }

    /// Whether one ray meets any triangle of an instance.
    pub fn meets_any(&self, lane: usize, instance: u32) -> bool {
        let mesh = self.scene.instances[instance as usize].mesh.0;
        let count = self.scene.meshes[mesh as usize].triangles.len() as u32;
        (0..count).any(|t| self.test(lane, PrimitiveId::triangle(mesh, t, instance)).is_some())
    }

    /// Marks the rays that the primitive keeps from their end.
    #[inline(always)]
    pub fn block(&mut self, shape: &impl Shape, valid: &[i32; W], tfar: &mut [f32; W]) {
        let Some(estimates) = self.estimates(shape, valid) else { return };
        for i in 0..W {
            let e = estimates[i];
            if valid[i] == 0 || e.is_outside(self.exact.tmax[i]) {
                continue;
            }
            if self.leaves && shape.is_left(self, i) {
                continue;
            }
            let within = e.lower() > 0.0 && e.upper() < self.exact.tmax[i];
            let clear = within && !self.goes_on && !shape.is_masked();
            let blocked = if clear && !(self.leaves && shape.may_be_left(self, i)) {
                true
            } else {
                self.test(i, shape.id()).is_some()
            };
            if blocked {
                tfar[i] = f32::NEG_INFINITY;
            }
        }
    }
}
