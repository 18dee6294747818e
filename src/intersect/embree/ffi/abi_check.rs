//! The check that the library lays its records out as `records` says, and stays within them: one
//! packet of each width against one triangle, before anything else.
#![allow(unsafe_code)]

use embree4_rs::geometry::TriangleMeshGeometry;
use embree4_sys as sys;

use crate::error::{Error, Result};
use crate::intersect::embree::ffi::handles::{CommittedScene, DeviceHandle, embree_error};
use crate::intersect::embree::ffi::queries::call_for_width;
use crate::intersect::embree::ffi::records::{INVALID, LaneMask, RayHitRecord, SENTINEL};

/// Traces the packets on a device.
///
/// # Errors
/// When the library is not Embree 4, or its records are not as expected.
pub fn check(device: &DeviceHandle) -> Result<()> {
    let version = device.property(sys::RTCDeviceProperty::VERSION_MAJOR);
    if version != 4 {
        return Err(Error::failed(format!("this is Embree {version}; envers needs Embree 4")));
    }
    let corners = [(-1.0, -1.0, 5.0), (3.0, -1.0, 5.0), (-1.0, 3.0, 5.0)];
    let mesh = TriangleMeshGeometry::try_new(&device.to_device(), &corners, &[(0, 1, 2)])
        .map_err(embree_error)?;
    let (quality, flags) = (sys::RTCBuildQuality::MEDIUM, sys::RTCSceneFlags::NONE);
    let scene = CommittedScene::new(device, quality, flags, &mesh)?;
    let agrees = agrees::<1>(&scene) && agrees::<4>(&scene) && agrees::<8>(&scene);
    if agrees && self::agrees::<16>(&scene) {
        return Ok(());
    }
    Err(Error::failed("this Embree lays its ray records out in a way that envers does not know")
        .help("Embree 4.0 to 4.4 are known to work"))
}

/// True if a packet along +z comes back with the hit in the right fields and the spare room
/// untouched.
fn agrees<const W: usize>(scene: &CommittedScene) -> bool {
    let mut record = RayHitRecord::<W>::new();
    record.dir[2] = [1.0; W];
    record.tfar = [f32::INFINITY; W];
    let active = LaneMask([-1; W]);
    let (ray_hit, arguments) = (std::ptr::from_mut(&mut record), std::ptr::null_mut());
    // SAFETY: the scene is committed; record and mask are 64-aligned and larger than any version
    // of the library needs; null arguments mean the defaults.
    unsafe {
        call_for_width!(
            active,
            [rtcIntersect1, rtcIntersect4, rtcIntersect8, rtcIntersect16],
            (scene.handle(), ray_hit.cast(), arguments)
        );
    }
    let hit = |i: usize| {
        (record.tfar[i] - 5.0).abs() < 1e-5
            && (record.u[i] - 0.25).abs() < 1e-6
            && (record.v[i] - 0.25).abs() < 1e-6
            && [record.prim[i], record.geom[i], record.inst[i]] == [0, 0, INVALID]
            && record.inst_prim[i] == INVALID
    };
    (0..W).all(hit) && record.spare == [SENTINEL; 32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn library_and_records_agree() {
        super::check(&DeviceHandle::start(1).unwrap()).unwrap();
    }
}
