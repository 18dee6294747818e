//! The spheres as one user geometry, and the callbacks that Embree calls for it.
//!
//! The callbacks compute in f64 from the exact rays that travel in the query context; of Embree's
//! own ray they only lower `tfar`, rounded up, so that what lies behind is skipped. The nearest
//! sphere stays in the context. They are arithmetic only: nothing in them allocates or unwinds.
#![allow(unsafe_code)]

use embree4_rs::geometry::{Geometry, UserGeometry, UserGeometryImpl};
use embree4_sys as sys;

use crate::error::{Error, Result};
use crate::geometry::sphere;
use crate::intersect::embree::frame::Frame;
use crate::intersect::embree::layout::{Context, RayHit};
use crate::intersect::embree::raw::DeviceHandle;
use crate::intersect::embree::width::Width;
use crate::intersect::primitive::{Leaving, leaving};
use crate::scene::Scene;
use glam::DVec3;

/// What the callbacks need of the spheres.
pub struct SphereTable {
    frame: Frame,
    spheres: Vec<Entry>,
}

#[derive(Clone, Copy)]
struct Entry {
    center: DVec3,
    radius: f64,
    casts_shadow: bool,
}

impl SphereTable {
    /// On the heap, since Embree keeps its address.
    pub fn new(scene: &Scene, frame: Frame) -> Box<Self> {
        let entry = |s: &crate::scene::Sphere| Entry {
            center: s.center,
            radius: s.radius,
            casts_shadow: s.casts_shadow,
        };
        Box::new(Self { frame, spheres: scene.spheres.iter().map(entry).collect() })
    }
}

/// Takes the place of a value in embree4-rs's own user geometry, whose callbacks are replaced.
struct Unused;

impl UserGeometryImpl for Unused {
    fn bounds(&self) -> sys::RTCBounds {
        sys::RTCBounds::default()
    }

    fn intersect(&self, _: u32, _: u32, _: &sys::RTCRayQueryContext, _: &mut sys::RTCRayHit) {}
}

/// The user geometry over `table`, which must outlive the scene that it is attached to.
pub fn geometry(
    device: &embree4_rs::Device,
    errors: &DeviceHandle,
    table: &SphereTable,
    width: Width,
) -> Result<impl Geometry + use<>> {
    let geometry = UserGeometry::try_new(device, &Unused)
        .map_err(|e| Error::failed(format!("Embree failed while making the spheres: {e}")))?;
    let count = u32::try_from(table.spheres.len())
        .map_err(|_| Error::input("more than 4,294,967,295 spheres"))?;
    let (intersect, occluded) = callbacks(width);
    let handle = geometry.handle;
    // SAFETY: the handle is live; the table stays where it is until the scene is gone; the
    // callbacks read it as what it is, and the contexts are those that `query` passes.
    unsafe {
        sys::rtcSetGeometryUserPrimitiveCount(handle, count);
        sys::rtcSetGeometryUserData(handle, std::ptr::from_ref(table).cast_mut().cast());
        sys::rtcSetGeometryBoundsFunction(handle, Some(bounds), std::ptr::null_mut());
        sys::rtcSetGeometryIntersectFunction(handle, Some(intersect));
        sys::rtcSetGeometryOccludedFunction(handle, Some(occluded));
        sys::rtcCommitGeometry(handle);
    }
    errors.check("making the spheres")?;
    Ok(geometry)
}

type Intersect = unsafe extern "C" fn(*const sys::RTCIntersectFunctionNArguments);
type Occluded = unsafe extern "C" fn(*const sys::RTCOccludedFunctionNArguments);

/// The callbacks for packets of `width`, compiled for a processor that has such packets.
fn callbacks(width: Width) -> (Intersect, Occluded) {
    match width {
        Width::One => (one::intersect, one::occluded),
        Width::Four => (four::intersect, four::occluded),
        #[cfg(target_arch = "x86_64")]
        Width::Eight => (eight::intersect, eight::occluded),
        #[cfg(target_arch = "x86_64")]
        Width::Sixteen => (sixteen::intersect, sixteen::occluded),
    }
}

/// The two callbacks for one width, with the processor features that it comes with.
macro_rules! callbacks_for {
    ($name:ident, $width:literal, $(#[$attribute:meta])*) => {
        mod $name {
            use super::*;

            // SAFETY, for both: Embree calls them with what it was given in `geometry` and in
            // `query`; those with target features are only chosen by `Width::native`, which asks
            // the processor.

            $(#[$attribute])*
            pub unsafe extern "C" fn intersect(args: *const sys::RTCIntersectFunctionNArguments) {
                unsafe { super::intersect::<$width>(&*args) }
            }

            $(#[$attribute])*
            pub unsafe extern "C" fn occluded(args: *const sys::RTCOccludedFunctionNArguments) {
                unsafe { super::occluded::<$width>(&*args) }
            }
        }
    };
}

callbacks_for!(one, 1,);
callbacks_for!(four, 4,);
#[cfg(target_arch = "x86_64")]
callbacks_for!(eight, 8, #[target_feature(enable = "avx2")]);
#[cfg(target_arch = "x86_64")]
callbacks_for!(sixteen, 16, #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw")]);

unsafe extern "C" fn bounds(args: *const sys::RTCBoundsFunctionArguments) {
    // SAFETY: Embree passes the user data set in `geometry` and a primitive below its count.
    unsafe {
        let args = &*args;
        let table = &*args.geometryUserPtr.cast::<SphereTable>();
        let s = table.spheres.get_unchecked(args.primID as usize);
        let bounds =
            crate::geometry::Bounds { lower: s.center - s.radius, upper: s.center + s.radius };
        let (lower, upper) = table.frame.padded(&bounds);
        (*args.bounds_o).lower_x = lower[0];
        (*args.bounds_o).lower_y = lower[1];
        (*args.bounds_o).lower_z = lower[2];
        (*args.bounds_o).upper_x = upper[0];
        (*args.bounds_o).upper_y = upper[1];
        (*args.bounds_o).upper_z = upper[2];
    }
}

/// Keeps the nearest sphere of each ray in the context.
#[inline(always)]
unsafe fn intersect<const W: usize>(args: &sys::RTCIntersectFunctionNArguments) {
    // SAFETY: the pointers are Embree's, for `N` rays; the context is ours, for `W` of them.
    unsafe {
        let table = &*args.geometryUserPtr.cast::<SphereTable>();
        let s = table.spheres.get_unchecked(args.primID as usize);
        let context = &mut *args.context.cast::<Context<'_, W>>();
        let valid = args.valid.cast_const();
        if args.N as usize == W {
            let record = &mut *args.rayhit.cast::<RayHit<W>>();
            let valid = &*valid.cast::<[i32; W]>();
            if in_order(&record.id) {
                let Some(ts) = crossings(context, s, valid, args.primID) else { return };
                for i in 0..W {
                    // A tie goes to the sphere with the lesser index.
                    let nearer = ts[i] < context.sphere_t[i]
                        || (ts[i] == context.sphere_t[i] && args.primID < context.sphere[i]);
                    let nearer = nearer && ts[i] < context.exact.tmax[i];
                    if nearer {
                        context.sphere_t[i] = ts[i];
                        context.sphere[i] = args.primID;
                    }
                    let end = context.exact.narrow(i, ts[i]);
                    if nearer && end < record.tfar[i] {
                        record.tfar[i] = end;
                    }
                }
                return;
            }
        }
        let n = args.N as usize;
        let floats = args.rayhit.cast::<f32>();
        for slot in 0..n {
            if *valid.add(slot) == 0 {
                continue;
            }
            let i = *floats.add(ID * n + slot).cast::<u32>() as usize;
            let t = crossing(context, s, args.primID, i);
            let nearer = t < context.sphere_t[i]
                || (t == context.sphere_t[i] && args.primID < context.sphere[i]);
            if nearer && t < context.exact.tmax[i] {
                context.sphere_t[i] = t;
                context.sphere[i] = args.primID;
                let tfar = floats.add(TFAR * n + slot);
                *tfar = context.exact.narrow(i, t).min(*tfar);
            }
        }
    }
}

/// Marks the rays that the sphere keeps from their end.
#[inline(always)]
unsafe fn occluded<const W: usize>(args: &sys::RTCOccludedFunctionNArguments) {
    // SAFETY: as in `intersect`; the ray part of the record is the same.
    unsafe {
        let table = &*args.geometryUserPtr.cast::<SphereTable>();
        let s = table.spheres.get_unchecked(args.primID as usize);
        if !s.casts_shadow {
            return;
        }
        let context = &mut *args.context.cast::<Context<'_, W>>();
        let valid = args.valid.cast_const();
        let n = args.N as usize;
        let floats = args.ray.cast::<f32>();
        if n == W {
            let id = &*floats.add(ID * W).cast::<[u32; W]>();
            let valid = &*valid.cast::<[i32; W]>();
            let tfar = &mut *floats.add(TFAR * W).cast::<[f32; W]>();
            if in_order(id) {
                let Some(ts) = crossings(context, s, valid, args.primID) else { return };
                for i in 0..W {
                    if ts[i] < context.exact.tmax[i] {
                        tfar[i] = f32::NEG_INFINITY;
                    }
                }
                return;
            }
        }
        for slot in 0..n {
            if *valid.add(slot) != 0 {
                let i = *floats.add(ID * n + slot).cast::<u32>() as usize;
                if crossing(context, s, args.primID, i) < context.exact.tmax[i] {
                    *floats.add(TFAR * n + slot) = f32::NEG_INFINITY;
                }
            }
        }
    }
}

/// The positions of `tfar` and `id` among the ray's fields.
const TFAR: usize = 8;
const ID: usize = 10;

/// Whether the packet came as it was sent: ray `i` in lane `i`.
#[inline(always)]
fn in_order<const W: usize>(id: &[u32; W]) -> bool {
    let mut moved = 0;
    for (i, &id) in id.iter().enumerate() {
        moved |= id ^ i as u32;
    }
    moved == 0
}

/// The first t > 0 at which each valid ray meets the sphere, or infinity; `None` when none does.
#[inline(always)]
fn crossings<const W: usize>(
    context: &Context<'_, W>,
    s: &Entry,
    valid: &[i32; W],
    primitive: u32,
) -> Option<[f64; W]> {
    let mut crosses = [false; W];
    let mut any = false;
    for i in 0..W {
        let line = line(context, s, i);
        crosses[i] = line.crosses() & (valid[i] != 0);
        any |= crosses[i];
    }
    if !any {
        return None;
    }
    let mut ts = [f64::INFINITY; W];
    for i in 0..W {
        let (near, far) = line(context, s, i).roots();
        let t = if near > 0.0 { near } else { far };
        ts[i] = if crosses[i] & (t > 0.0) { t } else { f64::INFINITY };
    }
    // Rays that were spawned and meet the sphere are few: one by one.
    if context.leaves {
        for i in 0..context.rays.len() {
            if ts[i] < f64::INFINITY && context.rays[i].from.is_some() {
                ts[i] = crossing(context, s, primitive, i);
            }
        }
    }
    Some(ts)
}

/// The first t > 0 at which ray `i` meets the sphere, or infinity.
#[inline(always)]
fn crossing<const W: usize>(context: &Context<'_, W>, s: &Entry, primitive: u32, i: usize) -> f64 {
    let line = line(context, s, i);
    if !line.crosses() {
        return f64::INFINITY;
    }
    let first = |inward| sphere::first_root(line.roots(), f64::INFINITY, inward);
    let left = |ray| leaving(context.scene, primitive, ray);
    let t = match (first(false), context.rays.get(i).map_or(Leaving::No, left)) {
        (None, _) | (_, Leaving::Outward) => None,
        (t, Leaving::No) => t,
        (_, Leaving::Inward) => first(true),
    };
    t.unwrap_or(f64::INFINITY)
}

#[inline(always)]
fn line<const W: usize>(context: &Context<'_, W>, s: &Entry, i: usize) -> sphere::Line {
    let (origin, direction) = context.exact.line(i);
    let inverse = context.exact.inverse_length_squared[i];
    sphere::Line::new(s.center, s.radius, origin, direction, inverse)
}
