//! The filter for the triangles that Embree finds: it drops the surface that a ray left, triangles
//! that the ray misses in f64, what an alpha mask cuts out, and, for shadow rays, what blocks no light.
//!
//! Primary rays need no filter, unless something has a mask.

use crate::geometry::{PrimitiveId, triangle};
use crate::intersect::embree::ffi::{Candidate, INVALID};
use crate::intersect::embree::packet::QueryContext;

/// Clears the active mask of a packet where its candidates do not count.
#[inline(always)]
pub fn filter_packet<const OCCLUSION: bool, const W: usize>(
    context: &QueryContext<'_, W>,
    active: &mut [i32; W],
    candidate: impl Fn(usize) -> Candidate,
) {
    let mut certain = [false; W];
    for i in 0..W {
        certain[i] = is_certain(context, i, &candidate(i));
    }
    // Nearly always all candidates certainly count.
    let mut uncertain = 0;
    for i in 0..W {
        uncertain |= if certain[i] { 0 } else { active[i] };
    }
    if uncertain == 0 && certain_hits_count::<OCCLUSION, W>(context) {
        return;
    }
    for i in 0..W {
        if active[i] != 0 && !counts::<OCCLUSION, W>(context, i, certain[i], &candidate(i)) {
            active[i] = 0;
        }
    }
}

/// True if every triangle that a ray certainly crosses counts: none is masked, and for occlusion all
/// block light.
#[inline(always)]
fn certain_hits_count<const OCCLUSION: bool, const W: usize>(
    context: &QueryContext<'_, W>,
) -> bool {
    (!OCCLUSION | context.query.all_block_light) & context.query.masked.is_empty()
}

/// True if the ray in `lane` certainly crosses the plane of the candidate within its segment.
///
/// The f32 ray is off by at most the margin of the f32 space, and twice that is
/// [`F32Space::t_uncertainty`] / 512: where its ends are higher over the triangle than that, so do
/// those of the exact ray, on the same sides. A ray that grazes a triangle in whose plane it starts or
/// ends may seem to cross it anywhere; the triangle that it left is one of those.
///
/// [`F32Space::t_uncertainty`]: crate::intersect::embree::f32_space::F32Space::t_uncertainty
#[inline(always)]
pub fn is_certain<const W: usize>(
    context: &QueryContext<'_, W>,
    lane: usize,
    candidate: &Candidate,
) -> bool {
    let Candidate { t, direction, normal, .. } = *candidate;
    let height = context.t_uncertainty / 512.0;
    // By how much the ray rises over the triangle for each unit of t, times |normal|.
    let slope = normal.dot(direction);
    let is_clear = |t: f32| {
        (t > context.t_uncertainty)
            & ((t * t) * (slope * slope) > (height * height) * normal.length_squared())
    };
    // In an instance normal and direction are in two spaces.
    (candidate.instance == INVALID)
        & !context.departures.any_continuation
        & is_clear(t)
        & is_clear(context.f32_tmax[lane] - t)
}

/// True if a candidate counts for the ray in `lane`.
#[inline(always)]
pub fn counts<const OCCLUSION: bool, const W: usize>(
    context: &QueryContext<'_, W>,
    lane: usize,
    certain: bool,
    candidate: &Candidate,
) -> bool {
    if certain && certain_hits_count::<OCCLUSION, W>(context) {
        return true;
    }
    // Look up the triangle.
    let QueryContext { query, scene, .. } = context;
    let in_world = candidate.instance == INVALID;
    let geometry = if in_world { candidate.geometry } else { candidate.instance };
    let Some(&index) = query.instance_of.get(geometry as usize) else { return true };
    let mesh = scene.instances[index as usize].mesh.0;
    let id = PrimitiveId::triangle(mesh, candidate.primitive, index);
    // Test it: by its material, by the ray in f64, and by its mask.
    if OCCLUSION && !scene.blocks_light(id) {
        if context.collects_crossings() {
            context.note_crossing(lane, id);
        }
        return false;
    }
    if !certain && !is_hit(context, lane, id) {
        return false;
    }
    !(query.is_masked(index) && is_cut_out(context, lane, id))
}

/// True if a mask cuts a hole where the ray in `lane` hits a triangle, by the weights in f64 that
/// `refine` gives.
#[inline(never)]
fn is_cut_out<const W: usize>(context: &QueryContext<'_, W>, lane: usize, id: PrimitiveId) -> bool {
    let scene = context.scene;
    let (origin, direction) = context.rays.origin_and_direction(lane);
    let (u, v) =
        triangle::EdgeFunctions::new(scene.triangle_vertices(id), origin, direction).weights();
    scene.is_cut_out(id, u, v)
}

/// True if the ray in `lane` hits a triangle by the formulas in f64.
#[cold]
#[inline(never)]
fn is_hit<const W: usize>(context: &QueryContext<'_, W>, lane: usize, id: PrimitiveId) -> bool {
    if lane >= context.packet.count {
        return false;
    }
    let ray = context.packet.ray(lane);
    context.query.primitives().with_ray(&ray).triangle(id, f64::INFINITY).is_some()
}
