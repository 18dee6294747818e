//! What a bench found: rows and pictures.

use std::time::Duration;

use serde::Serialize;

use super::front::dominators;
use super::machine::Machine;
use super::mode::Mode;
use super::reference::Reference;
use super::trial::{Attempt, Trial};
use super::{Options, Setup};
use crate::scene::Scene;

/// What a bench found.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// What the scene is called.
    pub scene: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Which camera, by its index.
    pub camera: usize,
    /// Threads used.
    pub threads: usize,
    /// The machine that was measured.
    pub machine: Machine,
    /// What every picture was held against.
    pub reference: Stated,
    /// The modes that were run: setup by setup, with ascending samples.
    pub modes: Vec<Row>,
    /// The modes that had no time for a single run.
    pub left_out: Vec<LeftOut>,
    /// The pictures, the reference's first; the others in the order of the modes, equal ones once.
    #[serde(skip)]
    pub plates: Vec<Plate>,
}

/// How the reference was made.
#[derive(Clone, Debug, Serialize)]
pub struct Stated {
    /// Its mode.
    pub mode: String,
    /// Samples per pixel.
    pub spp: u32,
    /// Time to build its intersector, once.
    pub build_ms: f64,
    /// Time to render it, once.
    pub render_ms: f64,
}

/// One mode: what it takes, and how far its picture is from the reference.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// What it is called, such as `embree fast 4 spp`.
    pub mode: String,
    /// Who finds the hits.
    pub backend: &'static str,
    /// How far hits can be trusted.
    pub precision: &'static str,
    /// How good Embree's trees are; empty where there is no Embree.
    pub quality: &'static str,
    /// Samples per pixel, such as `4` or, where they are adaptive, `1..25`.
    pub samples: String,
    /// How often it was run.
    pub runs: usize,
    /// Median time to build the intersector, in milliseconds.
    pub build_ms: f64,
    /// Median time to render, in milliseconds.
    pub render_ms: f64,
    /// Both together.
    pub total_ms: f64,
    /// Root of the mean squared difference of the radiance.
    pub rmse: f64,
    /// Largest difference of the radiance.
    pub max: f64,
    /// Mean FLIP of the PNG.
    pub flip: f64,
    /// Pixels whose ray hits something else than a certified one.
    pub hits_wrong: u64,
    /// What speaks for it.
    pub standing: Standing,
    /// The fastest mode that is no worse in anything, if it is dominated.
    pub dominated_by: Option<String>,
}

/// What speaks for a mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// No other is as fast with as small an RMSE.
    Front,
    /// One is, but has more wrong hits.
    Hits,
    /// Another is no slower, with no larger an RMSE and no more wrong hits.
    Dominated,
}

/// A mode that was not run.
#[derive(Clone, Debug, Serialize)]
pub struct LeftOut {
    /// What it is called.
    pub mode: String,
    /// Why.
    pub reason: String,
}

/// A picture, as a PNG shows it, and where it differs from the reference.
#[derive(Clone, Debug)]
pub struct Plate {
    /// The modes that make it.
    pub modes: Vec<String>,
    /// Red, green, blue of each pixel.
    pub bytes: Vec<u8>,
    /// FLIP of each pixel; empty for the reference.
    pub flip: Vec<f32>,
    /// The mean of it.
    pub mean: f64,
}

impl Standing {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Standing::Front => "front",
            Standing::Hits => "hits",
            Standing::Dominated => "dominated",
        }
    }
}

impl Report {
    pub(super) fn new(
        name: &str,
        scene: &Scene,
        options: &Options,
        (mode, reference): (Mode, Reference),
        trials: Vec<Trial>,
    ) -> Self {
        let stated = Stated {
            mode: mode.name(),
            spp: mode.samples.most(),
            build_ms: milliseconds(reference.build),
            render_ms: milliseconds(reference.render),
        };
        let bytes = reference.bytes;
        let mut plates = vec![Plate { modes: Vec::new(), bytes, flip: Vec::new(), mean: 0.0 }];
        let (mut modes, mut left_out) = (Vec::new(), Vec::new());
        for trial in trials {
            for attempt in &trial.modes {
                match Row::new(attempt, &trial) {
                    Some(row) => modes.push(row),
                    None => left_out.push(LeftOut {
                        mode: attempt.mode.name(),
                        reason: trial.why_left_out(&attempt.mode),
                    }),
                }
            }
            let made = trial.modes.into_iter().filter_map(|a| Some((a.mode.name(), a.distance?)));
            for (mode, distance) in made {
                match plates[1..].iter_mut().find(|plate| plate.bytes == distance.bytes) {
                    Some(plate) => plate.modes.push(mode),
                    None => plates.push(Plate {
                        modes: vec![mode],
                        bytes: distance.bytes,
                        flip: distance.flip.map,
                        mean: distance.flip.mean,
                    }),
                }
            }
        }
        judge(&mut modes);
        Self {
            scene: name.to_owned(),
            size: scene.film.size,
            camera: options.camera,
            threads: rayon::current_num_threads(),
            machine: Machine::here(),
            reference: stated,
            modes,
            left_out,
            plates,
        }
    }
}

impl Row {
    /// What was built for it, such as `embree fast`.
    pub fn setup(&self) -> &str {
        self.mode.strip_suffix(&format!(" {} spp", self.samples)).unwrap_or(&self.mode)
    }

    /// None where the mode was not run.
    fn new(attempt: &Attempt, trial: &Trial) -> Option<Self> {
        let distance = attempt.distance.as_ref()?;
        let Mode { setup: Setup { backend, precision, quality }, samples } = attempt.mode;
        let (build_ms, render_ms) = (median(&trial.builds), median(&attempt.renders));
        Some(Self {
            mode: attempt.mode.name(),
            backend: backend.name(),
            precision: precision.name(),
            quality: quality.map_or("", |quality| quality.name()),
            samples: samples.name(),
            runs: attempt.renders.len(),
            build_ms,
            render_ms,
            total_ms: whole_nanoseconds(build_ms + render_ms),
            rmse: distance.radiance.rmse,
            max: distance.radiance.max,
            flip: distance.flip.mean,
            hits_wrong: trial.wrong_hits?,
            standing: Standing::Front,
            dominated_by: None,
        })
    }
}

/// Finds out what speaks for each mode.
fn judge(rows: &mut [Row]) {
    let seen: Vec<_> = rows.iter().map(|r| [r.total_ms, r.rmse]).collect();
    let all: Vec<_> = rows.iter().map(|r| [r.total_ms, r.rmse, r.hits_wrong as f64]).collect();
    let names: Vec<String> = rows.iter().map(|r| r.mode.clone()).collect();
    let (seen, all) = (dominators(&seen), dominators(&all));
    for ((row, seen), all) in rows.iter_mut().zip(seen).zip(all) {
        row.standing = match (seen, all) {
            (None, _) => Standing::Front,
            (_, None) => Standing::Hits,
            _ => Standing::Dominated,
        };
        row.dominated_by =
            all.filter(|_| row.standing == Standing::Dominated).map(|i| names[i].clone());
    }
}

fn milliseconds(time: Duration) -> f64 {
    whole_nanoseconds(time.as_secs_f64() * 1e3)
}

/// Milliseconds without digits that no clock gave.
fn whole_nanoseconds(milliseconds: f64) -> f64 {
    (milliseconds * 1e6).round() / 1e6
}

/// The median in milliseconds, of an even number of times the mean of the two in the middle; 0 of
/// none.
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
