//! Closest hits and occlusion of rays, returned as lists.

use crate::geometry::{Hit, Ray};
use crate::intersect::{Coherence, Intersector};
use crate::scene::Scene;
use crate::surface::Surface;

/// Returns the closest hits of rays.
pub fn closest(
    intersector: &dyn Intersector,
    rays: &[Ray],
    coherence: Coherence,
) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    intersector.closest(rays, coherence, &mut hits);
    hits
}

/// Returns for each ray whether it is occluded.
pub fn occluded(intersector: &dyn Intersector, rays: &[Ray], coherence: Coherence) -> Vec<bool> {
    let mut occluded = vec![false; rays.len()];
    intersector.occluded(rays, coherence, &mut occluded);
    occluded
}

/// Returns all hits on the way of each ray, in order, as a ray meets them that goes straight on.
pub fn crossings(scene: &Scene, intersector: &dyn Intersector, rays: &[Ray]) -> Vec<Vec<Hit>> {
    let mut all = vec![Vec::new(); rays.len()];
    let mut ahead: Vec<(usize, Ray)> = rays.iter().copied().enumerate().collect();
    while !ahead.is_empty() {
        let rays: Vec<Ray> = ahead.iter().map(|(_, ray)| *ray).collect();
        let hits = closest(intersector, &rays, Coherence::Incoherent);
        let continued = ahead.iter().zip(hits).filter_map(|(&(i, ray), hit)| {
            let hit = hit?;
            all[i].push(hit);
            let side = Surface::new(scene, &ray, &hit).side;
            Some((i, ray.continue_past(&hit, side.opposite())))
        });
        ahead = continued.collect();
    }
    all
}

/// Returns the distance of two floats of the same sign, in units in the last place.
pub fn ulps_between(a: f64, b: f64) -> u64 {
    a.to_bits().abs_diff(b.to_bits())
}
