//! The infinite planes beside a packet: they stand in no tree, since nothing infinite can be
//! bounded.

use crate::geometry::{Found, LANES, PrimitiveId, plane};
use crate::intersect::Precision;
use crate::intersect::embree::exact::Exact;
use crate::intersect::embree::packet::Packet;
use crate::intersect::primitive::Primitives;
use crate::scene::Plane;

impl Primitives<'_> {
    /// Merges the planes into the hits of a packet, from lane `at` on; see
    /// [`Primitives::merge_planes`].
    #[inline(always)]
    pub(super) fn merge_planes_into<const W: usize>(
        &self,
        packet: &Packet<'_>,
        exact: &Exact<W>,
        found: &mut Found,
        at: usize,
    ) {
        let mut limits = [f64::INFINITY; W];
        for (index, plane) in (0..).zip(&self.scene.planes) {
            limits.copy_from_slice(&found.t[at..at + W]);
            let gone = packet.left_plane(index);
            let Some(mut ts) = self.ahead(plane, exact, &limits, &gone) else { continue };
            (packet.count..W).for_each(|i| ts[i] = f64::NAN);
            if self.precision == Precision::Fast && packet.is_fresh() {
                found.offer_plane(index, &ts, at);
                continue;
            }
            let mut open = [false; W];
            for i in 0..W {
                open[i] = !ts[i].is_nan();
            }
            if packet.is_fresh() {
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
        exact: &Exact<W>,
        open: &mut [bool; W],
        found: &mut Found,
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
        found.offer_plane(index, &ts, at);
    }

    /// Marks the rays that a plane keeps from their end.
    #[inline(always)]
    pub(super) fn planes_block<const W: usize>(
        &self,
        packet: &Packet<'_>,
        exact: &Exact<W>,
        blocked: &mut [bool],
    ) {
        for (index, plane) in (0..).zip(&self.scene.planes) {
            if !self.scene.blocks_light(PrimitiveId::plane(index)) {
                continue;
            }
            let gone = packet.left_plane(index);
            let Some(ts) = self.ahead(plane, exact, &exact.tmax, &gone) else { continue };
            for (i, blocked) in blocked.iter_mut().enumerate() {
                if !ts[i].is_nan() && !*blocked && exact.tmax[i] > 0.0 {
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
        exact: &Exact<W>,
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
