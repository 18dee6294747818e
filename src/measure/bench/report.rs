//! The results of a benchmark: a row for each mode, and the images.

use std::time::Duration;

use serde::Serialize;

use super::mode::{Mode, Setup};
use super::reference::{ImageError, Reference};
use super::runs::{ModeRuns, SetupRuns};
use super::{BenchOptions, machine::Machine, pareto::dominators};
use crate::measure::flip::Flip;
use crate::scene::Scene;

/// The results of a benchmark.
#[derive(Clone, Debug, Serialize)]
pub struct BenchReport {
    /// The name of the scene.
    pub scene: String,
    /// The width and height in pixels.
    pub size: [u32; 2],
    /// The index of the camera.
    pub camera: usize,
    /// The number of threads.
    pub threads: usize,
    /// The machine that the benchmark ran on.
    pub machine: Machine,
    /// The reference that every image is compared with.
    pub reference: ReferenceSummary,
    /// The modes that were run: setup by setup, with ascending samples.
    pub modes: Vec<Row>,
    /// The modes that had no time for a single run.
    #[serde(rename = "left_out")]
    pub skipped: Vec<SkippedMode>,
    /// The images: first the reference, then the others in the order of the modes; equal images
    /// once.
    #[serde(skip)]
    pub images: Vec<ModeImage>,
}

/// The mode and the times of the reference.
#[derive(Clone, Debug, Serialize)]
pub struct ReferenceSummary {
    /// The name of its mode.
    pub mode: String,
    /// The samples per pixel.
    pub spp: u32,
    /// The time to build its intersector, once.
    pub build_ms: f64,
    /// The time to render it, once.
    pub render_ms: f64,
}

/// The times of a mode, and the error of its image.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The name, such as `embree fast 4 spp`.
    pub mode: String,
    /// The name of the ray tracing backend.
    pub backend: &'static str,
    /// The precision of the hits.
    pub precision: &'static str,
    /// The build quality of Embree's BVH; empty for the pure-Rust BVH.
    pub quality: &'static str,
    /// The samples per pixel, such as `4` or, where they are adaptive, `1..25`.
    pub samples: String,
    /// The number of runs.
    pub runs: usize,
    /// The median time to build the intersector, in milliseconds.
    pub build_ms: f64,
    /// The median time to render, in milliseconds.
    pub render_ms: f64,
    /// The sum of both medians.
    pub total_ms: f64,
    /// The root-mean-square error of the radiance.
    pub rmse: f64,
    /// The largest difference of the radiance.
    pub max: f64,
    /// The mean FLIP of the PNG.
    pub flip: f64,
    /// The number of pixels whose ray hits something else than a certified one.
    #[serde(rename = "hits_wrong")]
    pub wrong_hits: u64,
    /// The rank of the mode relative to the Pareto front.
    #[serde(rename = "standing")]
    pub rank: ParetoRank,
    /// The fastest mode that dominates this one, if any does.
    pub dominated_by: Option<String>,
}

/// The rank of a mode relative to the Pareto front.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ParetoRank {
    /// The front of time and RMSE: no other mode is as fast with as small an RMSE.
    Front,
    /// The front of time, RMSE and wrong hits, but not that of time and RMSE.
    #[serde(rename = "hits")]
    FewerWrongHits,
    /// A dominated mode: another is no slower, with no larger RMSE and no more wrong hits.
    Dominated,
}

/// A mode that was not run.
#[derive(Clone, Debug, Serialize)]
pub struct SkippedMode {
    /// The name of the mode.
    pub mode: String,
    /// The reason.
    pub reason: String,
}

/// An image as a PNG shows it, and its FLIP error map.
#[derive(Clone, Debug)]
pub struct ModeImage {
    /// The modes that render this image; none for the reference.
    pub modes: Vec<String>,
    /// The red, green and blue of each pixel.
    pub bytes: Vec<u8>,
    /// The FLIP of each pixel against the reference; empty for the reference.
    pub flip: Vec<f32>,
    /// The mean FLIP.
    pub mean: f64,
}

impl ParetoRank {
    /// Returns the name: `front`, `hits` or `dominated`.
    pub fn name(self) -> &'static str {
        match self {
            ParetoRank::Front => "front",
            ParetoRank::FewerWrongHits => "hits",
            ParetoRank::Dominated => "dominated",
        }
    }
}

impl BenchReport {
    /// Sums up the finished runs of all setups.
    pub(super) fn new(
        name: &str,
        scene: &Scene,
        options: &BenchOptions,
        reference: Reference,
        setups: Vec<SetupRuns>,
    ) -> Self {
        let summary = ReferenceSummary {
            mode: reference.mode.name(),
            spp: reference.mode.samples.max_spp(),
            build_ms: milliseconds(reference.build),
            render_ms: milliseconds(reference.render),
        };
        let bytes = reference.bytes;
        let mut images = vec![ModeImage { modes: Vec::new(), bytes, flip: Vec::new(), mean: 0.0 }];
        let (mut modes, mut skipped) = (Vec::new(), Vec::new());
        for mut setup in setups {
            for runs in std::mem::take(&mut setup.modes) {
                // A row, or the reason why there is none.
                let mode = runs.mode.name();
                let Some(row) = Row::new(&runs, &setup) else {
                    skipped.push(SkippedMode { mode, reason: setup.skip_reason(&runs.mode) });
                    continue;
                };
                modes.push(row);
                // The image, with all modes that render the same one.
                let Some(ImageError { bytes, flip: Flip { map: flip, mean }, .. }) = runs.error
                else {
                    continue;
                };
                match images[1..].iter_mut().find(|image| image.bytes == bytes) {
                    Some(image) => image.modes.push(mode),
                    None => images.push(ModeImage { modes: vec![mode], bytes, flip, mean }),
                }
            }
        }
        rank(&mut modes);
        Self {
            scene: name.to_owned(),
            size: scene.film.size,
            camera: options.camera,
            threads: rayon::current_num_threads(),
            machine: Machine::current(),
            reference: summary,
            modes,
            skipped,
            images,
        }
    }
}

impl Row {
    /// Returns the name of the setup, such as `embree fast`.
    pub fn setup(&self) -> &str {
        self.mode.strip_suffix(&format!(" {} spp", self.samples)).unwrap_or(&self.mode)
    }

    /// Creates the row of a mode, not yet ranked; none if the mode was not run.
    fn new(runs: &ModeRuns, setup: &SetupRuns) -> Option<Self> {
        let error = runs.error.as_ref()?;
        let Mode { setup: Setup { backend, precision, quality }, samples } = runs.mode;
        let (build_ms, render_ms) = (median(&setup.builds), median(&runs.renders));
        Some(Self {
            mode: runs.mode.name(),
            backend: backend.name(),
            precision: precision.name(),
            quality: quality.map_or("", |quality| quality.name()),
            samples: samples.name(),
            runs: runs.renders.len(),
            build_ms,
            render_ms,
            total_ms: round_to_nanoseconds(build_ms + render_ms),
            rmse: error.radiance.rmse,
            max: error.radiance.max,
            flip: error.flip.mean,
            wrong_hits: setup.wrong_hits?,
            rank: ParetoRank::Front,
            dominated_by: None,
        })
    }
}

/// Ranks the modes relative to the Pareto fronts of two and of three costs.
fn rank(rows: &mut [Row]) {
    let visible: Vec<_> = rows.iter().map(|r| [r.total_ms, r.rmse]).collect();
    let all: Vec<_> = rows.iter().map(|r| [r.total_ms, r.rmse, r.wrong_hits as f64]).collect();
    let names: Vec<String> = rows.iter().map(|r| r.mode.clone()).collect();
    let dominators = dominators(&visible).into_iter().zip(dominators(&all));
    for (row, (visible, all)) in rows.iter_mut().zip(dominators) {
        (row.rank, row.dominated_by) = match (visible, all) {
            (None, _) => (ParetoRank::Front, None),
            (_, None) => (ParetoRank::FewerWrongHits, None),
            (_, Some(other)) => (ParetoRank::Dominated, Some(names[other].clone())),
        };
    }
}

fn milliseconds(time: Duration) -> f64 {
    round_to_nanoseconds(time.as_secs_f64() * 1e3)
}

/// Returns milliseconds without the digits that no clock measures.
fn round_to_nanoseconds(milliseconds: f64) -> f64 {
    (milliseconds * 1e6).round() / 1e6
}

/// Returns the median in milliseconds: of an even number of times the mean of the two in the
/// middle, of none 0.
fn median(times: &[Duration]) -> f64 {
    let mut times: Vec<f64> = times.iter().copied().map(milliseconds).collect();
    times.sort_by(f64::total_cmp);
    let middle = times.len().saturating_sub(1) / 2..times.len() / 2 + 1;
    let middle = times.get(middle).unwrap_or_default();
    middle.iter().sum::<f64>() / middle.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_of_an_odd_and_an_even_number_of_times() {
        let of = |ms: &[u64]| {
            median(&ms.iter().map(|&ms| Duration::from_millis(ms)).collect::<Vec<_>>())
        };
        let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
        assert!(
            close(of(&[7, 1, 3]), 3.0) && close(of(&[8, 1, 3, 4]), 3.5) && close(of(&[2]), 2.0)
        );
        assert_eq!(of(&[]), 0.0);
    }
}
