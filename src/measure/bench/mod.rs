//! The benchmark of run time against error: every mode that a user can choose, timed and compared
//! with a reference image that has certified hits and many samples.
//!
//! The runs of the modes are interleaved: each round runs every mode once, so that whatever slows
//! the machine for a while slows them all. The reported times are medians. All results but times
//! are the same on every run.

mod html;
mod machine;
mod mode;
mod pareto;
mod plot;
mod reference;
mod report;
mod runs;
mod table;

use std::cell::Cell;
use std::time::Duration;

use crate::error::{Error, Remedy, Result};
use crate::intersect::Precision;
use crate::render;
use crate::scene::{FilmSettings, Scene};

pub use html::html;
pub use machine::Machine;
pub use mode::{Mode, Samples, Setup};
pub use pareto::dominators;
pub use plot::plot;
pub use report::{BenchReport, ModeImage, ParetoRank, ReferenceSummary, Row, SkippedMode};

use reference::Reference;
use runs::SetupRuns;

/// The modes to compare, and the effort to spend.
#[derive(Clone, Debug)]
pub struct BenchOptions {
    /// The intersectors; at least one. The reference is rendered with the backend of the first.
    pub setups: Vec<Setup>,
    /// The numbers of samples per pixel, each tried with every setup; each at least 1, regular ones
    /// ascending and first.
    pub samples: Vec<Samples>,
    /// The samples per pixel of the reference, no fewer than those of any mode.
    pub reference_spp: u32,
    /// The number of runs of each mode, at least 1.
    pub runs: u32,
    /// The time that all runs of a mode may take together. A mode that would exceed it gets fewer
    /// runs, or is skipped where a single run would exceed it.
    pub budget: Duration,
    /// The number of threads; 0 means all there are.
    pub threads: usize,
    /// The index of the camera.
    pub camera: usize,
}

impl Default for BenchOptions {
    fn default() -> Self {
        let adaptive = [(1, 25), (4, 36)].map(|(min, max)| Samples::Adaptive { min, max });
        Self {
            setups: Setup::all(),
            samples: [1, 4, 16].map(Samples::Regular).into_iter().chain(adaptive).collect(),
            reference_spp: 64,
            runs: 5,
            budget: Duration::from_secs(60),
            threads: 0,
            camera: 0,
        }
    }
}

impl BenchOptions {
    /// Returns options for a quick benchmark, with fewer samples and runs.
    pub fn quick() -> Self {
        let adaptive = Samples::Adaptive { min: 1, max: 9 };
        let samples = vec![Samples::Regular(1), Samples::Regular(4), adaptive];
        Self { samples, reference_spp: 16, runs: 3, ..Self::default() }
    }

    /// Checks that the options are consistent.
    ///
    /// # Errors
    /// When there is no setup, no run or no sample, or a mode has more samples than the reference.
    pub fn check(&self) -> Result<()> {
        self.reference().map(drop)
    }

    /// Returns the mode of the reference image.
    fn reference(&self) -> Result<Mode> {
        let Some(first) = self.setups.first() else {
            return Err(Error::input("there is no backend to benchmark"));
        };
        let film = FilmSettings::default();
        if self.runs == 0 || self.samples.iter().any(|samples| samples.film(&film).spp == 0) {
            return Err(Error::input("a mode needs at least one run and one sample per pixel"));
        }
        let max_spp = self.samples.iter().map(|samples| samples.max_spp()).max().unwrap_or(1);
        if max_spp > self.reference_spp {
            return Err(Error::input(format!(
                "the reference has {} samples per pixel, fewer than a mode with {max_spp}",
                self.reference_spp
            ))
            .help("give the reference more samples")
            .remedied_by(Remedy::ReferenceSamples(4 * max_spp)));
        }
        let setup = Setup { precision: Precision::Certified, ..*first };
        Ok(Mode { setup, samples: Samples::Regular(self.reference_spp) })
    }
}

/// Benchmarks every mode on a scene called `name`; an animated scene is that of its first frame.
/// `progress` is called with the share done, in \[0, 1\].
///
/// # Errors
/// When the scene is not valid or has no such camera, when the options are inconsistent, or an
/// intersector cannot be built.
pub fn run(
    name: &str,
    scene: &Scene,
    options: &BenchOptions,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<BenchReport> {
    let mode = options.reference()?;
    scene.check()?;
    render::check_camera(scene, options.camera)?;
    let scene = &scene.at_time(0.0)?;
    render::in_pool(options.threads, || {
        // Progress counts samples per pixel.
        let round: f64 = options.samples.iter().map(|samples| f64::from(samples.max_spp())).sum();
        let reference_work = f64::from(options.reference_spp);
        let total = reference_work + round * options.setups.len() as f64 * f64::from(options.runs);

        let reference_progress =
            |share: f32| progress((f64::from(share) * reference_work / total) as f32);
        let reference = Reference::render(scene, mode, options.camera, &reference_progress)?;

        let done = Cell::new(reference_work);
        let step = |mode: &Mode| {
            done.set(done.get() + f64::from(mode.samples.max_spp()));
            progress((done.get() / total) as f32);
        };
        // Each round runs every mode once, so that what slows the machine slows all.
        let mut runs: Vec<SetupRuns> =
            options.setups.iter().map(|&setup| SetupRuns::new(scene, options, setup)).collect();
        for _ in 0..options.runs {
            for setup in &mut runs {
                setup.run_round(&reference, &step)?;
            }
        }
        Ok(BenchReport::new(name, scene, options, reference, runs))
    })
}
