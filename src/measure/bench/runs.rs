//! The timed runs of all modes that share a setup.

use std::time::{Duration, Instant};

use super::BenchOptions;
use super::mode::{Mode, Samples, Setup};
use super::reference::{ImageError, Reference};
use crate::error::Result;
use crate::intersect::Intersector;
use crate::render::{Renderer, Traced};
use crate::scene::{FilmSettings, Scene};

/// The factor by which the sides of the picture for the first estimate of render times are smaller.
const ESTIMATE_REDUCTION: u32 = 8;

/// The runs of a setup.
pub struct SetupRuns<'a> {
    scene: &'a Scene,
    options: &'a BenchOptions,
    setup: Setup,
    /// The time to build the intersector in each round.
    pub builds: Vec<Duration>,
    /// The estimated time to render one sample of every pixel.
    sample_time: Duration,
    /// The number of pixels whose ray hits something else than in the reference, once a mode was
    /// run.
    pub wrong_hits: Option<u64>,
    /// The runs of each mode, in the order of [`BenchOptions::samples`].
    pub modes: Vec<ModeRuns>,
}

/// The runs of a mode.
pub struct ModeRuns {
    /// The mode.
    pub mode: Mode,
    /// The time to render in each run.
    pub renders: Vec<Duration>,
    /// The time to build and render in all runs.
    spent: Duration,
    /// The error of the picture, once the mode was run; every run renders the same picture.
    pub error: Option<ImageError>,
}

impl<'a> SetupRuns<'a> {
    /// Creates the record of a setup before its first run.
    pub fn new(scene: &'a Scene, options: &'a BenchOptions, setup: Setup) -> Self {
        let mode_runs = |&samples: &Samples| ModeRuns {
            mode: Mode { setup, samples },
            renders: Vec::new(),
            spent: Duration::ZERO,
            error: None,
        };
        Self {
            scene,
            options,
            setup,
            builds: Vec::new(),
            sample_time: Duration::ZERO,
            wrong_hits: None,
            modes: options.samples.iter().map(mode_runs).collect(),
        }
    }

    /// Builds the intersector, and runs each mode once that fits its time budget. `step` is called
    /// after each mode, run or not.
    ///
    /// # Errors
    /// When the intersector cannot be built.
    pub fn run_round(&mut self, reference: &Reference, step: &dyn Fn(&Mode)) -> Result<()> {
        if !self.modes.iter().any(|runs| self.fits_budget(runs, self.build_time())) {
            self.modes.iter().for_each(|runs| step(&runs.mode));
            return Ok(());
        }
        let start = Instant::now();
        let intersector = self.setup.build(self.scene)?;
        let build = start.elapsed();
        self.builds.push(build);
        if self.builds.len() == 1 {
            self.estimate_sample_time(&*intersector);
        }
        for i in 0..self.modes.len() {
            if self.fits_budget(&self.modes[i], build) {
                self.run_mode(i, &*intersector, build, reference)?;
            }
            step(&self.modes[i].mode);
        }
        Ok(())
    }

    /// Estimates the time of a sample of every pixel from a small picture.
    fn estimate_sample_time(&mut self, intersector: &dyn Intersector) {
        let full = self.scene.film.size;
        let size = full.map(|n| n.div_ceil(ESTIMATE_REDUCTION));
        let film = FilmSettings { size, ..Samples::Regular(1).film(&self.scene.film) };
        let small = Scene { film, ..self.scene.clone() };
        self.render(&small, intersector); // Warms up the caches.
        let time = self.render(&small, intersector).elapsed.wall;
        let pixels = |[w, h]: [u32; 2]| f64::from(w) * f64::from(h);
        self.sample_time = time.mul_f64(pixels(full) / pixels(size));
    }

    /// Runs the mode with the given index, and compares its picture with the reference.
    fn run_mode(
        &mut self,
        index: usize,
        intersector: &dyn Intersector,
        build: Duration,
        reference: &Reference,
    ) -> Result<()> {
        // Render the picture, whose time also corrects the estimate for later modes.
        let mode = self.modes[index].mode;
        let scene = Scene { film: mode.samples.film(&self.scene.film), ..self.scene.clone() };
        let Traced { film, elapsed, .. } = self.render(&scene, intersector);
        let duration = elapsed.wall;
        if let Samples::Regular(spp) = mode.samples {
            self.sample_time = duration / spp;
        }
        // The hits are those of the setup, whatever the number of samples.
        if self.wrong_hits.is_none() {
            let camera = self.options.camera;
            self.wrong_hits = Some(reference.wrong_hits(self.scene, camera, intersector));
        }
        // Record the run, and compare its picture the first time.
        let runs = &mut self.modes[index];
        runs.renders.push(duration);
        runs.spent += build + duration;
        if runs.error.is_none() {
            runs.error = Some(reference.error(&film, &scene)?);
        }
        Ok(())
    }

    fn render(&self, scene: &Scene, intersector: &dyn Intersector) -> Traced {
        Renderer::new(scene).camera(self.options.camera).render_with(intersector)
    }

    fn build_time(&self) -> Duration {
        self.builds.last().copied().unwrap_or_default()
    }

    /// Returns the estimated time of a run of the mode; for an adaptive mode an upper bound.
    fn expected_time(&self, mode: &Mode, build: Duration) -> Duration {
        build + self.sample_time * mode.samples.max_spp()
    }

    /// True if another run of the mode fits its time budget.
    fn fits_budget(&self, runs: &ModeRuns, build: Duration) -> bool {
        runs.spent + self.expected_time(&runs.mode, build) <= self.options.budget
    }

    /// Returns the reason why a mode was skipped.
    pub fn skip_reason(&self, mode: &Mode) -> String {
        let expected = self.expected_time(mode, self.build_time()).as_secs_f64();
        let budget = self.options.budget.as_secs_f64();
        format!(
            "one run would take about {expected:.1} s, the budget of all its runs is {budget:.1} s"
        )
    }
}
