//! The records that Embree reads and writes in our memory.
//!
//! The bindings describe Embree 4.2. From 4.3 on the library appends a field to the hit and to the
//! query context, and so writes past the bindings' own types. The records here are laid out as
//! the newer library expects and end in spare room; the older one leaves the last field alone.
//! `abi_check` proves at start that the library agrees.

use glam::Vec3;

/// The id that Embree writes where there is no geometry or no instance.
pub const INVALID: u32 = u32::MAX;

/// The value of `spare` as long as nobody writes to it.
pub const SENTINEL: u32 = 0x5afe_5afe;

/// A packet of `W` rays and their hits in f32: `RTCRayHit`, `RTCRayHit4`, `8` and `16` in one.
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
    /// The instance primitive, written by Embree 4.3 and newer.
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

/// The active mask of a packet: −1 for each lane that is traced, and 0 for the others.
#[repr(C, align(64))]
pub struct LaneMask<const W: usize>(pub [i32; W]);

/// A hit that Embree found in f32, for a filter to accept or reject.
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
};
