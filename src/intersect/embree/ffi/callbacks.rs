//! The callbacks that Embree calls while it traces: the only file that dereferences its pointers to
//! the rays and hits of a packet.
//!
//! Nearly always Embree passes a whole packet, ray `i` in lane `i`, which is tested side by side. Else
//! (such as when few rays of a packet are left, and Embree goes on with one of them) it passes some
//! of the packet's rays, each of which tells by its id in which lane it was; these are tested one by
//! one. The tests themselves are safe code. They must not unwind: Embree is no Rust.
#![allow(unsafe_code)]

use std::marker::PhantomData;
use std::mem::offset_of;

use embree4_sys as sys;
use glam::Vec3;

use crate::intersect::embree::fast::filter;
use crate::intersect::embree::ffi::handles::CommittedScene;
use crate::intersect::embree::ffi::packet_width::Callback;
use crate::intersect::embree::ffi::queries::call_for_width;
use crate::intersect::embree::ffi::records::{Candidate, LaneMask, RayHitRecord};
use crate::intersect::embree::packet::QueryContext;

/// The positions of fields among those of a ray, of which each is as wide as the packet.
const DIR: usize = 4;
const TFAR: usize = 8;
const ID: usize = 10;
/// The positions of fields among those of a hit.
const NG: usize = 0;
const PRIM: usize = 5;
const GEOM: usize = 6;
const INST: usize = 7;

/// The primitives of a user geometry.
pub trait UserPrimitives {
    /// The user data of the geometry.
    type Table;
    /// A primitive, as it is tested.
    type Primitive<'t>: UserPrimitive;

    /// Looks up primitive `index`; to be inlined always.
    fn get<'t, const W: usize>(
        table: &'t Self::Table,
        index: u32,
        context: &QueryContext<'_, W>,
    ) -> Self::Primitive<'t>;
}

/// The tests of a primitive against rays. All of them are to be inlined always, so that they are
/// compiled for the features of the width.
pub trait UserPrimitive {
    /// Records the primitive as the hit of those rays of a packet that it is the closest hit of.
    fn intersect<const W: usize>(&self, packet: &mut CallbackPacket<'_, W>);

    /// Records the primitive as the hit of the ray in one lane if it is its closest hit.
    fn intersect_lane<const W: usize>(&self, context: &mut QueryContext<'_, W>, lane: usize);

    /// Sets `tfar` of each ray that the primitive occludes to minus infinity.
    fn occluded<const W: usize>(&self, packet: &mut CallbackPacket<'_, W>);

    /// True if the primitive occludes the ray in one lane.
    fn occluded_lane<const W: usize>(&self, context: &QueryContext<'_, W>, lane: usize) -> bool;
}

/// A packet as Embree passes it to a callback of a user geometry, ray `i` in lane `i`.
pub struct CallbackPacket<'c, const W: usize> {
    /// The arguments of the callback; those for occlusion are laid out alike.
    arguments: *const sys::RTCIntersectFunctionNArguments,
    is_occlusion: bool,
    context: *mut QueryContext<'c, W>,
    active: *const [i32; W],
    tfar: *mut [f32; W],
}

const _: () = {
    use sys::RTCIntersectFunctionNArguments as Intersect;
    use sys::RTCOccludedFunctionNArguments as Occluded;
    assert!(offset_of!(Intersect, valid) == offset_of!(Occluded, valid));
    assert!(offset_of!(Intersect, geometryUserPtr) == offset_of!(Occluded, geometryUserPtr));
    assert!(offset_of!(Intersect, primID) == offset_of!(Occluded, primID));
    assert!(offset_of!(Intersect, context) == offset_of!(Occluded, context));
    assert!(offset_of!(Intersect, rayhit) == offset_of!(Occluded, ray));
    assert!(offset_of!(Intersect, N) == offset_of!(Occluded, N));
};

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
        blas: &CommittedScene,
        instance: u32,
        active: &LaneMask<W>,
        record: &mut RayHitRecord<W>,
    ) {
        let (args, blas, ray) = (self.arguments, blas.handle(), std::ptr::from_mut(record));
        // SAFETY: the scene is committed, and its callbacks are made for the width of its device,
        // which is this one; the arguments are those of the live callback; no reference to the
        // context or the rays is held while Embree traces. Of an occlusion query only the ray part of
        // the record is used.
        unsafe {
            if self.is_occlusion {
                call_for_width!(
                    active,
                    [
                        rtcForwardOccluded1,
                        rtcForwardOccluded4,
                        rtcForwardOccluded8,
                        rtcForwardOccluded16
                    ],
                    (args.cast(), blas, ray.cast(), instance)
                );
            } else {
                call_for_width!(
                    active,
                    [
                        rtcForwardIntersect1,
                        rtcForwardIntersect4,
                        rtcForwardIntersect8,
                        rtcForwardIntersect16
                    ],
                    (args, blas, ray.cast(), instance)
                );
            }
        }
    }
}

/// Tests the rays of a callback: side by side if they are those of a whole packet, each in its own
/// lane, and else one by one.
///
/// # Safety
/// The arguments must be those of a callback of a geometry of such primitives, in a query of ours with
/// packets of `W` rays.
#[inline(always)]
unsafe fn test<P: UserPrimitives, const OCCLUSION: bool, const W: usize>(
    arguments: *const sys::RTCIntersectFunctionNArguments,
) {
    // SAFETY: the user data is the table of the geometry; each field of the rays is `count` wide; the
    // ids are those that we gave, below `W`.
    unsafe {
        let args = &*arguments;
        let (count, rays, active) = (args.N as usize, args.rayhit.cast::<f32>(), args.valid);
        let (ids, tfar) = (rays.add(ID * count).cast::<u32>(), rays.add(TFAR * count));
        let context = args.context.cast::<QueryContext<'_, W>>();
        let table = &*args.geometryUserPtr.cast::<P::Table>();
        let primitive = P::get(table, args.primID, &*context);
        if count == W && is_in_lane_order(&*ids.cast::<[u32; W]>()) {
            let packet = &mut CallbackPacket {
                arguments,
                is_occlusion: OCCLUSION,
                context,
                active: active.cast(),
                tfar: tfar.cast(),
            };
            if OCCLUSION {
                primitive.occluded(packet);
            } else {
                primitive.intersect(packet);
            }
            return;
        }
        for slot in 0..count {
            if *active.add(slot) == 0 {
                continue;
            }
            let (context, lane) = (&mut *context, *ids.add(slot) as usize);
            let tfar = &mut *tfar.add(slot);
            if !OCCLUSION {
                primitive.intersect_lane(context, lane);
                *tfar = context.closest_tfar(lane).min(*tfar);
            } else if primitive.occluded_lane(context, lane) {
                *tfar = f32::NEG_INFINITY;
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
pub struct Intersect<P>(PhantomData<P>);

impl<P: UserPrimitives> Callback for Intersect<P> {
    type Arguments = sys::RTCIntersectFunctionNArguments;

    #[inline(always)]
    unsafe fn call<const W: usize>(arguments: *const Self::Arguments) {
        // SAFETY: the caller's duty.
        unsafe { test::<P, false, W>(arguments) }
    }
}

/// The callback of a user geometry for occlusion.
pub struct Occluded<P>(PhantomData<P>);

impl<P: UserPrimitives> Callback for Occluded<P> {
    type Arguments = sys::RTCOccludedFunctionNArguments;

    #[inline(always)]
    unsafe fn call<const W: usize>(arguments: *const Self::Arguments) {
        // SAFETY: the caller's duty; the arguments are laid out alike.
        unsafe { test::<P, true, W>(arguments.cast()) }
    }
}

/// The callback of closest-hit or occlusion queries for each triangle that Embree finds: it clears the
/// active mask where the hit does not count.
pub struct Filter<const OCCLUSION: bool>;

impl<const OCCLUSION: bool> Callback for Filter<OCCLUSION> {
    type Arguments = sys::RTCFilterFunctionNArguments;

    #[inline(always)]
    unsafe fn call<const W: usize>(arguments: *const Self::Arguments) {
        // SAFETY: Embree passes pointers to `N` rays and hits, field by field, and the context of
        // the query, which was made for packets of this width; the ids are those that we gave.
        unsafe {
            let args = &*arguments;
            let (count, active) = (args.N as usize, args.valid);
            let context = &*args.context.cast::<QueryContext<'_, W>>();
            let (ray, hit) = (args.ray.cast::<f32>(), args.hit.cast::<f32>());
            let ids = ray.add(ID * count).cast::<u32>();
            if count == W && is_in_lane_order(&*ids.cast::<[u32; W]>()) {
                let active = &mut *active.cast::<[i32; W]>();
                filter::filter_packet::<OCCLUSION, W>(context, active, |i| {
                    candidate(ray, hit, W, i)
                });
                return;
            }
            for slot in 0..count {
                if *active.add(slot) == 0 {
                    continue;
                }
                let (lane, candidate) = (*ids.add(slot) as usize, candidate(ray, hit, count, slot));
                let certain = filter::is_certain(context, lane, &candidate);
                if !filter::counts::<OCCLUSION, W>(context, lane, certain, &candidate) {
                    *active.add(slot) = 0;
                }
            }
        }
    }
}

/// Reads a candidate hit.
///
/// # Safety
/// The pointers must be to the fields of a ray and of a hit, each `count` wide, and `slot` below that.
#[inline(always)]
unsafe fn candidate(ray: *const f32, hit: *const f32, count: usize, slot: usize) -> Candidate {
    // SAFETY: the caller's duty.
    unsafe {
        let number = |record: *const f32, field: usize| *record.add(field * count + slot);
        let vector = |record, field| Vec3::from([0, 1, 2].map(|axis| number(record, field + axis)));
        Candidate {
            t: number(ray, TFAR),
            direction: vector(ray, DIR),
            normal: vector(hit, NG),
            primitive: number(hit, PRIM).to_bits(),
            geometry: number(hit, GEOM).to_bits(),
            instance: number(hit, INST).to_bits(),
        }
    }
}
