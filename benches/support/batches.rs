//! Rays as the renderer hands them over: side by side, a tile at a time.

use envers::{Coherence, HitBatch, Intersector, Ray, RayBatch};

/// The number of rays of a tile.
const TILE: usize = 1024;

/// Rays in batches, and room for what they hit.
pub struct Batches {
    rays: Vec<RayBatch>,
    hits: HitBatch,
    blocked: Vec<bool>,
}

impl Batches {
    pub fn new(rays: &[Ray]) -> Self {
        let batch = |rays: &[Ray]| {
            let mut batch = RayBatch::default();
            batch.extend(rays);
            batch
        };
        let rays = rays.chunks(TILE).map(batch).collect();
        Self { rays, hits: HitBatch::default(), blocked: Vec::new() }
    }

    /// Traces all rays; returns the number that hit anything.
    pub fn closest(&mut self, intersector: &dyn Intersector, coherence: Coherence) -> usize {
        let mut count = 0;
        for rays in &self.rays {
            intersector.closest_batch(rays, coherence, &mut self.hits);
            count += self.hits.count();
        }
        count
    }

    /// Traces all rays; returns the number that are blocked.
    #[allow(dead_code)] // Not every bench asks for shadows.
    pub fn occluded(&mut self, intersector: &dyn Intersector) -> usize {
        let mut count = 0;
        for rays in &self.rays {
            intersector.occluded_batch(rays, Coherence::Coherent, &mut self.blocked);
            count += self.blocked.iter().filter(|&&blocked| blocked).count();
        }
        count
    }
}
