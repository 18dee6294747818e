//! The way of radiance from the rays of a wave to samples, from samples to sums, and from sums to
//! pixels.

use glam::Vec3;

use crate::film::Pixel;
use crate::geometry::{LANES, Lanes};
use crate::integrator::Counts;
use crate::integrator::radiance::{DARK, Radiance16, WaveRadiance, all_finite, lane, set_lane};
use crate::integrator::tiling::Tile;
use crate::integrator::wave::Wave;

/// Adds the radiance along the rays of a wave to their samples, by their throughput.
pub(super) fn add_to_samples(
    wave: &Wave,
    radiance: &mut WaveRadiance,
    samples: &mut Vec<Radiance16>,
    counts: &mut Counts,
) {
    // Without paths each ray is a whole sample.
    if wave.paths.is_empty() {
        std::mem::swap(&mut radiance.blocks, samples);
        radiance.not_finite.drain(..).for_each(|ray| ray.cause.count(counts));
        return;
    }
    // A sample that is NaN stays so.
    for (i, path) in wave.paths.iter().enumerate() {
        let (block, i) = (&radiance.blocks[i / LANES], i % LANES);
        let (sample, sample_lane) = path.sample_lane();
        let (radiance, sum) = (lane(block, i), lane(&samples[sample], sample_lane));
        if !sum.is_nan() && !radiance.is_nan() {
            let weighted = (path.throughput * radiance.as_dvec3()).as_vec3();
            set_lane(&mut samples[sample], sample_lane, sum + weighted);
        }
    }
    // Each sample counts once, for the first of its rays that is not finite.
    for not_finite in radiance.not_finite.drain(..) {
        let (sample, i) = wave.paths[not_finite.ray as usize].sample_lane();
        if !lane(&samples[sample], i).is_nan() {
            not_finite.cause.count(counts);
            set_lane(&mut samples[sample], i, Vec3::NAN);
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
    arch.dispatch(
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
    arch.dispatch(
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
    std::array::from_fn(|i| [values[0][i], values[1][i], values[2][i]])
}
