//! The spheres as one user geometry, and the callbacks of precision `fast` for it.
//!
//! The callbacks compute in f64 from the exact rays that travel in the query context; of Embree's
//! own ray they only lower `tfar`, rounded up, so that what lies behind is skipped. The nearest
//! sphere stays in the context. They are arithmetic only: nothing in them allocates or unwinds.
#![allow(unsafe_code)]

use embree4_sys as sys;

use crate::geometry::{Bounds, PrimitiveId, Ray, sphere};
use crate::intersect::Precision;
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::packet_width::PacketWidth;
use crate::intersect::embree::ffi::records::{QueryContext, RayHitRecord};
use crate::intersect::embree::ffi::user_geometry::{
    Callbacks, ID, TFAR, UserPrimitives, callbacks_for, in_order,
};
use crate::intersect::primitive::{Primitives, SphereDeparture, sphere_departure};
use crate::scene::Scene;
use glam::DVec3;

/// What the callbacks need of the spheres.
pub struct SphereTable {
    frame: F32Space,
    pub spheres: Vec<Entry>,
}

/// A sphere without what only shading needs.
#[derive(Clone, Copy)]
pub struct Entry {
    pub center: DVec3,
    pub radius: f64,
    pub blocks_light: bool,
}

impl SphereTable {
    /// On the heap, since Embree keeps its address.
    pub fn new(scene: &Scene, frame: F32Space) -> Box<Self> {
        let mut table = Box::new(Self { frame, spheres: Vec::new() });
        table.refresh(scene);
        table
    }

    /// Takes over the spheres of a scene. Where they moved, or are more or fewer, Embree must be
    /// told.
    pub fn refresh(&mut self, scene: &Scene) {
        let entry = |(i, s): (u32, &crate::scene::Sphere)| Entry {
            center: s.center,
            radius: s.radius,
            blocks_light: scene.blocks_light(PrimitiveId::sphere(i)),
        };
        self.spheres.clear();
        self.spheres.extend((0..).zip(&scene.spheres).map(entry));
    }
}

impl UserPrimitives for SphereTable {
    fn len(&self) -> usize {
        self.spheres.len()
    }

    fn bounds(&self, index: u32) -> (Bounds, &F32Space) {
        let s = &self.spheres[index as usize];
        (Bounds { lower: s.center - s.radius, upper: s.center + s.radius }, &self.frame)
    }
}

/// The callbacks for packets of `width`.
pub fn callbacks(width: PacketWidth) -> Callbacks {
    callbacks_for!(width)
}

/// Keeps the nearest sphere of each ray in the context.
#[inline(always)]
unsafe fn intersect<const W: usize>(args: *const sys::RTCIntersectFunctionNArguments) {
    // SAFETY: the pointers are Embree's, for `N` rays; the context is ours, for `W` of them.
    unsafe {
        let args = &*args;
        let table = &*args.geometryUserPtr.cast::<SphereTable>();
        let s = table.spheres.get_unchecked(args.primID as usize);
        let context = &mut *args.context.cast::<QueryContext<'_, W>>();
        let valid = args.valid.cast_const();
        if args.N as usize == W {
            let record = &mut *args.rayhit.cast::<RayHitRecord<W>>();
            let valid = &*valid.cast::<[i32; W]>();
            if in_order(&record.id) {
                let Some(ts) = crossings(context, s, valid, args.primID) else { return };
                for i in 0..W {
                    // A tie goes to the sphere with the lesser index.
                    let nearer = ts[i] < context.nearest.t[i]
                        || (ts[i] == context.nearest.t[i]
                            && args.primID < context.nearest.primitive[i]);
                    let nearer = nearer && ts[i] < context.exact.tmax[i];
                    if nearer {
                        context.nearest.t[i] = ts[i];
                        context.nearest.primitive[i] = args.primID;
                    }
                    let end = context.exact.clip.narrow(i, ts[i]);
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
            let nearer = t < context.nearest.t[i]
                || (t == context.nearest.t[i] && args.primID < context.nearest.primitive[i]);
            if nearer && t < context.exact.tmax[i] {
                context.nearest.t[i] = t;
                context.nearest.primitive[i] = args.primID;
                let tfar = floats.add(TFAR * n + slot);
                *tfar = context.exact.clip.narrow(i, t).min(*tfar);
            }
        }
    }
}

/// Marks the rays that the sphere keeps from their end.
#[inline(always)]
unsafe fn occluded<const W: usize>(args: *const sys::RTCOccludedFunctionNArguments) {
    // SAFETY: as in `intersect`; the ray part of the record is the same.
    unsafe {
        let args = &*args;
        let table = &*args.geometryUserPtr.cast::<SphereTable>();
        let s = table.spheres.get_unchecked(args.primID as usize);
        if !s.blocks_light {
            return;
        }
        let context = &mut *args.context.cast::<QueryContext<'_, W>>();
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

/// The first t > 0 at which each valid ray meets the sphere, or infinity; `None` when none does.
#[inline(always)]
fn crossings<const W: usize>(
    context: &QueryContext<'_, W>,
    s: &Entry,
    valid: &[i32; W],
    primitive: u32,
) -> Option<[f64; W]> {
    if context.goes_on {
        // What lies ahead of a ray that went through surfaces is not the first root: one by one.
        return Some(std::array::from_fn(|i| match valid[i] {
            0 => f64::INFINITY,
            _ => crossing(context, s, primitive, i),
        }));
    }
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
    let mut on = [false; W];
    let mut any_on = false;
    for i in 0..W {
        let line = line(context, s, i);
        let (near, far) = line.roots();
        let t = if near > 0.0 { near } else { far };
        let meets = crosses[i] & (t > 0.0) & (context.outward[i] != primitive);
        ts[i] = if meets { t } else { f64::INFINITY };
        on[i] = meets & context.may_start_on(i, primitive, s.radius, line.power());
        any_on |= on[i];
    }
    // Rays that start on the sphere are few: one by one.
    if context.leaves & any_on {
        for i in (0..W).filter(|&i| on[i]) {
            ts[i] = crossing(context, s, primitive, i);
        }
    }
    Some(ts)
}

/// The first t > 0 at which ray `i` meets the sphere, or infinity.
#[inline(always)]
fn crossing<const W: usize>(
    context: &QueryContext<'_, W>,
    s: &Entry,
    primitive: u32,
    i: usize,
) -> f64 {
    let line = line(context, s, i);
    if !line.crosses() {
        return f64::INFINITY;
    }
    if let Some(ray) = context.rays.get(i).filter(|ray| ray.continuation.is_some()).as_ref() {
        let primitives = Primitives { scene: context.scene, precision: Precision::Fast };
        let inverse = context.exact.inverse_length_squared[i];
        let hit = primitives.sphere(primitive, ray, inverse, f64::INFINITY);
        return hit.map_or(f64::INFINITY, |hit| hit.t);
    }
    let first = |inward| sphere::first_root(line.roots(), f64::INFINITY, inward);
    let left = |ray: Ray| sphere_departure(context.scene, primitive, &ray);
    let t = match (first(false), context.rays.get(i).map_or(SphereDeparture::No, left)) {
        (None, _) | (_, SphereDeparture::Outward) => None,
        (t, SphereDeparture::No) => t,
        (_, SphereDeparture::Inward) => first(true),
    };
    t.unwrap_or(f64::INFINITY)
}

#[inline(always)]
fn line<const W: usize>(context: &QueryContext<'_, W>, s: &Entry, i: usize) -> sphere::Quadratic {
    let (origin, direction) = context.exact.line(i);
    let inverse = context.exact.inverse_length_squared[i];
    sphere::Quadratic::new(s.center, s.radius, origin, direction, inverse)
}
