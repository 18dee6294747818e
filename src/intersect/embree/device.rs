//! The Embree device that intersectors are built on.

use std::sync::{Mutex, PoisonError};

use crate::error::Result;
use crate::intersect::embree::ffi::{DeviceHandle, PacketWidth, check_abi};

/// The device that was opened last, and its number of threads.
static LAST: Mutex<Option<(usize, DeviceHandle)>> = Mutex::new(None);

/// Returns a device of `threads` threads (0: all there are), for packets of `width`, or else of the widest
/// that are native.
///
/// The device that was opened last serves again if it has as many threads: after a second device of one
/// thread was opened, a thread of Embree's task library would never rest for as long as rays are traced.
///
/// # Errors
/// When the library cannot be opened, does not start, or is not as expected.
///
/// # Panics
/// When the processor does not support the width.
pub fn open(threads: usize, width: Option<PacketWidth>) -> Result<DeviceHandle> {
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((last_threads, device)) = &*last
        && *last_threads == threads
    {
        return Ok(device.with_width(width));
    }
    let device = DeviceHandle::start(threads)?;
    check_abi(&device)?;
    device.monitor_memory();
    Ok(last.insert((threads, device)).1.with_width(width))
}
