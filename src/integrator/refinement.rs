//! The second pass of an adaptive picture: more samples for the pixels that need them.

use crate::film::Pixel;
use crate::integrator::adaptive_sampling::PixelRecord;
use crate::integrator::sample_pattern::SamplePattern;
use crate::integrator::tile_loop::Scratch;
use crate::integrator::{Counts, Integrator};

/// The number of pixels that are refined together.
const REFINED_TOGETHER: usize = 1024;

/// A strip of an adaptive picture after the first pass, in whole rows.
pub struct RefineStrip<'a> {
    /// The row of the picture where it begins.
    pub first_row: usize,
    /// The means of each pixel's first samples; they become those of all.
    pub pixels: &'a mut [Pixel],
    /// The same of their alpha; empty unless the picture has alpha.
    pub alpha: &'a mut [f32],
    /// The records of the pixels.
    pub records: &'a [PixelRecord],
    /// True for each pixel that gets more samples.
    pub refined: &'a [bool],
}

/// A pixel that gets more samples.
#[derive(Clone, Copy)]
struct ActivePixel {
    /// The index of the pixel in the strip.
    index: usize,
    record: PixelRecord,
}

impl Integrator<'_> {
    /// Takes more samples of the pixels of a strip that need them.
    pub fn refine_strip(&self, strip: RefineStrip<'_>, scratch: &mut Scratch) -> Counts {
        let RefineStrip { first_row, pixels, alpha: strip_alpha, records, refined } = strip;
        let width = self.scene.film.size[0] as usize;
        let rows = pixels.len() / width;
        let SamplePattern { steps, first, .. } = &self.samples;
        let mut counts = Counts::default();
        // They are taken in the order in which tiles order their rays.
        let mut active: Vec<ActivePixel> = Vec::new();
        for column in (0..width).step_by(self.tiling.columns) {
            scratch.tile.set(&self.tiling, [column, first_row], [width, rows]);
            for run in &scratch.tile.runs {
                let run = scratch.tile.run_in_strip(run, width).filter(|&i| refined[i]);
                active.extend(run.map(|index| ActivePixel { index, record: records[index] }));
            }
        }
        for step in first + 1..steps.len() {
            counts.refined[step - first - 1] += active.len() as u64;
            let mut next_active = Vec::new();
            for group in active.chunks(REFINED_TOGETHER) {
                // A tile of these pixels, with their sums and records so far.
                let Scratch { tile, sums, alpha, records, .. } = scratch;
                tile.set_pixels(
                    group.iter().map(|p| [p.index % width, first_row + p.index / width]),
                );
                sums.set_means(group.iter().map(|p| pixels[p.index]), steps[step - 1]);
                if self.has_alpha {
                    alpha.set_means(group.iter().map(|p| strip_alpha[p.index]), steps[step - 1]);
                }
                records.clear();
                for &ActivePixel { index, record } in group {
                    records.push(record, pixels[index].into());
                }
                // The samples of this step.
                self.trace_step(step, scratch, &mut counts);
                // Pixels whose samples disagree go on, if there are more to take.
                let read = group.iter().zip(&scratch.records.records);
                for (i, (&ActivePixel { index, .. }, &record)) in read.enumerate() {
                    let goes_on = record.disagrees && step + 1 < steps.len();
                    pixels[index] = scratch.sums.mean(i, steps[step]);
                    if self.has_alpha {
                        strip_alpha[index] = scratch.alpha.mean(i, steps[step]);
                    }
                    if goes_on {
                        next_active.push(ActivePixel { index, record });
                    }
                }
            }
            active = next_active;
        }
        counts
    }
}
