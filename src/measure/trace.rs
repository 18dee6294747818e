//! Closest hits and occlusion of rays, returned as lists.

use crate::geometry::{Hit, Ray};
use crate::intersect::{Coherence, Intersector};

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

/// Returns the distance of two floats of the same sign, in units in the last place.
pub fn ulps_between(a: f64, b: f64) -> u64 {
    a.to_bits().abs_diff(b.to_bits())
}
