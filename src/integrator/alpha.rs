//! The alpha of a transparent picture: the share of each pixel that something covers.
//!
//! A ray that comes straight from the camera, also through what alpha leaves uncovered and through null
//! interfaces, and hits nothing leaves its share of the sample uncovered, and brings no radiance. So
//! radiance is premultiplied by alpha (Porter and Duff, 1984). What mirrors and glass show is covered.

use crate::geometry::{LANES, PrimitiveId16};
use crate::integrator::pixel_sums::{mean, sum_of_mean};
use crate::integrator::radiance::{WaveRadiance, set_lane};
use crate::integrator::tiling::Tile;
use crate::integrator::wave::Wave;

/// The sums of the alpha of a tile's pixels over their samples.
#[derive(Default)]
pub(super) struct AlphaSums {
    sums: Vec<f64>,
}

impl AlphaSums {
    /// Begins with pixels without samples.
    pub fn clear(&mut self) {
        self.sums.clear();
    }

    /// Begins a sample of each of `count` pixels: it is covered, but for what
    /// [`AlphaSums::uncover`] takes away.
    pub fn begin_sample(&mut self, count: usize) {
        self.sums.resize(count, 0.0);
        self.sums.iter_mut().for_each(|sum| *sum += 1.0);
    }

    /// Takes away the share of the samples' rays that come straight from the camera and hit nothing, and
    /// makes them dark. The share is the mean of the throughput's channels.
    pub fn uncover(&mut self, wave: &Wave, radiance: &mut WaveRadiance) {
        for ray in 0..wave.rays.len() {
            let (block, i) = (ray / LANES, ray % LANES);
            if wave.hits.blocks()[block].id.geometry[i] != PrimitiveId16::NONE {
                continue;
            }
            // Without paths each ray is a whole sample.
            let (sample, share) = match wave.paths.get(ray) {
                None => (ray, 1.0),
                Some(path) if path.depth == 0 => {
                    (path.sample as usize, path.throughput.element_sum() / 3.0)
                }
                Some(_) => continue,
            };
            self.sums[sample] -= share;
            set_lane(&mut radiance.blocks[block], i, glam::Vec3::ZERO);
        }
    }

    /// Takes away a share of a sample.
    pub fn uncover_sample(&mut self, sample: u32, share: f64) {
        self.sums[sample as usize] -= share;
    }

    /// Returns the mean of the samples of pixel `i`, of which there are this many.
    pub fn mean(&self, i: usize, samples: usize) -> f32 {
        mean(self.sums[i], samples)
    }

    /// Goes on from pixels whose alpha is the mean of this many samples.
    pub fn set_means(&mut self, means: impl Iterator<Item = f32>, samples: usize) {
        self.sums.clear();
        self.sums.extend(means.map(|mean| sum_of_mean(mean, samples)));
    }

    /// Rounds the means of this many samples to those that a film stores.
    pub fn round_means(&mut self, samples: usize) {
        self.sums.iter_mut().for_each(|sum| *sum = sum_of_mean(mean(*sum, samples), samples));
    }

    /// Writes the means of the pixels of a tile, of this many samples, into the alpha of a strip.
    pub fn write(&self, tile: &Tile, samples: usize, alpha: &mut [f32], width: usize) {
        let mut sums = self.sums.iter();
        for run in &tile.runs {
            let written = alpha[tile.run_in_strip(run, width)].iter_mut();
            written.zip(&mut sums).for_each(|(to, sum)| *to = mean(*sum, samples));
        }
    }
}
