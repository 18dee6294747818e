//! The owners of Embree's devices, scenes and instances, and access to the handles that embree4-rs
//! has as private fields.
#![allow(unsafe_code)]

use std::ffi::c_void;
use std::fmt::Display;
use std::sync::atomic::{AtomicIsize, Ordering};

use embree4_rs::geometry::Geometry;
use embree4_sys as sys;

use crate::error::{Error, Result};
use crate::intersect::embree::ffi::library;
use crate::intersect::embree::ffi::packet_width::PacketWidth;

/// The bytes that all devices of the process hold now.
static HELD_BYTES: AtomicIsize = AtomicIsize::new(0);
/// The most bytes that all devices of the process ever held together.
static PEAK_BYTES: AtomicIsize = AtomicIsize::new(0);

/// The most bytes that Embree held at any time in this process: trees, the vertices of meshes, and
/// what it needs while it builds.
#[cfg(feature = "cli")]
pub fn peak_memory() -> u64 {
    u64::try_from(PEAK_BYTES.load(Ordering::Relaxed)).unwrap_or(0)
}

/// The memory monitor, called from any thread, several at once, with the bytes that are allocated
/// (above 0) or freed.
unsafe extern "C" fn count_bytes(_: *mut c_void, bytes: isize, _: bool) -> bool {
    let held = HELD_BYTES.fetch_add(bytes, Ordering::Relaxed).wrapping_add(bytes);
    PEAK_BYTES.fetch_max(held, Ordering::Relaxed);
    true
}

/// Converts an error of embree4-rs into one of ours.
pub fn embree_error(error: impl Display) -> Error {
    Error::failed(format!("Embree does not start: {error}"))
}

/// A reference to a device, and the packet width of everything that is built on it.
pub struct DeviceHandle {
    handle: sys::RTCDevice,
    pub width: PacketWidth,
}

impl DeviceHandle {
    /// Starts a device of `threads` threads (0: all there are), for single rays.
    ///
    /// # Errors
    /// When the library cannot be opened, or does not start.
    pub fn start(threads: usize) -> Result<Self> {
        library::open()?;
        let config = format!("threads={threads}\0");
        let device = embree4_rs::Device::try_new(Some(&config)).map_err(embree_error)?;
        const _: () = assert!(size_of::<embree4_rs::Device>() == size_of::<sys::RTCDevice>());
        // SAFETY: the crate's struct is its handle and nothing else, by the assertion here and in
        // `scene_handle`; the crate's version is pinned. Its reference is the one that `drop` releases.
        let handle = unsafe { std::mem::transmute::<embree4_rs::Device, sys::RTCDevice>(device) };
        Ok(Self { handle, width: PacketWidth::One })
    }

    /// Returns another reference to the device, for packets of `width`, or else of the widest that are
    /// native.
    ///
    /// # Panics
    /// When the processor does not support the width.
    pub fn with_width(&self, width: Option<PacketWidth>) -> Self {
        let width = width.unwrap_or_else(|| PacketWidth::native(|p| self.property(p)));
        assert!(width.is_supported(), "packets of a width that the processor lacks");
        let mut device = self.clone();
        device.width = width;
        device
    }

    /// Returns another reference to the device, in the type of embree4-rs.
    pub fn to_device(&self) -> embree4_rs::Device {
        // SAFETY: as in `new`. The reference that `clone` adds is the one that the struct releases
        // when it is dropped.
        unsafe {
            let handle = std::mem::ManuallyDrop::new(self.clone()).handle;
            std::mem::transmute::<sys::RTCDevice, embree4_rs::Device>(handle)
        }
    }

    /// Starts to count the memory that the device allocates.
    pub fn monitor_memory(&self) {
        // SAFETY: the device is live, and the callback uses no pointer.
        unsafe {
            sys::rtcSetDeviceMemoryMonitorFunction(
                self.handle,
                Some(count_bytes),
                std::ptr::null_mut(),
            );
        }
    }

    /// The version of the library, such as `4.4.0`.
    pub fn version(&self) -> String {
        let [major, minor, patch] = [
            sys::RTCDeviceProperty::VERSION_MAJOR,
            sys::RTCDeviceProperty::VERSION_MINOR,
            sys::RTCDeviceProperty::VERSION_PATCH,
        ]
        .map(|property| self.property(property));
        format!("{major}.{minor}.{patch}")
    }

    /// A property such as the version or a supported packet width.
    pub fn property(&self, property: sys::RTCDeviceProperty) -> isize {
        // SAFETY: the device is live.
        unsafe { sys::rtcGetDeviceProperty(self.handle, property) }
    }

    /// Returns the first error on the device since the last check; `action` is what failed.
    pub fn check(&self, action: &str) -> Result<()> {
        // SAFETY: the device is live.
        match unsafe { sys::rtcGetDeviceError(self.handle) } {
            sys::RTCError::NONE => Ok(()),
            sys::RTCError::OUT_OF_MEMORY => {
                Err(Error::failed(format!("Embree ran out of memory while {action}")))
            }
            error => Err(Error::failed(format!("Embree failed while {action}: {error:?}"))),
        }
    }
}

impl Clone for DeviceHandle {
    fn clone(&self) -> Self {
        // SAFETY: the device is live; the call adds a reference, which `drop` releases.
        unsafe { sys::rtcRetainDevice(self.handle) };
        Self { ..*self }
    }
}

impl Drop for DeviceHandle {
    fn drop(&mut self) {
        // SAFETY: this is the reference that `new` or `clone` took.
        unsafe { sys::rtcReleaseDevice(self.handle) }
    }
}

// SAFETY: Embree lets any thread use and release a device, and trace and release a committed scene,
// which is changed through `&mut` only, when nobody traces it.
unsafe impl Send for DeviceHandle {}
unsafe impl Sync for DeviceHandle {}
unsafe impl Send for CommittedScene {}
unsafe impl Sync for CommittedScene {}
// SAFETY: Embree lets any thread attach and release a geometry.
unsafe impl Sync for OpenScene {}
unsafe impl Send for OwnedGeometry {}

/// A scene that geometries are attached to, before it is committed.
pub struct OpenScene(embree4_rs::Scene);

impl OpenScene {
    /// Begins a scene.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub fn new(
        device: &DeviceHandle,
        build_quality: sys::RTCBuildQuality,
        flags: sys::RTCSceneFlags,
    ) -> Result<Self> {
        let options = embree4_rs::SceneOptions { build_quality, flags };
        embree4_rs::Scene::try_new(device.to_device(), options).map(Self).map_err(embree_error)
    }

    /// Attaches a geometry, and returns its id.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub fn attach(&self, geometry: &dyn Geometry) -> Result<u32> {
        self.0.attach_geometry(geometry).map_err(embree_error)
    }

    /// Commits the scene, on the device that it was made with.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub fn commit(self, device: &DeviceHandle) -> Result<CommittedScene> {
        let build_error = |e| Error::failed(format!("Embree cannot build the scene: {e}"));
        Ok(CommittedScene { scene: self.0.commit().map_err(build_error)?, device: device.clone() })
    }
}

/// A committed scene: that of a BLAS or of a TLAS.
pub struct CommittedScene {
    scene: embree4_rs::CommittedScene,
    pub device: DeviceHandle,
}

impl CommittedScene {
    /// Builds a scene of one geometry.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub fn new(
        device: &DeviceHandle,
        quality: sys::RTCBuildQuality,
        flags: sys::RTCSceneFlags,
        geometry: &dyn Geometry,
    ) -> Result<Self> {
        let scene = OpenScene::new(device, quality, flags)?;
        scene.attach(geometry)?;
        scene.commit(device)
    }

    /// Commits the scene again, after geometries of it were changed and committed.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub fn recommit(&mut self) -> Result<()> {
        // SAFETY: the handle is live.
        unsafe { sys::rtcCommitScene(self.handle()) };
        self.device.check("placing what moved")
    }

    /// Sets the transform of the instance with this geometry id; [`CommittedScene::recommit`] must
    /// be called afterwards.
    pub fn set_instance_transform(&mut self, id: u32, columns: &[[f32; 3]; 4]) {
        // SAFETY: `id` is one of the scene's instances, as the caller says.
        unsafe { set_transform(self.geometry(id), columns) }
    }

    /// The handle of the geometry with this id.
    pub(super) fn geometry(&self, id: u32) -> sys::RTCGeometry {
        // SAFETY: the handle is live.
        unsafe { sys::rtcGetGeometry(self.handle(), id) }
    }

    /// The handle of the scene, a private field of embree4-rs.
    ///
    /// A version of the crate that gives access to its handles will replace this.
    #[inline(always)]
    pub(super) fn handle(&self) -> sys::RTCScene {
        use std::mem::{offset_of, size_of};
        const WORD: usize = size_of::<usize>();
        const DEVICE: usize = offset_of!(embree4_rs::Scene, device);
        // The struct is the device (one word: its handle) and the scene's handle, in either order.
        const _: () = assert!(size_of::<embree4_rs::Scene>() == 2 * WORD);
        const _: () = assert!(size_of::<embree4_rs::Device>() == WORD);
        const _: () = assert!(DEVICE == 0 || DEVICE == WORD);
        let words = std::ptr::from_ref(&self.scene.scene).cast::<sys::RTCScene>();
        // SAFETY: by the assertions the struct is two words, both pointers, and the one that is not
        // the device is the scene's handle; the crate's version is pinned.
        unsafe { words.add(if DEVICE == 0 { 1 } else { 0 }).read() }
    }
}

/// The owner of a geometry, which can be attached to scenes.
pub struct OwnedGeometry(pub(super) sys::RTCGeometry);

impl OwnedGeometry {
    pub(super) fn new(device: &DeviceHandle, kind: sys::RTCGeometryType) -> Self {
        // SAFETY: the device is live.
        Self(unsafe { sys::rtcNewGeometry(device.handle, kind) })
    }

    /// Makes an instance of a scene, with the columns of the matrix from its space to that of the
    /// outer scene.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub fn instance(
        device: &DeviceHandle,
        scene: &CommittedScene,
        columns: &[[f32; 3]; 4],
    ) -> Result<Self> {
        let instance = Self::new(device, sys::RTCGeometryType::INSTANCE);
        // SAFETY: both are live; the instance takes a reference to the scene.
        unsafe {
            sys::rtcSetGeometryInstancedScene(instance.0, scene.handle());
            set_transform(instance.0, columns);
        }
        device.check("placing an instance")?;
        Ok(instance)
    }
}

/// Sets the transform of an instance.
///
/// # Safety
/// The handle must be a live instance's, which copies the twelve floats.
unsafe fn set_transform(instance: sys::RTCGeometry, columns: &[[f32; 3]; 4]) {
    let format = sys::RTCFormat::FLOAT3X4_COLUMN_MAJOR;
    // SAFETY: the caller's duty.
    unsafe {
        sys::rtcSetGeometryTransform(instance, 0, format, columns.as_ptr().cast());
        sys::rtcCommitGeometry(instance);
    }
}

impl Geometry for OwnedGeometry {
    fn handle(&self) -> &sys::RTCGeometry {
        &self.0
    }
}

impl Drop for OwnedGeometry {
    fn drop(&mut self) {
        // SAFETY: this is the reference that `rtcNewGeometry` gave.
        unsafe { sys::rtcReleaseGeometry(self.0) }
    }
}
