//! How many rays go through Embree at once.

use embree4_sys::RTCDeviceProperty;

use crate::intersect::embree::ffi::handles::DeviceHandle;

/// The packet widths that can be native to a processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketWidth {
    One,
    Four,
    #[cfg(target_arch = "x86_64")]
    Eight,
    #[cfg(target_arch = "x86_64")]
    Sixteen,
}

impl PacketWidth {
    /// The widest packet that library and processor both have natively: a wider one is taken
    /// apart by Embree and traced at the speed of single rays.
    pub fn native(device: &DeviceHandle) -> Self {
        let has = |property| device.property(property) != 0;
        #[cfg(target_arch = "x86_64")]
        {
            let fma = is_x86_feature_detected!("fma");
            let avx512 = fma
                && is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw");
            if avx512 && has(RTCDeviceProperty::NATIVE_RAY16_SUPPORTED) {
                return PacketWidth::Sixteen;
            }
            if is_x86_feature_detected!("avx2")
                && fma
                && has(RTCDeviceProperty::NATIVE_RAY8_SUPPORTED)
            {
                return PacketWidth::Eight;
            }
        }
        if has(RTCDeviceProperty::NATIVE_RAY4_SUPPORTED) {
            PacketWidth::Four
        } else {
            PacketWidth::One
        }
    }
}
