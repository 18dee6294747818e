//! The last step of precision `certified`: the rounding of the distances of the closest hits.

use glam::DVec3;

use crate::geometry::{Geometry, Hit, Hit16, PrimitiveId, PrimitiveId16, sphere, triangle};
use crate::intersect::embree::packet::QueryContext;
use crate::scene::Triangles;

/// Distances and weights side by side, and which of them are proven.
struct Rounded<const W: usize> {
    t: [f64; W],
    u: [f64; W],
    v: [f64; W],
    certain: [bool; W],
}

/// Writes the hits of a packet.
///
/// Spheres and triangles are rounded all at once, in double-double numbers; where these leave
/// a distance open, exactly.
#[inline(always)]
pub fn round_hits<const W: usize>(context: &QueryContext<'_, W>, hits: &mut Hit16) {
    let QueryContext { scene, packet, .. } = context;
    let mut ids = [None; W];
    let (mut any_sphere, mut any_triangle) = (false, false);
    for i in 0..packet.count {
        ids[i] = context.hits.id(scene, i);
        let is_sphere = ids[i].is_some_and(|id| id.geometry == Geometry::Spheres);
        any_sphere |= is_sphere;
        any_triangle |= ids[i].is_some() & !is_sphere;
    }
    let mut rounded = Rounded { t: [0.0; W], u: [0.0; W], v: [0.0; W], certain: [false; W] };
    if any_sphere {
        round_spheres(context, &ids, &mut rounded);
    }
    if any_triangle {
        round_triangles(context, &ids, &mut rounded);
    }
    for i in 0..packet.count {
        let hit = ids[i].and_then(|id| {
            if rounded.certain[i] {
                Some(Hit { t: rounded.t[i], u: rounded.u[i], v: rounded.v[i], id })
            } else {
                context.exact_hit(i, id)
            }
        });
        hits.set(packet.first_lane() + i, hit);
    }
}

/// Rounds the distances of the spheres among the hits.
#[inline(always)]
fn round_spheres<const W: usize>(
    context: &QueryContext<'_, W>,
    ids: &[Option<PrimitiveId>; W],
    to: &mut Rounded<W>,
) {
    let mut center = [[0.0; W]; 3];
    let mut radius = [0.0; W];
    let mut is_first_root = [false; W];
    for i in 0..W {
        let Some(id) = ids[i].filter(|id| id.geometry == Geometry::Spheres) else { continue };
        let s = &context.scene.spheres[id.primitive as usize];
        for axis in 0..3 {
            center[axis][i] = s.center[axis];
        }
        radius[i] = s.radius;
        // A ray that goes into a sphere that it starts on hits its far root. Those were resolved
        // exactly; they are few.
        let is_exact = context.departures.any && context.hits.error[i] == 0.0;
        is_first_root[i] = !is_exact;
    }
    for i in 0..W {
        let (origin, direction) = context.rays.origin_and_direction(i);
        let center = DVec3::new(center[0][i], center[1][i], center[2][i]);
        let r = sphere::certified::round(center, radius[i], origin, direction, false);
        to.t[i] = r.t;
        to.certain[i] = r.is_certain & is_first_root[i];
    }
}

/// Rounds the distances and weights of the triangles among the hits.
#[inline(always)]
fn round_triangles<const W: usize>(
    context: &QueryContext<'_, W>,
    ids: &[Option<PrimitiveId>; W],
    to: &mut Rounded<W>,
) {
    let mut geometry = [PrimitiveId16::NONE; W];
    for i in 0..W {
        if let Some(PrimitiveId { geometry: Geometry::Mesh(mesh), .. }) = ids[i] {
            geometry[i] = PrimitiveId16::MESHES + mesh;
        }
    }
    let QueryContext { scene, hits, .. } = context;
    let triangles = Triangles::from_ids(scene, &geometry, &hits.primitive, &hits.instance);
    let Some(triangles) = triangles else { return };
    for i in 0..W {
        let (origin, direction) = context.rays.origin_and_direction(i);
        let r = triangle::certified::round(triangles.vertices(i), origin, direction);
        let is_triangle = geometry[i] != PrimitiveId16::NONE;
        to.t[i] = if is_triangle { r.t } else { to.t[i] };
        to.u[i] = if is_triangle { r.u } else { 0.0 };
        to.v[i] = if is_triangle { r.v } else { 0.0 };
        to.certain[i] = if is_triangle { r.is_certain } else { to.certain[i] };
    }
}
