//! The sums of the samples of a tile's pixels, and their means.

use glam::{DVec3, Vec3};

use crate::film::Pixel;
use crate::geometry::{LANES, Lanes};
use crate::integrator::radiance::{
    DARK, GroupSums16, Radiance16, all_finite, end_group, lane, set_lane,
};
use crate::integrator::simd;
use crate::integrator::tiling::Tile;

/// The sums of the samples of a tile's pixels.
#[derive(Default)]
pub(super) struct PixelSums {
    /// The sums of the samples of the last group; empty before the first one.
    pub group: Vec<Radiance16>,
    /// The sums of the groups before; empty where there are none.
    groups: Vec<GroupSums16>,
}

impl PixelSums {
    /// Begins with pixels without samples.
    pub fn clear(&mut self) {
        self.group.clear();
        self.groups.clear();
    }

    /// Begins a group of samples.
    pub fn begin_group(&mut self, arch: pulp::Arch) {
        if !self.group.is_empty() {
            end_group(arch, &mut self.group, &mut self.groups);
        }
    }

    /// Adds a sample of each pixel. One that is NaN or beyond f32 is left out; `overflows` counts the
    /// latter.
    pub fn add(&mut self, arch: pulp::Arch, samples: &[Radiance16], overflows: &mut u64) {
        self.group.resize(samples.len(), DARK);
        simd::dispatch(
            arch,
            #[inline(always)]
            || {
                for (block, samples) in samples.iter().enumerate() {
                    let mut total = self.group[block];
                    for channel in 0..3 {
                        for i in 0..LANES {
                            total[channel][i] += samples[channel][i];
                        }
                    }
                    if all_finite(&total) {
                        self.group[block] = total;
                    } else {
                        self.add_finite(block, samples, overflows);
                    }
                }
            },
        );
    }

    /// Adds the finite samples of a block; those that do not fit into their group join the others.
    #[cold]
    fn add_finite(&mut self, block: usize, samples: &Radiance16, overflows: &mut u64) {
        for i in 0..LANES {
            let sample = lane(samples, i);
            let sum = lane(&self.group[block], i) + sample;
            if !sample.is_finite() {
                // A sample that is NaN was counted where it arose.
                *overflows += u64::from(!sample.is_nan());
            } else if sum.is_finite() {
                set_lane(&mut self.group[block], i, sum);
            } else {
                self.groups.resize(self.group.len(), [[0.0; LANES]; 3]);
                let before = group_lane(&self.groups[block], i);
                set_group_lane(&mut self.groups[block], i, before + sample.as_dvec3());
            }
        }
    }

    /// Returns the mean of the samples of pixel `i`, of which there are this many.
    pub fn mean(&self, i: usize, samples: usize) -> Pixel {
        let in_block = |sums: &GroupSums16| group_lane(sums, i % LANES);
        let before = self.groups.get(i / LANES).map_or(DVec3::ZERO, in_block);
        let last = self.group.get(i / LANES).map_or(Vec3::ZERO, |group| lane(group, i % LANES));
        (before + last.as_dvec3()).to_array().map(|sum| mean(sum, samples))
    }

    /// Goes on from pixels that are the means of this many samples.
    pub fn set_means(&mut self, means: impl Iterator<Item = Pixel>, samples: usize) {
        self.clear();
        for (i, pixel) in means.enumerate() {
            if i % LANES == 0 {
                self.groups.push([[0.0; LANES]; 3]);
            }
            let sum = DVec3::from(pixel.map(|mean| sum_of_mean(mean, samples)));
            set_group_lane(&mut self.groups[i / LANES], i % LANES, sum);
        }
    }

    /// Rounds the means of this many samples to those that a film stores.
    pub fn round_means(&mut self, arch: pulp::Arch, samples: usize) {
        self.begin_group(arch);
        let sums = self.groups.as_flattened_mut().as_flattened_mut();
        sums.iter_mut().for_each(|sum| *sum = sum_of_mean(mean(*sum, samples), samples));
    }

    /// Writes the means of the pixels of a tile, of this many samples, into the pixels of a strip; those
    /// that are NaN become black.
    pub fn write(
        &self,
        arch: pulp::Arch,
        tile: &Tile,
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
                            values = self.pixel_values(written / LANES, samples);
                        }
                        *pixel = values[written % LANES];
                        written += 1;
                    }
                }
            },
        );
    }

    /// Returns the pixels of a block.
    #[inline(always)]
    fn pixel_values(&self, block: usize, samples: usize) -> Lanes<Pixel> {
        // One group is its own sum.
        let mut means = self.group[block];
        if let Some(groups) = self.groups.get(block) {
            for channel in 0..3 {
                for i in 0..LANES {
                    let sum = groups[channel][i] + f64::from(means[channel][i]);
                    means[channel][i] = mean(sum, samples);
                }
            }
        } else {
            let weight = 1.0 / samples as f32;
            for channel in 0..3 {
                for i in 0..LANES {
                    means[channel][i] *= weight;
                }
            }
        }
        // Black for what is NaN.
        let mut pixels = [[0.0; 3]; LANES];
        for i in 0..LANES {
            let is_number = !(means[0][i] + means[1][i] + means[2][i]).is_nan();
            let value = |channel: usize| if is_number { means[channel][i] } else { 0.0 };
            pixels[i] = [value(0), value(1), value(2)];
        }
        pixels
    }
}

/// Returns the sum in lane `i`.
fn group_lane(sums: &GroupSums16, i: usize) -> DVec3 {
    DVec3::new(sums[0][i], sums[1][i], sums[2][i])
}

/// Sets the sum in lane `i`.
fn set_group_lane(sums: &mut GroupSums16, i: usize, sum: DVec3) {
    for channel in 0..3 {
        sums[channel][i] = sum[channel];
    }
}

/// Returns the mean of a number of samples that have this sum, as a film stores it.
#[inline(always)]
pub(super) fn mean(sum: f64, samples: usize) -> f32 {
    (sum * (1.0 / samples as f64)) as f32
}

/// Returns the sum of a number of samples that have this mean; [`mean`] of it is the same mean again.
#[inline(always)]
pub(super) fn sum_of_mean(mean: f32, samples: usize) -> f64 {
    f64::from(mean) * samples as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_has_a_sum_of_the_same_mean() {
        for samples in 1..=1 << 16 {
            let x = 0.1 + samples as f32;
            assert_eq!(mean(sum_of_mean(x, samples), samples), x);
        }
    }
}
