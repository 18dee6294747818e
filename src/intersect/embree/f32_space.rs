//! The f32 space: the recentred and scaled copies of scene and rays that Embree traverses.
//!
//! Only these copies are moved: the f64 tests use world coordinates. The copies are centred on the
//! scene, and scaled by a power of two so that its longest side is from 1 to 2 long. Such a scale rounds
//! nothing, and keeps the products of three coordinates in Embree's triangle test, as well as the
//! squares of lengths, from overflowing or underflowing, whatever unit the scene is in.
//!
//! # How far off an f32 ray can be
//!
//! Let L be the longest side of the scene's box, before it is scaled, and u = 2⁻²⁴. An f32 ray starts at most
//! [`MAX_ORIGIN_DISTANCE`]·L = 4 L from the centre in each coordinate (a ray that starts farther away is
//! first moved, in f64, to where it enters the box), and what it can hit lies within L/2 of it. On each
//! axis, to where it crosses the plane of a box,
//! - rounding the origin moves it by at most 4 u L,
//! - rounding the direction turns it: u times the way along that axis, at most 4.5 u L, once for
//!   this axis's own component and once, through t, for the axis whose slab is compared,
//! - Embree's own slab arithmetic errs by at most 5.1 u (|origin| + |box|) ≤ 5.1 · 4.5 u L = 23 u L
//!   (measured: 3.84 with AVX-512, 4.56 with AVX2, 5.10 with SSE),
//!
//! 36 u L in all. Boxes of user geometry are therefore rounded outward and widened by
//! [`BOX_PADDING`] = 40 u L; Embree's ROBUST flag does not reach them. The padding is fixed while the rays are
//! not, which is why the move to the box is needed.
//!
//! # The move to the box
//!
//! A ray o + t·d may start its f32 copy at any of its points near the box: all that counts is how far off
//! the line that point is. From up to [`MAX_MOVED_DISTANCE`]·L = 2²⁷ L away it is computed in f64: the three
//! roundings on the way come to 3 · 2⁻⁵³ · 2²⁷ L < u L, which the padding has to spare.
//!
//! From farther away it is computed in double-double numbers (`packet/approach.rs`). The difference o − c
//! from the centre c, of two f64s, is exact in these, and so is t·d for any f64 t. Their sum has a relative
//! error below 8 · 2⁻¹⁰⁶ in each component, however much of it cancels. As t has only 53 bits, the point lies
//! up to 2⁻⁴⁵ of the way before or behind the box, and the same is repeated from there. What the first of
//! the sums has lost is then 2⁻¹⁰³ · 2⁻⁴⁵ of the way, below u L / 2 up to [`MAX_APPROACH`]·L = 2¹⁰⁰ L;
//! what the others lose is less.

use glam::DVec3;

use crate::geometry::Bounds;

/// The distance from the scene's centre, in units of L, up to which f64 may move the origin of a ray to
/// the box.
pub const MAX_MOVED_DISTANCE: f64 = (1u32 << 27) as f64;
/// The same for double-double numbers.
pub const MAX_APPROACH: f64 = (1u128 << 100) as f64;
/// The distance from the scene's centre, in units of L, up to which an f32 ray may start.
pub const MAX_ORIGIN_DISTANCE: f64 = 4.0;
/// The widening of boxes of user geometry, in units of L.
pub const BOX_PADDING: f64 = 40.0 / (1u32 << 24) as f64;

/// The least L: a scale by its inverse, and by the length of a direction that is not extreme, stays
/// within the range of f64.
const MIN_EXTENT: f64 = f64::from_bits((1023 - 500) << 52);

/// The space of the f32 copies of a scene.
#[derive(Clone, Copy, Debug)]
pub struct F32Space {
    pub center: DVec3,
    /// The scene's box in world space.
    pub bounds: Bounds,
    /// The longest side of the box, L, in world units.
    pub extent: f64,
    /// The length of a world unit in this space: the power of two by which L is from 1 to 2 long.
    pub scale: f64,
}

impl F32Space {
    /// Makes the space of a scene with this box.
    pub fn from_bounds(bounds: Bounds) -> Self {
        if bounds.is_empty() {
            return Self::new(DVec3::ZERO, Bounds::from_points([DVec3::ZERO]), 1.0);
        }
        let extent = bounds.size().max_element();
        // A scene that is a single point still needs room to round in.
        let extent = extent.max(1e-9 * bounds.max_abs()).max(MIN_EXTENT);
        Self::new(bounds.center(), bounds, extent)
    }

    fn new(center: DVec3, bounds: Bounds, extent: f64) -> Self {
        // The power of two below it, by the bits.
        let power = f64::from_bits(extent.to_bits() >> 52 << 52);
        Self { center, bounds, extent, scale: 1.0 / power }
    }

    /// Makes the space of a frame, with box `bounds`, of an animation that lies mostly within
    /// `animation_bounds`: the same for all frames whose boxes lie in these bounds and are at least
    /// a quarter as large, and else one that is the same while the box changes a little. It does
    /// not depend on earlier frames.
    pub fn for_animation(bounds: Bounds, animation_bounds: Bounds) -> Self {
        let own = Self::from_bounds(bounds);
        let shared = Self { bounds, ..Self::snapped(animation_bounds) };
        let far = (bounds.lower - shared.center).abs().max((bounds.upper - shared.center).abs());
        let fits = far.max_element() <= 0.5 * shared.extent;
        if fits && 4.0 * own.extent >= shared.extent { shared } else { Self::snapped(bounds) }
    }

    /// Makes a space whose L is a power of two, more than 5/4 of the box's longest side and at most 5/2
    /// of it, and whose centre is a multiple of L/8 that is at most L/16 from the box's own on each axis.
    /// So the box lies within (2/5 + 1/16) L < L/2 of it, and what is said at the head of this file
    /// holds.
    fn snapped(bounds: Bounds) -> Self {
        let Self { center, extent, bounds, .. } = Self::from_bounds(bounds);
        let extent = (1.25 * extent).log2().floor().exp2() * 2.0;
        let step = extent / 8.0;
        Self::new((center / step).round() * step, bounds, extent)
    }

    /// True if f32 copies in the other space are those in this one.
    pub fn has_same_coordinates(&self, other: &Self) -> bool {
        (self.center, self.extent) == (other.center, other.extent)
    }

    /// A point, recentred, scaled and rounded.
    pub fn point(&self, p: DVec3) -> [f32; 3] {
        ((p - self.center) * self.scale).as_vec3().to_array()
    }

    /// A box of user geometry, recentred, widened, scaled and rounded outward.
    pub fn padded(&self, bounds: &Bounds) -> ([f32; 3], [f32; 3]) {
        let pad = self.margin();
        let lower = ((bounds.lower - self.center - pad) * self.scale).as_vec3().to_array();
        let upper = ((bounds.upper - self.center + pad) * self.scale).as_vec3().to_array();
        (lower.map(f32::next_down), upper.map(f32::next_up))
    }

    /// The distance in world units by which an f32 ray may be off, with room to spare; see the head of
    /// this file.
    pub fn margin(&self) -> f64 {
        BOX_PADDING * self.extent
    }

    /// The greatest error of the transform that takes an f64 ray into this space, as an object space:
    /// what is left of the padding.
    pub fn max_transform_error(&self) -> f64 {
        2.0 / f64::from(1u32 << 24) * self.extent
    }

    /// The distance, in units of an f32 ray's direction, within which its t says nothing about the
    /// side of a surface that it starts on: the errors above, with the direction at least 1 long and
    /// a triangle seen at a grazing angle allowed for.
    pub fn t_uncertainty(&self) -> f32 {
        (1024.0 * self.margin() * self.scale) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_snapped_space_holds_its_box_within_half_of_its_side(
            middle in prop::array::uniform3(-1.0..1.0f64),
            size in prop::array::uniform3(0.0..1.0f64),
            offset in -9..9i32,
            scale in -40..40i32,
        ) {
            let middle = DVec3::from(middle) * 10f64.powi(offset);
            let half = DVec3::from(size) * f64::from(scale).exp2();
            let bounds = Bounds { lower: middle - half, upper: middle + half };
            let F32Space { center, extent, scale, .. } = F32Space::snapped(bounds);
            let far = (bounds.lower - center).abs().max((bounds.upper - center).abs());
            prop_assert!(far.max_element() < 0.5 * extent, "{far} {extent}");
            prop_assert_eq!(scale * extent, 1.0);
            let longest = bounds.size().max_element().max(1e-9 * bounds.max_abs());
            prop_assert!(extent <= 2.5 * longest.max(MIN_EXTENT), "{extent} {longest}");
        }
    }

    /// A box with sides of this length about a point of the x axis.
    fn cube(x: f64, side: f64) -> Bounds {
        Bounds::from_points([DVec3::X * x - 0.5 * side, DVec3::X * x + 0.5 * side])
    }

    #[test]
    fn frames_on_one_stage_share_a_space() {
        let space = |x| F32Space::for_animation(cube(x, 1.0), cube(0.0, 1.5));
        assert!(space(-0.25).has_same_coordinates(&space(0.25)));
        assert_ne!(space(-0.25).bounds, space(0.25).bounds);
    }

    #[test]
    fn a_frame_that_leaves_the_stage_or_is_small_on_it_has_a_space_of_its_own() {
        let animation_bounds = cube(0.0, 8.0);
        let shared = F32Space::for_animation(animation_bounds, animation_bounds);
        for bounds in [cube(9.0, 8.0), cube(0.0, 1.0)] {
            let space = F32Space::for_animation(bounds, animation_bounds);
            assert!(
                !space.has_same_coordinates(&shared)
                    && space.has_same_coordinates(&F32Space::snapped(bounds))
            );
        }
    }

    #[test]
    fn an_empty_scene_has_a_space() {
        for (bounds, animation_bounds) in
            [(Bounds::EMPTY, cube(0.0, 1.0)), (cube(0.0, 1.0), Bounds::EMPTY)]
        {
            let space = F32Space::for_animation(bounds, animation_bounds);
            assert!(space.center.is_finite() && space.extent > 0.0);
        }
    }
}
