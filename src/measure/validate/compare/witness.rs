//! The rays that mirrors and glass send on, held against the judge while the judge's picture is
//! made of them.

use std::sync::Mutex;

use super::{Comparer, Tally};
use crate::geometry::{Hit, Ray};
use crate::intersect::{Coherence, Intersector};

/// Answers as the judge does, and compares what the subject says of every ray after a bounce.
pub struct Witness<'a> {
    comparer: &'a Comparer<'a>,
    tally: Mutex<Tally>,
}

impl<'a> Witness<'a> {
    pub fn new(comparer: &'a Comparer<'a>) -> Self {
        Self { comparer, tally: Mutex::default() }
    }

    pub fn tally(self) -> Tally {
        // A poisoned lock still holds the counts; the panic that caused it is reported anyway.
        self.tally.into_inner().unwrap_or_else(|e| e.into_inner())
    }
}

impl Intersector for Witness<'_> {
    fn name(&self) -> &'static str {
        self.comparer.judge.name()
    }

    fn version(&self) -> String {
        self.comparer.judge.version()
    }

    fn closest(&self, rays: &[Ray], coherence: Coherence, hits: &mut [Option<Hit>]) {
        self.comparer.judge.closest(rays, coherence, hits);
        if coherence == Coherence::Coherent {
            return; // Rays from the eye are compared pixel by pixel.
        }
        let mut found = vec![None; rays.len()];
        self.comparer.subject.closest(rays, coherence, &mut found);
        let mut tally = Tally { secondary: rays.len() as u64, ..Tally::default() };
        for ((ray, found), truth) in rays.iter().zip(&found).zip(&*hits) {
            self.comparer.nearest(ray, None, found.as_ref(), truth.as_ref(), &mut tally);
        }
        let mut all = self.tally.lock().unwrap_or_else(|e| e.into_inner());
        *all = std::mem::take(&mut *all).and(tally);
    }

    fn occluded(&self, rays: &[Ray], coherence: Coherence, blocked: &mut [bool]) {
        self.comparer.judge.occluded(rays, coherence, blocked);
    }
}
