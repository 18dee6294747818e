//! The entry points of Embree that trace packets, one set for each packet width.
#![allow(unsafe_code)]

use embree4_sys as sys;

use crate::intersect::Coherence;
use crate::intersect::embree::ffi::handles::CommittedScene;
use crate::intersect::embree::ffi::records::{LaneMask, RayHitRecord};
use crate::intersect::embree::packet::QueryContext;

/// The feature mask of Embree's own default arguments: everything.
const ALL_FEATURES: sys::RTCFeatureFlags = sys::RTCFeatureFlags(u32::MAX);

/// Calls the entry point for packets of `W` rays; the one for single rays takes no active mask.
macro_rules! call_for_width {
    ($active:expr, [$one:ident, $four:ident, $eight:ident, $sixteen:ident], ($($argument:expr),*)) => {
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

/// Defines a query of one kind.
macro_rules! query {
    ($(#[$doc:meta])* $name:ident, $arguments:ident { $callback:ident }, $entry_points:tt) => {
        $(#[$doc])*
        #[inline(always)]
        pub fn $name<const W: usize>(
            scene: &CommittedScene,
            active: &LaneMask<W>,
            record: &mut RayHitRecord<W>,
            context: &mut QueryContext<'_, W>,
            coherence: Coherence,
            filter: sys::RTCFilterFunctionN,
        ) {
            assert!(W == scene.device.width as usize, "a scene for packets of another width");
            let record = std::ptr::from_mut(record);
            let args = &mut sys::$arguments {
                flags: query_flags(coherence, filter),
                feature_mask: ALL_FEATURES,
                context: std::ptr::from_mut(context).cast(),
                filter,
                $callback: None,
            };
            // SAFETY: the scene is committed, and its callbacks are made for this width; record,
            // mask and context are laid out as the library wants them (see `records` and
            // `abi_check`), larger than it needs, and 64-aligned; the callbacks get a pointer to the
            // whole context. An occlusion query touches the ray part of the record only.
            unsafe { call_for_width!(active, $entry_points, (scene.handle(), record.cast(), args)) }
        }
    };
}
query!(
    /// Finds the closest hits of a packet.
    intersect,
    RTCIntersectArguments { intersect },
    [rtcIntersect1, rtcIntersect4, rtcIntersect8, rtcIntersect16]
);
query!(
    /// Sets `tfar` of each occluded ray of a packet to minus infinity.
    occluded,
    RTCOccludedArguments { occluded },
    [rtcOccluded1, rtcOccluded4, rtcOccluded8, rtcOccluded16]
);

/// The flags of a query.
fn query_flags(coherence: Coherence, filter: sys::RTCFilterFunctionN) -> sys::RTCRayQueryFlags {
    let flags = match coherence {
        Coherence::Coherent => sys::RTCRayQueryFlags::COHERENT,
        Coherence::Incoherent => sys::RTCRayQueryFlags::INCOHERENT,
    };
    if filter.is_some() { flags | sys::RTCRayQueryFlags::INVOKE_ARGUMENT_FILTER } else { flags }
}
