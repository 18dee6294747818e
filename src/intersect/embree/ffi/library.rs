//! The Embree library: opened when it is first needed, and the functions of it that are called.
//!
//! embree4-sys declares Embree's functions and leaves it to the linker to find them in a library named
//! `embree4`. The build script puts an empty one there, and the linker finds the functions of this file
//! instead, each of which passes its call on to the library that was opened. So a program is built, and
//! starts, without Embree. A function that is called and not listed here is an error of the linker.
#![allow(unsafe_code)]

use std::os::raw::{c_char, c_int, c_uint, c_void};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use embree4_sys::*;
use libloading::Library;

use crate::error::{Error, Result};
use crate::intersect::embree::library_search::{self, Candidates};

/// Opens the library, unless it is open. It stays open until the process ends.
///
/// # Errors
/// When it is found nowhere, cannot be opened, or lacks a function; the same in every call.
pub fn open() -> Result<()> {
    OPENED.get_or_init(find_and_open).as_ref().map(drop).map_err(Clone::clone)
}

/// Returns the path of the library that is open, or the bare name by which the system's loader found it.
#[cfg(feature = "cli")]
pub fn path() -> Option<&'static Path> {
    OPENED.get()?.as_ref().ok().map(|functions| &*functions.path)
}

/// The functions of the library that is open, or the reason why none is.
static OPENED: OnceLock<Result<Functions>> = OnceLock::new();

/// Opens the first of the candidates that can be opened.
fn find_and_open() -> Result<Functions> {
    let Candidates { paths, help } = library_search::candidates()?;
    let mut troubles = vec![];
    for path in &paths {
        match Functions::open(path) {
            Ok(functions) => return Ok(functions),
            // A bare name, which the loader looks for in the system's folders, is there or is not.
            Err(_) if path.parent() == Some(Path::new("")) => {}
            Err(error) => troubles.push(format!("{}: {error}", path.display())),
        }
    }
    let message = if troubles.is_empty() {
        "Embree 4 is not on this machine".to_owned()
    } else {
        format!("Embree 4 cannot be opened: {}", troubles.join("; "))
    };
    Err(Error::failed(message).help(help))
}

/// Returns the functions, which are there: devices are opened, and so everything else is called, only
/// after [`open`] succeeded.
#[inline(always)]
fn functions() -> &'static Functions {
    match OPENED.get() {
        Some(Ok(functions)) => functions,
        _ => unreachable!("Embree is called before it is open"),
    }
}

/// Defines the functions that are passed on, and the table of their addresses.
macro_rules! pass_on {
    ($(fn $name:ident($($argument:ident: $type:ty),*) $(-> $result:ty)?;)*) => {
        /// The addresses of the functions in the library that is open.
        #[allow(non_snake_case)]
        struct Functions {
            /// The library's path, or the bare name by which the system's loader found it.
            #[cfg_attr(not(feature = "cli"), expect(dead_code))]
            path: PathBuf,
            $($name: unsafe extern "C" fn($($type),*) $(-> $result)?,)*
        }

        impl Functions {
            /// Opens the library at `path` and looks the functions up.
            fn open(path: &Path) -> std::result::Result<Self, libloading::Error> {
                // SAFETY: what runs when a library is opened is the user's choice of library, as it is
                // when the system's loader opens it. The functions have the signatures of the header that
                // embree4-sys is made from, as the assertions below check, and the library is never closed.
                unsafe {
                    let library = std::mem::ManuallyDrop::new(Library::new(path)?);
                    Ok(Self { path: path.to_owned(), $($name: *library.get(stringify!($name).as_bytes())?,)* })
                }
            }
        }

        $(
            /// Passes the call on to the library.
            #[allow(non_snake_case)]
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $name($($argument: $type),*) $(-> $result)? {
                // SAFETY: the caller's duty.
                unsafe { (functions().$name)($($argument),*) }
            }

            // The signature is the header's: the declaration of embree4-sys has the same type.
            const _: unsafe extern "C" fn($($type),*) $(-> $result)? = embree4_sys::$name;
        )*
    };
}

pass_on! {
    fn rtcNewDevice(config: *const c_char) -> RTCDevice;
    fn rtcRetainDevice(device: RTCDevice);
    fn rtcReleaseDevice(device: RTCDevice);
    fn rtcGetDeviceProperty(device: RTCDevice, property: RTCDeviceProperty) -> isize;
    fn rtcGetDeviceError(device: RTCDevice) -> RTCError;
    fn rtcSetDeviceMemoryMonitorFunction(device: RTCDevice, monitor: RTCMemoryMonitorFunction, data: *mut c_void);
    fn rtcNewGeometry(device: RTCDevice, kind: RTCGeometryType) -> RTCGeometry;
    fn rtcReleaseGeometry(geometry: RTCGeometry);
    fn rtcCommitGeometry(geometry: RTCGeometry);
    fn rtcSetGeometryBuildQuality(geometry: RTCGeometry, quality: RTCBuildQuality);
    fn rtcSetSharedGeometryBuffer(geometry: RTCGeometry, kind: RTCBufferType, slot: c_uint, format: RTCFormat, data: *const c_void, offset: usize, stride: usize, count: usize);
    fn rtcSetNewGeometryBuffer(geometry: RTCGeometry, kind: RTCBufferType, slot: c_uint, format: RTCFormat, stride: usize, count: usize) -> *mut c_void;
    fn rtcSetGeometryUserData(geometry: RTCGeometry, data: *mut c_void);
    fn rtcSetGeometryPointQueryFunction(geometry: RTCGeometry, function: RTCPointQueryFunction);
    fn rtcSetGeometryUserPrimitiveCount(geometry: RTCGeometry, count: c_uint);
    fn rtcSetGeometryBoundsFunction(geometry: RTCGeometry, function: RTCBoundsFunction, data: *mut c_void);
    fn rtcSetGeometryIntersectFunction(geometry: RTCGeometry, function: RTCIntersectFunctionN);
    fn rtcSetGeometryOccludedFunction(geometry: RTCGeometry, function: RTCOccludedFunctionN);
    fn rtcSetGeometryInstancedScene(geometry: RTCGeometry, scene: RTCScene);
    fn rtcSetGeometryTransform(geometry: RTCGeometry, step: c_uint, format: RTCFormat, transform: *const c_void);
    fn rtcNewScene(device: RTCDevice) -> RTCScene;
    fn rtcReleaseScene(scene: RTCScene);
    fn rtcAttachGeometry(scene: RTCScene, geometry: RTCGeometry) -> c_uint;
    fn rtcGetGeometry(scene: RTCScene, id: c_uint) -> RTCGeometry;
    fn rtcCommitScene(scene: RTCScene);
    fn rtcSetSceneBuildQuality(scene: RTCScene, quality: RTCBuildQuality);
    fn rtcSetSceneFlags(scene: RTCScene, flags: RTCSceneFlags);
    fn rtcGetSceneBounds(scene: RTCScene, bounds: *mut RTCBounds);
    fn rtcIntersect1(scene: RTCScene, record: *mut RTCRayHit, arguments: *mut RTCIntersectArguments);
    fn rtcIntersect4(active: *const c_int, scene: RTCScene, record: *mut RTCRayHit4, arguments: *mut RTCIntersectArguments);
    fn rtcIntersect8(active: *const c_int, scene: RTCScene, record: *mut RTCRayHit8, arguments: *mut RTCIntersectArguments);
    fn rtcIntersect16(active: *const c_int, scene: RTCScene, record: *mut RTCRayHit16, arguments: *mut RTCIntersectArguments);
    fn rtcOccluded1(scene: RTCScene, ray: *mut RTCRay, arguments: *mut RTCOccludedArguments);
    fn rtcOccluded4(active: *const c_int, scene: RTCScene, ray: *mut RTCRay4, arguments: *mut RTCOccludedArguments);
    fn rtcOccluded8(active: *const c_int, scene: RTCScene, ray: *mut RTCRay8, arguments: *mut RTCOccludedArguments);
    fn rtcOccluded16(active: *const c_int, scene: RTCScene, ray: *mut RTCRay16, arguments: *mut RTCOccludedArguments);
    fn rtcForwardIntersect1(arguments: *const RTCIntersectFunctionNArguments, scene: RTCScene, ray: *mut RTCRay, instance: c_uint);
    fn rtcForwardIntersect4(active: *const c_int, arguments: *const RTCIntersectFunctionNArguments, scene: RTCScene, ray: *mut RTCRay4, instance: c_uint);
    fn rtcForwardIntersect8(active: *const c_int, arguments: *const RTCIntersectFunctionNArguments, scene: RTCScene, ray: *mut RTCRay8, instance: c_uint);
    fn rtcForwardIntersect16(active: *const c_int, arguments: *const RTCIntersectFunctionNArguments, scene: RTCScene, ray: *mut RTCRay16, instance: c_uint);
    fn rtcForwardOccluded1(arguments: *const RTCOccludedFunctionNArguments, scene: RTCScene, ray: *mut RTCRay, instance: c_uint);
    fn rtcForwardOccluded4(active: *const c_int, arguments: *const RTCOccludedFunctionNArguments, scene: RTCScene, ray: *mut RTCRay4, instance: c_uint);
    fn rtcForwardOccluded8(active: *const c_int, arguments: *const RTCOccludedFunctionNArguments, scene: RTCScene, ray: *mut RTCRay8, instance: c_uint);
    fn rtcForwardOccluded16(active: *const c_int, arguments: *const RTCOccludedFunctionNArguments, scene: RTCScene, ray: *mut RTCRay16, instance: c_uint);
}
