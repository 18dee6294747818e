//! The infinite planes beside a packet: they stand in no tree, since nothing infinite can be
//! bounded.

use glam::DVec3;

use crate::geometry::{Hit16, LANES, PrimitiveId, PrimitiveId16, plane};
use crate::intersect::Precision;
use crate::intersect::embree::packet::context::QueryContext;
use crate::intersect::embree::packet::rays::PacketRays;
use crate::scene::Plane;

/// Merges the planes into the hits of a packet; see
/// [`Primitives::merge_planes`](crate::intersect::primitive::Primitives::merge_planes).
#[inline(always)]
pub fn merge_planes<const W: usize>(context: &QueryContext<'_, W>, hits: &mut Hit16) {
    let QueryContext { scene, packet, rays, departures, .. } = context;
    let first = packet.first_lane();
    let mut limits = [f64::INFINITY; W];
    for (index, plane) in (0..).zip(&scene.scene.planes) {
        // Find the rays that may cross the plane before their hits so far.
        limits.copy_from_slice(&hits.t[first..first + W]);
        let departed = packet.departed_plane(index);
        let crossings = match scene.precision {
            Precision::Fast => crossings(plane, rays, &limits, &departed),
            Precision::Certified => possible_crossings(plane, rays, &limits, &departed),
        };
        let Some(mut ts) = crossings else { continue };
        (packet.count..W).for_each(|i| ts[i] = f64::NAN);
        let mut open = [false; W];
        for i in 0..W {
            open[i] = !ts[i].is_nan();
        }
        // Merge what a formula for the whole packet decides.
        if scene.precision == Precision::Fast && !departures.any_continuation {
            // A ray that left a surface near the plane may have been spawned in it.
            for i in 0..W {
                let origin = rays.origin_and_direction(i).0;
                let height = plane.normal.dot(origin - plane.point).abs();
                open[i] &= departures.any & !(height > departures.tolerance);
                ts[i] = if open[i] { f64::NAN } else { ts[i] };
            }
            hits.merge_closer(PrimitiveId16::PLANES, &[index; W], &ts, first);
        } else if !departures.any {
            let ts = certain_distances(plane, rays, &mut open);
            hits.merge_closer(PrimitiveId16::PLANES, &[index; W], &ts, first);
        }
        // Test the rays that are left one by one.
        for i in (0..packet.count).filter(|&i| open[i]) {
            let best = hits.hit(first + i);
            let hit = scene.primitives().plane(index, &packet.ray(i));
            if let Some(hit) = hit.filter(|hit| best.is_none_or(|best| hit.is_before(&best))) {
                hits.set(first + i, Some(hit));
            }
        }
    }
}

/// Sets `occluded` for each ray of a packet that a plane occludes.
#[inline(always)]
pub fn occlude<const W: usize>(context: &QueryContext<'_, W>, occluded: &mut [bool]) {
    let QueryContext { scene, packet, rays, .. } = context;
    for (index, plane) in (0..).zip(&scene.scene.planes) {
        if !scene.scene.blocks_light(PrimitiveId::plane(index)) {
            continue;
        }
        let departed = packet.departed_plane::<W>(index);
        let mut may_cross = [0u64; W];
        for i in 0..W {
            let (origin, direction) = rays.origin_and_direction(i);
            let misses = match scene.precision {
                Precision::Fast => certainly_misses(plane, origin, direction, rays.tmax[i]),
                Precision::Certified => {
                    let Plane { point, normal, .. } = *plane;
                    let limit = rays.tmax[i];
                    plane::certified::certainly_misses(point, normal, origin, direction, limit)
                }
            };
            may_cross[i] = u64::from(!misses & !departed[i] & (rays.tmax[i] > 0.0));
        }
        if may_cross.iter().fold(0, |any, may| any | may) == 0 {
            continue;
        }
        for (i, occluded) in occluded.iter_mut().enumerate() {
            if may_cross[i] != 0 && !*occluded {
                *occluded = scene.primitives().plane(index, &packet.ray(i)).is_some();
            }
        }
    }
}

/// The distances, by the formula of precision `fast`, at which rays cross a plane no farther than
/// `limits`, and NaN for rays that do not, or that `departed` from it. `None` if no ray does.
#[inline(always)]
fn crossings<const W: usize>(
    plane: &Plane,
    rays: &PacketRays<W>,
    limits: &[f64; W],
    departed: &[bool; W],
) -> Option<[f64; W]> {
    const { assert!(W <= LANES) };
    let mut ts = [f64::NAN; W];
    let mut any = false;
    for i in 0..W {
        let (origin, direction) = rays.origin_and_direction(i);
        let t = plane::quotient(plane.point, plane.normal, origin, direction);
        let ahead = (t > 0.0) & (t <= limits[i]) & (t < rays.tmax[i]) & !departed[i];
        ts[i] = if ahead { t } else { f64::NAN };
        any |= ahead;
    }
    any.then_some(ts)
}

/// As [`crossings`], for precision `certified`: 0 for rays that may cross the plane, and NaN for those
/// that certainly do not.
#[inline(always)]
fn possible_crossings<const W: usize>(
    plane: &Plane,
    rays: &PacketRays<W>,
    limits: &[f64; W],
    departed: &[bool; W],
) -> Option<[f64; W]> {
    let Plane { point, normal, .. } = *plane;
    let mut ts = [f64::NAN; W];
    let mut any = false;
    for i in 0..W {
        let (origin, direction) = rays.origin_and_direction(i);
        let misses =
            plane::certified::certainly_misses(point, normal, origin, direction, limits[i]);
        let may = !misses & !departed[i];
        ts[i] = if may { 0.0 } else { f64::NAN };
        any |= may;
    }
    any.then_some(ts)
}

/// The distances of a plane, in precision `certified`, of those `open` rays that left nothing and for
/// which double-double numbers tell, who are open no longer; NaN for the others, and for misses.
#[inline(always)]
fn certain_distances<const W: usize>(
    plane: &Plane,
    rays: &PacketRays<W>,
    open: &mut [bool; W],
) -> [f64; W] {
    let mut ts = [f64::NAN; W];
    for i in 0..W {
        let (origin, direction) = rays.origin_and_direction(i);
        let (t, certain) = plane::certified::round(plane.point, plane.normal, origin, direction);
        let decided = open[i] & certain & (t != rays.tmax[i]);
        ts[i] = if decided & (t > 0.0) & (t < rays.tmax[i]) { t } else { f64::NAN };
        open[i] &= !decided;
    }
    ts
}

/// True if a ray certainly does not cross a plane before it ends, by the formula of precision
/// `fast`, which takes a division: the quotient and these products are right to a few ulp.
#[inline(always)]
fn certainly_misses(plane: &Plane, origin: DVec3, direction: DVec3, tmax: f64) -> bool {
    let height = plane.normal.dot(plane.point - origin);
    let slope = plane.normal.dot(direction);
    (height * slope < 0.0) | (height.abs() > slope.abs() * tmax * (1.0 + 1e-12))
}
