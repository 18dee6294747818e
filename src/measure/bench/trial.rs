//! The runs of the modes that share a setup.

use std::time::{Duration, Instant};

use super::Options;
use super::mode::{Mode, Samples, Setup};
use super::reference::{Distance, Reference};
use crate::error::Result;
use crate::intersect::Intersector;
use crate::render::{Renderer, Traced};
use crate::scene::{FilmSettings, Scene};

/// By how much smaller, each way, the picture is that tells how long the others will take.
const PROBE: u32 = 8;

/// What is tried of one setup.
pub struct Trial<'a> {
    scene: &'a Scene,
    options: &'a Options,
    setup: Setup,
    /// How long building took, in each round.
    pub builds: Vec<Duration>,
    /// How long one sample of every pixel takes, as far as is known.
    pace: Duration,
    /// Pixels whose ray hits something else than the reference's, once a mode was run.
    pub wrong_hits: Option<u64>,
    /// In the order of the samples.
    pub modes: Vec<Attempt>,
}

/// What is tried of one mode.
pub struct Attempt {
    /// The mode.
    pub mode: Mode,
    /// How long rendering took, in each run.
    pub renders: Vec<Duration>,
    /// Building and rendering, of all runs.
    spent: Duration,
    /// How far its picture is from the reference, once it was run; every run makes the same one.
    pub distance: Option<Distance>,
}

impl<'a> Trial<'a> {
    pub fn new(scene: &'a Scene, options: &'a Options, setup: Setup) -> Self {
        let attempt = |&samples: &Samples| Attempt {
            mode: Mode { setup, samples },
            renders: Vec::new(),
            spent: Duration::ZERO,
            distance: None,
        };
        let modes = options.samples.iter().map(attempt).collect();
        let (builds, pace) = (Vec::new(), Duration::ZERO);
        Self { scene, options, setup, builds, pace, wrong_hits: None, modes }
    }

    /// Builds the setup, and runs each of its modes once that still has time.
    pub fn round(&mut self, reference: &Reference, step: &dyn Fn(&Mode)) -> Result<()> {
        if self.modes.iter().any(|attempt| self.has_time(attempt, self.build_time())) {
            let start = Instant::now();
            let intersector = self.setup.build(self.scene)?;
            let build = start.elapsed();
            self.builds.push(build);
            if self.builds.len() == 1 {
                self.look_ahead(&*intersector);
            }
            for i in 0..self.modes.len() {
                if self.has_time(&self.modes[i], build) {
                    self.run(i, &*intersector, build, reference)?;
                }
                step(&self.modes[i].mode);
            }
        } else {
            self.modes.iter().for_each(|attempt| step(&attempt.mode));
        }
        Ok(())
    }

    /// Finds out from a small picture how long a sample takes.
    fn look_ahead(&mut self, by: &dyn Intersector) {
        let size = self.scene.film.size.map(|n| n.div_ceil(PROBE));
        let [whole, part] = [self.scene.film.size, size].map(|[w, h]| f64::from(w) * f64::from(h));
        let mut small = self.scene.clone();
        small.film = FilmSettings { size, ..Samples::Regular(1).film(&small.film) };
        // Once to warm up.
        let [_, measured] = [(); 2].map(|()| self.render(&small, by));
        self.pace = measured.duration.mul_f64(whole / part);
    }

    fn run(
        &mut self,
        index: usize,
        by: &dyn Intersector,
        build: Duration,
        reference: &Reference,
    ) -> Result<()> {
        let mode = self.modes[index].mode;
        let scene = Scene { film: mode.samples.film(&self.scene.film), ..self.scene.clone() };
        let Traced { film, duration: time, .. } = self.render(&scene, by);
        if let Samples::Regular(spp) = mode.samples {
            self.pace = time / spp;
        }
        let (whole, camera) = (self.scene, self.options.camera);
        self.wrong_hits.get_or_insert_with(|| reference.wrong_hits(whole, camera, by));
        let attempt = &mut self.modes[index];
        attempt.renders.push(time);
        attempt.spent += build + time;
        if attempt.distance.is_none() {
            attempt.distance = Some(reference.distance(&film, &scene)?);
        }
        Ok(())
    }

    fn render(&self, scene: &Scene, intersector: &dyn Intersector) -> Traced {
        Renderer::new(scene).camera(self.options.camera).render_with(intersector)
    }

    fn build_time(&self) -> Duration {
        self.builds.last().copied().unwrap_or_default()
    }

    /// How long a run of the mode will take; of an adaptive one, at most.
    fn expected(&self, mode: &Mode, build: Duration) -> Duration {
        build + self.pace * mode.samples.most()
    }

    /// Whether the mode has time for another run.
    fn has_time(&self, attempt: &Attempt, build: Duration) -> bool {
        attempt.spent + self.expected(&attempt.mode, build) <= self.options.budget
    }

    /// Why a mode that was not run was not.
    pub fn why_left_out(&self, mode: &Mode) -> String {
        let expected = self.expected(mode, self.build_time()).as_secs_f64();
        let budget = self.options.budget.as_secs_f64();
        format!("one run would take about {expected:.1} s, and all its runs may take {budget:.1} s")
    }
}
