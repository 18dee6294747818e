//! The callbacks that Embree calls while it traces: the one place where its pointers to the rays
//! and hits of a packet are followed.
//!
//! Nearly always Embree passes a whole packet, ray `i` in lane `i`, which is tested side by side. Else
//! (such as when few rays of a packet are left, and Embree goes on with one of them) it passes some
//! of the packet's rays, each of which tells by its id in which lane it was; these are tested one by
//! one. The tests themselves are safe code. They must not unwind: Embree is no Rust.
#![allow(unsafe_code)]

use std::ffi::c_void;
use std::marker::PhantomData;

use embree4_sys as sys;
use glam::Vec3;

use crate::intersect::embree::ffi::handles::InnerScene;
use crate::intersect::embree::ffi::packet_width::{Callback, PacketWidth};
use crate::intersect::embree::ffi::queries::call_for_width;
use crate::intersect::embree::ffi::records::{LaneMask, RayHitRecord};
use crate::intersect::embree::packet::context::QueryContext;

/// The positions of fields among those of a ray, of which each is as wide as the packet.
const DIR: usize = 4;
const TFAR: usize = 8;
const ID: usize = 10;
/// The positions of fields among those of a hit.
const NG: usize = 0;
const PRIM: usize = 5;
const GEOM: usize = 6;
const INST: usize = 7;

/// The tests of the primitives of a user geometry against rays. All of them are to be inlined
/// always, so that they are compiled for the features of the width.
pub trait PrimitiveTests {
    /// The user data of the geometry.
    type Table;

    /// Keeps primitive `index` for those rays of a packet that it is the closest hit of.
    fn intersect<const W: usize>(
        table: &Self::Table,
        index: u32,
        packet: &mut CallbackPacket<'_, W>,
    );

    /// As [`PrimitiveTests::intersect`], for the ray in one lane.
    fn intersect_lane<const W: usize>(
        table: &Self::Table,
        index: u32,
        context: &mut QueryContext<'_, W>,
        lane: usize,
    );

    /// Sets `tfar` of each ray that primitive `index` occludes to minus infinity.
    fn occluded<const W: usize>(
        table: &Self::Table,
        index: u32,
        packet: &mut CallbackPacket<'_, W>,
    );

    /// True if primitive `index` occludes the ray in one lane.
    fn occluded_lane<const W: usize>(
        table: &Self::Table,
        index: u32,
        context: &mut QueryContext<'_, W>,
        lane: usize,
    ) -> bool;
}

/// A packet as Embree passes it to a callback of a user geometry, ray `i` in lane `i`.
pub struct CallbackPacket<'c, const W: usize> {
    arguments: Arguments,
    context: *mut QueryContext<'c, W>,
    active: *const [i32; W],
    tfar: *mut [f32; W],
}

/// The arguments of the callback that a packet was passed to.
#[derive(Clone, Copy)]
enum Arguments {
    Intersect(*const sys::RTCIntersectFunctionNArguments),
    Occluded(*const sys::RTCOccludedFunctionNArguments),
}

impl<'c, const W: usize> CallbackPacket<'c, W> {
    /// The context of the query, the active mask, and the ends of the f32 rays.
    #[inline(always)]
    pub fn parts(&mut self) -> (&mut QueryContext<'c, W>, &[i32; W], &mut [f32; W]) {
        // SAFETY: the pointers are those of a live callback, to three different records, and the
        // borrow of `self` keeps them from being used by `forward` at the same time.
        unsafe { (&mut *self.context, &*self.active, &mut *self.tfar) }
    }

    /// Traces the BLAS of `instance` with the origins and directions in `record`, which lie in the
    /// object space of the instance.
    #[inline(always)]
    pub fn forward(
        &mut self,
        blas: &InnerScene,
        instance: u32,
        active: &LaneMask<W>,
        record: &mut RayHitRecord<W>,
    ) {
        let (blas, ray) = (blas.0, std::ptr::from_mut(record));
        // SAFETY: the scene is committed, and its callbacks are made for the width of its device,
        // which is this one; the arguments are those of the live callback; no reference to the
        // context or the rays is held while Embree traces. Of an occlusion query only the ray part of
        // the record is used.
        unsafe {
            match self.arguments {
                Arguments::Intersect(args) => call_for_width!(
                    active,
                    [
                        rtcForwardIntersect1,
                        rtcForwardIntersect4,
                        rtcForwardIntersect8,
                        rtcForwardIntersect16
                    ],
                    args,
                    blas,
                    ray.cast(),
                    instance
                ),
                Arguments::Occluded(args) => call_for_width!(
                    active,
                    [
                        rtcForwardOccluded1,
                        rtcForwardOccluded4,
                        rtcForwardOccluded8,
                        rtcForwardOccluded16
                    ],
                    args,
                    blas,
                    ray.cast(),
                    instance
                ),
            }
        }
    }
}

/// A call for some rays of a packet and one primitive, as both kinds of callback describe it.
struct Call {
    arguments: Arguments,
    context: *mut sys::RTCRayQueryContext,
    user_data: *mut c_void,
    index: u32,
    active: *const i32,
    /// The fields of the rays, each `count` wide.
    rays: *mut f32,
    count: usize,
}

impl Call {
    /// Tests the rays: side by side if they are those of a whole packet, each in its own lane, and
    /// else one by one.
    ///
    /// # Safety
    /// The pointers must be those of a callback of the geometry that these are the tests of, in a
    /// query of ours with packets of `W` rays.
    #[inline(always)]
    unsafe fn test<T: PrimitiveTests, const OCCLUDED: bool, const W: usize>(self) {
        let Self { arguments, index, active, rays, count, .. } = self;
        let context = self.context.cast::<QueryContext<'_, W>>();
        // SAFETY: each field is `count` wide; the ids are those that we gave, below `W`; the user data
        // is the table of the geometry.
        unsafe {
            let table = &*self.user_data.cast::<T::Table>();
            let (ids, tfar) = (rays.add(ID * count).cast::<u32>(), rays.add(TFAR * count));
            if count == W && is_in_lane_order(&*ids.cast::<[u32; W]>()) {
                let (active, tfar) = (active.cast(), tfar.cast());
                let packet = &mut CallbackPacket { arguments, context, active, tfar };
                if OCCLUDED {
                    T::occluded(table, index, packet);
                } else {
                    T::intersect(table, index, packet);
                }
                return;
            }
            for slot in 0..count {
                if *active.add(slot) == 0 {
                    continue;
                }
                let (context, tfar) = (&mut *context, &mut *tfar.add(slot));
                let lane = *ids.add(slot) as usize;
                if !OCCLUDED {
                    T::intersect_lane(table, index, context, lane);
                    *tfar = context.closest_tfar(lane).min(*tfar);
                } else if T::occluded_lane(table, index, context, lane) {
                    *tfar = f32::NEG_INFINITY;
                }
            }
        }
    }
}

/// True if the packet came as it was sent: ray `i` in lane `i`.
#[inline(always)]
fn is_in_lane_order<const W: usize>(id: &[u32; W]) -> bool {
    let mut moved = 0;
    for (i, &id) in id.iter().enumerate() {
        moved |= id ^ i as u32;
    }
    moved == 0
}

/// The callback of a user geometry for closest hits.
pub struct Intersect<T>(PhantomData<T>);

impl<T: PrimitiveTests> Callback for Intersect<T> {
    type Arguments = sys::RTCIntersectFunctionNArguments;

    #[inline(always)]
    unsafe fn call<const W: usize>(arguments: *const Self::Arguments) {
        // SAFETY: the caller's duty.
        unsafe {
            let args = &*arguments;
            let call = Call {
                arguments: Arguments::Intersect(arguments),
                context: args.context,
                user_data: args.geometryUserPtr,
                index: args.primID,
                active: args.valid,
                rays: args.rayhit.cast(),
                count: args.N as usize,
            };
            call.test::<T, false, W>();
        }
    }
}

/// The callback of a user geometry for occlusion.
pub struct Occluded<T>(PhantomData<T>);

impl<T: PrimitiveTests> Callback for Occluded<T> {
    type Arguments = sys::RTCOccludedFunctionNArguments;

    #[inline(always)]
    unsafe fn call<const W: usize>(arguments: *const Self::Arguments) {
        // SAFETY: the caller's duty.
        unsafe {
            let args = &*arguments;
            let call = Call {
                arguments: Arguments::Occluded(arguments),
                context: args.context,
                user_data: args.geometryUserPtr,
                index: args.primID,
                active: args.valid,
                rays: args.ray.cast(),
                count: args.N as usize,
            };
            call.test::<T, true, W>();
        }
    }
}

/// A function that Embree calls for each hit that it finds on a triangle of its own.
pub type FilterFunction = unsafe extern "C" fn(*const sys::RTCFilterFunctionNArguments);

/// The decision whether a hit that Embree found counts. Both functions are to be inlined always.
pub trait HitFilter {
    /// Clears the active mask of a packet where its candidates do not count.
    fn filter<const W: usize>(
        context: &QueryContext<'_, W>,
        candidates: &CandidatePacket<'_, W>,
        active: &mut [i32; W],
    );

    /// True if the candidate of the ray in one lane counts.
    fn accepts<const W: usize>(
        context: &QueryContext<'_, W>,
        lane: usize,
        candidate: &Candidate,
    ) -> bool;
}

/// A hit that Embree found in f32.
pub struct Candidate {
    pub t: f32,
    /// The direction of the f32 ray.
    pub direction: Vec3,
    /// The normal, of any length, in the object space of the triangle.
    pub normal: Vec3,
    pub primitive: u32,
    pub geometry: u32,
    /// The instance, or `INVALID` in world space.
    pub instance: u32,
}

/// The hits that Embree found for the rays of a packet.
pub struct CandidatePacket<'a, const W: usize> {
    t: &'a [f32; W],
    direction: [&'a [f32; W]; 3],
    normal: [&'a [f32; W]; 3],
    primitive: &'a [u32; W],
    geometry: &'a [u32; W],
    instance: &'a [u32; W],
}

impl<const W: usize> CandidatePacket<'_, W> {
    /// The candidate in lane `i`.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Candidate {
        Candidate {
            t: self.t[i],
            direction: Vec3::from_array(self.direction.map(|axis| axis[i])),
            normal: Vec3::from_array(self.normal.map(|axis| axis[i])),
            primitive: self.primitive[i],
            geometry: self.geometry[i],
            instance: self.instance[i],
        }
    }
}

/// The callback of a query for triangles.
struct Filter<F>(PhantomData<F>);

/// Returns the filter function for packets of a width.
pub fn filter_function<F: HitFilter>(width: PacketWidth) -> FilterFunction {
    width.callback::<Filter<F>>()
}

impl<F: HitFilter> Callback for Filter<F> {
    type Arguments = sys::RTCFilterFunctionNArguments;

    #[inline(always)]
    unsafe fn call<const W: usize>(arguments: *const Self::Arguments) {
        // SAFETY: Embree passes pointers to `N` rays and hits, field by field, and the context of
        // the query, which was made for packets of this width.
        unsafe {
            let args = &*arguments;
            let count = args.N as usize;
            let context = &*args.context.cast::<QueryContext<'_, W>>();
            let ray = |field: usize| args.ray.cast::<f32>().add(field * count);
            let hit = |field: usize| args.hit.cast::<f32>().add(field * count);
            if count == W && is_in_lane_order(&*ray(ID).cast::<[u32; W]>()) {
                let candidates = CandidatePacket {
                    t: &*ray(TFAR).cast(),
                    direction: [0, 1, 2].map(|axis| &*ray(DIR + axis).cast()),
                    normal: [0, 1, 2].map(|axis| &*hit(NG + axis).cast()),
                    primitive: &*hit(PRIM).cast(),
                    geometry: &*hit(GEOM).cast(),
                    instance: &*hit(INST).cast(),
                };
                F::filter(context, &candidates, &mut *args.valid.cast());
                return;
            }
            for slot in (0..count).filter(|&slot| *args.valid.add(slot) != 0) {
                let candidate = Candidate {
                    t: *ray(TFAR).add(slot),
                    direction: Vec3::from_array([0, 1, 2].map(|axis| *ray(DIR + axis).add(slot))),
                    normal: Vec3::from_array([0, 1, 2].map(|axis| *hit(NG + axis).add(slot))),
                    primitive: *hit(PRIM).add(slot).cast(),
                    geometry: *hit(GEOM).add(slot).cast(),
                    instance: *hit(INST).add(slot).cast(),
                };
                let lane = *ray(ID).add(slot).cast::<u32>() as usize;
                if !F::accepts(context, lane, &candidate) {
                    *args.valid.add(slot) = 0;
                }
            }
        }
    }
}
