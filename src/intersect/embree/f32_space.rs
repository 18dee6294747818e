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
pub struct F32Space {
    pub center: DVec3,
    /// The scene's box in world space.
    pub bounds: Bounds,
    /// Its longest side, L.
    pub extent: f64,
}

impl F32Space {
    pub fn around(bounds: Bounds) -> Self {
        if bounds.is_empty() {
            return Self {
                center: DVec3::ZERO,
                bounds: Bounds::from_points([DVec3::ZERO]),
                extent: 1.0,
            };
        }
        let extent = bounds.size().max_element();
        // A scene that is a single point still needs room to round in.
        let extent = extent.max(1e-9 * bounds.max_abs()).max(1e-30);
        Self { center: bounds.center(), bounds, extent }
    }

    /// A frame for a picture of an animation that takes place mostly within `stage`, as far as that
    /// is known: one for them all where the picture's own box lies in it and is at least a quarter
    /// as large, and else one that is the same while the box changes a little. Which pictures came
    /// before has no part in it.
    pub fn on_stage(bounds: Bounds, stage: Bounds) -> Self {
        let own = Self::around(bounds);
        let shared = Self { bounds, ..Self::steady(stage) };
        let far = (bounds.lower - shared.center).abs().max((bounds.upper - shared.center).abs());
        let fits = far.max_element() <= 0.5 * shared.extent;
        if fits && 4.0 * own.extent >= shared.extent { shared } else { Self::steady(bounds) }
    }

    /// L is a power of two, more than 5/4 of the box's longest side and at most 5/2 of it, and the
    /// centre is a multiple of L/8 that is at most L/16 from the box's own on each axis. So the box
    /// lies within (2/5 + 1/16) L < L/2 of it, and what is said at the head of this file holds.
    fn steady(bounds: Bounds) -> Self {
        let Self { center, extent, bounds } = Self::around(bounds);
        let extent = (1.25 * extent).log2().floor().exp2() * 2.0;
        let step = extent / 8.0;
        Self { center: (center / step).round() * step, bounds, extent }
    }

    /// Whether f32 copies in the other frame are those in this one.
    pub fn is_at(&self, other: &Self) -> bool {
        (self.center, self.extent) == (other.center, other.extent)
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_steady_frame_holds_its_box_within_half_of_its_side(
            middle in prop::array::uniform3(-1.0..1.0f64),
            size in prop::array::uniform3(0.0..1.0f64),
            offset in -9..9i32,
            scale in -40..40i32,
        ) {
            let middle = DVec3::from(middle) * 10f64.powi(offset);
            let half = DVec3::from(size) * f64::from(scale).exp2();
            let bounds = Bounds { lower: middle - half, upper: middle + half };
            let F32Space { center, extent, .. } = F32Space::steady(bounds);
            let far = (bounds.lower - center).abs().max((bounds.upper - center).abs());
            prop_assert!(far.max_element() < 0.5 * extent, "{far} {extent}");
            let longest = bounds.size().max_element().max(1e-9 * bounds.max_abs());
            prop_assert!(extent <= 2.5 * longest.max(1e-30), "{extent} {longest}");
        }
    }

    /// A box of this side about a point of the x axis.
    fn cube(x: f64, side: f64) -> Bounds {
        Bounds::from_points([DVec3::X * x - 0.5 * side, DVec3::X * x + 0.5 * side])
    }

    #[test]
    fn pictures_of_one_stage_share_a_frame() {
        let frame = |x| F32Space::on_stage(cube(x, 1.0), cube(0.0, 1.5));
        assert!(frame(-0.25).is_at(&frame(0.25)));
        assert_ne!(frame(-0.25).bounds, frame(0.25).bounds);
    }

    #[test]
    fn what_leaves_the_stage_or_is_small_on_it_has_a_frame_of_its_own() {
        let stage = cube(0.0, 8.0);
        let shared = F32Space::on_stage(stage, stage);
        for bounds in [cube(9.0, 8.0), cube(0.0, 1.0)] {
            let frame = F32Space::on_stage(bounds, stage);
            assert!(!frame.is_at(&shared) && frame.is_at(&F32Space::steady(bounds)));
        }
    }

    #[test]
    fn a_scene_of_nothing_has_a_frame() {
        for (bounds, stage) in [(Bounds::EMPTY, cube(0.0, 1.0)), (cube(0.0, 1.0), Bounds::EMPTY)] {
            let frame = F32Space::on_stage(bounds, stage);
            assert!(frame.center.is_finite() && frame.extent > 0.0);
        }
    }
}
