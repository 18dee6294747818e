//! How much memory Embree takes, as it tells itself.
#![allow(unsafe_code)]

use std::ffi::c_void;
use std::sync::atomic::{AtomicIsize, Ordering};

use embree4_sys as sys;

use crate::intersect::embree::ffi::handles::DeviceHandle;

/// Bytes that all devices of the process hold now, and the most that they ever held.
static HELD: AtomicIsize = AtomicIsize::new(0);
static PEAK: AtomicIsize = AtomicIsize::new(0);

/// The most bytes that Embree held at any time in this process: trees, the vertices of meshes, and
/// what it needs while it builds.
pub fn peak() -> u64 {
    u64::try_from(PEAK.load(Ordering::Relaxed)).unwrap_or(0)
}

/// Counts from now on what a device takes.
pub fn watch(device: &DeviceHandle) {
    // SAFETY: the device is live, and the callback uses no pointer.
    unsafe {
        sys::rtcSetDeviceMemoryMonitorFunction(device.0, Some(count), std::ptr::null_mut());
    }
}

/// Called from any thread, several at once, with what is taken (above 0) or given back.
unsafe extern "C" fn count(_: *mut c_void, bytes: isize, _: bool) -> bool {
    let held = HELD.fetch_add(bytes, Ordering::Relaxed).wrapping_add(bytes);
    PEAK.fetch_max(held, Ordering::Relaxed);
    true
}
