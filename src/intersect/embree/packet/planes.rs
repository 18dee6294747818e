//! The infinite planes beside a packet: they stand in no tree, since nothing infinite can be
//! bounded.

use glam::DVec3;

use crate::geometry::{Hit16, LANES, PrimitiveId, plane};
use crate::intersect::Precision;
use crate::intersect::embree::packet::Packet;
use crate::intersect::embree::packet::packet_rays::PacketRays;
use crate::intersect::primitive::Primitives;
use crate::scene::Plane;

impl Primitives<'_> {
    /// Merges the planes into the hits of a packet, from lane `at` on; see
    /// [`Primitives::merge_planes`]. No ray that was spawned in a plane starts farther from it than
    /// `slack`.
    #[inline(always)]
    pub(super) fn merge_planes_into<const W: usize>(
        &self,
        packet: &Packet<'_>,
        exact: &PacketRays<W>,
        slack: f64,
        found: &mut Hit16,
        at: usize,
    ) {
        let mut limits = [f64::INFINITY; W];
        for (index, plane) in (0..).zip(&self.scene.planes) {
            limits.copy_from_slice(&found.t[at..at + W]);
            let gone = packet.left_plane(index);
            let Some(mut ts) = self.ahead(plane, exact, &limits, &gone) else { continue };
            (packet.count..W).for_each(|i| ts[i] = f64::NAN);
            let mut open = [false; W];
            for i in 0..W {
                open[i] = !ts[i].is_nan();
            }
            if self.precision == Precision::Fast && packet.is_unbroken() {
                // A ray that left a surface near the plane may have been spawned in it.
                for i in 0..W {
                    let height = plane.normal.dot(exact.line(i).0 - plane.point).abs();
                    open[i] &= !(packet.is_fresh() | (height > slack));
                    ts[i] = if open[i] { f64::NAN } else { ts[i] };
                }
                found.merge_plane_hits(index, &ts, at);
            } else if packet.is_fresh() {
                self.merge_certain(index, exact, &mut open, found, at);
            }
            for i in (0..packet.count).filter(|&i| open[i]) {
                let best = found.hit(at + i);
                let hit = self.plane(index, &packet.ray(i));
                if let Some(hit) = hit.filter(|hit| best.is_none_or(|best| hit.is_before(&best))) {
                    found.set(at + i, Some(hit));
                }
            }
        }
    }

    /// Merges a plane into the hits of rays that left nothing, in precision `certified`, where
    /// double-double numbers tell its distance; what they leave open stays so.
    #[inline(always)]
    fn merge_certain<const W: usize>(
        &self,
        index: u32,
        exact: &PacketRays<W>,
        open: &mut [bool; W],
        found: &mut Hit16,
        at: usize,
    ) {
        let plane = &self.scene.planes[index as usize];
        let mut ts = [f64::NAN; W];
        for i in 0..W {
            let (origin, direction) = exact.line(i);
            let (t, certain) =
                plane::certified::round(plane.point, plane.normal, origin, direction);
            let told = open[i] & certain & (t != exact.tmax[i]);
            ts[i] = if told & (t > 0.0) & (t < exact.tmax[i]) { t } else { f64::NAN };
            open[i] &= !told;
        }
        found.merge_plane_hits(index, &ts, at);
    }

    /// Marks the rays that a plane keeps from their end.
    #[inline(always)]
    pub(super) fn planes_block<const W: usize>(
        &self,
        packet: &Packet<'_>,
        exact: &PacketRays<W>,
        blocked: &mut [bool],
    ) {
        for (index, plane) in (0..).zip(&self.scene.planes) {
            if !self.scene.blocks_light(PrimitiveId::plane(index)) {
                continue;
            }
            let gone = packet.left_plane::<W>(index);
            let mut may = [0u64; W];
            for i in 0..W {
                let (origin, direction) = exact.line(i);
                let misses = match self.precision {
                    Precision::Fast => passes_by(plane, origin, direction, exact.tmax[i]),
                    Precision::Certified => {
                        let Plane { point, normal, .. } = *plane;
                        let limit = exact.tmax[i];
                        plane::certified::certainly_misses(point, normal, origin, direction, limit)
                    }
                };
                may[i] = u64::from(!misses & !gone[i] & (exact.tmax[i] > 0.0));
            }
            if may.iter().fold(0, |all, may| all | may) == 0 {
                continue;
            }
            for (i, blocked) in blocked.iter_mut().enumerate() {
                if may[i] != 0 && !*blocked {
                    *blocked = self.plane(index, &packet.ray(i)).is_some();
                }
            }
        }
    }

    /// Where the lines may cross a plane ahead and no farther than `limits`, by the formula of
    /// precision `fast`; no number where they certainly do not, as those that are `gone` from it.
    /// `None` where none does.
    #[inline(always)]
    fn ahead<const W: usize>(
        &self,
        plane: &Plane,
        exact: &PacketRays<W>,
        limits: &[f64; W],
        gone: &[bool; W],
    ) -> Option<[f64; W]> {
        const { assert!(W <= LANES) };
        let mut ts = [f64::NAN; W];
        let mut any = false;
        match self.precision {
            Precision::Fast => {
                for i in 0..W {
                    let (origin, direction) = exact.line(i);
                    let t = plane::quotient(plane.point, plane.normal, origin, direction);
                    let ahead = (t > 0.0) & (t <= limits[i]) & (t < exact.tmax[i]) & !gone[i];
                    ts[i] = if ahead { t } else { f64::NAN };
                    any |= ahead;
                }
            }
            Precision::Certified => {
                for i in 0..W {
                    let (origin, direction) = exact.line(i);
                    let misses = plane::certified::certainly_misses(
                        plane.point,
                        plane.normal,
                        origin,
                        direction,
                        limits[i],
                    );
                    let may = !misses & !gone[i];
                    ts[i] = if may { 0.0 } else { f64::NAN };
                    any |= may;
                }
            }
        }
        any.then_some(ts)
    }
}

/// Whether a ray certainly does not cross a plane before it ends, by the formula of precision
/// `fast`, which takes a division: the quotient and these products are right to a few ulp.
#[inline(always)]
fn passes_by(plane: &Plane, origin: DVec3, direction: DVec3, tmax: f64) -> bool {
    let height = plane.normal.dot(plane.point - origin);
    let rise = plane.normal.dot(direction);
    (height * rise < 0.0) | (height.abs() > rise.abs() * tmax * (1.0 + 1e-12))
}
