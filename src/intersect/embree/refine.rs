//! The f64 hits of the triangles that Embree found.

use crate::geometry::{Found, PrimitiveId, triangle};
use crate::intersect::embree::exact::Exact;
use crate::intersect::embree::layout::{INVALID, RayHit};
use crate::scene::{Faces, Scene};

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
    exact: &Exact<W>,
    record: &RayHit<W>,
    count: usize,
    found: &mut Found,
    at: usize,
) -> bool {
    let mut ids = [None; W];
    for i in 0..count {
        if record.geom[i] == INVALID {
            continue;
        }
        let attached = if record.inst[i] == INVALID { record.geom[i] } else { record.inst[i] };
        let instance = instance_of[attached as usize];
        let mesh = scene.instances[instance as usize].mesh.0;
        ids[i] = Some(PrimitiveId::triangle(mesh, record.prim[i], instance));
    }
    let Some(faces) = Faces::of(scene, &ids) else { return true };
    let mut ts = [0.0; W];
    let mut us = [0.0; W];
    let mut vs = [0.0; W];
    let mut flat = [false; W];
    for i in 0..W {
        let (origin, direction) = exact.line(i);
        let edges = triangle::Edges::new(faces.corners(i), origin, direction);
        (us[i], vs[i]) = edges.weights();
        ts[i] = edges.t;
        flat[i] = edges.flat;
    }
    for i in (0..W).filter(|&i| flat[i] && ids[i].is_some()) {
        let (origin, direction) = exact.line(i);
        ts[i] = triangle::certified::round(faces.corners(i), origin, direction).t;
    }
    let mut odd = [false; W];
    let (mut any_odd, mut all_within) = (false, true);
    for i in 0..W {
        let within = (ts[i] > 0.0) & (ts[i] < exact.tmax[i]);
        odd[i] = !(within & us[i].is_finite() & vs[i].is_finite());
        any_odd |= odd[i];
    }
    if any_odd {
        for i in (0..W).filter(|&i| odd[i] && ids[i].is_some()) {
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
        found.t[at + i] = if ids[i].is_some() { ts[i] } else { f64::INFINITY };
        found.u[at + i] = us[i];
        found.v[at + i] = vs[i];
        found.id[at + i] = ids[i];
    }
    all_within
}
