//! What Embree reads and writes in our memory.
//!
//! The bindings describe Embree 4.2. From 4.3 on the library appends a field to the hit and to the
//! query context, and so writes past the bindings' own types. The records here are laid out as
//! the newer library expects and end in spare room; the older one leaves the last field alone.
//! `canary` proves at start that the library agrees.

use crate::geometry::{Hit16, PrimitiveId16};
use crate::intersect::embree::f32_space::F32Space;
pub use crate::intersect::embree::ffi::handles::INVALID;
use crate::intersect::embree::packet::Packet;
use crate::intersect::embree::packet::packet_hits::PacketHits;
use crate::intersect::embree::packet::packet_rays::{PacketRays, TracedLanes};
use crate::intersect::self_intersection::greatest_slack;
use crate::scene::Scene;

/// A packet of `W` rays and their hits: `RTCRayHit`, `RTCRayHit4`, `8` and `16` in one.
#[repr(C, align(64))]
pub struct RayHitRecord<const W: usize> {
    pub org: [[f32; W]; 3],
    pub tnear: [f32; W],
    pub dir: [[f32; W]; 3],
    pub time: [f32; W],
    pub tfar: [f32; W],
    pub mask: [u32; W],
    pub id: [u32; W],
    pub flags: [u32; W],
    pub ng: [[f32; W]; 3],
    pub u: [f32; W],
    pub v: [f32; W],
    pub prim: [u32; W],
    pub geom: [u32; W],
    pub inst: [u32; W],
    /// Written by Embree 4.3 and newer.
    pub inst_prim: [u32; W],
    /// Room for what a later library may append.
    pub spare: [u32; 32],
}

impl<const W: usize> RayHitRecord<W> {
    pub fn new() -> Self {
        Self {
            org: [[0.0; W]; 3],
            tnear: [0.0; W],
            dir: [[0.0; W]; 3],
            time: [0.0; W],
            tfar: [0.0; W],
            mask: [u32::MAX; W],
            id: std::array::from_fn(|i| i as u32),
            flags: [0; W],
            ng: [[0.0; W]; 3],
            u: [0.0; W],
            v: [0.0; W],
            prim: [INVALID; W],
            geom: [INVALID; W],
            inst: [INVALID; W],
            inst_prim: [INVALID; W],
            spare: [SENTINEL; 32],
        }
    }
}

/// What `spare` holds as long as nobody writes to it.
pub const SENTINEL: u32 = 0x5afe_5afe;

/// Which rays of a packet are traced: −1 or 0 each, as Embree wants it, 64-aligned.
#[repr(C, align(64))]
pub struct LaneMask<const W: usize>(pub [i32; W]);

/// The query context: Embree's own room first, then what our callbacks need.
///
/// Embree hands the callbacks the pointer that it was given, so that they find the rest behind it.
#[repr(C, align(64))]
pub struct QueryContext<'a, const W: usize> {
    /// `RTCRayQueryContext`, larger than any version's; all ones means "in no instance".
    pub embree: [u32; 16],
    pub scene: &'a Scene,
    /// The rays of the packet as they were asked; fewer than `W` in the last one.
    pub rays: Packet<'a>,
    /// The same, side by side, and where on them the f32 rays lie that are being traced; within an
    /// instance these are its own.
    pub exact: PacketRays<W>,
    /// The instance whose mesh is being traced in its own space.
    pub instance: u32,
    /// For each geometry of the Embree scene the instance that stands there.
    pub instance_of: &'a [u32],
    /// What the callbacks have found: in precision `fast` spheres, in `certified` everything.
    pub nearest: PacketHits<W>,
    /// Distance along the f32 rays below which, and before whose end, a candidate triangle is
    /// tested again in f64.
    pub doubt: f32,
    /// The ends of the f32 rays, before anything was found.
    pub end: [f32; W],
    /// Whether every triangle blocks light.
    pub all_block: bool,
    /// Of which instances the alpha is tested; empty where it is of none.
    pub masked: &'a [bool],
    /// Whether any ray of the packet left a surface, or went through one.
    pub leaves: bool,
    /// Whether any went straight through one.
    pub goes_on: bool,
    /// The sphere that each ray left toward its outside, and so does not meet, and toward its
    /// inside; `INVALID` for what left none.
    pub outward: [u32; W],
    pub inward: [u32; W],
    /// The largest absolute coordinate in the scene.
    reach: f64,
    /// How far from a surface a ray may start that starts on it to within rounding.
    pub slack: f64,
}

impl<'a, const W: usize> QueryContext<'a, W> {
    /// The context for the packets of a batch.
    pub fn new(
        scene: &'a Scene,
        rays: Packet<'a>,
        instance_of: &'a [u32],
        (doubt, reach): (f32, f64),
        (all_block, masked): (bool, &'a [bool]),
    ) -> Self {
        let exact = PacketRays::new();
        let nearest = PacketHits::new(exact.tmax);
        Self {
            embree: [INVALID; 16],
            scene,
            rays,
            exact,
            instance: INVALID,
            instance_of,
            nearest,
            doubt,
            end: [0.0; W],
            all_block,
            masked,
            leaves: !rays.is_fresh(),
            goes_on: !rays.is_unbroken(),
            outward: [INVALID; W],
            inward: [INVALID; W],
            reach,
            slack: 0.0,
        }
    }

    /// Takes up another packet of the same batch, and sets up its f32 rays.
    #[inline(always)]
    pub fn take_up(
        &mut self,
        rays: Packet<'a>,
        frame: &F32Space,
        org: &mut [[f32; W]; 3],
        dir: &mut [[f32; W]; 3],
        tfar: &mut [f32; W],
    ) -> TracedLanes<W> {
        self.rays = rays;
        self.exact.load(&rays);
        let entered = self.exact.set_up(frame, org, dir, tfar);
        self.end = *tfar;
        self.nearest.begin(&self.exact.tmax);
        if self.leaves {
            self.slack = greatest_slack(self.exact.farthest().max(self.reach));
            (self.outward, self.inward) = rays.spheres_left();
        }
        entered
    }

    /// Whether the alpha of an instance is tested.
    #[inline(always)]
    pub fn is_masked(&self, instance: u32) -> bool {
        !self.masked.is_empty() && self.masked[instance as usize]
    }

    /// Merges the spheres that the callbacks of precision `fast` found into the hits of the
    /// packet, from lane `at` on.
    #[inline(always)]
    pub fn merge_spheres(&self, found: &mut Hit16, at: usize) {
        let mut any = false;
        for i in 0..W {
            any |= self.nearest.primitive[i] != INVALID;
        }
        if !any {
            return;
        }
        for i in 0..W {
            let (t, primitive) = (self.nearest.t[i], self.nearest.primitive[i]);
            // Of two at the same distance the sphere counts.
            let counts = (primitive != INVALID) & (t <= found.t[at + i]);
            found.t[at + i] = if counts { t } else { found.t[at + i] };
            found.u[at + i] = if counts { 0.0 } else { found.u[at + i] };
            found.v[at + i] = if counts { 0.0 } else { found.v[at + i] };
            let id = &mut found.id;
            id.geometry[at + i] = if counts { PrimitiveId16::SPHERES } else { id.geometry[at + i] };
            id.primitive[at + i] = if counts { primitive } else { id.primitive[at + i] };
            id.instance[at + i] = if counts { 0 } else { id.instance[at + i] };
        }
    }

    /// Whether ray `i`, which did not leave the sphere outward, may start on it, so that `sphere_departure`
    /// must be asked; `power` is |f|² − r² with f from the centre to the origin.
    #[inline(always)]
    pub fn may_start_on(&self, i: usize, sphere: u32, radius: f64, power: f64) -> bool {
        // Negated for what is not a number.
        let apart = power.abs() > self.slack * (2.0 * radius + self.slack);
        (self.inward[i] == sphere) | !apart
    }
}

const _: () = {
    use std::mem::{offset_of, size_of};
    // Twelve fields of the ray, then nine of the hit, each as wide as the packet.
    assert!(offset_of!(RayHitRecord<1>, ng) == 48 && offset_of!(RayHitRecord<1>, inst_prim) == 80);
    assert!(
        offset_of!(RayHitRecord<4>, ng) == 192 && offset_of!(RayHitRecord<4>, inst_prim) == 320
    );
    assert!(
        offset_of!(RayHitRecord<8>, ng) == 384 && offset_of!(RayHitRecord<8>, inst_prim) == 640
    );
    assert!(
        offset_of!(RayHitRecord<16>, ng) == 768 && offset_of!(RayHitRecord<16>, inst_prim) == 1280
    );
    assert!(offset_of!(RayHitRecord<16>, spare) == 1344 && size_of::<[u32; 32]>() >= 64);
    assert!(size_of::<embree4_sys::RTCRayHit>() == 80);
    assert!(size_of::<embree4_sys::RTCRayQueryContext>() <= size_of::<[u32; 16]>());
    assert!(offset_of!(QueryContext<'static, 16>, embree) == 0);
};
