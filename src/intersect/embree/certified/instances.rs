//! Meshes in spaces of their own, for precision `certified`: an instance is a user primitive that
//! takes the exact ray into the mesh's space in f64, and traces the mesh's own scene with the f32
//! copy made there. (Embree's own instances transform the f32 ray, in f32.)
//!
//! A mesh has a space of its own when it stands several times, and when it is so small in the
//! scene that the scene's padding would drown its triangles.
#![allow(unsafe_code)]

use embree4_sys as sys;

use crate::geometry::{Bounds, PrimitiveId};
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::handles::InnerScene;
use crate::intersect::embree::ffi::packet_width::PacketWidth;
use crate::intersect::embree::ffi::records::{LaneMask, QueryContext, RayHitRecord};
use crate::intersect::embree::ffi::user_geometry::{
    Callbacks, ID, TFAR, UserPrimitives, callbacks_for, in_order,
};
use crate::intersect::embree::packet::packet_rays::PacketRays;
use crate::intersect::object_space::ObjectSpace;
use crate::scene::{Instance, Scene};

/// The instances that stand there as such, by ascending index.
pub struct Instances {
    frame: F32Space,
    placements: Vec<PlacedInstance>,
}

/// One of them.
struct PlacedInstance {
    instance: u32,
    /// The mesh's scene, which must live as long as the placement.
    inner: sys::RTCScene,
    /// Where that scene's f32 copies live.
    own: F32Space,
    entry: ObjectSpace,
    /// The box in the world.
    bounds: Bounds,
}

impl Instances {
    pub fn new(frame: F32Space) -> Self {
        Self { frame, placements: Vec::new() }
    }

    /// Adds an instance that takes up `bounds` in the world, of a mesh whose scene is `inner` and
    /// whose f32 copies live in `own`.
    pub fn add(
        &mut self,
        scene: &Scene,
        instance: u32,
        bounds: Bounds,
        inner: &InnerScene,
        own: F32Space,
    ) {
        let entry = ObjectSpace::new(&scene.instances[instance as usize], &bounds);
        let inner = inner.0;
        self.placements.push(PlacedInstance { instance, inner, own, entry, bounds });
    }

    /// Moves the instance with this index, if it is one of them, to where it takes up `bounds`.
    pub fn replace(&mut self, instance: &Instance, index: u32, bounds: Bounds) {
        let at = self.placements.binary_search_by_key(&index, |placement| placement.instance);
        if let Some(placement) = at.ok().and_then(|at| self.placements.get_mut(at)) {
            placement.entry = ObjectSpace::new(instance, &bounds);
            placement.bounds = bounds;
        }
    }

    pub fn is_empty(&self) -> bool {
        self.placements.is_empty()
    }
}

impl UserPrimitives for Instances {
    fn len(&self) -> usize {
        self.placements.len()
    }

    fn bounds(&self, index: u32) -> (Bounds, &F32Space) {
        (self.placements[index as usize].bounds, &self.frame)
    }
}

/// The callbacks for packets of `width`.
pub fn callbacks(width: PacketWidth) -> Callbacks {
    callbacks_for!(width)
}

/// A packet in the space of a placement.
struct Inside<const W: usize> {
    exact: PacketRays<W>,
    /// Of this only origins and directions are used.
    ray: RayHitRecord<W>,
    tfar: [f32; W],
    valid: LaneMask<W>,
    /// Whether any lane is.
    any: bool,
    /// The rays that f64 cannot place there well enough; they try every triangle.
    astray: [bool; W],
}

impl PlacedInstance {
    /// Takes the valid rays, as far as their `limits`, into the mesh's space.
    #[inline(always)]
    fn enter<const W: usize>(
        &self,
        world: &PacketRays<W>,
        valid: &[i32; W],
        limits: [f64; W],
    ) -> Inside<W> {
        let mut exact = PacketRays::<W>::new();
        exact.tmax = limits;
        let mut lost = [false; W];
        for i in 0..W {
            let (o, d) = world.line(i);
            exact.set_line(i, self.entry.object_ray(o, d));
            // Negated for what is not a number.
            let placed = self.entry.error(o) <= self.own.spare();
            lost[i] = !placed;
        }
        let mut ray = RayHitRecord::<W>::new();
        let mut tfar = [0.0; W];
        let lanes = exact.set_up(&self.own, &mut ray.org, &mut ray.dir, &mut tfar);
        let mut inside =
            Inside { exact, ray, tfar, valid: LaneMask([0; W]), any: false, astray: [false; W] };
        for i in 0..W {
            let astray = lost[i] | lanes.astray[i];
            let traced = (valid[i] != 0) & lanes.inside[i] & !astray;
            inside.valid.0[i] = if traced { -1 } else { 0 };
            inside.astray[i] = (valid[i] != 0) & astray;
            inside.any |= traced;
        }
        inside
    }
}

/// Traces the mesh of the placement with the rays that come into its box.
///
/// # Safety
/// To be called by Embree, for `Instances`, in a query with a context of ours.
#[inline(always)]
unsafe fn intersect<const W: usize>(args: *const sys::RTCIntersectFunctionNArguments) {
    // SAFETY: the pointers are Embree's, for `N` rays; the context is ours, for `W` of them. What
    // is forwarded is as it would be in `query`, and no reference to context or record is used
    // while Embree traces.
    unsafe {
        let (n, valid) = ((*args).N as usize, (*args).valid.cast_const());
        let table = &*(*args).geometryUserPtr.cast::<Instances>();
        let Some(placement) = table.placements.get((*args).primID as usize) else { return };
        let context = (*args).context.cast::<QueryContext<'_, W>>();
        let floats = (*args).rayhit.cast::<f32>();
        let tfar = floats.add(TFAR * n);
        let ids = floats.add(ID * n).cast::<u32>();
        if n != W || !in_order(&*ids.cast::<[u32; W]>()) {
            for slot in (0..n).filter(|&slot| *valid.add(slot) != 0) {
                let lane = *ids.add(slot) as usize;
                (*context).settle_all(lane, placement.instance);
                let end = (*context).exact.clip.narrow(lane, (*context).nearest.upper(lane));
                *tfar.add(slot) = end.min(*tfar.add(slot));
            }
            return;
        }
        let outer = *tfar.cast::<[f32; W]>();
        let limits = std::array::from_fn(|i| (*context).nearest.upper(i));
        let mut inside = placement.enter(&(*context).exact, &*valid.cast::<[i32; W]>(), limits);
        for i in 0..W {
            if inside.astray[i] {
                (*context).settle_all(i, placement.instance);
            }
            if inside.valid.0[i] != 0 {
                *tfar.add(i) = inside.tfar[i];
            }
        }
        if inside.any {
            let around = std::mem::replace(&mut (*context).exact.clip, inside.exact.clip);
            (*context).instance = placement.instance;
            let (valid, ray) = (inside.valid.0.as_ptr(), std::ptr::from_mut(&mut inside.ray));
            let (scene, id) = (placement.inner, placement.instance);
            match W {
                1 => sys::rtcForwardIntersect1(args, scene, ray.cast(), id),
                4 => sys::rtcForwardIntersect4(valid, args, scene, ray.cast(), id),
                8 => sys::rtcForwardIntersect8(valid, args, scene, ray.cast(), id),
                _ => sys::rtcForwardIntersect16(valid, args, scene, ray.cast(), id),
            }
            (*context).exact.clip = around;
        }
        for i in 0..W {
            let end = (*context).exact.clip.narrow(i, (*context).nearest.upper(i));
            *tfar.add(i) = end.min(outer[i]);
        }
    }
}

/// Marks the rays that a triangle of the placement keeps from their end.
///
/// # Safety
/// As `intersect`.
#[inline(always)]
unsafe fn occluded<const W: usize>(args: *const sys::RTCOccludedFunctionNArguments) {
    // SAFETY: as in `intersect`; of the record only the ray part is there, and used.
    unsafe {
        let (n, valid) = ((*args).N as usize, (*args).valid.cast_const());
        let table = &*(*args).geometryUserPtr.cast::<Instances>();
        let Some(placement) = table.placements.get((*args).primID as usize) else { return };
        let context = (*args).context.cast::<QueryContext<'_, W>>();
        let scene = (*context).scene;
        let mesh = scene.instances[placement.instance as usize].mesh.0;
        if !scene.blocks_light(PrimitiveId::triangle(mesh, 0, placement.instance)) {
            return;
        }
        let floats = (*args).ray.cast::<f32>();
        let tfar = floats.add(TFAR * n);
        let ids = floats.add(ID * n).cast::<u32>();
        if n != W || !in_order(&*ids.cast::<[u32; W]>()) {
            for slot in (0..n).filter(|&slot| *valid.add(slot) != 0) {
                if (*context).meets_any(*ids.add(slot) as usize, placement.instance) {
                    *tfar.add(slot) = f32::NEG_INFINITY;
                }
            }
            return;
        }
        let outer = *tfar.cast::<[f32; W]>();
        let exact = &(*context).exact;
        let mut inside = placement.enter(exact, &*valid.cast::<[i32; W]>(), exact.tmax);
        for i in (0..W).filter(|&i| inside.valid.0[i] != 0) {
            *tfar.add(i) = inside.tfar[i];
        }
        if inside.any {
            let around = std::mem::replace(&mut (*context).exact.clip, inside.exact.clip);
            (*context).instance = placement.instance;
            let (valid, ray) = (inside.valid.0.as_ptr(), std::ptr::from_mut(&mut inside.ray));
            let (args, scene, id) = (args.cast(), placement.inner, placement.instance);
            match W {
                1 => sys::rtcForwardOccluded1(args, scene, ray.cast(), id),
                4 => sys::rtcForwardOccluded4(valid, args, scene, ray.cast(), id),
                8 => sys::rtcForwardOccluded8(valid, args, scene, ray.cast(), id),
                _ => sys::rtcForwardOccluded16(valid, args, scene, ray.cast(), id),
            }
            (*context).exact.clip = around;
        }
        for i in 0..W {
            let met = if inside.astray[i] {
                (*context).meets_any(i, placement.instance)
            } else {
                inside.valid.0[i] != 0 && *tfar.add(i) == f32::NEG_INFINITY
            };
            *tfar.add(i) = if met { f32::NEG_INFINITY } else { outer[i] };
        }
    }
}
