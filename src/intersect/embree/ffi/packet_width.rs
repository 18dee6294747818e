//! The packet widths, and the functions that are compiled once for each of them.
//!
//! The table at the end of this file lists the widths, each with the processor features that it
//! needs: the compiler and the detection at run time read the same list.
#![allow(unsafe_code)]

use embree4_sys::RTCDeviceProperty;

/// A loop over packets, compiled once for each width.
pub trait Kernel {
    /// Runs the loop with packets of `W` rays; to be inlined always.
    fn run<const W: usize>(self);
}

/// A function that Embree calls while it traces, compiled once for each width.
pub trait Callback {
    /// The record of arguments that Embree passes.
    type Arguments;

    /// Answers a call in a query with packets of `W` rays; to be inlined always.
    ///
    /// # Safety
    /// To be called by Embree, with arguments of a query of ours with packets of this width.
    unsafe fn call<const W: usize>(arguments: *const Self::Arguments);
}

/// Defines the packet widths, with the device property and the processor features that each needs.
macro_rules! packet_widths {
    ($(
        $(#[$cfg:meta])?
        $variant:ident = $width:literal, $module:ident, $property:expr, [$($feature:tt),*];
    )*) => {
        /// The number of rays that Embree traces together.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum PacketWidth {
            $($(#[$cfg])? $variant = $width,)*
        }

        $(
            $(#[$cfg])?
            mod $module {
                use super::{Callback, Kernel};

                $(#[target_feature(enable = $feature)])*
                pub unsafe fn run(kernel: impl Kernel) {
                    kernel.run::<$width>();
                }

                $(#[target_feature(enable = $feature)])*
                pub unsafe extern "C" fn call<C: Callback>(arguments: *const C::Arguments) {
                    // SAFETY: the caller's duty.
                    unsafe { C::call::<$width>(arguments) }
                }
            }
        )*

        impl PacketWidth {
            /// The widest packet that library and processor both support natively: Embree splits a
            /// wider one, and traces it at the speed of single rays.
            pub fn native(property: impl Fn(RTCDeviceProperty) -> isize) -> Self {
                let is_native = |width: Self, supported: Option<RTCDeviceProperty>| {
                    width.is_supported() && supported.is_none_or(|p| property(p) != 0)
                };
                let mut widest = PacketWidth::One;
                $(
                    $(#[$cfg])?
                    if is_native(PacketWidth::$variant, $property) {
                        widest = PacketWidth::$variant;
                    }
                )*
                widest
            }

            /// True if the processor has the features that this width is compiled for.
            pub fn is_supported(self) -> bool {
                match self {
                    $($(#[$cfg])?
                    PacketWidth::$variant => true $(&& is_x86_feature_detected!($feature))*,)*
                }
            }

            /// Runs the version of a kernel for this width, which the processor must support.
            pub fn run(self, kernel: impl Kernel) {
                match self {
                    // SAFETY: the processor has the features, since `DeviceHandle::new` asked it.
                    $($(#[$cfg])? PacketWidth::$variant => unsafe { $module::run(kernel) },)*
                }
            }

            /// Returns the version of a callback for this width.
            pub fn callback<C: Callback>(self) -> unsafe extern "C" fn(*const C::Arguments) {
                match self {
                    $($(#[$cfg])? PacketWidth::$variant => $module::call::<C>,)*
                }
            }
        }
    };
}

packet_widths! {
    One = 1, one, None, [];
    Four = 4, four, Some(RTCDeviceProperty::NATIVE_RAY4_SUPPORTED), [];
    #[cfg(target_arch = "x86_64")]
    Eight = 8, eight, Some(RTCDeviceProperty::NATIVE_RAY8_SUPPORTED), ["avx2", "fma"];
    #[cfg(target_arch = "x86_64")]
    Sixteen = 16, sixteen, Some(RTCDeviceProperty::NATIVE_RAY16_SUPPORTED),
        ["avx512f", "avx512vl", "avx512dq", "avx512bw", "fma"];
}
