//! The f64 hits of the triangles that Embree found.

use crate::geometry::{Hit16, PrimitiveId16, triangle};
use crate::intersect::embree::ffi::records::{INVALID, RayHitRecord};
use crate::intersect::embree::packet::packet_rays::PacketRays;
use crate::scene::{Scene, Triangles};

/// Intersects the triangles of the first `count` lanes again in f64, and writes the hits from lane
/// `at` of `found` on; where no lane has one, nothing is written.
/// Says whether all of them lie within their rays' segments.
///
/// Where f64 says that the ray just misses the triangle that Embree's f32 arithmetic hit, the hit
/// is kept, with t from the triangle's plane and the weights clamped: dropping it would leave a
/// hole, since Embree no longer looked behind it. Where the plane gives no t either (the ray runs
/// along it, or meets it outside the segment) Embree's own t is taken.
#[inline(always)]
pub fn refine<const W: usize>(
    scene: &Scene,
    instance_of: &[u32],
    exact: &PacketRays<W>,
    record: &RayHitRecord<W>,
    count: usize,
    found: &mut Hit16,
    at: usize,
) -> bool {
    if record.geom == [INVALID; W] {
        return true;
    }
    let (mut geometry, mut instances) = ([PrimitiveId16::NONE; W], [0; W]);
    let primitives = &record.prim;
    for i in 0..count {
        if record.geom[i] == INVALID {
            continue;
        }
        let attached = if record.inst[i] == INVALID { record.geom[i] } else { record.inst[i] };
        instances[i] = instance_of[attached as usize];
        geometry[i] = PrimitiveId16::MESHES + scene.instances[instances[i] as usize].mesh.0;
    }
    let Some(faces) = Triangles::from_ids(scene, &geometry, primitives, &instances) else {
        return true;
    };
    let mut ts = [0.0; W];
    let mut us = [0.0; W];
    let mut vs = [0.0; W];
    let mut flat = [false; W];
    for i in 0..W {
        let (origin, direction) = exact.line(i);
        let edges = triangle::EdgeFunctions::new(faces.vertices(i), origin, direction);
        (us[i], vs[i]) = edges.weights();
        ts[i] = edges.t;
        flat[i] = edges.is_flat;
    }
    for i in (0..W).filter(|&i| flat[i] && geometry[i] != PrimitiveId16::NONE) {
        let (origin, direction) = exact.line(i);
        ts[i] = triangle::certified::round(faces.vertices(i), origin, direction).t;
    }
    let mut odd = [false; W];
    let (mut any_odd, mut all_within) = (false, true);
    for i in 0..W {
        let within = (ts[i] > 0.0) & (ts[i] < exact.tmax[i]);
        odd[i] = !(within & us[i].is_finite() & vs[i].is_finite());
        any_odd |= odd[i];
    }
    if any_odd {
        for i in (0..W).filter(|&i| odd[i] && geometry[i] != PrimitiveId16::NONE) {
            if !(ts[i] > 0.0 && ts[i] < exact.tmax[i]) {
                all_within = false;
                let last = exact.tmax[i].next_down();
                ts[i] = exact.clip.widen(i, record.tfar[i]).clamp(f64::MIN_POSITIVE, last);
            }
            if !(us[i].is_finite() && vs[i].is_finite()) {
                (us[i], vs[i]) = (f64::from(record.u[i]), f64::from(record.v[i]));
            }
        }
    }
    for i in 0..W {
        found.t[at + i] = if geometry[i] != PrimitiveId16::NONE { ts[i] } else { f64::INFINITY };
        found.u[at + i] = us[i];
        found.v[at + i] = vs[i];
    }
    found.id.geometry[at..at + W].copy_from_slice(&geometry);
    found.id.primitive[at..at + W].copy_from_slice(primitives);
    found.id.instance[at..at + W].copy_from_slice(&instances);
    all_within
}
