//! The sheen of cloth: the "Charlie" distribution (KHR_materials_sheen; Estevez and Kulla, 2017).

use std::f64::consts::TAU;
use std::sync::LazyLock;

use glam::DVec3;
use rayon::prelude::*;

use super::table::{Place, at_node, midpoints};

/// The least roughness; a smaller one would be a reflection at grazing angles only.
const MIN_ROUGHNESS: f64 = 0.07;

/// The least cosine: below it, masking is as at it.
const MIN_COSINE: f64 = 1e-3;

/// The number of roughnesses and of directions in the table, and of samples along each of two axes.
const ROUGHNESSES: usize = 32;
const DIRECTIONS: usize = 32;
const SAMPLES: usize = 40;

/// The directional albedo, by roughness and direction.
static ALBEDO: LazyLock<Vec<[f32; DIRECTIONS]>> =
    LazyLock::new(|| (0..ROUGHNESSES).into_par_iter().map(albedo_row).collect());

/// A layer of fibres with a roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen {
    roughness: f64,
}

impl Sheen {
    /// The sheen of a roughness in \[0, 1\].
    pub fn new(roughness: f32) -> Self {
        Self { roughness: f64::from(roughness).clamp(MIN_ROUGHNESS, 1.0) }
    }

    /// Returns f |cos θi| of white sheen, with both directions on the side of the normal.
    pub fn evaluate(&self, wo: DVec3, wi: DVec3) -> f64 {
        let h = (wo + wi).normalize_or(DVec3::Z);
        let inverse = 1.0 / self.roughness;
        let sine = ((1.0 - h.z) * (1.0 + h.z)).max(0.0).sqrt();
        let density = (2.0 + inverse) * sine.powf(inverse) / TAU;
        let [o, i] = [wo.z, wi.z].map(|cosine| cosine.clamp(MIN_COSINE, 1.0));
        let visibility = 1.0 / ((1.0 + self.lambda(o) + self.lambda(i)) * 4.0 * o * i);
        density * visibility * wi.z
    }

    /// Returns Λ, of which the share of fibres that are seen is made.
    fn lambda(&self, cosine: f64) -> f64 {
        let t = (1.0 - self.roughness) * (1.0 - self.roughness);
        let mix = |x: f64, y: f64| x + (y - x) * t;
        let (a, b) = (mix(21.5473, 25.3245), mix(3.82987, 3.32435));
        let (c, d, e) = (mix(0.19823, 0.16801), mix(-1.97760, -1.27393), mix(-4.32054, -4.85967));
        let l = |x: f64| a / (1.0 + b * x.powf(c)) + d * x + e;
        if cosine < 0.5 { l(cosine).exp() } else { (2.0 * l(0.5) - l(1.0 - cosine)).exp() }
    }

    /// Returns the directional albedo of white sheen, at most 1.
    pub fn albedo(&self, wo: DVec3) -> f32 {
        let x = (self.roughness - MIN_ROUGHNESS) / (1.0 - MIN_ROUGHNESS);
        let mut sum = 0.0;
        for (row, weight) in Place::new(x, ROUGHNESSES).ends() {
            for (node, share) in Place::new(wo.z.abs().sqrt(), DIRECTIONS).ends() {
                sum += ALBEDO[row][node] * weight * share;
            }
        }
        sum.min(1.0)
    }
}

/// Integrates the light from each direction over the hemisphere.
fn albedo_row(row: usize) -> [f32; DIRECTIONS] {
    let roughness = MIN_ROUGHNESS + (1.0 - MIN_ROUGHNESS) * at_node(row, ROUGHNESSES);
    let sheen = Sheen { roughness };
    std::array::from_fn(|node| {
        let direction = |cosine: f64, phi: f64| {
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            DVec3::new(sine * phi.cos(), sine * phi.sin(), cosine)
        };
        let wo = direction(at_node(node, DIRECTIONS).powi(2), 0.0);
        let mut sum = 0.0;
        for u in midpoints(SAMPLES) {
            for v in midpoints(SAMPLES) {
                // Directions are dense at grazing angles: cos θ = u², over half of the azimuths.
                sum += 2.0 * u * sheen.evaluate(wo, direction(u * u, TAU / 2.0 * v));
            }
        }
        (sum * TAU / (SAMPLES * SAMPLES) as f64) as f32
    })
}
