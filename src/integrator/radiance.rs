//! The radiance along the rays of a wave, sixteen rays side by side.

use glam::Vec3;

use crate::geometry::{LANES, Lanes};
use crate::integrator::counts::NotFiniteCause;

/// The radiance along sixteen rays, channel by channel; also other colours of sixteen points.
pub(super) type Radiance16 = [Lanes<f32>; 3];

/// Zero radiance along all sixteen rays.
pub(super) const DARK: Radiance16 = [[0.0; LANES]; 3];

/// Returns the colour in lane `i`.
#[inline(always)]
pub(super) fn lane(colors: &Radiance16, i: usize) -> Vec3 {
    Vec3::new(colors[0][i], colors[1][i], colors[2][i])
}

/// Sets the colour in lane `i`.
#[inline(always)]
pub(super) fn set_lane(colors: &mut Radiance16, i: usize, color: Vec3) {
    for channel in 0..3 {
        colors[channel][i] = color[channel];
    }
}

/// True if any lane is set.
#[inline(always)]
pub(super) fn any(lanes: &Lanes<bool>) -> bool {
    // As numbers: compilers fold these side by side, and truth values one by one.
    lanes.map(u8::from).iter().fold(0, |all, one| all | one) != 0
}

/// True if every channel of every lane is finite.
#[inline(always)]
pub(super) fn all_finite(colors: &Radiance16) -> bool {
    const EXPONENT: u32 = f32::INFINITY.to_bits();
    let mut not_finite = [0; LANES];
    for i in 0..LANES {
        for channel in colors {
            not_finite[i] |= u32::from(channel[i].to_bits() & EXPONENT == EXPONENT);
        }
    }
    not_finite.iter().fold(0, |all, one| all | one) == 0
}

/// The radiance along the rays of a wave, except what mirrors and glass show.
#[derive(Default)]
pub(super) struct WaveRadiance {
    /// The radiance, sixteen rays to a block.
    pub blocks: Vec<Radiance16>,
    /// The rays whose radiance is not finite; it is NaN in `blocks`. Each stands here once.
    pub not_finite: Vec<NotFiniteRay>,
}

/// A ray whose radiance is not finite.
pub(super) struct NotFiniteRay {
    /// The number of the ray in its wave.
    pub ray: u32,
    /// The first cause.
    pub cause: NotFiniteCause,
}

impl WaveRadiance {
    /// Resets to `blocks` blocks, each to be set before it is read.
    pub fn reset(&mut self, blocks: usize) {
        self.blocks.resize(blocks, DARK);
        self.not_finite.clear();
    }

    /// Adds radiance to the active lanes of a block, except where theirs is already NaN.
    #[inline(always)]
    pub fn add_block(&mut self, block: usize, radiance: &Radiance16, is_active: &Lanes<bool>) {
        let sums = &mut self.blocks[block];
        let mut total = *sums;
        for channel in 0..3 {
            for i in 0..LANES {
                let sum = total[channel][i] + radiance[channel][i];
                total[channel][i] = if is_active[i] { sum } else { total[channel][i] };
            }
        }
        if all_finite(&total) {
            *sums = total;
            return;
        }
        for i in (0..LANES).filter(|&i| is_active[i]) {
            self.add(block, i, lane(radiance, i));
        }
    }

    /// Adds radiance along one ray, except where its own is already NaN.
    pub fn add(&mut self, block: usize, i: usize, radiance: Vec3) {
        let sum = lane(&self.blocks[block], i) + radiance;
        if sum.is_finite() {
            set_lane(&mut self.blocks[block], i, sum);
        } else if radiance.is_nan() {
            self.mark_not_finite(block, i, NotFiniteCause::Light);
        } else {
            self.mark_not_finite(block, i, NotFiniteCause::Sum);
        }
    }

    /// Makes the radiance along one ray NaN, so that it stays out of the picture, and records the
    /// cause if it is the first.
    #[cold]
    pub fn mark_not_finite(&mut self, block: usize, i: usize, cause: NotFiniteCause) {
        if !lane(&self.blocks[block], i).is_nan() {
            self.not_finite.push(NotFiniteRay { ray: (block * LANES + i) as u32, cause });
        }
        set_lane(&mut self.blocks[block], i, Vec3::NAN);
    }
}
