//! The callbacks of precision `certified`: every sphere and every triangle that Embree offers is
//! tested in f64 with an error bound, and exactly where that cannot tell.
//!
//! Of Embree's own ray they only lower `tfar`, with slack, so that what lies behind is skipped.
#![allow(unsafe_code)]

use embree4_sys as sys;
use glam::DVec3;

use crate::geometry::{Estimate, PrimitiveId, sphere, triangle};
use crate::intersect::embree::certified::triangles::Triangles;
use crate::intersect::embree::fast::spheres::SphereTable;
use crate::intersect::embree::ffi::packet_width::PacketWidth;
use crate::intersect::embree::ffi::records::{INVALID, QueryContext, RayHitRecord};
use crate::intersect::embree::ffi::user_geometry::{Callbacks, ID, TFAR, callbacks_for, in_order};
use crate::intersect::primitive::{SphereDeparture, sphere_departure, starts_on_triangle};

/// A primitive as the callbacks test it.
pub trait Shape {
    /// Primitive `index` of the geometry with this user data.
    ///
    /// # Safety
    /// `user` must be what the geometry was made with.
    unsafe fn of<const W: usize>(
        user: *const std::ffi::c_void,
        index: u32,
        context: &QueryContext<'_, W>,
    ) -> Self;

    fn id(&self) -> PrimitiveId;

    fn blocks_light(&self) -> bool;

    /// Whether a mask may cut holes into it, so that only the exact weights of a hit tell.
    fn is_masked(&self) -> bool;

    /// Whether a line may meet it: false only where it certainly passes.
    fn may_cross(&self, origin: DVec3, direction: DVec3, inverse_length_squared: f64) -> bool;

    /// What f64 says of the first t > 0, for a ray that left no surface.
    fn estimate(&self, origin: DVec3, direction: DVec3, inverse_length_squared: f64) -> Estimate;

    /// Whether a ray left this very primitive, and so does not meet it again.
    fn is_left<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool;

    /// Whether a ray that left a surface, and that this primitive is in the way of by its
    /// estimate, starts on it and so may not meet it.
    fn may_be_left<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool;
}

struct Ball {
    index: u32,
    center: DVec3,
    radius: f64,
    blocks_light: bool,
}

impl Shape for Ball {
    #[inline(always)]
    unsafe fn of<const W: usize>(
        user: *const std::ffi::c_void,
        index: u32,
        _: &QueryContext<'_, W>,
    ) -> Self {
        // SAFETY: the user data of the spheres' geometry is their table.
        let table = unsafe { &*user.cast::<SphereTable>() };
        let s = &table.spheres[index as usize];
        Ball { index, center: s.center, radius: s.radius, blocks_light: s.blocks_light }
    }

    #[inline(always)]
    fn id(&self) -> PrimitiveId {
        PrimitiveId::sphere(self.index)
    }

    #[inline(always)]
    fn blocks_light(&self) -> bool {
        self.blocks_light
    }

    #[inline(always)]
    fn is_masked(&self) -> bool {
        false
    }

    #[inline(always)]
    fn may_cross(&self, origin: DVec3, direction: DVec3, inverse: f64) -> bool {
        sphere::certified::QuadraticBound::new(self.center, self.radius, origin, direction, inverse)
            .may_cross()
    }

    #[inline(always)]
    fn estimate(&self, origin: DVec3, direction: DVec3, inverse: f64) -> Estimate {
        sphere::certified::estimate(self.center, self.radius, origin, direction, inverse)
    }

    #[inline(always)]
    fn is_left<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool {
        context.outward[lane] == self.index
    }

    #[inline(always)]
    fn may_be_left<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool {
        let f = context.exact.line(lane).0 - self.center;
        let power = f.length_squared() - self.radius * self.radius;
        context.may_start_on(lane, self.index, self.radius, power)
            && sphere_departure(context.scene, self.index, &context.rays.ray(lane))
                != SphereDeparture::No
    }
}

struct Face {
    id: PrimitiveId,
    corners: [DVec3; 3],
    blocks_light: bool,
    is_masked: bool,
}

impl Shape for Face {
    #[inline(always)]
    unsafe fn of<const W: usize>(
        user: *const std::ffi::c_void,
        index: u32,
        context: &QueryContext<'_, W>,
    ) -> Self {
        // SAFETY: the user data of a mesh's geometry is its table.
        let table = unsafe { &*user.cast::<Triangles>() };
        let instance = if table.instance == INVALID { context.instance } else { table.instance };
        let id = PrimitiveId::triangle(table.mesh, index, instance);
        let blocks_light = context.scene.blocks_light(id);
        let is_masked = context.is_masked(instance);
        Face { id, corners: context.scene.triangle_vertices(id), blocks_light, is_masked }
    }

    #[inline(always)]
    fn id(&self) -> PrimitiveId {
        self.id
    }

    #[inline(always)]
    fn blocks_light(&self) -> bool {
        self.blocks_light
    }

    #[inline(always)]
    fn is_masked(&self) -> bool {
        self.is_masked
    }

    #[inline(always)]
    fn may_cross(&self, origin: DVec3, direction: DVec3, _: f64) -> bool {
        triangle::certified::EdgeBounds::new(self.corners, origin, direction).may_cross()
    }

    #[inline(always)]
    fn estimate(&self, origin: DVec3, direction: DVec3, _: f64) -> Estimate {
        triangle::certified::estimate(self.corners, origin, direction)
    }

    #[inline(always)]
    fn is_left<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool {
        context.rays.from(lane).is_some_and(|from| from.id == self.id)
    }

    fn may_be_left<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool {
        starts_on_triangle(context.scene, self.corners, &context.rays.ray(lane))
    }
}

/// The callbacks of the spheres, for packets of `width`.
pub fn spheres(width: PacketWidth) -> Callbacks {
    callbacks_for!(width, Ball)
}

/// The callbacks of meshes.
pub fn triangles(width: PacketWidth) -> Callbacks {
    callbacks_for!(width, Face)
}

/// Keeps the nearest hit of each ray in the context.
///
/// # Safety
/// To be called by Embree, for a geometry of such shapes, in a query with a context of ours.
#[inline(always)]
unsafe fn intersect<S: Shape, const W: usize>(args: *const sys::RTCIntersectFunctionNArguments) {
    // SAFETY: the pointers are Embree's, for `N` rays; the context is ours, for `W` of them.
    unsafe {
        let args = &*args;
        let context = &mut *args.context.cast::<QueryContext<'_, W>>();
        let shape = S::of(args.geometryUserPtr, args.primID, context);
        let (n, valid) = (args.N as usize, args.valid.cast_const());
        if n == W {
            let record = &mut *args.rayhit.cast::<RayHitRecord<W>>();
            if in_order(&record.id) {
                context.offer(&shape, &*valid.cast::<[i32; W]>(), &mut record.tfar);
                return;
            }
        }
        let floats = args.rayhit.cast::<f32>();
        for slot in (0..n).filter(|&slot| *valid.add(slot) != 0) {
            let lane = *floats.add(ID * n + slot).cast::<u32>() as usize;
            context.settle(lane, shape.id());
            let tfar = floats.add(TFAR * n + slot);
            *tfar = context.exact.clip.narrow(lane, context.nearest.upper(lane)).min(*tfar);
        }
    }
}

/// Marks the rays that the primitive keeps from their end.
///
/// # Safety
/// As `intersect`.
#[inline(always)]
unsafe fn occluded<S: Shape, const W: usize>(args: *const sys::RTCOccludedFunctionNArguments) {
    // SAFETY: as in `intersect`; the ray part of the record is the same.
    unsafe {
        let args = &*args;
        let context = &mut *args.context.cast::<QueryContext<'_, W>>();
        let shape = S::of(args.geometryUserPtr, args.primID, context);
        if !shape.blocks_light() {
            return;
        }
        let (n, valid) = (args.N as usize, args.valid.cast_const());
        let floats = args.ray.cast::<f32>();
        if n == W && in_order(&*floats.add(ID * W).cast::<[u32; W]>()) {
            let tfar = &mut *floats.add(TFAR * W).cast::<[f32; W]>();
            context.block(&shape, &*valid.cast::<[i32; W]>(), tfar);
            return;
        }
        for slot in (0..n).filter(|&slot| *valid.add(slot) != 0) {
            let lane = *floats.add(ID * n + slot).cast::<u32>() as usize;
            if context.test(lane, shape.id()).is_some() {
                *floats.add(TFAR * n + slot) = f32::NEG_INFINITY;
            }
        }
    }
}
