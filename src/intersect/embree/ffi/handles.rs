//! Owners of the Embree objects that embree4-rs does not own, and the way to its own handles.
#![allow(unsafe_code)]

use embree4_rs::geometry::Geometry;
use embree4_sys as sys;

use crate::error::{Error, Result};

/// What Embree writes where there is no geometry or no instance.
pub const INVALID: u32 = u32::MAX;

/// The handle of a scene of embree4-rs, which keeps it private.
///
/// This goes when the crate offers its handles itself.
pub fn scene_handle(scene: &embree4_rs::Scene) -> sys::RTCScene {
    use std::mem::{offset_of, size_of};
    const WORD: usize = size_of::<usize>();
    const DEVICE: usize = offset_of!(embree4_rs::Scene, device);
    // The struct is the device (one word: its handle) and the scene's handle, in either order.
    const _: () = assert!(size_of::<embree4_rs::Scene>() == 2 * WORD);
    const _: () = assert!(size_of::<embree4_rs::Device>() == WORD);
    const _: () = assert!(DEVICE == 0 || DEVICE == WORD);
    let words = std::ptr::from_ref(scene).cast::<sys::RTCScene>();
    // SAFETY: by the assertions the struct is two words, both pointers, and the one that is not
    // the device is the scene's handle; the crate's version is pinned.
    unsafe { words.add(if DEVICE == 0 { 1 } else { 0 }).read() }
}

/// Commits a scene again, of which geometries were changed and committed since.
pub fn commit_again(scene: &embree4_rs::Scene) -> Result<()> {
    // SAFETY: the handle is live.
    unsafe { sys::rtcCommitScene(scene_handle(scene)) };
    DeviceHandle::of(scene).check("placing what moved")
}

/// A reference of our own to a scene's device.
pub struct DeviceHandle(pub sys::RTCDevice);

impl DeviceHandle {
    pub fn of(scene: &embree4_rs::Scene) -> Self {
        // SAFETY: the handle is a live scene's; the call adds a reference, which `drop` releases.
        Self(unsafe { sys::rtcGetSceneDevice(scene_handle(scene)) })
    }

    /// The same device, as embree4-rs owns one.
    pub fn device(&self) -> embree4_rs::Device {
        const _: () = assert!(size_of::<embree4_rs::Device>() == size_of::<sys::RTCDevice>());
        // SAFETY: the crate's struct is its handle and nothing else, by the assertion here and in
        // `scene_handle`; the crate's version is pinned. The reference that the first call adds is
        // the one that the struct releases when it is dropped.
        unsafe {
            sys::rtcRetainDevice(self.0);
            std::mem::transmute::<sys::RTCDevice, embree4_rs::Device>(self.0)
        }
    }

    /// A property such as the version or a supported packet width.
    pub fn property(&self, property: sys::RTCDeviceProperty) -> isize {
        // SAFETY: the device is live.
        unsafe { sys::rtcGetDeviceProperty(self.0, property) }
    }

    /// The first error since the last call, as one of ours.
    pub fn check(&self, doing: &str) -> Result<()> {
        // SAFETY: the device is live.
        match unsafe { sys::rtcGetDeviceError(self.0) } {
            sys::RTCError::NONE => Ok(()),
            sys::RTCError::OUT_OF_MEMORY => {
                Err(Error::failed(format!("Embree ran out of memory while {doing}")))
            }
            error => Err(Error::failed(format!("Embree failed while {doing}: {error:?}"))),
        }
    }
}

impl Drop for DeviceHandle {
    fn drop(&mut self) {
        // SAFETY: this is the reference that `of` took.
        unsafe { sys::rtcReleaseDevice(self.0) }
    }
}

// SAFETY: Embree lets any thread use and release a device, and trace and release a committed scene,
// which is what an `InnerScene` is from `new` on.
unsafe impl Send for DeviceHandle {}
unsafe impl Sync for DeviceHandle {}
unsafe impl Send for InnerScene {}
unsafe impl Sync for InnerScene {}
// SAFETY: Embree lets any thread attach and release a geometry.
unsafe impl Send for InstanceGeometry {}

/// Moves the instance that a scene knows by `id`; the scene is to be committed again then.
pub fn move_instance(scene: &embree4_rs::Scene, id: u32, columns: &[[f32; 3]; 4]) {
    // SAFETY: the scene is live, and `id` one of its instances, which copies the twelve floats.
    unsafe {
        let handle = sys::rtcGetGeometry(scene_handle(scene), id);
        let format = sys::RTCFormat::FLOAT3X4_COLUMN_MAJOR;
        sys::rtcSetGeometryTransform(handle, 0, format, columns.as_ptr().cast());
        sys::rtcCommitGeometry(handle);
    }
}

/// A scene to be instanced, on a device that already has one.
pub struct InnerScene(pub sys::RTCScene);

impl InnerScene {
    pub fn new(
        device: &DeviceHandle,
        quality: sys::RTCBuildQuality,
        flags: sys::RTCSceneFlags,
        geometry: &dyn Geometry,
    ) -> Result<Self> {
        // SAFETY: the device is live, and so is the geometry, which the scene then references.
        let scene = unsafe {
            let handle = sys::rtcNewScene(device.0);
            sys::rtcSetSceneBuildQuality(handle, quality);
            sys::rtcSetSceneFlags(handle, flags);
            sys::rtcAttachGeometry(handle, *geometry.handle());
            sys::rtcCommitScene(handle);
            Self(handle)
        };
        device.check("building an instanced mesh")?;
        Ok(scene)
    }
}

impl Drop for InnerScene {
    fn drop(&mut self) {
        // SAFETY: this is the reference that `rtcNewScene` gave.
        unsafe { sys::rtcReleaseScene(self.0) }
    }
}

/// An instance of a scene, to be attached to another one.
pub struct InstanceGeometry(sys::RTCGeometry);

impl InstanceGeometry {
    /// `columns`: the matrix from the inner scene's space to the outer's, column by column.
    pub fn new(device: &DeviceHandle, scene: &InnerScene, columns: &[[f32; 3]; 4]) -> Result<Self> {
        // SAFETY: device and scene are live; the instance takes a reference to the scene and
        // copies the twelve floats.
        let instance = unsafe {
            let handle = sys::rtcNewGeometry(device.0, sys::RTCGeometryType::INSTANCE);
            sys::rtcSetGeometryInstancedScene(handle, scene.0);
            let format = sys::RTCFormat::FLOAT3X4_COLUMN_MAJOR;
            sys::rtcSetGeometryTransform(handle, 0, format, columns.as_ptr().cast());
            sys::rtcCommitGeometry(handle);
            Self(handle)
        };
        device.check("placing an instance")?;
        Ok(instance)
    }
}

impl Geometry for InstanceGeometry {
    fn handle(&self) -> &sys::RTCGeometry {
        &self.0
    }
}

impl Drop for InstanceGeometry {
    fn drop(&mut self) {
        // SAFETY: this is the reference that `rtcNewGeometry` gave.
        unsafe { sys::rtcReleaseGeometry(self.0) }
    }
}
