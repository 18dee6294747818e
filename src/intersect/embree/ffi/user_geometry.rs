//! User geometry: primitives that Embree knows by their boxes only, and asks our callbacks about.
#![allow(unsafe_code)]

use embree4_sys as sys;

use crate::error::{Error, Result};
use crate::geometry::Bounds;
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::callbacks::{Intersect, Occluded, UserPrimitives};
use crate::intersect::embree::ffi::handles::{CommittedScene, DeviceHandle, OwnedGeometry};

/// The user data of a geometry, which its callbacks read.
pub trait PrimitiveTable {
    /// The number of primitives.
    fn len(&self) -> usize;

    /// The box of primitive `index`, and the f32 space that it lies in.
    fn bounds(&self, index: u32) -> (Bounds, &F32Space);
}

/// Makes the user geometry over `table`, which must outlive the scene that it is attached to.
///
/// # Errors
/// When Embree runs out of memory, or there are too many primitives.
pub fn new_geometry<P>(
    device: &DeviceHandle,
    quality: sys::RTCBuildQuality,
    table: &P::Table,
) -> Result<OwnedGeometry>
where
    P: UserPrimitives<Table: PrimitiveTable>,
{
    let count = u32::try_from(table.len())
        .map_err(|_| Error::input("more than 4,294,967,295 primitives of one kind"))?;
    let geometry = OwnedGeometry::new(device, sys::RTCGeometryType::USER);
    device.check("making a geometry")?;
    let (handle, width) = (geometry.0, device.width);
    // SAFETY: the handle is live; by the caller's word the table stays where it is until the
    // scene is gone, and the callbacks read it as what it is.
    unsafe {
        // In a scene of low quality each geometry has a tree of its own, by its own quality.
        sys::rtcSetGeometryBuildQuality(handle, quality);
        sys::rtcSetGeometryUserPrimitiveCount(handle, count);
        sys::rtcSetGeometryUserData(handle, std::ptr::from_ref(table).cast_mut().cast());
        sys::rtcSetGeometryBoundsFunction(handle, Some(bounds::<P::Table>), std::ptr::null_mut());
        sys::rtcSetGeometryIntersectFunction(handle, Some(width.callback::<Intersect<P>>()));
        sys::rtcSetGeometryOccludedFunction(handle, Some(width.callback::<Occluded<P>>()));
        sys::rtcCommitGeometry(handle);
    }
    device.check("making a geometry")?;
    Ok(geometry)
}

/// Tells Embree that primitives moved of the geometry with this id: they are as many as before, and
/// `table` is where it was. [`CommittedScene::recommit`] must be called afterwards.
pub fn update_geometry(scene: &mut CommittedScene, id: u32, table: &impl PrimitiveTable) {
    let handle = scene.geometry(id);
    // SAFETY: `id` is one of the scene's geometries; the rest is as in `new_geometry`. The address is
    // set again since the one that Embree had does not outlast a change of the table.
    unsafe {
        sys::rtcSetGeometryUserData(handle, std::ptr::from_ref(table).cast_mut().cast());
        sys::rtcCommitGeometry(handle);
    }
}

/// The callback for the box of a primitive, in f32.
unsafe extern "C" fn bounds<T: PrimitiveTable>(args: *const sys::RTCBoundsFunctionArguments) {
    // SAFETY: Embree passes the user data set in `new_geometry`, and a primitive below its count.
    unsafe {
        let args = &*args;
        let (bounds, space) = (*args.geometryUserPtr.cast::<T>()).bounds(args.primID);
        let (lower, upper) = space.padded(&bounds);
        let to = &mut *args.bounds_o;
        [to.lower_x, to.lower_y, to.lower_z] = lower;
        [to.upper_x, to.upper_y, to.upper_z] = upper;
    }
}
