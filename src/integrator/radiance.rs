//! Radiance along sixteen rays side by side, and its way to the pixels.

use glam::Vec3;

use crate::film::Pixel;
use crate::geometry::{LANES, Lanes};
use crate::integrator::tiling::Tile;

/// The radiance along sixteen rays, channel by channel.
pub(super) type Radiance = [Lanes<f32>; 3];

/// None.
pub(super) const DARK: Radiance = [[0.0; LANES]; 3];

/// That in lane `i`.
#[inline(always)]
pub(super) fn at(v: &Radiance, i: usize) -> Vec3 {
    Vec3::new(v[0][i], v[1][i], v[2][i])
}

/// Sets that in lane `i`.
#[inline(always)]
pub(super) fn put(v: &mut Radiance, i: usize, value: Vec3) {
    for axis in 0..3 {
        v[axis][i] = value[axis];
    }
}

/// Whether any of them is.
#[inline(always)]
pub(super) fn any(lanes: &Lanes<bool>) -> bool {
    // As numbers: compilers fold these side by side, and truths one by one.
    lanes.map(u8::from).iter().fold(0, |all, one| all | one) != 0
}

/// Whether all of it is finite.
#[inline(always)]
pub(super) fn all_finite(v: &Radiance) -> bool {
    const INFINITE: u32 = f32::INFINITY.to_bits();
    let mut odd = [0; LANES];
    for i in 0..LANES {
        for lanes in v {
            odd[i] |= u32::from(lanes[i].to_bits() & INFINITE == INFINITE);
        }
    }
    odd.iter().fold(0, |all, odd| all | odd) == 0
}

/// Adds a sample of each pixel to the sums of its samples. What is not a number, or would make a sum
/// infinite, is left out.
pub(super) struct Add<'a> {
    pub samples: &'a [Radiance],
    pub sums: &'a mut [Radiance],
    /// How many sums would have been infinite, of samples that were numbers.
    pub infinite: &'a mut u64,
}

impl pulp::WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for (sums, samples) in self.sums.iter_mut().zip(self.samples) {
            let mut with = *sums;
            for axis in 0..3 {
                for i in 0..LANES {
                    with[axis][i] += samples[axis][i];
                }
            }
            if !all_finite(&with) {
                add_finite(samples, sums, self.infinite);
            } else {
                *sums = with;
            }
        }
    }
}

#[cold]
fn add_finite(samples: &Radiance, sums: &mut Radiance, infinite: &mut u64) {
    for i in 0..LANES {
        let (sample, sum) = (at(samples, i), at(samples, i) + at(sums, i));
        if sum.is_finite() {
            put(sums, i, sum);
        } else {
            // A sample that is NaN was counted where it arose.
            *infinite += u64::from(!sample.is_nan());
        }
    }
}

/// Writes what a tile's pixels are into whole rows of a picture; those that are not numbers are
/// dark.
pub(super) struct Develop<'a> {
    pub tile: &'a Tile,
    pub sums: &'a [Radiance],
    /// What the sums are multiplied with.
    pub share: f32,
    /// The column of the picture where the tile begins.
    pub left: usize,
    pub width: usize,
    pub pixels: &'a mut [Pixel],
}

impl pulp::WithSimd for Develop<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { tile, sums, share, left, width, pixels } = self;
        let mut done = 0;
        let mut values = [[0.0; 3]; LANES];
        for [x, y, length] in tile.runs.iter().map(|run| run.map(|n| n as usize)) {
            let to = &mut pixels[y * width + left + x..][..length];
            for to in to {
                if done % LANES == 0 {
                    values = developed(&sums[done / LANES], share);
                }
                *to = values[done % LANES];
                done += 1;
            }
        }
    }
}

/// Sixteen pixels.
#[inline(always)]
fn developed(sums: &Radiance, share: f32) -> Lanes<Pixel> {
    let mut clean = DARK;
    for i in 0..LANES {
        let is_number = !(sums[0][i] + sums[1][i] + sums[2][i]).is_nan();
        for axis in 0..3 {
            clean[axis][i] = if is_number { sums[axis][i] * share } else { 0.0 };
        }
    }
    std::array::from_fn(|i| [clean[0][i], clean[1][i], clean[2][i]])
}
