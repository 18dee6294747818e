//! An intersector that keeps the rays it was asked about.

use std::sync::Mutex;

use envers::{Coherence, Hit, Intersector, Ray};

/// The kind of a batch of rays.
#[derive(Clone, Copy)]
pub enum Batch {
    Coherent,
    Incoherent,
    Shadow,
}

/// Answers as another intersector does.
pub struct Recorder<'a> {
    of: &'a dyn Intersector,
    rays: [Mutex<Vec<Ray>>; 3],
}

impl<'a> Recorder<'a> {
    pub fn new(of: &'a dyn Intersector) -> Self {
        Self { of, rays: Default::default() }
    }

    /// The rays of one kind so far, which are forgotten.
    pub fn take(&self, batch: Batch) -> Vec<Ray> {
        std::mem::take(&mut *self.rays[batch as usize].lock().unwrap())
    }
}

impl Intersector for Recorder<'_> {
    fn name(&self) -> &'static str {
        self.of.name()
    }

    fn version(&self) -> String {
        self.of.version()
    }

    fn closest(&self, rays: &[Ray], coherence: Coherence, hits: &mut [Option<Hit>]) {
        let batch = match coherence {
            Coherence::Coherent => Batch::Coherent,
            Coherence::Incoherent => Batch::Incoherent,
        };
        self.rays[batch as usize].lock().unwrap().extend(rays);
        self.of.closest(rays, coherence, hits);
    }

    fn occluded(&self, rays: &[Ray], coherence: Coherence, blocked: &mut [bool]) {
        self.rays[Batch::Shadow as usize].lock().unwrap().extend(rays);
        self.of.occluded(rays, coherence, blocked);
    }
}
