//! The refinement: the f64 hits of the triangles that Embree found in f32.

use crate::geometry::{Hit16, PrimitiveId16, triangle};
use crate::intersect::embree::ffi::{INVALID, RayHitRecord};
use crate::intersect::embree::packet::QueryContext;
use crate::scene::Triangles;

/// Intersects the triangles in `record` again in f64, and writes the hits; writes nothing if
/// there are no triangles. Returns true if all of them lie within their rays' segments.
///
/// Rays that just miss, in f64, the triangle that Embree hit in f32 count as hits, with t from the
/// triangle's plane and the weights clamped: without them there would be a hole, since Embree has
/// skipped what lies behind. If the plane gives no t either (the ray runs along it, or crosses it
/// outside the segment), Embree's own t is taken.
#[inline(always)]
pub fn refine<const W: usize>(
    context: &QueryContext<'_, W>,
    record: &RayHitRecord<W>,
    hits: &mut Hit16,
) -> bool {
    let QueryContext { query, scene, packet, rays, .. } = context;
    if record.geom == [INVALID; W] {
        return true;
    }
    // Look up the meshes and instances of the triangles.
    let (mut geometry, mut instances) = ([PrimitiveId16::NONE; W], [0; W]);
    let primitives = &record.prim;
    for i in 0..packet.count {
        if record.geom[i] == INVALID {
            continue;
        }
        let in_world = record.inst[i] == INVALID;
        let attached = if in_world { record.geom[i] } else { record.inst[i] };
        instances[i] = query.instance_of[attached as usize];
        let mesh = scene.instances[instances[i] as usize].mesh.0;
        geometry[i] = PrimitiveId16::MESHES + mesh;
    }
    let triangles = Triangles::from_ids(scene, &geometry, primitives, &instances);
    let Some(triangles) = triangles else { return true };
    // Intersect them in f64.
    let mut ts = [0.0; W];
    let mut us = [0.0; W];
    let mut vs = [0.0; W];
    let mut flat = [false; W];
    for i in 0..W {
        let (origin, direction) = rays.origin_and_direction(i);
        let edges = triangle::EdgeFunctions::new(triangles.vertices(i), origin, direction);
        (us[i], vs[i]) = edges.weights();
        ts[i] = edges.t;
        flat[i] = edges.is_flat;
    }
    for i in (0..W).filter(|&i| flat[i] && geometry[i] != PrimitiveId16::NONE) {
        let (origin, direction) = rays.origin_and_direction(i);
        ts[i] = triangle::certified::round(triangles.vertices(i), origin, direction).t;
    }
    // Take Embree's own numbers where f64 gives none.
    let mut failed = [false; W];
    let (mut any_failed, mut all_within) = (false, true);
    for i in 0..W {
        let within = (ts[i] > 0.0) & (ts[i] < rays.tmax[i]);
        failed[i] = !(within & us[i].is_finite() & vs[i].is_finite());
        any_failed |= failed[i];
    }
    if any_failed {
        for i in (0..W).filter(|&i| failed[i] && geometry[i] != PrimitiveId16::NONE) {
            if !(ts[i] > 0.0 && ts[i] < rays.tmax[i]) {
                all_within = false;
                let last = rays.tmax[i].next_down();
                let t = rays.interval.f64_t(i, record.tfar[i]);
                ts[i] = t.clamp(f64::MIN_POSITIVE, last);
            }
            if !(us[i].is_finite() && vs[i].is_finite()) {
                (us[i], vs[i]) = (f64::from(record.u[i]), f64::from(record.v[i]));
            }
        }
    }
    // Write the hits.
    let first = packet.first_lane();
    for i in 0..W {
        hits.t[first + i] = if geometry[i] != PrimitiveId16::NONE { ts[i] } else { f64::INFINITY };
        hits.u[first + i] = us[i];
        hits.v[first + i] = vs[i];
    }
    hits.id.geometry[first..first + W].copy_from_slice(&geometry);
    hits.id.primitive[first..first + W].copy_from_slice(primitives);
    hits.id.instance[first..first + W].copy_from_slice(&instances);
    all_within
}
