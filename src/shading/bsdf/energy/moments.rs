//! The light that a single reflection off microfacets sends back, by numeric integration, and the nodes of its
//! tables.

use glam::DVec3;

use crate::shading::bsdf::fresnel::grazing;
use crate::shading::bsdf::ggx::{Ggx, reflect};
use crate::shading::bsdf::table::{Place, at_node, midpoints};

/// The shares of the light that come back from one reflection.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// E: of mirrors that reflect everything.
    pub all: f32,
    /// The same of mirrors that reflect (1 − c)⁵: with F₀ = 0 and F₉₀ = 1.
    pub grazing: f32,
}

impl Moments {
    /// Adds another value with a weight.
    #[inline(always)]
    pub fn add(&mut self, other: Self, weight: f32) {
        self.all += other.all * weight;
        self.grazing += other.grazing * weight;
    }

    /// Integrates the light from `wo`, with `samples` along each of two axes, and shows each sample's
    /// weight and cosine to the microfacet. Where microfacets are isotropic and `wo` is in the plane of
    /// x and z, `is_symmetric` takes the half of the samples that the others mirror.
    pub fn integrate(
        ggx: &Ggx,
        wo: DVec3,
        samples: usize,
        is_symmetric: bool,
        mut each: impl FnMut(f64, f64),
    ) -> Self {
        let mut sum = [0.0; 2];
        let (count, range) = if is_symmetric { (samples / 2, 0.5) } else { (samples, 1.0) };
        let share = 1.0 / (count * samples) as f64;
        for u in midpoints(count) {
            for v in midpoints(samples) {
                let h = ggx.sample(wo, [u * range, v]);
                let (wi, cosine) = (reflect(wo, h), wo.dot(h).clamp(0.0, 1.0));
                let density = ggx.reflected_density(wo, h);
                if wi.z > 0.0 && density > 0.0 {
                    // What arrives on normals that are visible is G₂/G₁.
                    let weight = ggx.density(h) * ggx.visibility(wo, wi) / density * share;
                    sum[0] += weight;
                    sum[1] += weight * grazing(cosine);
                    each(weight, cosine);
                }
            }
        }
        Self { all: sum[0] as f32, grazing: sum[1] as f32 }
    }
}

/// Returns the cosine of the direction at a node. Nodes are dense at grazing angles, where E changes
/// fastest.
pub fn cosine_at(node: usize, count: usize) -> f64 {
    at_node(node, count).powi(2)
}

/// Returns the place of a direction among the nodes.
pub fn place_of_direction(w: DVec3, count: usize) -> Place {
    Place::new(w.z.abs().sqrt(), count)
}

/// Returns the weights with which the nodes enter the mean over all directions, with weight cos θ/π: the
/// integrals of 2 cos θ times the interpolation between them.
pub fn mean_weights(count: usize) -> Vec<f32> {
    const STEPS: usize = 64;
    let steps = STEPS * (count - 1);
    let mut weights = vec![0.0f64; count];
    // cos θ = x², and so 2 cos θ d(cos θ) = 4 x³ dx.
    for x in midpoints(steps) {
        for (node, share) in Place::new(x, count).ends() {
            weights[node] += 4.0 * x.powi(3) / steps as f64 * f64::from(share);
        }
    }
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| (weight / sum) as f32).collect()
}
