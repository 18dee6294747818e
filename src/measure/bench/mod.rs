//! Run time against error: every mode that a user can choose, timed and held against a reference,
//! which is certified and has many samples.
//!
//! Runs are interleaved: each round runs every mode once, so that what slows the machine for a
//! while slows them all. What is told of a mode is the median of its runs. Apart from times the
//! result is the same on every run.

mod front;
mod machine;
mod mode;
mod page;
mod plot;
mod reference;
mod report;
mod table;
mod trial;

use std::cell::Cell;
use std::time::Duration;

use crate::error::{Error, Result};
use crate::intersect::Precision;
use crate::render;
use crate::scene::{FilmSettings, Scene};

pub use front::dominators;
pub use machine::Machine;
pub use mode::{Mode, Samples, Setup};
pub use page::page;
pub use plot::plot;
pub use report::{LeftOut, Plate, Report, Row, Standing, Stated};

use reference::Reference;
use trial::Trial;

/// What to try.
#[derive(Clone, Debug)]
pub struct Options {
    /// What is built; at least one. The reference is made by the backend of the first.
    pub setups: Vec<Setup>,
    /// How many samples a pixel has, each tried with every setup; each at least 1, regular ones
    /// ascending and first.
    pub samples: Vec<Samples>,
    /// Samples per pixel of the reference, no fewer than those of any mode.
    pub reference_spp: u32,
    /// Runs of each mode, at least 1.
    pub runs: u32,
    /// How long the runs of a mode may take together. One that has no time for all its runs has
    /// fewer, one that would take longer for a single run is left out.
    pub budget: Duration,
    /// How many threads; 0 means all there are.
    pub threads: usize,
    /// Which of the scene's cameras.
    pub camera: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            setups: Setup::all(),
            samples: [1, 4, 16]
                .map(Samples::Regular)
                .into_iter()
                .chain([Samples::Adaptive(1, 25), Samples::Adaptive(4, 36)])
                .collect(),
            reference_spp: 64,
            runs: 5,
            budget: Duration::from_secs(60),
            threads: 0,
            camera: 0,
        }
    }
}

impl Options {
    /// Checks that they make sense together.
    ///
    /// # Errors
    /// When they do not.
    pub fn check(&self) -> Result<()> {
        self.reference().map(drop)
    }

    /// How the reference is made.
    fn reference(&self) -> Result<Mode> {
        let Some(first) = self.setups.first() else {
            return Err(Error::input("there is nothing to try"));
        };
        let none = FilmSettings::default();
        if self.runs == 0 || self.samples.iter().any(|samples| samples.film(&none).spp == 0) {
            return Err(Error::input("a mode has at least one run, of at least one sample"));
        }
        let most = self.samples.iter().map(|samples| samples.most()).max().unwrap_or(1);
        if most > self.reference_spp {
            return Err(Error::input(format!(
                "the reference has {} samples per pixel, and a mode {most}",
                self.reference_spp
            ))
            .help(format!("give it --reference-spp {}, or more", 4 * most)));
        }
        let setup = Setup { precision: Precision::Certified, ..*first };
        Ok(Mode { setup, samples: Samples::Regular(self.reference_spp) })
    }
}

/// Times every mode on a scene (of an animated one, the first moment) called `name`, and holds its
/// picture against the reference. `progress` is called with the share done, in \[0, 1\].
///
/// # Errors
/// When the scene is not valid or has no such camera, when the options make no sense together, or
/// an intersector cannot be built.
pub fn bench(
    name: &str,
    scene: &Scene,
    options: &Options,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Report> {
    let reference = options.reference()?;
    scene.check()?;
    render::check_camera(scene, options.camera)?;
    let scene = &scene.at_time(0.0)?;
    render::in_pool(options.threads, || {
        let of_modes: f64 = options.samples.iter().map(|samples| f64::from(samples.most())).sum();
        let of_modes = of_modes * options.setups.len() as f64 * f64::from(options.runs);
        let of_reference = f64::from(options.reference_spp);
        let total = of_reference + of_modes;
        let share = |share: f32| progress((f64::from(share) * of_reference / total) as f32);
        let stated = Reference::new(scene, reference, options.camera, &share)?;
        let trials = options.setups.iter().map(|&setup| Trial::new(scene, options, setup));
        let mut trials: Vec<Trial> = trials.collect();
        let done = Cell::new(of_reference);
        let step = |mode: &Mode| {
            done.set(done.get() + f64::from(mode.samples.most()));
            progress((done.get() / total) as f32);
        };
        for _ in 0..options.runs {
            for trial in &mut trials {
                trial.round(&stated, &step)?;
            }
        }
        Ok(Report::new(name, scene, options, (reference, stated), trials))
    })
}
