//! The comparison of secondary rays, while the reference picture is rendered with them.

use std::sync::Mutex;

use super::{Comparer, Differences};
use crate::geometry::{Hit, Ray};
use crate::intersect::{Coherence, Intersector};
use crate::measure::trace::closest;

/// An intersector that answers as the reference does, and compares every secondary ray with the
/// tested intersector.
pub struct SecondaryRayComparer<'a> {
    comparer: &'a Comparer<'a>,
    differences: Mutex<Differences>,
}

impl<'a> SecondaryRayComparer<'a> {
    /// Creates the intersector without any ray compared.
    pub fn new(comparer: &'a Comparer<'a>) -> Self {
        Self { comparer, differences: Mutex::default() }
    }

    /// Returns the differences of all rays traced.
    pub fn differences(self) -> Differences {
        // A poisoned lock still holds the counts; the panic that caused it is reported anyway.
        self.differences.into_inner().unwrap_or_else(|e| e.into_inner())
    }
}

impl Intersector for SecondaryRayComparer<'_> {
    fn name(&self) -> &'static str {
        self.comparer.reference.name()
    }

    fn version(&self) -> String {
        self.comparer.reference.version()
    }

    fn closest(&self, rays: &[Ray], coherence: Coherence, hits: &mut [Option<Hit>]) {
        self.comparer.reference.closest(rays, coherence, hits);
        if coherence == Coherence::Coherent {
            return; // Camera rays are compared pixel by pixel.
        }
        let tested = closest(self.comparer.tested, rays, coherence);
        let mut differences =
            Differences { secondary: rays.len() as u64, ..Differences::default() };
        for ((ray, tested), reference) in rays.iter().zip(&tested).zip(&*hits) {
            let (tested, reference) = (tested.as_ref(), reference.as_ref());
            self.comparer.compare_hits(ray, None, tested, reference, &mut differences);
        }
        // Added under the lock, once for each call.
        let mut all = self.differences.lock().unwrap_or_else(|e| e.into_inner());
        *all = std::mem::take(&mut *all).merge(differences);
    }

    fn occluded(&self, rays: &[Ray], coherence: Coherence, blocked: &mut [bool]) {
        self.comparer.reference.occluded(rays, coherence, blocked);
    }
}
