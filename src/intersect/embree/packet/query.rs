//! The queries of a batch: its packets, traced through Embree one by one.

use crate::geometry::{Hit16, HitBatch, RayBatch};
use crate::intersect::embree::certified::round_hits;
use crate::intersect::embree::fast::{merge_triangles, refine};
use crate::intersect::embree::ffi::{Filter, INVALID, Kernel, LaneMask, RayHitRecord, queries};
use crate::intersect::embree::packet::{Packet, QueryContext, QueryScene, planes};
use crate::intersect::{Coherence, Crossing, Precision};

/// The query for the closest hits of a batch.
pub struct ClosestQuery<'a> {
    pub query: &'a QueryScene<'a>,
    pub rays: &'a RayBatch,
    pub coherence: Coherence,
    pub hits: &'a mut HitBatch,
}

impl Kernel for ClosestQuery<'_> {
    #[inline(always)]
    fn run<const W: usize>(self) {
        let mut context = QueryContext::<W>::new(self.query, self.rays);
        let mut record = RayHitRecord::new();
        let is_filtered = self.query.precision == Precision::Fast
            && (context.departures.any || !self.query.masked.is_empty());
        for packet in Packet::split::<W>(self.rays) {
            let hits = &mut self.hits.blocks_mut()[packet.block()];
            let (context, record) = (&mut context, &mut record);
            if !closest_hits(context, record, packet, self.coherence, is_filtered, hits) {
                // A ray starts on a triangle, which hides what lies behind it: the filter drops it
                // and lets Embree go on.
                closest_hits(context, record, packet, self.coherence, true, hits);
            }
        }
    }
}

/// Finds the closest hits of a packet. Returns false if one of them lies outside its ray's segment
/// and no filter was there to reject it.
#[inline(always)]
fn closest_hits<'a, const W: usize>(
    context: &mut QueryContext<'a, W>,
    record: &mut RayHitRecord<W>,
    packet: Packet<'a>,
    coherence: Coherence,
    is_filtered: bool,
    hits: &mut Hit16,
) -> bool {
    let (query, first) = (context.query, packet.first_lane());
    // Load the rays, and set up their f32 copies.
    hits.clear::<W>(first);
    let lanes = context.load_packet(packet, record);
    record.geom = [INVALID; W];
    record.inst = [INVALID; W];
    // Trace; the callbacks leave their hits in the context.
    let filter = is_filtered.then(|| query.top.device.width.callback::<Filter<false>>());
    let active = active_lanes(&packet, &lanes.traced);
    queries::intersect(query.top, &active, record, context, coherence, filter);
    // Convert what was found into hits in f64.
    match query.precision {
        Precision::Fast => {
            let all_within = refine(context, record, hits);
            if !all_within && !is_filtered {
                return false;
            }
            context.hits.merge_spheres_into(hits, first);
            merge_triangles(context, hits);
        }
        Precision::Certified => round_hits(context, hits),
    }
    // Add what Embree does not find: the hits of extreme rays, and the planes.
    if lanes.any_brute_force {
        for i in (0..packet.count).filter(|&i| lanes.brute_force[i]) {
            hits.set(first + i, query.brute_force().closest_hit(&packet.ray(i)));
        }
    }
    if !context.scene.planes.is_empty() {
        planes::merge_planes(context, hits);
    }
    true
}

/// The query for which rays of a batch are occluded.
pub struct OcclusionQuery<'a> {
    pub query: &'a QueryScene<'a>,
    pub rays: &'a RayBatch,
    pub coherence: Coherence,
    /// The answers, one for each ray: true if it is occluded.
    pub occluded: &'a mut [bool],
    /// The triangles that let light through and that the rays may cross, if somebody asks for them.
    pub crossings: Option<&'a mut Vec<Crossing>>,
}

impl Kernel for OcclusionQuery<'_> {
    #[inline(always)]
    fn run<const W: usize>(self) {
        let query = self.query;
        let mut context = QueryContext::<W>::new(query, self.rays);
        if self.crossings.is_some() {
            context = context.with_crossings();
        }
        let mut record = RayHitRecord::new();
        let filter = (query.precision == Precision::Fast)
            .then(|| query.top.device.width.callback::<Filter<true>>());
        for (packet, occluded) in Packet::split::<W>(self.rays).zip(self.occluded.chunks_mut(W)) {
            // Load the rays, and trace their f32 copies.
            let (context, record) = (&mut context, &mut record);
            let lanes = context.load_packet(packet, record);
            let active = active_lanes(&packet, &lanes.traced);
            queries::occluded(query.top, &active, record, context, self.coherence, filter);
            for (i, occluded) in occluded.iter_mut().enumerate() {
                *occluded = (active.0[i] != 0) & (record.tfar[i] == f32::NEG_INFINITY);
            }
            // Add what Embree does not find: the hits of extreme rays, and the planes.
            if lanes.any_brute_force {
                for i in (0..packet.count).filter(|&i| lanes.brute_force[i]) {
                    occluded[i] = query.brute_force().is_occluded(&packet.ray(i));
                    if context.collects_crossings() {
                        let hits = query.brute_force();
                        hits.all_hits(&packet.ray(i))
                            .for_each(|hit| context.note_crossing(i, hit.id));
                    }
                }
            }
            if !context.scene.planes.is_empty() {
                planes::occlude(context, occluded);
            }
        }
        if let Some(crossings) = self.crossings {
            *crossings = context.into_crossings();
        }
    }
}

/// The active mask of the rays of a packet that are traced.
#[inline(always)]
fn active_lanes<const W: usize>(packet: &Packet<'_>, traced: &[bool; W]) -> LaneMask<W> {
    let mut active = LaneMask([0; W]);
    for i in 0..W {
        active.0[i] = if traced[i] & (i < packet.count) { -1 } else { 0 };
    }
    active
}
