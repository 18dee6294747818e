//! A mesh as Embree's own triangles: it reads the mesh's indices, and vertices are written straight
//! into its memory.
#![allow(unsafe_code)]

use std::mem::MaybeUninit;

use embree4_sys as sys;
use glam::DVec3;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::intersect::embree::ffi::handles::{DeviceHandle, OwnedGeometry};
use crate::scene::{GRAIN, Mesh};

/// Makes the geometry of `mesh`, which must outlive every scene that it is attached to, with each
/// vertex as `to_f32_space` returns it.
///
/// # Errors
/// When Embree runs out of memory.
pub fn new_mesh_geometry(
    device: &DeviceHandle,
    mesh: &Mesh,
    quality: sys::RTCBuildQuality,
    to_f32_space: impl Fn(DVec3) -> [f32; 3] + Sync,
) -> Result<OwnedGeometry> {
    let failed = |e: Error| {
        Error::failed(format!("Embree cannot take mesh `{}`: {}", mesh.name, e.message()))
    };
    let (vertices, indices) = (&mesh.positions, &mesh.triangles);
    const STRIDE: usize = size_of::<[f32; 3]>();
    let geometry = OwnedGeometry::new(device, sys::RTCGeometryType::TRIANGLE);
    device.check("making a geometry").map_err(failed)?;
    // Share the indices, and let Embree allocate the vertices.
    // SAFETY: the geometry is live. The index buffer is as long as said, aligned to four bytes,
    // and by the caller's word stays where it is until the scene is gone. Embree pads the
    // vertex buffer, which is its own.
    let buffer = unsafe {
        // In a scene of low quality each geometry has a tree of its own, by its own quality.
        sys::rtcSetGeometryBuildQuality(geometry.0, quality);
        sys::rtcSetSharedGeometryBuffer(
            geometry.0,
            sys::RTCBufferType::INDEX,
            0,
            sys::RTCFormat::UINT3,
            indices.as_ptr().cast(),
            0,
            size_of::<[u32; 3]>(),
            indices.len(),
        );
        sys::rtcSetNewGeometryBuffer(
            geometry.0,
            sys::RTCBufferType::VERTEX,
            0,
            sys::RTCFormat::FLOAT3,
            STRIDE,
            vertices.len(),
        )
    };
    device.check("making the buffers of a geometry").map_err(failed)?;
    // Write the vertices.
    let buffer = buffer.cast::<MaybeUninit<[f32; 3]>>();
    // SAFETY: Embree gave room for as many vertices, which nobody else reads or writes before
    // the geometry is committed; there was no error, so that the pointer is not null.
    let written = unsafe { std::slice::from_raw_parts_mut(buffer, vertices.len()) };
    written.par_iter_mut().enumerate().with_min_len(GRAIN).for_each(|(i, to)| {
        to.write(to_f32_space(vertices.at(i)));
    });
    // SAFETY: the geometry is live, and all its buffers are filled.
    unsafe { sys::rtcCommitGeometry(geometry.0) };
    device.check("making a geometry").map_err(failed)?;
    Ok(geometry)
}
