//! The triangles that f32 does not resolve, as user geometry, and their tests in f64.

use glam::DVec3;

use crate::geometry::{Hit16, PrimitiveId, triangle};
use crate::intersect::embree::ffi::{CallbackPacket, INVALID, UserPrimitive, UserPrimitives};
use crate::intersect::embree::packet::QueryContext;
use crate::intersect::embree::user_meshes::TriangleTable;

/// A triangle as precision `fast` tests it where f32 does not resolve it.
pub struct FastTriangle {
    id: PrimitiveId,
    vertices: [DVec3; 3],
    blocks_light: bool,
}

impl UserPrimitives for FastTriangle {
    type Table = TriangleTable;
    type Primitive<'t> = Self;

    #[inline(always)]
    fn get<const W: usize>(
        table: &TriangleTable,
        index: u32,
        context: &QueryContext<'_, W>,
    ) -> Self {
        let (id, scene) = (table.id(index, context), context.scene);
        Self { id, vertices: scene.triangle_vertices(id), blocks_light: scene.blocks_light(id) }
    }
}

impl UserPrimitive for FastTriangle {
    #[inline(always)]
    fn intersect<const W: usize>(&self, packet: &mut CallbackPacket<'_, W>) {
        let (context, active, tfar) = packet.parts();
        let Some(crosses) = self.crosses(context, active) else { return };
        for i in (0..W).filter(|&i| crosses[i]) {
            context.resolve_exactly(i, self.id);
            tfar[i] = context.closest_tfar(i).min(tfar[i]);
        }
    }

    #[inline(always)]
    fn intersect_lane<const W: usize>(&self, context: &mut QueryContext<'_, W>, lane: usize) {
        context.resolve_exactly(lane, self.id);
    }

    #[inline(always)]
    fn occluded<const W: usize>(&self, packet: &mut CallbackPacket<'_, W>) {
        let (context, active, tfar) = packet.parts();
        if !self.blocks_light && !context.collects_crossings() {
            return;
        }
        let Some(crosses) = self.crosses(context, active) else { return };
        for i in (0..W).filter(|&i| crosses[i]) {
            if !self.blocks_light {
                context.note_crossing(i, self.id);
            } else if context.exact_hit(i, self.id).is_some() {
                tfar[i] = f32::NEG_INFINITY;
            }
        }
    }

    #[inline(always)]
    fn occluded_lane<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool {
        if !self.blocks_light {
            context.note_crossing(lane, self.id);
            return false;
        }
        context.exact_hit(lane, self.id).is_some()
    }
}

impl FastTriangle {
    /// True for each active ray whose line crosses the triangle; `None` if none does, as for most.
    #[inline(always)]
    fn crosses<const W: usize>(
        &self,
        context: &QueryContext<'_, W>,
        active: &[i32; W],
    ) -> Option<[bool; W]> {
        let (mut crosses, mut any) = ([false; W], false);
        for i in 0..W {
            let (origin, direction) = context.rays.origin_and_direction(i);
            let edges = triangle::EdgeFunctions::new(self.vertices, origin, direction);
            crosses[i] = edges.crosses() & (active[i] != 0);
            any |= crosses[i];
        }
        any.then_some(crosses)
    }
}

/// Merges the triangles that these callbacks found into the hits of a packet.
#[inline(always)]
pub fn merge_triangles<const W: usize>(context: &QueryContext<'_, W>, hits: &mut Hit16) {
    if context.hits.instance == [INVALID; W] {
        return;
    }
    let first = context.packet.first_lane();
    for i in (0..context.packet.count).filter(|&i| context.hits.instance[i] != INVALID) {
        let found = context.hits.id(context.scene, i).and_then(|id| context.exact_hit(i, id));
        let Some(found) = found else { continue };
        let ray = context.packet.ray(i);
        let mut best = hits.hit(first + i);
        context.query.primitives().with_ray(&ray).keep_closest(&mut best, found);
        hits.set(first + i, best);
    }
}
