//! Tracing a batch through Embree, packet by packet.
#![allow(unsafe_code)]

use embree4_sys as sys;

use crate::geometry::{Hit16, HitBatch, LANES, RayBatch};
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::fast::filter::filter;
use crate::intersect::embree::fast::refine::refine;
use crate::intersect::embree::ffi::packet_width::PacketWidth;
use crate::intersect::embree::ffi::records::{INVALID, LaneMask, QueryContext, RayHitRecord};
use crate::intersect::embree::packet::Packet;
use crate::intersect::primitive::Primitives;
use crate::intersect::{BruteForce, Coherence, Precision};
use crate::scene::Scene;

/// A committed Embree scene and what belongs to it.
#[derive(Clone, Copy)]
pub struct Target<'a> {
    pub handle: sys::RTCScene,
    pub scene: &'a Scene,
    pub instance_of: &'a [u32],
    pub frame: &'a F32Space,
    pub width: PacketWidth,
    pub precision: Precision,
    /// Whether rays that left nothing are filtered, too.
    pub careful: bool,
    /// The largest absolute coordinate in the scene.
    pub reach: f64,
    /// Whether every triangle blocks light.
    pub all_block: bool,
    /// Of which instances the alpha is tested; empty where it is of none.
    pub masked: &'a [bool],
}

impl Target<'_> {
    fn primitives(&self) -> Primitives<'_> {
        Primitives { scene: self.scene, precision: self.precision }
    }

    fn context<'a, const W: usize>(&'a self, rays: Packet<'a>) -> QueryContext<'a, W> {
        let reaches = (self.frame.doubt(), self.reach);
        let solid = (self.all_block, self.masked);
        QueryContext::new(self.scene, rays, self.instance_of, reaches, solid)
    }

    /// What rays are left to that no f32 ray can stand for.
    fn brute_force(&self) -> BruteForce<'_> {
        BruteForce::new(self.scene, self.precision)
    }

    /// The closest hit of each ray.
    pub fn closest(&self, rays: &RayBatch, coherence: Coherence, hits: &mut HitBatch) {
        // SAFETY: the widths with target features are only chosen where the processor has them.
        match self.width {
            PacketWidth::One => closest::<1>(self, rays, coherence, hits),
            PacketWidth::Four => closest::<4>(self, rays, coherence, hits),
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Eight => unsafe { closest_8(self, rays, coherence, hits) },
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Sixteen => unsafe { closest_16(self, rays, coherence, hits) },
        }
    }

    /// Whether each ray is kept from its end.
    pub fn occluded(&self, rays: &RayBatch, coherence: Coherence, blocked: &mut [bool]) {
        // SAFETY: as in `closest`.
        match self.width {
            PacketWidth::One => occluded::<1>(self, rays, coherence, blocked),
            PacketWidth::Four => occluded::<4>(self, rays, coherence, blocked),
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Eight => unsafe { occluded_8(self, rays, coherence, blocked) },
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Sixteen => unsafe { occluded_16(self, rays, coherence, blocked) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn closest_8(target: &Target<'_>, rays: &RayBatch, c: Coherence, hits: &mut HitBatch) {
    closest::<8>(target, rays, c, hits);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,fma")]
fn closest_16(target: &Target<'_>, rays: &RayBatch, c: Coherence, hits: &mut HitBatch) {
    closest::<16>(target, rays, c, hits);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn occluded_8(target: &Target<'_>, rays: &RayBatch, c: Coherence, blocked: &mut [bool]) {
    occluded::<8>(target, rays, c, blocked);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,fma")]
fn occluded_16(target: &Target<'_>, rays: &RayBatch, c: Coherence, blocked: &mut [bool]) {
    occluded::<16>(target, rays, c, blocked);
}

fn query_flags(coherence: Coherence, filtered: bool) -> sys::RTCRayQueryFlags {
    let flags = match coherence {
        Coherence::Coherent => sys::RTCRayQueryFlags::COHERENT,
        Coherence::Incoherent => sys::RTCRayQueryFlags::INCOHERENT,
    };
    if filtered { flags | sys::RTCRayQueryFlags::INVOKE_ARGUMENT_FILTER } else { flags }
}

/// The feature mask of Embree's own default arguments: everything.
const ALL_FEATURES: sys::RTCFeatureFlags = sys::RTCFeatureFlags(u32::MAX);

#[inline(always)]
fn lanes<const W: usize>(count: usize, inside: &[bool; W]) -> LaneMask<W> {
    let mut valid = LaneMask([0; W]);
    for i in 0..W {
        valid.0[i] = if inside[i] & (i < count) { -1 } else { 0 };
    }
    valid
}

#[inline(always)]
fn closest<const W: usize>(
    target: &Target<'_>,
    rays: &RayBatch,
    coherence: Coherence,
    hits: &mut HitBatch,
) {
    let Some(first) = Packet::all::<W>(rays).next() else { return };
    let mut room = Room { context: target.context::<W>(first), record: RayHitRecord::new() };
    for packet in Packet::all::<W>(rays) {
        let found = &mut hits.blocks_mut()[packet.first / LANES];
        if !closest_in_packet(target, packet, coherence, &mut room, found) {
            // A ray that starts on a triangle, which hides what lies behind it: the filter drops it
            // and lets Embree look on.
            let careful = Target { careful: true, ..*target };
            closest_in_packet(&careful, packet, coherence, &mut room, found);
        }
    }
}

/// What a packet is traced with.
struct Room<'a, const W: usize> {
    context: QueryContext<'a, W>,
    record: RayHitRecord<W>,
}

/// Writes the closest hits of a packet; says whether all lie within their rays' segments, or else
/// are the best that there are.
#[inline(always)]
fn closest_in_packet<'a, const W: usize>(
    target: &Target<'_>,
    packet: Packet<'a>,
    coherence: Coherence,
    Room { context, record }: &mut Room<'a, W>,
    found: &mut Hit16,
) -> bool {
    let at = packet.first % LANES;
    found.clear::<W>(at);
    let RayHitRecord { org, dir, tfar, .. } = record;
    let entry = context.take_up(packet, target.frame, org, dir, tfar);
    record.geom = [INVALID; W];
    record.inst = [INVALID; W];
    let valid = lanes(packet.count, &entry.inside);
    let asked = context.leaves || target.careful || !target.masked.is_empty();
    let filtered = asked && target.precision == Precision::Fast;
    let mut args = sys::RTCIntersectArguments {
        flags: query_flags(coherence, filtered),
        feature_mask: ALL_FEATURES,
        context: std::ptr::from_mut(context).cast(),
        filter: if filtered { Some(filter::<W, false>()) } else { None },
        intersect: None,
    };
    let record_ptr = std::ptr::from_mut(record);
    // SAFETY: the scene is committed and lives as long as `target`; record, valid and context
    // are laid out as the library wants them (see `layout` and `canary`), larger than it
    // needs, and 64-aligned; the callbacks get a pointer to the whole context.
    unsafe {
        match W {
            1 => {
                if valid.0[0] != 0 {
                    sys::rtcIntersect1(target.handle, record_ptr.cast(), &mut args);
                }
            }
            4 => sys::rtcIntersect4(valid.0.as_ptr(), target.handle, record_ptr.cast(), &mut args),
            8 => sys::rtcIntersect8(valid.0.as_ptr(), target.handle, record_ptr.cast(), &mut args),
            _ => sys::rtcIntersect16(valid.0.as_ptr(), target.handle, record_ptr.cast(), &mut args),
        }
    }
    match target.precision {
        Precision::Fast => {
            let (scene, instance_of) = (target.scene, target.instance_of);
            let exact = &context.exact;
            let within = refine(scene, instance_of, exact, record, packet.count, found, at);
            if !within && !filtered {
                return false;
            }
            context.merge_spheres(found, at);
        }
        Precision::Certified => context.finish(found, at),
    }
    if entry.any_astray {
        for i in (0..packet.count).filter(|&i| entry.astray[i]) {
            found.set(at + i, target.brute_force().first(&packet.ray(i)));
        }
    }
    if !target.scene.planes.is_empty() {
        target.primitives().merge_planes_into(&packet, &context.exact, context.slack, found, at);
    }
    true
}

#[inline(always)]
fn occluded<const W: usize>(
    target: &Target<'_>,
    rays: &RayBatch,
    coherence: Coherence,
    blocked: &mut [bool],
) {
    let Some(first) = Packet::all::<W>(rays).next() else { return };
    let (mut context, mut record) = (target.context::<W>(first), RayHitRecord::<W>::new());
    for (packet, blocked) in Packet::all::<W>(rays).zip(blocked.chunks_mut(W)) {
        let RayHitRecord { org, dir, tfar, .. } = &mut record;
        let entry = context.take_up(packet, target.frame, org, dir, tfar);
        let valid = lanes(packet.count, &entry.inside);
        let filtered = target.precision == Precision::Fast;
        let mut args = sys::RTCOccludedArguments {
            flags: query_flags(coherence, filtered),
            feature_mask: ALL_FEATURES,
            context: std::ptr::from_mut(&mut context).cast(),
            filter: if filtered { Some(filter::<W, true>()) } else { None },
            occluded: None,
        };
        let record_ptr = std::ptr::from_mut(&mut record);
        // SAFETY: as in `closest`; an occlusion call touches the ray part of the record only.
        unsafe {
            match W {
                1 => {
                    if valid.0[0] != 0 {
                        sys::rtcOccluded1(target.handle, record_ptr.cast(), &mut args);
                    }
                }
                4 => {
                    sys::rtcOccluded4(valid.0.as_ptr(), target.handle, record_ptr.cast(), &mut args)
                }
                8 => {
                    sys::rtcOccluded8(valid.0.as_ptr(), target.handle, record_ptr.cast(), &mut args)
                }
                _ => sys::rtcOccluded16(
                    valid.0.as_ptr(),
                    target.handle,
                    record_ptr.cast(),
                    &mut args,
                ),
            }
        }
        for (i, blocked) in blocked.iter_mut().enumerate() {
            *blocked = (valid.0[i] != 0) & (record.tfar[i] == f32::NEG_INFINITY);
        }
        if entry.any_astray {
            for i in (0..packet.count).filter(|&i| entry.astray[i]) {
                blocked[i] = target.brute_force().blocks(&packet.ray(i));
            }
        }
        if !target.scene.planes.is_empty() {
            target.primitives().planes_block(&packet, &context.exact, blocked);
        }
    }
}
