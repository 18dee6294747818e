//! User geometry: primitives that Embree knows by their boxes only, and asks our callbacks about.
#![allow(unsafe_code)]

use std::ffi::c_void;

use embree4_rs::geometry::{Geometry, UserGeometry, UserGeometryImpl};
use embree4_sys as sys;

use crate::error::{Error, Result};
use crate::geometry::Bounds;
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::handles::{DeviceHandle, scene_handle};

pub type Intersect = unsafe extern "C" fn(*const sys::RTCIntersectFunctionNArguments);
pub type Occluded = unsafe extern "C" fn(*const sys::RTCOccludedFunctionNArguments);

/// What Embree calls for a packet that comes into a primitive's box.
#[derive(Clone, Copy)]
pub struct Callbacks {
    pub intersect: Intersect,
    pub occluded: Occluded,
}

/// The user data of a geometry: what its callbacks read.
pub trait UserPrimitives {
    /// How many primitives there are.
    fn len(&self) -> usize;

    /// The box of primitive `index`, and the frame that it is placed in.
    fn bounds(&self, index: u32) -> (Bounds, &F32Space);
}

/// The positions of `tfar` and `id` among the ray's fields.
pub const TFAR: usize = 8;
pub const ID: usize = 10;

/// Whether the packet came as it was sent: ray `i` in lane `i`.
#[inline(always)]
pub fn in_order<const W: usize>(id: &[u32; W]) -> bool {
    let mut moved = 0;
    for (i, &id) in id.iter().enumerate() {
        moved |= id ^ i as u32;
    }
    moved == 0
}

/// Takes the place of a value in embree4-rs's own user geometry, whose callbacks are replaced.
struct Unused;

impl UserGeometryImpl for Unused {
    fn bounds(&self) -> sys::RTCBounds {
        sys::RTCBounds::default()
    }

    fn intersect(&self, _: u32, _: u32, _: &sys::RTCRayQueryContext, _: &mut sys::RTCRayHit) {}
}

/// The user geometry over `table`, which must outlive the scene that it is attached to; the
/// callbacks must read it as what it is.
pub fn geometry<T: UserPrimitives>(
    device: &DeviceHandle,
    quality: sys::RTCBuildQuality,
    table: &T,
    callbacks: Callbacks,
) -> Result<impl Geometry + use<T>> {
    let geometry = UserGeometry::try_new(&device.device(), &Unused)
        .map_err(|e| Error::failed(format!("Embree failed while making a geometry: {e}")))?;
    let count = u32::try_from(table.len())
        .map_err(|_| Error::input("more than 4,294,967,295 primitives of one kind"))?;
    let handle = geometry.handle;
    // SAFETY: the handle is live; by the caller's word the table stays where it is until the
    // scene is gone, and the callbacks read it as what it is.
    unsafe {
        // In a scene of low quality each geometry has a tree of its own, by its own quality.
        sys::rtcSetGeometryBuildQuality(handle, quality);
        sys::rtcSetGeometryUserPrimitiveCount(handle, count);
        sys::rtcSetGeometryUserData(handle, std::ptr::from_ref(table).cast_mut().cast());
        sys::rtcSetGeometryBoundsFunction(handle, Some(bounds::<T>), std::ptr::null_mut());
        sys::rtcSetGeometryIntersectFunction(handle, Some(callbacks.intersect));
        sys::rtcSetGeometryOccludedFunction(handle, Some(callbacks.occluded));
        sys::rtcCommitGeometry(handle);
    }
    device.check("making a geometry")?;
    Ok(geometry)
}

/// Tells Embree that primitives of a geometry moved, which the scene knows by `id`: they are as
/// many as before, and `table` is where it was. The scene is to be committed again then.
pub fn moved<T: UserPrimitives>(scene: &embree4_rs::Scene, id: u32, table: &T) {
    // SAFETY: the scene is live, and `id` one of its geometries; the rest is as in `geometry`. The
    // address is set again since the one that Embree had does not outlast a change of the table.
    unsafe {
        let handle = sys::rtcGetGeometry(scene_handle(scene), id);
        sys::rtcSetGeometryUserData(handle, std::ptr::from_ref(table).cast_mut().cast());
        sys::rtcCommitGeometry(handle);
    }
}

unsafe extern "C" fn bounds<T: UserPrimitives>(args: *const sys::RTCBoundsFunctionArguments) {
    // SAFETY: Embree passes the user data set in `geometry`, and a primitive below its count.
    unsafe {
        let args = &*args;
        let table: *const c_void = args.geometryUserPtr;
        let (bounds, frame) = (*table.cast::<T>()).bounds(args.primID);
        let (lower, upper) = frame.padded(&bounds);
        let to = &mut *args.bounds_o;
        [to.lower_x, to.lower_y, to.lower_z] = lower;
        [to.upper_x, to.upper_y, to.upper_z] = upper;
    }
}

/// The `Callbacks` for a width, made of the functions `intersect` and `occluded` of the place
/// where this is used: generic over the shape, if one is named, and the width.
macro_rules! callbacks_for {
    ($width:expr $(, $shape:ty)?) => {{
        use $crate::intersect::embree::ffi::{packet_width::PacketWidth, user_geometry::compiled};
        match $width {
            PacketWidth::One => compiled!(1, inline(never) $(, $shape)?),
            PacketWidth::Four => compiled!(4, inline(never) $(, $shape)?),
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Eight => compiled!(8, target_feature(enable = "avx2,fma") $(, $shape)?),
            #[cfg(target_arch = "x86_64")]
            PacketWidth::Sixteen => compiled!(
                16,
                target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,fma")
                $(, $shape)?
            ),
        }
    }};
}

/// The callbacks for one width, compiled for the processor features that it comes with.
macro_rules! compiled {
    ($w:literal, $attribute:meta $(, $shape:ty)?) => {{
        // SAFETY, for both: Embree calls them with what it was given in `geometry` and in `query`;
        // those with target features are only chosen by `Width::native`, which asks the processor.
        #[$attribute]
        unsafe extern "C" fn for_hits(
            args: *const embree4_sys::RTCIntersectFunctionNArguments,
        ) {
            unsafe { intersect::<$($shape,)? $w>(args) }
        }
        #[$attribute]
        unsafe extern "C" fn for_shadows(
            args: *const embree4_sys::RTCOccludedFunctionNArguments,
        ) {
            unsafe { occluded::<$($shape,)? $w>(args) }
        }
        $crate::intersect::embree::ffi::user_geometry::Callbacks { intersect: for_hits, occluded: for_shadows }
    }};
}
pub(in crate::intersect::embree) use {callbacks_for, compiled};
