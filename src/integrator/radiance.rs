//! The radiance along the rays of a wave, and its way to samples, sums of samples, and pixels.

use glam::{DVec3, Vec3};

use crate::film::Pixel;
use crate::geometry::{LANES, Lanes};
use crate::integrator::counts::NotFiniteCause;
use crate::integrator::tiling::Tile;
use crate::integrator::wave::Wave;
use crate::integrator::{Counts, simd};

/// The radiance along sixteen rays, channel by channel; also other colours of sixteen points.
pub(super) type Radiance16 = [Lanes<f32>; 3];

/// The sums of radiance along sixteen rays, channel by channel. In f64 neither thousands of lights nor
/// millions of samples lose anything that f32 could show.
pub(super) type RadianceSum16 = [Lanes<f64>; 3];

/// Zero radiance along all sixteen rays.
pub(super) const DARK: RadianceSum16 = [[0.0; LANES]; 3];

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

/// Returns the sum in lane `i`.
#[inline(always)]
pub(super) fn sum_lane(sums: &RadianceSum16, i: usize) -> DVec3 {
    DVec3::new(sums[0][i], sums[1][i], sums[2][i])
}

/// Sets the sum in lane `i`.
#[inline(always)]
pub(super) fn set_sum_lane(sums: &mut RadianceSum16, i: usize, sum: DVec3) {
    for channel in 0..3 {
        sums[channel][i] = sum[channel];
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

/// True if no channel of a sum is NaN or beyond f32.
#[inline(always)]
fn fits_f32(sum: DVec3) -> bool {
    sum.abs().cmple(DVec3::splat(f64::from(f32::MAX))).all()
}

/// True if [`fits_f32`] is true of every lane.
#[inline(always)]
fn all_fit_f32(sums: &RadianceSum16) -> bool {
    const LIMIT: f64 = f32::MAX as f64;
    let mut beyond = [0; LANES];
    for i in 0..LANES {
        for channel in sums {
            beyond[i] |= u64::from(!(channel[i].abs() <= LIMIT));
        }
    }
    beyond.iter().fold(0, |all, one| all | one) == 0
}

/// The radiance along the rays of a wave, except what mirrors and glass show.
#[derive(Default)]
pub(super) struct WaveRadiance {
    /// The radiance, sixteen rays to a block.
    pub blocks: Vec<RadianceSum16>,
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
                let sum = total[channel][i] + f64::from(radiance[channel][i]);
                total[channel][i] = if is_active[i] { sum } else { total[channel][i] };
            }
        }
        if all_fit_f32(&total) {
            *sums = total;
            return;
        }
        for i in (0..LANES).filter(|&i| is_active[i]) {
            self.add(block, i, lane(radiance, i).as_dvec3());
        }
    }

    /// Adds radiance along one ray, except where its own is already NaN.
    pub fn add(&mut self, block: usize, i: usize, radiance: DVec3) {
        let sum = sum_lane(&self.blocks[block], i) + radiance;
        if fits_f32(sum) {
            set_sum_lane(&mut self.blocks[block], i, sum);
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
        if !sum_lane(&self.blocks[block], i).is_nan() {
            self.not_finite.push(NotFiniteRay { ray: (block * LANES + i) as u32, cause });
        }
        set_sum_lane(&mut self.blocks[block], i, DVec3::NAN);
    }

    /// Adds the radiance along the rays of the wave to their samples, by their throughput.
    pub fn add_to_samples(
        &mut self,
        wave: &Wave,
        samples: &mut Vec<RadianceSum16>,
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
            let radiance = sum_lane(&self.blocks[i / LANES], i % LANES);
            let (sample, i) = path.sample_lane();
            let sum = sum_lane(&samples[sample], i);
            if !sum.is_nan() && !radiance.is_nan() {
                set_sum_lane(&mut samples[sample], i, sum + path.throughput * radiance);
            }
        }
        // Each sample counts once, for the first of its rays that is not finite.
        for not_finite in self.not_finite.drain(..) {
            let (sample, i) = wave.paths[not_finite.ray as usize].sample_lane();
            if !sum_lane(&samples[sample], i).is_nan() {
                not_finite.cause.count(counts);
                set_sum_lane(&mut samples[sample], i, DVec3::NAN);
            }
        }
    }
}

/// The number of samples that are added in f32 before their sum joins those of a pixel in f64. Four
/// equal ones add up exactly, whatever they are; four others to within the rounding of three additions,
/// however many follow.
pub(super) const GROUP: usize = 4;

/// Adds a sample of each pixel to the sums of its group, which are f32, or, where these would be beyond
/// f32, to the pixel's. A sample that is NaN or itself beyond f32 is left out; `overflows` counts the
/// latter.
pub(super) fn add_samples(
    arch: pulp::Arch,
    samples: &[RadianceSum16],
    group: &mut Vec<Radiance16>,
    sums: &mut [RadianceSum16],
    overflows: &mut u64,
) {
    group.resize(samples.len(), [[0.0; LANES]; 3]);
    simd::dispatch(
        arch,
        #[inline(always)]
        || {
            for ((group, sums), samples) in group.iter_mut().zip(&mut *sums).zip(samples) {
                let mut total = *group;
                for channel in 0..3 {
                    for i in 0..LANES {
                        total[channel][i] += samples[channel][i] as f32;
                    }
                }
                if all_finite(&total) {
                    *group = total;
                } else {
                    add_finite_samples(samples, group, sums, overflows);
                }
            }
        },
    );
}

/// Adds the samples of a block that are numbers within f32.
#[cold]
fn add_finite_samples(
    samples: &RadianceSum16,
    group: &mut Radiance16,
    sums: &mut RadianceSum16,
    overflows: &mut u64,
) {
    for i in 0..LANES {
        let sample = sum_lane(samples, i).as_vec3();
        let in_group = lane(group, i) + sample;
        if !sample.is_finite() {
            // A sample that is NaN was counted where it arose.
            *overflows += u64::from(!sample.is_nan());
        } else if in_group.is_finite() {
            set_lane(group, i, in_group);
        } else {
            set_sum_lane(sums, i, sum_lane(sums, i) + sample.as_dvec3());
        }
    }
}

/// Adds the sums of a group to those of the pixels, and empties the group.
pub(super) fn add_group(arch: pulp::Arch, group: &mut Vec<Radiance16>, sums: &mut [RadianceSum16]) {
    simd::dispatch(
        arch,
        #[inline(always)]
        || {
            for (sums, group) in sums.iter_mut().zip(&*group) {
                for channel in 0..3 {
                    for i in 0..LANES {
                        sums[channel][i] += f64::from(group[channel][i]);
                    }
                }
            }
        },
    );
    group.clear();
}

/// Returns the mean of a number of samples that have this sum, as a pixel stores it.
#[inline(always)]
pub(super) fn mean(sum: f64, samples: usize) -> f32 {
    (sum * (1.0 / samples as f64)) as f32
}

/// Returns the sum of a number of samples that have this mean; [`mean`] of it is the same mean again.
#[inline(always)]
pub(super) fn sum_of_mean(mean: f32, samples: usize) -> f64 {
    f64::from(mean) * samples as f64
}

/// Rounds sums of a number of samples so that the means can be stored in pixels.
pub(super) fn round_to_means(sums: &mut [RadianceSum16], samples: usize) {
    let values = sums.as_flattened_mut().as_flattened_mut();
    values.iter_mut().for_each(|sum| *sum = sum_of_mean(mean(*sum, samples), samples));
}

/// Writes the means of the pixels of a tile, whose sums are of `samples` samples each, into the pixels
/// of a strip; those that are NaN become black.
pub(super) fn write_pixels(
    arch: pulp::Arch,
    tile: &Tile,
    sums: &[RadianceSum16],
    samples: usize,
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
                        values = pixel_values(&sums[written / LANES], samples);
                    }
                    *pixel = values[written % LANES];
                    written += 1;
                }
            }
        },
    );
}

/// Returns sixteen pixels: the means of sums of `samples` samples, and black for those that are NaN.
#[inline(always)]
fn pixel_values(sums: &RadianceSum16, samples: usize) -> Lanes<Pixel> {
    let mut values: Radiance16 = [[0.0; LANES]; 3];
    for i in 0..LANES {
        let is_number = !(sums[0][i] + sums[1][i] + sums[2][i]).is_nan();
        for channel in 0..3 {
            values[channel][i] = if is_number { mean(sums[channel][i], samples) } else { 0.0 };
        }
    }
    let mut pixels = [[0.0; 3]; LANES];
    for i in 0..LANES {
        pixels[i] = [values[0][i], values[1][i], values[2][i]];
    }
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_of_equal_samples_adds_up_exactly() {
        let mut bits = 0x3f80_0000u32;
        for _ in 0..100_000 {
            let x = f32::from_bits(bits);
            assert_eq!((0..GROUP).fold(0.0, |sum, _| sum + x), GROUP as f32 * x, "{x}");
            bits = 0x3f80_0000 | (bits.wrapping_mul(0x9e37_79b9).wrapping_add(1) & 0x7f_ffff);
        }
    }

    #[test]
    fn a_mean_has_a_sum_of_the_same_mean() {
        for samples in 1..=1 << 16 {
            let x = 0.1 + samples as f32;
            assert_eq!(mean(sum_of_mean(x, samples), samples), x);
        }
    }
}
