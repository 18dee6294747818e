//! The entry points of Embree that trace packets, one set for each packet width.
#![allow(unsafe_code)]

use embree4_sys as sys;

use crate::intersect::Coherence;
use crate::intersect::embree::ffi::callbacks::FilterFunction;
use crate::intersect::embree::ffi::handles::TopScene;
use crate::intersect::embree::ffi::records::{LaneMask, RayHitRecord};
use crate::intersect::embree::packet::context::QueryContext;

/// The feature mask of Embree's own default arguments: everything.
const ALL_FEATURES: sys::RTCFeatureFlags = sys::RTCFeatureFlags(u32::MAX);

/// Calls the entry point for packets of `W` rays; the one for single rays takes no active mask.
macro_rules! call_for_width {
    ($active:expr, [$one:ident, $four:ident, $eight:ident, $sixteen:ident], $($argument:expr),*) => {
        match W {
            1 if $active.0[0] == 0 => {}
            1 => sys::$one($($argument),*),
            4 => sys::$four($active.0.as_ptr(), $($argument),*),
            8 => sys::$eight($active.0.as_ptr(), $($argument),*),
            _ => sys::$sixteen($active.0.as_ptr(), $($argument),*),
        }
    };
}
pub(super) use call_for_width;

/// Finds the closest hits of a packet.
#[inline(always)]
pub fn intersect<const W: usize>(
    scene: &TopScene,
    active: &LaneMask<W>,
    record: &mut RayHitRecord<W>,
    context: &mut QueryContext<'_, W>,
    coherence: Coherence,
    filter: Option<FilterFunction>,
) {
    assert!(W == scene.device.width as usize, "the scene is built for packets of another width");
    let record = std::ptr::from_mut(record);
    let args = &mut sys::RTCIntersectArguments {
        flags: query_flags(coherence, filter),
        feature_mask: ALL_FEATURES,
        context: std::ptr::from_mut(context).cast(),
        filter,
        intersect: None,
    };
    // SAFETY: the scene is committed, and its callbacks are made for this width; record, mask and
    // context are laid out as the library wants them (see `records` and `abi_check`), larger than
    // it needs, and 64-aligned; the callbacks get a pointer to the whole context.
    unsafe {
        call_for_width!(
            active,
            [rtcIntersect1, rtcIntersect4, rtcIntersect8, rtcIntersect16],
            scene.handle(),
            record.cast(),
            args
        );
    }
}

/// Sets `tfar` of each occluded ray of a packet to minus infinity.
#[inline(always)]
pub fn occluded<const W: usize>(
    scene: &TopScene,
    active: &LaneMask<W>,
    record: &mut RayHitRecord<W>,
    context: &mut QueryContext<'_, W>,
    coherence: Coherence,
    filter: Option<FilterFunction>,
) {
    assert!(W == scene.device.width as usize, "the scene is built for packets of another width");
    let record = std::ptr::from_mut(record);
    let args = &mut sys::RTCOccludedArguments {
        flags: query_flags(coherence, filter),
        feature_mask: ALL_FEATURES,
        context: std::ptr::from_mut(context).cast(),
        filter,
        occluded: None,
    };
    // SAFETY: as in `intersect`; an occlusion query touches the ray part of the record only.
    unsafe {
        call_for_width!(
            active,
            [rtcOccluded1, rtcOccluded4, rtcOccluded8, rtcOccluded16],
            scene.handle(),
            record.cast(),
            args
        );
    }
}

fn query_flags(coherence: Coherence, filter: Option<FilterFunction>) -> sys::RTCRayQueryFlags {
    let flags = match coherence {
        Coherence::Coherent => sys::RTCRayQueryFlags::COHERENT,
        Coherence::Incoherent => sys::RTCRayQueryFlags::INCOHERENT,
    };
    if filter.is_some() { flags | sys::RTCRayQueryFlags::INVOKE_ARGUMENT_FILTER } else { flags }
}
