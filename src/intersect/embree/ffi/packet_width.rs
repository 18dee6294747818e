//! The packet widths, and the functions that are compiled once for each of them.
//!
//! The processor features that come with a width stand here once: the compiler and the detection
//! at run time read the same list.
#![allow(unsafe_code)]

use embree4_sys::RTCDeviceProperty;

/// The number of rays that Embree traces together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketWidth {
    One = 1,
    Four = 4,
    #[cfg(target_arch = "x86_64")]
    Eight = 8,
    #[cfg(target_arch = "x86_64")]
    Sixteen = 16,
}

/// A loop over packets.
pub trait Kernel {
    /// Runs the loop with packets of `W` rays; to be inlined always.
    fn run<const W: usize>(self);
}

/// A function that Embree calls while it traces.
pub trait Callback {
    /// The record of arguments that Embree passes.
    type Arguments;

    /// Answers a call in a query with packets of `W` rays; to be inlined always.
    ///
    /// # Safety
    /// To be called by Embree, with arguments of a query of ours with packets of this width.
    unsafe fn call<const W: usize>(arguments: *const Self::Arguments);
}

/// Defines the versions of kernels and callbacks for one width, and whether the processor has the
/// features that they are compiled for.
macro_rules! version {
    ($name:ident, $width:literal, [$($feature:tt),*]) => {
        mod $name {
            use super::{Callback, Kernel};

            $(#[target_feature(enable = $feature)])*
            pub fn run(kernel: impl Kernel) {
                kernel.run::<$width>();
            }

            $(#[target_feature(enable = $feature)])*
            pub unsafe extern "C" fn call<C: Callback>(arguments: *const C::Arguments) {
                // SAFETY: the caller's duty.
                unsafe { C::call::<$width>(arguments) }
            }

            pub fn is_supported() -> bool {
                true $(&& is_x86_feature_detected!($feature))*
            }
        }
    };
}
version!(one, 1, []);
version!(four, 4, []);
#[cfg(target_arch = "x86_64")]
version!(eight, 8, ["avx2", "fma"]);
#[cfg(target_arch = "x86_64")]
version!(sixteen, 16, ["avx512f", "avx512vl", "avx512dq", "avx512bw", "fma"]);

impl PacketWidth {
    /// The widest packet that library and processor both have natively: a wider one is taken
    /// apart by Embree and traced at the speed of single rays.
    pub fn native(property: impl Fn(RTCDeviceProperty) -> isize) -> Self {
        let is_native = |width: &Self| {
            let supported = match width {
                PacketWidth::One => return true,
                PacketWidth::Four => RTCDeviceProperty::NATIVE_RAY4_SUPPORTED,
                #[cfg(target_arch = "x86_64")]
                PacketWidth::Eight => RTCDeviceProperty::NATIVE_RAY8_SUPPORTED,
                #[cfg(target_arch = "x86_64")]
                PacketWidth::Sixteen => RTCDeviceProperty::NATIVE_RAY16_SUPPORTED,
            };
            width.is_supported() && property(supported) != 0
        };
        let widest_first = [
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Sixteen,
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Eight,
            PacketWidth::Four,
        ];
        widest_first.into_iter().find(is_native).unwrap_or(PacketWidth::One)
    }

    /// True if the processor has the features that this width is compiled for.
    pub fn is_supported(self) -> bool {
        match self {
            PacketWidth::One => one::is_supported(),
            PacketWidth::Four => four::is_supported(),
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Eight => eight::is_supported(),
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Sixteen => sixteen::is_supported(),
        }
    }

    /// Runs the version of a kernel for this width, which the processor must support.
    pub fn run(self, kernel: impl Kernel) {
        match self {
            PacketWidth::One => one::run(kernel),
            PacketWidth::Four => four::run(kernel),
            // SAFETY: the processor has the features, since `DeviceHandle::new` asked it.
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Eight => unsafe { eight::run(kernel) },
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Sixteen => unsafe { sixteen::run(kernel) },
        }
    }

    /// Returns the version of a callback for this width.
    pub fn callback<C: Callback>(self) -> unsafe extern "C" fn(*const C::Arguments) {
        match self {
            PacketWidth::One => one::call::<C>,
            PacketWidth::Four => four::call::<C>,
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Eight => eight::call::<C>,
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Sixteen => sixteen::call::<C>,
        }
    }
}
