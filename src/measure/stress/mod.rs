//! The numerical stability sweeps: what this renderer promises of its hits, tried where numbers
//! are at their worst, and judged by the exact oracle.
//!
//! A sweep is a set of cells; a cell tries rays of one kind and becomes a row of the report.
//! Random numbers come from (seed, goal, cell, ray), so that a run can be repeated on any number
//! of threads.

mod cell;
mod grazing;
mod leaks;
mod metamorphic;
mod naive;
mod paths;
mod plot;
mod random;
mod report;
mod resume;
mod shadows;
mod shapes;
mod spheres;
mod tangency;

use std::path::PathBuf;

use crate::error::Result;

pub use plot::plot;
pub use report::{Beside, Row, Table, Tally};
pub use spheres::{Method, certified};

use cell::Cell;
use resume::{Conditions, Finished};

/// What is promised; one sweep each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// Distances to spheres are exact, correctly rounded.
    SphereDistance,
    /// So they are at a tangent.
    Tangency,
    /// The trees find what trying every primitive finds.
    Traversal,
    /// Closed meshes have no holes.
    Watertight,
    /// Thin triangles met at a small angle.
    Grazing,
    /// Nothing shadows itself, and nothing close is passed over.
    SelfShadow,
    /// Scale and threads do not change a picture.
    Invariance,
}

impl Goal {
    /// All of them.
    pub const ALL: [Goal; 7] = [
        Goal::SphereDistance,
        Goal::Tangency,
        Goal::Traversal,
        Goal::Watertight,
        Goal::Grazing,
        Goal::SelfShadow,
        Goal::Invariance,
    ];

    /// What it is called: `SphereDistance` to `Invariance`.
    pub const fn name(self) -> &'static str {
        match self {
            Goal::SphereDistance => "G1",
            Goal::Tangency => "G2",
            Goal::Traversal => "G3",
            Goal::Watertight => "G4",
            Goal::Grazing => "G5",
            Goal::SelfShadow => "G6",
            Goal::Invariance => "G7",
        }
    }

    fn cells(self, method: Method) -> Vec<Cell> {
        match self {
            Goal::SphereDistance => spheres::cells(method),
            Goal::Tangency => tangency::cells(method),
            Goal::Traversal => paths::cells(),
            Goal::Watertight => leaks::cells(),
            Goal::Grazing => grazing::cells(),
            Goal::SelfShadow => shadows::cells(),
            Goal::Invariance => metamorphic::cells(),
        }
    }
}

/// What to try, and how much of it.
#[derive(Clone, Debug)]
pub struct Options {
    /// Which sweeps.
    pub goals: Vec<Goal>,
    /// Rays of each kind in a cell, at least 1; a sweep of few cells takes more, so that it has ten
    /// times as many in all.
    pub rays: u64,
    /// What the random numbers depend on.
    pub seed: u64,
    /// Where finished cells are kept, and looked up before they are tried.
    pub resume: Option<PathBuf>,
    /// What finds the distances to spheres in G1 and G2: [`certified`], unless a test wants to see
    /// the sweep fail.
    pub method: Method,
}

impl Options {
    /// Rays of a cell in a full run.
    pub const FULL: u64 = 100_000;
    /// Rays of a cell in a quick run: every cell, in less than a minute on two cores.
    pub const QUICK: u64 = 500;
}

impl Default for Options {
    fn default() -> Self {
        let (goals, rays) = (Goal::ALL.into(), Self::FULL);
        Self { goals, rays, seed: 1, resume: None, method: certified }
    }
}

/// Runs the sweeps. `progress` is called with the share done, in (0, 1], after each cell.
///
/// # Errors
/// When an intersector cannot be built, or the file of finished cells cannot be read or written.
pub fn stress(options: &Options, progress: &dyn Fn(f32)) -> Result<Vec<Row>> {
    let conditions = Conditions {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        embree: cfg!(feature = "embree"),
        seed: options.seed,
        size: options.rays,
    };
    let mut finished = Finished::open(options.resume.as_deref(), conditions)?;
    let sweeps: Vec<(Goal, Vec<Cell>)> =
        options.goals.iter().map(|goal| (*goal, goal.cells(options.method))).collect();
    let total: usize = sweeps.iter().map(|(_, cells)| cells.len()).sum();
    let mut rows = Vec::with_capacity(total);
    for (goal, cells) in &sweeps {
        let rays = options.rays.max((10 * options.rays).div_ceil(cells.len() as u64));
        for cell in cells {
            let row = match finished.row(goal.name(), &cell.name, &cell.method) {
                Some(row) => row.clone(),
                None => {
                    let row = cell.row(goal.name(), options.seed, rays)?;
                    finished.keep(&row)?;
                    row
                }
            };
            rows.push(row);
            progress(rows.len() as f32 / total as f32);
        }
    }
    Ok(rows)
}
