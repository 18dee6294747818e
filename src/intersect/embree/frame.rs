//! From exact f64 rays to the f32 rays that Embree traverses with.
//!
//! Only these copies are recentred on the scene: the f64 tests use world coordinates.
//!
//! # How far off an f32 ray can be
//!
//! Let L be the longest side of the scene's box and u = 2⁻²⁴. An f32 ray starts at most
//! [`REACH`]·L = 4 L from the centre in each coordinate (a ray that starts farther away is first
//! moved, in f64, to where it enters the box), and what it can meet lies within L/2 of it. On each
//! axis, to where it crosses the plane of a box,
//! - rounding the origin moves it by at most 4 u L,
//! - rounding the direction turns it: u times the way along that axis, at most 4.5 u L, once for
//!   this axis's own component and once, through t, for the axis whose slab is compared,
//! - Embree's own slab arithmetic errs by at most 5.1 u (|origin| + |box|) ≤ 5.1 · 4.5 u L = 23 u L
//!   (measured: 3.84 with AVX-512, 4.56 with AVX2, 5.10 with SSE),
//!
//! 36 u L in all. Boxes of user geometry are therefore rounded outward and widened by [`PAD`]
//! = 40 u L; Embree's ROBUST flag does not reach them. The padding is fixed while the rays are
//! not, which is why the move to the box is needed.

use glam::DVec3;

use crate::geometry::Bounds;

/// How far from the scene's centre, in units of L, a ray may start for f64 to move it to the box:
/// the three roundings on the way come to 3 · 2⁻⁵³ · 2²⁷ L < u L, which the padding has to spare.
pub const FAR: f64 = (1u32 << 27) as f64;
/// How far from the scene's centre, in units of L, an f32 ray may start.
pub const REACH: f64 = 4.0;
/// By how much boxes of user geometry are widened, in units of L.
pub const PAD: f64 = 40.0 / (1u32 << 24) as f64;
/// Where the f32 copies of a scene live.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub center: DVec3,
    /// The scene's box in world space.
    pub bounds: Bounds,
    /// Its longest side, L.
    pub extent: f64,
}

impl Frame {
    pub fn around(bounds: Bounds) -> Self {
        if bounds.is_empty() {
            return Self { center: DVec3::ZERO, bounds: Bounds::of([DVec3::ZERO]), extent: 1.0 };
        }
        let extent = bounds.size().max_element();
        // A scene that is a single point still needs room to round in.
        let extent = extent.max(1e-9 * bounds.max_abs()).max(1e-30);
        Self { center: bounds.center(), bounds, extent }
    }

    /// A point, recentred and rounded.
    pub fn point(&self, p: DVec3) -> [f32; 3] {
        (p - self.center).as_vec3().to_array()
    }

    /// A box of user geometry, recentred, widened and rounded outward.
    pub fn padded(&self, bounds: &Bounds) -> ([f32; 3], [f32; 3]) {
        let pad = self.margin();
        let lower = (bounds.lower - self.center - pad).as_vec3().to_array();
        let upper = (bounds.upper - self.center + pad).as_vec3().to_array();
        (lower.map(f32::next_down), upper.map(f32::next_up))
    }

    /// How far an f32 ray may be from the exact one, and then some; see the head of this file.
    pub fn margin(&self) -> f64 {
        PAD * self.extent
    }

    /// What of the padding is left for a ray that f64 itself places only so well, in this frame.
    pub fn spare(&self) -> f64 {
        2.0 / f64::from(1u32 << 24) * self.extent
    }

    /// Distance, in units of an f32 ray's direction, within which its t says nothing about which
    /// side of a surface it starts on: the errors above, with the direction at least 1 long and
    /// a triangle seen at a grazing angle allowed for.
    pub fn doubt(&self) -> f32 {
        (1024.0 * self.margin()) as f32
    }
}
