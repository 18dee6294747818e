//! The radiance along the rays of a wave, and its way to samples, sums of samples, and pixels.

use glam::Vec3;

use crate::film::Pixel;
use crate::geometry::{LANES, Lanes};
use crate::integrator::counts::NotFiniteCause;
use crate::integrator::tiling::Tile;
use crate::integrator::wave::Wave;
use crate::integrator::{Counts, simd};

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
    let mut any = 0;
    for i in 0..LANES {
        any |= u8::from(lanes[i]);
    }
    any != 0
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

    /// Adds the radiance along the rays of the wave to their samples, by their throughput.
    pub fn add_to_samples(
        &mut self,
        wave: &Wave,
        samples: &mut Vec<Radiance16>,
        counts: &mut Counts,
    ) {
        // Without paths each ray is a whole sample.
        if wave.paths.is_empty() {
            std::mem::swap(&mut self.blocks, samples);
            self.not_finite.drain(..).for_each(|ray| ray.cause.count(counts));
            return;
        }
        // A sample that is NaN stays so.
        for (i, path) in wave.paths.iter().enumerate() {
            let radiance = lane(&self.blocks[i / LANES], i % LANES);
            let (sample, i) = path.sample_lane();
            let sum = lane(&samples[sample], i);
            if !sum.is_nan() && !radiance.is_nan() {
                let weighted = (path.throughput * radiance.as_dvec3()).as_vec3();
                set_lane(&mut samples[sample], i, sum + weighted);
            }
        }
        // Each sample counts once, for the first of its rays that is not finite.
        for not_finite in self.not_finite.drain(..) {
            let (sample, i) = wave.paths[not_finite.ray as usize].sample_lane();
            if !lane(&samples[sample], i).is_nan() {
                not_finite.cause.count(counts);
                set_lane(&mut samples[sample], i, Vec3::NAN);
            }
        }
    }
}

/// Adds a sample of each pixel to the sums of its samples. A sample that is NaN, or would make a sum
/// infinite, is left out; `overflows` counts the latter.
pub(super) fn add_samples(
    arch: pulp::Arch,
    samples: &[Radiance16],
    sums: &mut [Radiance16],
    overflows: &mut u64,
) {
    simd::dispatch(
        arch,
        #[inline(always)]
        || {
            for (sums, samples) in sums.iter_mut().zip(samples) {
                let mut total = *sums;
                for channel in 0..3 {
                    for i in 0..LANES {
                        total[channel][i] += samples[channel][i];
                    }
                }
                if all_finite(&total) {
                    *sums = total;
                } else {
                    add_finite_samples(samples, sums, overflows);
                }
            }
        },
    );
}

/// Adds the samples of a block whose sums stay finite.
#[cold]
fn add_finite_samples(samples: &Radiance16, sums: &mut Radiance16, overflows: &mut u64) {
    for i in 0..LANES {
        let sample = lane(samples, i);
        let sum = sample + lane(sums, i);
        if sum.is_finite() {
            set_lane(sums, i, sum);
        } else {
            // A sample that is NaN was counted where it arose.
            *overflows += u64::from(!sample.is_nan());
        }
    }
}

/// Writes the sums of a tile, times `weight`, into the pixels of a strip; sums that are NaN become
/// black.
pub(super) fn write_pixels(
    arch: pulp::Arch,
    tile: &Tile,
    sums: &[Radiance16],
    weight: f32,
    pixels: &mut [Pixel],
    width: usize,
) {
    simd::dispatch(
        arch,
        #[inline(always)]
        || {
            let mut written = 0;
            let mut values = [[0.0; 3]; LANES];
            for run in &tile.runs {
                for pixel in &mut pixels[tile.run_in_strip(run, width)] {
                    if written % LANES == 0 {
                        values = pixel_values(&sums[written / LANES], weight);
                    }
                    *pixel = values[written % LANES];
                    written += 1;
                }
            }
        },
    );
}

/// Returns sixteen pixels: sums times `weight`, and black for those that are NaN.
#[inline(always)]
fn pixel_values(sums: &Radiance16, weight: f32) -> Lanes<Pixel> {
    let mut values = DARK;
    for i in 0..LANES {
        let is_number = !(sums[0][i] + sums[1][i] + sums[2][i]).is_nan();
        for channel in 0..3 {
            values[channel][i] = if is_number { sums[channel][i] * weight } else { 0.0 };
        }
    }
    let mut pixels = [[0.0; 3]; LANES];
    for i in 0..LANES {
        pixels[i] = [values[0][i], values[1][i], values[2][i]];
    }
    pixels
}
