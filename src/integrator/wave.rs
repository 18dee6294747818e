//! Waves: the rays of a tile that are traced together, and the light paths that they continue.

use glam::DVec3;

use crate::geometry::{HitBatch, LANES, RayBatch};
use crate::integrator::Integrator;
use crate::integrator::nested_dielectrics::InteriorList;
use crate::surface::RayCone;

/// The most rays of a wave. Up to as many more wait for each level of depth.
const MAX_RAYS: usize = 1 << 14;

/// Rays that are traced together, and their hits.
#[derive(Default)]
pub(super) struct Wave {
    /// The index of the sample of the pixels that the rays belong to.
    pub sample: usize,
    /// The rays.
    pub rays: RayBatch,
    /// Their closest hits, once they are traced.
    pub hits: HitBatch,
    /// The path of each ray; empty for camera rays that are whole samples and start at one point.
    pub paths: Vec<PathState>,
}

/// The state of a light path at one of its rays.
#[derive(Clone, Debug)]
pub(super) struct PathState {
    /// The number, in the tile, of the sample that the path belongs to.
    pub sample: u32,
    /// The number of surfaces that reflected or refracted the light.
    pub depth: u32,
    /// The number of surfaces that it went straight through, as through what alpha leaves uncovered.
    pub layers: u32,
    /// The share that the light of the ray has in the sample.
    pub throughput: DVec3,
    /// The dielectrics that the ray is in.
    pub interior: InteriorList,
    /// The cone of the ray, for the level of detail of textures.
    pub cone: RayCone,
    /// The roughness of the surfaces that the light met, by which an environment is blurred.
    pub roughness: f32,
}

impl PathState {
    /// Returns the block and the lane of the sample.
    pub fn sample_lane(&self) -> (usize, usize) {
        (self.sample as usize / LANES, self.sample as usize % LANES)
    }
}

impl Wave {
    /// Returns the path of ray `i`.
    pub fn path(&self, i: usize, integrator: &Integrator<'_>) -> PathState {
        if let Some(path) = self.paths.get(i) {
            return path.clone();
        }
        let ray = self.rays.ray(i);
        let interior = match &integrator.media.camera_interior {
            Some(interior) => interior.clone(),
            None => integrator.media.dielectrics.interior_at(
                ray.origin,
                integrator.scene,
                integrator.intersector,
            ),
        };
        let cone = integrator.texture_lod.camera_cone(&ray);
        PathState {
            sample: i as u32,
            depth: 0,
            layers: 0,
            throughput: DVec3::ONE,
            interior,
            cone,
            roughness: 0.0,
        }
    }

    fn clear(&mut self) {
        self.rays.clear();
        self.paths.clear();
    }

    /// Splits off the rays from number `first` on.
    fn split_off(&mut self, first: usize) -> Self {
        let paths = self.paths.split_off(first);
        let mut second = Self { sample: self.sample, paths, ..Self::default() };
        (first..self.rays.len()).for_each(|i| second.rays.push(&self.rays.ray(i)));
        self.rays.truncate(first);
        second
    }
}

/// The waves of one sample of a tile.
#[derive(Default)]
pub(super) struct WaveQueue {
    /// The wave that is traced and shaded.
    pub current: Wave,
    /// The secondary rays that its surfaces send on.
    pub next: Wave,
    /// The waves that wait; the last is traced first.
    waiting: Vec<Wave>,
}

impl WaveQueue {
    /// Makes the next wave of secondary rays the current one; returns false if none is left.
    ///
    /// The rays of a wave keep the order in which their surfaces were hit, so that the sum of a
    /// sample has one order. A wave of too many rays is split: between samples, which do not depend
    /// on each other, or, if all are of one sample, in the middle, whatever else is traced with
    /// them.
    pub fn advance(&mut self) -> bool {
        self.next.sample = self.current.sample;
        self.waiting.push(std::mem::take(&mut self.next));
        while let Some(mut wave) = self.waiting.pop() {
            if wave.rays.len() > MAX_RAYS {
                let second = wave.split_off(split_index(&wave.paths));
                self.waiting.extend([second, wave]);
            } else if wave.rays.is_empty() {
                self.next = wave; // Its memory is used again.
            } else {
                self.next = std::mem::replace(&mut self.current, wave);
                self.next.clear();
                return true;
            }
        }
        false
    }
}

/// Returns the index at which to split a wave: between two samples near its middle, or, if it is all
/// of one sample, in its middle.
fn split_index(paths: &[PathState]) -> usize {
    let middle = paths.len() / 2;
    let starts_sample = |&i: &usize| paths[i - 1].sample != paths[i].sample;
    let after = (middle..paths.len()).find(starts_sample);
    let before = (1..middle).rev().find(starts_sample);
    match (before, after) {
        (Some(before), Some(after)) if middle - before < after - middle => before,
        (_, Some(after)) => after,
        (Some(before), None) => before,
        (None, None) => middle,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(samples: &[u32]) -> Vec<PathState> {
        let path = |&sample: &u32| PathState {
            sample,
            depth: 1,
            layers: 0,
            throughput: DVec3::ONE,
            interior: InteriorList::default(),
            cone: RayCone::default(),
            roughness: 0.0,
        };
        samples.iter().map(path).collect()
    }

    #[test]
    fn a_wave_is_split_between_samples_near_its_middle() {
        assert_eq!(split_index(&paths(&[0, 0, 0, 1, 1, 1])), 3);
        assert_eq!(split_index(&paths(&[0, 0, 1, 1, 1, 1])), 2);
        assert_eq!(split_index(&paths(&[0, 0, 0, 0, 1, 1])), 4);
        assert_eq!(split_index(&paths(&[0, 1, 1, 1, 1, 1, 1])), 1);
    }

    #[test]
    fn a_wave_of_one_sample_is_split_in_its_middle() {
        assert_eq!(split_index(&paths(&[7; 5])), 2);
    }
}
