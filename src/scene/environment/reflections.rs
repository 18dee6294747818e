//! Reflections of an environment by microfacets of one roughness, as if their surface were seen head-on: wide lobes as
//! sums over cells of directions, narrow ones by samples.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::cube_map::{self, CubeMap};
use super::map_light::{CELLS, Cell};

/// The number of samples of a sharper filtered reflection.
const SAMPLES: usize = 64;

/// A direction in which light is reflected, about the mirrored direction.
struct ReflectedSample {
    /// The direction, with the mirrored one along z.
    direction: Vec3,
    /// The weight.
    weight: f32,
    /// The level of the pyramid whose texels have half of the solid angle that the sample stands for: they are
    /// interpolated.
    level: f32,
}

/// The light of a cell of directions as that of one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellLight {
    /// The direction: the mean of those of the cell by their light.
    direction: Vec3,
    /// The integral of radiance over the cell.
    sum: Vec3,
    /// The solid angle of the cell.
    solid_angle: f32,
}

impl CellLight {
    pub fn new((index, cell): (usize, &Cell)) -> Self {
        let center = cube_map::center_of(index, CELLS);
        let direction = cell.vectors.iter().sum::<Vec3>().normalize_or(center);
        Self { direction, sum: cell.sum, solid_angle: cell.solid_angle }
    }
}

/// Returns the mean of the radiance that microfacets of a roughness α, seen head-on, reflect about a mirrored direction:
/// each direction at an angle of cosine c to it with the weight D(h) c, where cos² of the angle to h is (1 + c)/2.
pub fn mean_of_cells(cells: &[CellLight], alpha: f32, mirrored: Vec3) -> Vec3 {
    let (mut sum, mut total) = (Vec3::ZERO, 0.0);
    for cell in cells {
        let cosine = cell.direction.dot(mirrored).max(0.0);
        let d = 0.5 * (1.0 + cosine) * (alpha * alpha - 1.0) + 1.0;
        let weight = cosine / (d * d);
        sum += cell.sum * weight;
        total += cell.solid_angle * weight;
    }
    sum / total
}

/// The reflections of an environment by microfacets of a low roughness.
///
/// The samples are those of the distribution of microfacets seen head-on. Each reads the level of the pyramid
/// with texels of its size (Křivánek and Colbert, *Real-time Shading with Filtered Importance Sampling*, 2008).
pub struct NarrowReflection<'a> {
    samples: Vec<ReflectedSample>,
    /// The sum of their weights.
    total: f32,
    pyramid: &'a [CubeMap],
}

impl<'a> NarrowReflection<'a> {
    /// The reflections by a roughness α; `finest` is the size of the finest map of the pyramid.
    pub fn new(alpha: f32, finest: usize, pyramid: &'a [CubeMap]) -> Self {
        let samples = reflected_samples(alpha, finest);
        let total: f32 = samples.iter().map(|sample| sample.weight).sum();
        Self { samples, total, pyramid }
    }

    /// Returns the mean of the radiance that is reflected about a mirrored direction.
    pub fn mean(&self, mirrored: Vec3) -> Vec3 {
        let (x, y) = mirrored.any_orthonormal_pair();
        let mut sum = Vec3::ZERO;
        for ReflectedSample { direction, weight, level } in &self.samples {
            let toward = x * direction.x + y * direction.y + mirrored * direction.z;
            sum += lookup_level(self.pyramid, toward, *level) * *weight;
        }
        sum / self.total
    }
}

fn reflected_samples(alpha: f32, size: usize) -> Vec<ReflectedSample> {
    let texel = 4.0 * PI / (6 * size * size) as f32;
    let sample = |i: usize| {
        // Points that are spread by the golden ratio.
        let u = (i as f32 + 0.5) / SAMPLES as f32;
        let phi = TAU * (i as f32 * 0.618_034).fract();
        // The microfacet, and the direction into which it reflects what comes head-on.
        let square = (1.0 - u) / (1.0 + (alpha * alpha - 1.0) * u);
        let cosine = 2.0 * square - 1.0;
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let density = {
            let d = square * (alpha * alpha - 1.0) + 1.0;
            alpha * alpha / (PI * d * d) / 4.0
        };
        let solid_angle = 1.0 / (SAMPLES as f32 * density);
        ReflectedSample {
            direction: Vec3::new(sine * phi.cos(), sine * phi.sin(), cosine),
            weight: cosine.max(0.0),
            level: (0.5 * (solid_angle / texel).log2() - 0.5).max(0.0),
        }
    };
    (0..SAMPLES).map(sample).filter(|sample| sample.weight > 0.0).collect()
}

fn lookup_level(pyramid: &[CubeMap], direction: Vec3, level: f32) -> Vec3 {
    let first = (level as usize).min(pyramid.len() - 1);
    let second = (first + 1).min(pyramid.len() - 1);
    let near = pyramid[first].lookup(direction);
    near.lerp(pyramid[second].lookup(direction), (level - first as f32).min(1.0))
}
