//! One packet of each width against one triangle, before anything else: does the library lay its
//! records out as `layout` says, and stay within them?
#![allow(unsafe_code)]

use std::fmt::Display;

use embree4_rs::geometry::TriangleMeshGeometry;
use embree4_rs::{Device, SceneOptions};
use embree4_sys as sys;

use crate::error::{Error, Result};
use crate::intersect::embree::ffi::handles::{DeviceHandle, scene_handle};
use crate::intersect::embree::ffi::records::{INVALID, LaneMask, RayHitRecord, SENTINEL};

/// Fires the packets.
///
/// # Errors
/// When the library does not start, is not Embree 4, or its records are not as expected.
pub fn check() -> Result<()> {
    let device = Device::try_new(Some("threads=1\0")).map_err(failed)?;
    let corners = [(-1.0, -1.0, 5.0), (3.0, -1.0, 5.0), (-1.0, 3.0, 5.0)];
    let mesh = TriangleMeshGeometry::try_new(&device, &corners, &[(0, 1, 2)]).map_err(failed)?;
    let scene = embree4_rs::Scene::try_new(device, SceneOptions::default()).map_err(failed)?;
    scene.attach_geometry(&mesh).map_err(failed)?;
    let scene = scene.commit().map_err(failed)?;
    let version = DeviceHandle::of(&scene.scene).property(sys::RTCDeviceProperty::VERSION_MAJOR);
    if version != 4 {
        return Err(Error::failed(format!("this is Embree {version}; envers needs Embree 4")));
    }
    let handle = scene_handle(&scene.scene);
    let agrees = packet::<1>(handle) && packet::<4>(handle) && packet::<8>(handle);
    if agrees && packet::<16>(handle) {
        return Ok(());
    }
    Err(Error::failed("this Embree lays its ray records out in a way that envers does not know")
        .help("Embree 4.0 to 4.4 are known to work; `--backend rust` works without it"))
}

/// The error of embree4-rs as one of ours.
pub fn failed(error: impl Display) -> Error {
    Error::failed(format!("Embree does not start: {error}"))
}

/// Whether a packet along +z comes back with the hit in the right fields and the spare room
/// untouched.
fn packet<const W: usize>(scene: sys::RTCScene) -> bool {
    let mut record = RayHitRecord::<W>::new();
    record.dir[2] = [1.0; W];
    record.tfar = [f32::INFINITY; W];
    let valid = LaneMask([-1; W]);
    let ptr = std::ptr::from_mut(&mut record);
    let none = std::ptr::null_mut();
    // SAFETY: the scene is committed; record and mask are 64-aligned and larger than any version
    // of the library needs; null arguments mean the defaults.
    unsafe {
        match W {
            1 => sys::rtcIntersect1(scene, ptr.cast(), none),
            4 => sys::rtcIntersect4(valid.0.as_ptr(), scene, ptr.cast(), none),
            8 => sys::rtcIntersect8(valid.0.as_ptr(), scene, ptr.cast(), none),
            _ => sys::rtcIntersect16(valid.0.as_ptr(), scene, ptr.cast(), none),
        }
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
    #[test]
    fn library_and_layout_agree() {
        super::check().unwrap();
    }
}
