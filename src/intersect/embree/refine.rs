//! The f64 hits of the triangles that Embree found.

use glam::DVec3;

use crate::geometry::{Hit, PrimitiveId, triangle};
use crate::intersect::embree::exact::Exact;
use crate::intersect::embree::layout::{INVALID, RayHit};
use crate::scene::Scene;

/// The corners of a packet's triangles, side by side: corner, axis, lane.
type Corners<T, const W: usize> = [[[T; W]; 3]; 3];

/// Intersects each lane's triangle again in f64, and writes the hits; `None` where there is none.
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
    hits: &mut [Option<Hit>],
) -> bool {
    let mut local: Corners<f32, W> = [[[0.0; W]; 3]; 3];
    let mut ids = [None; W];
    let mut instances = [INVALID; W];
    let mut first = INVALID;
    for i in 0..hits.len() {
        if record.geom[i] == INVALID {
            continue;
        }
        let attached = if record.inst[i] == INVALID { record.geom[i] } else { record.inst[i] };
        let instance = instance_of[attached as usize];
        let mesh = scene.instances[instance as usize].mesh.0;
        let corners = scene.meshes[mesh as usize].corners(record.prim[i]);
        for (to, p) in local.iter_mut().zip(corners) {
            for axis in 0..3 {
                to[axis][i] = p[axis];
            }
        }
        ids[i] = Some(PrimitiveId::triangle(mesh, record.prim[i], instance));
        instances[i] = instance;
        first = instance;
    }
    if first == INVALID {
        hits.fill(None);
        return true;
    }
    let corners = bake(scene, first, &instances, &local);
    let mut ts = [0.0; W];
    let mut us = [0.0; W];
    let mut vs = [0.0; W];
    let mut flat = [false; W];
    for i in 0..W {
        let (origin, direction) = exact.line(i);
        let corner = |c: usize| DVec3::new(corners[c][0][i], corners[c][1][i], corners[c][2][i]);
        let edges = triangle::Edges::new([corner(0), corner(1), corner(2)], origin, direction);
        (us[i], vs[i]) = edges.weights();
        ts[i] = edges.t;
        flat[i] = edges.flat;
    }
    for i in (0..W).filter(|&i| flat[i] && ids[i].is_some()) {
        let (origin, direction) = exact.line(i);
        let corner = |c: usize| DVec3::new(corners[c][0][i], corners[c][1][i], corners[c][2][i]);
        let triangle = [corner(0), corner(1), corner(2)];
        ts[i] = triangle::certified::round(triangle, origin, direction).t;
    }
    let mut all_within = true;
    for (i, (hit, id)) in hits.iter_mut().zip(ids).enumerate() {
        *hit = id.map(|id| {
            let mut t = ts[i];
            if !(t > 0.0 && t < exact.tmax[i]) {
                all_within = false;
                let last = exact.tmax[i].next_down();
                t = exact.clip.widen(i, record.tfar[i]).clamp(f64::MIN_POSITIVE, last);
            }
            let (mut u, mut v) = (us[i], vs[i]);
            if !(u.is_finite() && v.is_finite()) {
                (u, v) = (f64::from(record.u[i]), f64::from(record.v[i]));
            }
            Hit { t, u, v, id }
        });
    }
    all_within
}

/// The corners in world space. Nearly always all lanes are in one instance, whose transform then
/// is the same for all.
#[inline(always)]
fn bake<const W: usize>(
    scene: &Scene,
    first: u32,
    instances: &[u32; W],
    local: &Corners<f32, W>,
) -> Corners<f64, W> {
    let mut world: Corners<f64, W> = [[[0.0; W]; 3]; 3];
    let mut one = true;
    for &instance in instances {
        one &= instance == INVALID || instance == first;
    }
    let placed = &scene.instances[first as usize];
    for (to, from) in world.iter_mut().zip(local) {
        for i in 0..W {
            let p = placed.bake([from[0][i], from[1][i], from[2][i]]);
            for axis in 0..3 {
                to[axis][i] = p[axis];
            }
        }
    }
    if !one {
        for i in (0..W).filter(|&i| instances[i] != INVALID) {
            let placed = &scene.instances[instances[i] as usize];
            for (to, from) in world.iter_mut().zip(local) {
                let p = placed.bake([from[0][i], from[1][i], from[2][i]]);
                for axis in 0..3 {
                    to[axis][i] = p[axis];
                }
            }
        }
    }
    world
}
