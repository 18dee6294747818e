//! The cases of a sweep: rays of one kind, and the errors that they may have.

use std::ops::Range;

use rayon::prelude::*;

use super::{CaseStats, Row, random::Random};
use crate::error::Result;

/// The number of rays that are generated and traced together.
const BATCH: u64 = 256;

/// A function that tests the rays of a case.
pub type Test = dyn Fn(&RaySampler) -> Result<CaseStats>;

/// A case: rays of one kind, and the errors that they may have.
pub struct Case {
    /// The name of the rays.
    pub name: String,
    /// The name of the method that is tested.
    pub method: String,
    /// The number of kinds of rays in the case, a factor of the number of its rays.
    pub kinds: u64,
    /// The largest error of a distance that passes, in ulp.
    pub max_ulp: f64,
    /// The largest relative error that passes.
    pub max_relative: f64,
    /// The test of the rays.
    pub test: Box<Test>,
}

impl Case {
    /// Creates a case in which no ray may be misclassified or have any error.
    pub fn new(
        name: impl Into<String>,
        method: impl Into<String>,
        test: impl Fn(&RaySampler) -> Result<CaseStats> + 'static,
    ) -> Self {
        let (name, method) = (name.into(), method.into());
        Self { name, method, kinds: 1, max_ulp: 0.0, max_relative: 0.0, test: Box::new(test) }
    }

    /// Tests about `rays` rays of each kind.
    ///
    /// # Errors
    /// When an intersector cannot be built.
    pub fn run(&self, goal: &str, seed: u64, rays: u64) -> Result<Row> {
        let case = format!("{goal}/{}", self.name);
        let stats = (self.test)(&RaySampler { seed, case, rays: rays * self.kinds })?;
        let passed = stats.rays > 0
            && stats.misclassified == 0
            && stats.max_ulp.is_none_or(|error| error <= self.max_ulp)
            && stats.max_relative.is_none_or(|error| error <= self.max_relative);
        let (goal, case, method) = (goal.to_owned(), self.name.clone(), self.method.clone());
        Ok(Row { goal, case, method, stats, passed })
    }
}

/// A generator of the random rays of a case.
pub struct RaySampler {
    seed: u64,
    case: String,
    /// The number of rays.
    pub rays: u64,
}

impl RaySampler {
    /// Returns random numbers for what all rays of the case share.
    pub fn shared_random(&self) -> Random {
        self.random(u64::MAX)
    }

    fn random(&self, index: u64) -> Random {
        Random::new(self.seed, &self.case, index)
    }

    /// Tests every ray, on all threads; `test` gets its index, its random numbers, and the
    /// statistics to count in.
    pub fn for_each_ray(
        &self,
        test: impl Fn(u64, &mut Random, &mut CaseStats) + Sync,
    ) -> CaseStats {
        self.for_each_range(|range, stats| {
            for index in range {
                test(index, &mut self.random(index), stats);
            }
        })
    }

    /// Generates batches of rays with `ray`, and tests each batch, on all threads.
    pub fn for_each_batch<R>(
        &self,
        ray: impl Fn(&mut Random) -> R + Sync,
        test: impl Fn(&[R], &mut CaseStats) + Sync,
    ) -> CaseStats {
        self.for_each_range(|range, stats| {
            let rays: Vec<R> = range.map(|index| ray(&mut self.random(index))).collect();
            test(&rays, stats);
        })
    }

    fn for_each_range(&self, test: impl Fn(Range<u64>, &mut CaseStats) + Sync) -> CaseStats {
        (0..self.rays.div_ceil(BATCH))
            .into_par_iter()
            .map(|batch| {
                let range = batch * BATCH..self.rays.min((batch + 1) * BATCH);
                let mut stats = CaseStats { rays: range.end - range.start, ..CaseStats::default() };
                test(range, &mut stats);
                stats
            })
            .reduce(CaseStats::default, CaseStats::merge)
    }
}
