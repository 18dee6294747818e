//! The numerical stress test: sweeps over rays for which rounding errors are worst, checked against
//! the exact oracle.
//!
//! A sweep is a set of cases, each with rays of one kind, which become the rows of the report.
//! Random numbers are determined by seed, goal, case and ray, so that a run can be repeated on any
//! number of threads.

mod backends;
mod case;
mod enclosure;
mod far_detail;
mod flat_caps;
mod grazing;
mod invariance;
mod lamp_on_surface;
mod meshes;
mod order;
mod plot;
mod random;
mod report;
mod resume;
mod scale;
mod self_shadow;
mod sphere_distance;
mod tangency;
mod textbook;
mod traversal;
mod watertight;

use std::path::PathBuf;

use crate::error::Result;
use crate::intersect::Backend;

pub use plot::plot;
pub use report::{BaselineStats, CaseStats, Row, Table};
pub use sphere_distance::{Method, certified};

use case::Case;
use resume::{FinishedCases, RunConditions};

/// A goal: something that the renderer promises about its hits, tested by one sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// G1: distances to spheres are exact, correctly rounded.
    SphereDistance,
    /// G2: distances to spheres are exact for tangents and rays close to a tangent, too.
    Tangency,
    /// G3: the traversal of a BVH finds the same hits as brute force.
    Traversal,
    /// G4: closed meshes have no holes.
    Watertight,
    /// G5: thin triangles hit at a grazing angle are found, at the right distance.
    Grazing,
    /// G6: no surface shadows itself, and no occluder close to a surface is missed.
    SelfShadow,
    /// G7: scale, threads and tiles do not change a picture.
    Invariance,
    /// G8: surfaces a few ulp apart are hit in their order.
    Order,
    /// G9: a lamp on a surface lights what it sees.
    LampOnSurface,
    /// G10: no light leaves a closed mesh.
    Enclosure,
    /// G11: nothing passes through flat caps, or through planes given by far points.
    FlatCaps,
    /// G12: hits do not change with the scale of the scene.
    Scale,
    /// G13: fine details far from the origin of coordinates are hit exactly.
    FarDetail,
}

impl Goal {
    /// All goals, from G1 to G13.
    pub const ALL: [Goal; 13] = [
        Goal::SphereDistance,
        Goal::Tangency,
        Goal::Traversal,
        Goal::Watertight,
        Goal::Grazing,
        Goal::SelfShadow,
        Goal::Invariance,
        Goal::Order,
        Goal::LampOnSurface,
        Goal::Enclosure,
        Goal::FlatCaps,
        Goal::Scale,
        Goal::FarDetail,
    ];

    /// Returns the name, `G1` to `G13`.
    pub const fn name(self) -> &'static str {
        ["G1", "G2", "G3", "G4", "G5", "G6", "G7", "G8", "G9", "G10", "G11", "G12", "G13"]
            [self as usize]
    }

    /// Returns the most rays of a case, which is less where the oracle takes a tenth of a millisecond or
    /// more for each.
    const fn max_rays(self) -> u64 {
        match self {
            Goal::Order | Goal::FarDetail => 20_000,
            _ => u64::MAX,
        }
    }

    fn cases(self, method: Method) -> Vec<Case> {
        match self {
            Goal::SphereDistance => sphere_distance::cases(method),
            Goal::Tangency => tangency::cases(method),
            Goal::Traversal => traversal::cases(),
            Goal::Watertight => watertight::cases(),
            Goal::Grazing => grazing::cases(),
            Goal::SelfShadow => self_shadow::cases(),
            Goal::Invariance => invariance::cases(),
            Goal::Order => order::cases(),
            Goal::LampOnSurface => lamp_on_surface::cases(),
            Goal::Enclosure => enclosure::cases(),
            Goal::FlatCaps => flat_caps::cases(),
            Goal::Scale => scale::cases(),
            Goal::FarDetail => far_detail::cases(),
        }
    }
}

/// The sweeps to run, and the number of their rays.
#[derive(Clone, Debug)]
pub struct StressOptions {
    /// The goals to test.
    pub goals: Vec<Goal>,
    /// The number of rays of each kind in a case, at least 1; a sweep of fewer than ten cases gets
    /// more, so that it has ten times as many in all, and some sweeps have fewer.
    pub rays: u64,
    /// The seed of the random numbers.
    pub seed: u64,
    /// The file in which finished cases are recorded; cases found there are not run again.
    pub resume: Option<PathBuf>,
    /// The method that is tested for G1 and G2: [`certified`], except in tests that need a sweep to
    /// fail.
    pub method: Method,
}

impl StressOptions {
    /// The rays of a case in a full run.
    pub const FULL: u64 = 100_000;
    /// The rays of a case in a quick run: every case, in less than a minute on two cores.
    pub const QUICK: u64 = 500;
}

impl Default for StressOptions {
    fn default() -> Self {
        let (goals, rays) = (Goal::ALL.into(), Self::FULL);
        Self { goals, rays, seed: 1, resume: None, method: certified }
    }
}

/// Runs the sweeps. `progress` is called with the share done, in (0, 1], after each case.
///
/// # Errors
/// When an intersector cannot be built, or the file of finished cases cannot be read or written.
pub fn run(options: &StressOptions, progress: &dyn Fn(f32)) -> Result<Vec<Row>> {
    let conditions = RunConditions {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        embree: Backend::available().len() > 1,
        seed: options.seed,
        size: options.rays,
    };
    // The cases of an earlier run under the same conditions.
    let mut finished = FinishedCases::open(options.resume.as_deref(), conditions)?;
    // The cases of all sweeps, whose number tells the share that is done.
    let sweeps: Vec<(Goal, Vec<Case>)> =
        options.goals.iter().map(|goal| (*goal, goal.cases(options.method))).collect();
    let total: usize = sweeps.iter().map(|(_, cases)| cases.len()).sum();
    let mut rows = Vec::with_capacity(total);
    for (goal, cases) in &sweeps {
        // A sweep of few cases tests more rays in each.
        let rays = options.rays.max((10 * options.rays).div_ceil(cases.len() as u64));
        let rays = rays.min(goal.max_rays());
        for case in cases {
            let row = match finished.row(goal.name(), case) {
                Some(row) => row.clone(),
                None => {
                    let row = case.run(goal.name(), options.seed, rays)?;
                    finished.append(&row)?;
                    row
                }
            };
            rows.push(row);
            progress(rows.len() as f32 / total as f32);
        }
    }
    Ok(rows)
}
