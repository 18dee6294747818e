//! The table of the directional albedo of anisotropic surfaces.

use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

use glam::DVec3;
use rayon::prelude::*;

use super::isotropic::Isotropic;
use super::moments::{Moments, cosine_at, mean_weights, place_of_direction};
use crate::shading::bsdf::ggx::{Ggx, MIN_ALPHA};
use crate::shading::bsdf::table::{Place, at_node};

/// The number of roughnesses, strengths, azimuths and directions in the table.
const ROUGHNESSES: usize = 17;
const STRENGTHS: usize = 9;
const AZIMUTHS: usize = 7;
const DIRECTIONS: usize = 24;

/// The number of samples of a direction along each of two axes.
const SAMPLES: usize = 24;

/// The albedos of one roughness and strength, by azimuth and direction, and their mean.
struct Block {
    moments: [[Moments; DIRECTIONS]; AZIMUTHS],
    mean: Moments,
}

static TABLE: LazyLock<Vec<Block>> =
    LazyLock::new(|| (0..ROUGHNESSES * STRENGTHS).into_par_iter().map(Block::compute).collect());

/// Returns α along x, the direction of more roughness, and along y, by roughness and strength
/// (KHR_materials_anisotropy).
pub fn alpha(roughness: f64, strength: f64) -> [f64; 2] {
    let alpha = roughness * roughness;
    [alpha + (1.0 - alpha) * (strength * strength), alpha]
}

impl Block {
    fn compute(index: usize) -> Self {
        let roughness = at_node(index / STRENGTHS, ROUGHNESSES);
        let strength = at_node(index % STRENGTHS, STRENGTHS);
        let alpha = alpha(roughness, strength).map(|alpha| alpha.max(MIN_ALPHA));
        let ggx = Ggx::new(alpha).expect("at least the least α");
        let weights = mean_weights(DIRECTIONS);
        let mut block = Self {
            moments: [[Moments::default(); DIRECTIONS]; AZIMUTHS],
            mean: Moments::default(),
        };
        for azimuth in 0..AZIMUTHS {
            let (sin, cos) = (at_node(azimuth, AZIMUTHS) * FRAC_PI_2).sin_cos();
            // The mean over azimuths is that of the interpolation between them.
            let is_end = azimuth == 0 || azimuth == AZIMUTHS - 1;
            let share = if is_end { 0.5 } else { 1.0 } / (AZIMUTHS - 1) as f32;
            for node in 0..DIRECTIONS {
                let z = cosine_at(node, DIRECTIONS);
                let sine = (1.0 - z * z).max(0.0).sqrt();
                let wo = DVec3::new(sine * cos, sine * sin, z);
                let moments = Moments::integrate(&ggx, wo, SAMPLES, false, |_, _| ());
                block.moments[azimuth][node] = moments;
                block.mean.add(moments, share * weights[node]);
            }
        }
        block
    }
}

/// The albedos of microfacets with one roughness and strength of anisotropy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anisotropic {
    roughness: Place,
    strength: Place,
    /// The roughness whose α is the geometric mean of the two along x and y.
    mean_roughness: f64,
}

impl Anisotropic {
    /// The albedos of a roughness and a strength.
    pub fn new(roughness: f64, strength: f64) -> Self {
        let [x, y] = alpha(roughness, strength).map(|alpha| alpha.max(MIN_ALPHA));
        Self {
            roughness: Place::new(roughness, ROUGHNESSES),
            strength: Place::new(strength, STRENGTHS),
            mean_roughness: (x * y).powf(0.25),
        }
    }

    /// Returns the albedos of an isotropic surface that is alike: of the geometric mean of both α.
    pub fn isotropic(&self) -> Isotropic {
        Isotropic::new(self.mean_roughness)
    }

    /// Returns the shares of the light from `wo` that come back from one reflection.
    pub fn moments(&self, wo: DVec3) -> Moments {
        let azimuth = Place::new(wo.y.abs().atan2(wo.x.abs()) / FRAC_PI_2, AZIMUTHS);
        let direction = place_of_direction(wo, DIRECTIONS);
        let mut moments = Moments::default();
        self.for_each_block(|block, weight| {
            for (i, share) in azimuth.ends() {
                for (j, part) in direction.ends() {
                    moments.add(block.moments[i][j], weight * share * part);
                }
            }
        });
        moments
    }

    /// Returns the mean of the shares over all directions, with weight cos θ/π.
    pub fn mean(&self) -> Moments {
        let mut mean = Moments::default();
        self.for_each_block(|block, weight| mean.add(block.mean, weight));
        mean
    }

    fn for_each_block(&self, mut f: impl FnMut(&Block, f32)) {
        for (i, weight) in self.roughness.ends() {
            for (j, share) in self.strength.ends() {
                f(&TABLE[i * STRENGTHS + j], weight * share);
            }
        }
    }
}
