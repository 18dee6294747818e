//! The table of the directional albedo of isotropic surfaces.

use std::fmt;
use std::sync::OnceLock;

use glam::DVec3;

use super::moments::{Moments, cosine_at, mean_weights, place_of_direction};
use crate::shading::bsdf::fresnel::COSINES;
use crate::shading::bsdf::ggx::{Ggx, MIN_ALPHA};
use crate::shading::bsdf::table::{Place, at_node};

/// The number of roughnesses and of directions in the table.
const ROUGHNESSES: usize = 33;
const DIRECTIONS: usize = 40;

/// The number of samples of a direction along each of two axes.
const SAMPLES: usize = 48;

/// The factors of the reflectance at each of the cosines, of which the light that comes back is the sum.
pub type CosineWeights = [f32; COSINES];

/// The albedos of one roughness, by direction, and their means with weight cos θ/π.
struct Row {
    moments: [Moments; DIRECTIONS],
    weights: [CosineWeights; DIRECTIONS],
    mean_moments: Moments,
    mean_weights: CosineWeights,
}

/// The rows of the table, each computed when it is first used: most materials have one roughness.
static TABLE: [OnceLock<Row>; ROUGHNESSES] = [const { OnceLock::new() }; ROUGHNESSES];

/// Returns a row of the table.
fn row(index: usize) -> &'static Row {
    TABLE[index].get_or_init(|| Row::compute(index))
}

impl Row {
    fn compute(roughness: usize) -> Self {
        let alpha = at_node(roughness, ROUGHNESSES).powi(2).max(MIN_ALPHA);
        let ggx = Ggx::new([alpha; 2]).expect("at least the least α");
        let mut row = Self {
            moments: [Moments::default(); DIRECTIONS],
            weights: [[0.0; COSINES]; DIRECTIONS],
            mean_moments: Moments::default(),
            mean_weights: [0.0; COSINES],
        };
        for (node, share) in mean_weights(DIRECTIONS).into_iter().enumerate() {
            let cosine = cosine_at(node, DIRECTIONS);
            let wo = DVec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
            let weights = &mut row.weights[node];
            row.moments[node] = Moments::integrate(&ggx, wo, SAMPLES, true, |weight, cosine| {
                for (k, part) in Place::new(cosine, COSINES).ends() {
                    weights[k] += weight as f32 * part;
                }
            });
            row.mean_moments.add(row.moments[node], share);
            for k in 0..COSINES {
                row.mean_weights[k] += row.weights[node][k] * share;
            }
        }
        row
    }
}

/// The albedos of isotropic microfacets with one roughness.
#[derive(Clone, Copy)]
pub struct Isotropic {
    place: Place,
    /// The rows of the table around the place.
    rows: [&'static Row; 2],
}

impl PartialEq for Isotropic {
    fn eq(&self, other: &Self) -> bool {
        self.place == other.place
    }
}

impl fmt::Debug for Isotropic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Isotropic").field(&self.place).finish()
    }
}

impl Isotropic {
    /// The albedos of a roughness.
    pub fn new(roughness: f64) -> Self {
        let place = Place::new(roughness, ROUGHNESSES);
        // At a node the other row counts for nothing, and need not be computed.
        let nodes = match place.fraction {
            0.0 => [place.node; 2],
            1.0 => [place.node + 1; 2],
            _ => [place.node, place.node + 1],
        };
        Self { place, rows: nodes.map(row) }
    }

    /// Returns the rows with their weights.
    #[inline]
    fn rows(&self) -> [(&'static Row, f32); 2] {
        let fraction = self.place.fraction;
        [(self.rows[0], 1.0 - fraction), (self.rows[1], fraction)]
    }

    /// Returns the shares of the light from `wo` that come back from one reflection.
    pub fn moments(&self, wo: DVec3) -> Moments {
        self.moments_at(place_of_direction(wo, DIRECTIONS))
    }

    /// Returns the same by the square root of the cosine of the direction.
    #[inline(always)]
    pub fn moments_by_root(&self, root: f32) -> Moments {
        self.moments_at(Place::of(root, DIRECTIONS))
    }

    #[inline(always)]
    fn moments_at(&self, direction: Place) -> Moments {
        let mut moments = Moments::default();
        for (row, weight) in self.rows() {
            for (node, share) in direction.ends() {
                moments.add(row.moments[node], weight * share);
            }
        }
        moments
    }

    /// Returns the mean of the shares over all directions.
    pub fn mean(&self) -> Moments {
        let mut mean = Moments::default();
        self.rows().iter().for_each(|(row, weight)| mean.add(row.mean_moments, *weight));
        mean
    }

    /// Returns the factors of the reflectance at each cosine, for light from `wo`.
    pub fn weights(&self, wo: DVec3) -> CosineWeights {
        let mut sum = [0.0; COSINES];
        for (row, weight) in self.rows() {
            for (node, share) in place_of_direction(wo, DIRECTIONS).ends() {
                add(&mut sum, &row.weights[node], weight * share);
            }
        }
        sum
    }

    /// Returns the means of these factors over all directions.
    pub fn mean_weights(&self) -> CosineWeights {
        let mut sum = [0.0; COSINES];
        self.rows().iter().for_each(|(row, weight)| add(&mut sum, &row.mean_weights, *weight));
        sum
    }
}

fn add(sum: &mut CosineWeights, other: &CosineWeights, weight: f32) {
    sum.iter_mut().zip(other).for_each(|(sum, x)| *sum += x * weight);
}
