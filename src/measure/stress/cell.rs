//! A cell: rays of one kind, and what has to hold for them.

use std::ops::Range;

use rayon::prelude::*;

use super::random::Random;
use super::report::{Row, Tally};
use crate::error::Result;

/// Rays that are tried together.
const BATCH: u64 = 256;

/// What tries the rays of a cell.
pub type Run = dyn Fn(&Draw) -> Result<Tally>;

/// Rays of one kind, and what has to hold for them.
pub struct Cell {
    /// Which rays.
    pub name: String,
    /// What is tested.
    pub method: String,
    /// How many times the usual number of rays it takes, because it holds several kinds.
    pub kinds: u64,
    /// The largest error of a distance that passes, in ulp.
    pub max_ulp: f64,
    /// The largest relative error that passes.
    pub max_relative: f64,
    /// Tries the rays.
    pub run: Box<Run>,
}

impl Cell {
    /// A cell in which no ray may come out wrong, and no error is bounded yet.
    pub fn new(
        name: impl Into<String>,
        method: impl Into<String>,
        run: impl Fn(&Draw) -> Result<Tally> + 'static,
    ) -> Self {
        let (name, method) = (name.into(), method.into());
        Self { name, method, kinds: 1, max_ulp: 0.0, max_relative: 0.0, run: Box::new(run) }
    }

    /// Tries about `rays` rays of each kind.
    ///
    /// # Errors
    /// When an intersector cannot be built.
    pub fn row(&self, goal: &str, seed: u64, rays: u64) -> Result<Row> {
        let draw = Draw { seed, cell: format!("{goal}/{}", self.name), rays: rays * self.kinds };
        let tally = (self.run)(&draw)?;
        let passed = tally.rays > 0
            && tally.misclassified == 0
            && tally.max_ulp.is_none_or(|error| error <= self.max_ulp)
            && tally.max_relative.is_none_or(|error| error <= self.max_relative);
        let (goal, cell, method) = (goal.to_owned(), self.name.clone(), self.method.clone());
        Ok(Row { goal, cell, method, tally, passed })
    }
}

/// The rays of a cell, to be drawn: how many, and by which random numbers.
pub struct Draw {
    seed: u64,
    cell: String,
    /// How many.
    pub rays: u64,
}

impl Draw {
    /// Random numbers for what all the rays of the cell share.
    pub fn shared(&self) -> Random {
        self.random(u64::MAX)
    }

    fn random(&self, index: u64) -> Random {
        Random::new(self.seed, &self.cell, index)
    }

    /// Tries every ray, on all threads; `each` gets its number, its random numbers, and what to
    /// count in.
    pub fn each(&self, each: impl Fn(u64, &mut Random, &mut Tally) + Sync) -> Tally {
        self.batches(|range, tally| {
            for index in range {
                each(index, &mut self.random(index), tally);
            }
        })
    }

    /// Makes the rays of batches with `ray`, and hands each batch to `try_all`.
    pub fn batch<R>(
        &self,
        ray: impl Fn(u64, &mut Random) -> R + Sync,
        try_all: impl Fn(&[R], &mut Tally) + Sync,
    ) -> Tally {
        self.batches(|range, tally| {
            let rays: Vec<R> = range.map(|index| ray(index, &mut self.random(index))).collect();
            try_all(&rays, tally);
        })
    }

    fn batches(&self, work: impl Fn(Range<u64>, &mut Tally) + Sync) -> Tally {
        (0..self.rays.div_ceil(BATCH))
            .into_par_iter()
            .map(|batch| {
                let range = batch * BATCH..self.rays.min((batch + 1) * BATCH);
                let mut tally = Tally { rays: range.end - range.start, ..Tally::default() };
                work(range, &mut tally);
                tally
            })
            .reduce(Tally::default, Tally::merge)
    }
}
