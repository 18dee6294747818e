//! The tests of a packet against the infinite planes: these are in no tree, since nothing infinite
//! can be bounded.

use glam::DVec3;

use crate::geometry::plane::certified::{certainly_misses, round};
use crate::geometry::{Hit, Hit16, PrimitiveId, PrimitiveId16, plane};
use crate::intersect::Precision;
use crate::intersect::embree::packet::QueryContext;
use crate::intersect::order::NEAR_TIE;
use crate::scene::Plane;

/// Merges the planes into the hits of a packet; see
/// [`RayTests::merge_planes`](crate::intersect::primitive::RayTests::merge_planes).
#[inline(always)]
pub fn merge_planes<const W: usize>(context: &QueryContext<'_, W>, hits: &mut Hit16) {
    let QueryContext { query, packet, rays, departures, .. } = context;
    let first = packet.first_lane();
    for (index, plane) in (0..).zip(&context.scene.planes) {
        let Plane { point, normal, .. } = *plane;
        // Find the rays that may cross the plane before their hits so far; in precision `fast`, where.
        let mut limits = [f64::INFINITY; W];
        limits.copy_from_slice(&hits.t[first..first + W]);
        let departed = packet.departed_plane::<W>(index);
        let (mut ts, mut open) = ([f64::NAN; W], [false; W]);
        match query.precision {
            Precision::Fast => {
                for i in 0..W {
                    let (origin, direction) = rays.origin_and_direction(i);
                    ts[i] = plane::quotient(point, normal, origin, direction);
                    let limit = limits[i] + NEAR_TIE * limits[i];
                    open[i] = (ts[i] > 0.0) & (ts[i] <= limit) & (ts[i] < rays.tmax[i]);
                }
            }
            Precision::Certified => {
                for i in 0..W {
                    let (origin, direction) = rays.origin_and_direction(i);
                    let limit = limits[i];
                    open[i] = !certainly_misses(point, normal, origin, direction, limit);
                }
            }
        }
        let mut any = false;
        for i in 0..W {
            open[i] &= !departed[i] & (i < packet.count);
            any |= open[i];
        }
        if !any {
            continue;
        }
        // Merge what a formula for the whole packet decides.
        if query.precision == Precision::Fast && !departures.any_continuation {
            // A ray that left a surface near the plane may have been spawned in it, and a face may
            // coincide with the plane.
            for i in 0..W {
                let height = normal.dot(rays.origin_and_direction(i).0 - point).abs();
                // Negated for what is not a number.
                let is_apart = height > departures.tolerance;
                let may_start_on = departures.any & !is_apart;
                let may_tie = (ts[i] - limits[i]).abs() < NEAR_TIE * limits[i];
                let is_plain = !(may_start_on | may_tie);
                ts[i] = if open[i] & is_plain { ts[i] } else { f64::NAN };
                open[i] &= !is_plain;
            }
            hits.merge_closer(PrimitiveId16::PLANES, &[index; W], &ts, first);
        } else if !departures.any {
            // In precision `certified` double-double numbers nearly always tell the distance.
            for i in 0..W {
                let (origin, direction) = rays.origin_and_direction(i);
                let (t, certain) = round(point, normal, origin, direction);
                // What rounds to the same distance as the hit so far is compared exactly.
                let decided = open[i] & certain & (t != rays.tmax[i]) & (t != limits[i]);
                ts[i] = if decided & (t > 0.0) & (t < rays.tmax[i]) { t } else { f64::NAN };
                open[i] &= !decided;
            }
            hits.merge_closer(PrimitiveId16::PLANES, &[index; W], &ts, first);
        }
        // Test the rays that are left one by one.
        for i in (0..packet.count).filter(|&i| open[i]) {
            let best = hits.hit(first + i);
            let ray = packet.ray(i);
            let tests = query.primitives().with_ray(&ray);
            let is_first = |hit: &Hit| best.is_none_or(|best| tests.is_before(hit, &best));
            if let Some(hit) = tests.plane(index).filter(is_first) {
                hits.set(first + i, Some(hit));
            }
        }
    }
}

/// Sets `occluded` for each ray of a packet that a plane occludes.
#[inline(always)]
pub fn occlude<const W: usize>(context: &QueryContext<'_, W>, occluded: &mut [bool]) {
    let QueryContext { query, scene, packet, rays, .. } = context;
    for (index, plane) in (0..).zip(&scene.planes) {
        if !scene.blocks_light(PrimitiveId::plane(index)) {
            continue;
        }
        let Plane { point, normal, .. } = *plane;
        let departed = packet.departed_plane::<W>(index);
        let mut may_cross = [0u64; W];
        for i in 0..W {
            let (origin, direction) = rays.origin_and_direction(i);
            let tmax = rays.tmax[i];
            let misses = match query.precision {
                Precision::Fast => misses(point, normal, origin, direction, tmax),
                Precision::Certified => {
                    // A shadow ray may be blocked at its origin, by a plane on which it starts.
                    let height = normal.dot(origin - point).abs();
                    let is_apart = height > context.departures.tolerance;
                    (!context.are_shadow_rays | is_apart)
                        & certainly_misses(point, normal, origin, direction, tmax)
                }
            };
            may_cross[i] = u64::from(!misses & !departed[i] & (tmax > 0.0));
        }
        if may_cross.iter().fold(0, |any, may| any | may) == 0 {
            continue;
        }
        for (i, occluded) in occluded.iter_mut().enumerate() {
            if may_cross[i] != 0 && !*occluded {
                *occluded = query.primitives().with_ray(&packet.ray(i)).plane(index).is_some();
            }
        }
    }
}

/// True if a ray does not cross a plane before it ends, by the formula of precision `fast`, which takes a
/// division: the quotient and these products are right to a few ulp.
#[inline(always)]
fn misses(point: DVec3, normal: DVec3, origin: DVec3, direction: DVec3, tmax: f64) -> bool {
    let height = normal.dot(point - origin);
    let slope = normal.dot(direction);
    (height * slope < 0.0) | (height.abs() > slope.abs() * tmax * (1.0 + 1e-12))
}
