//! The clearcoat (KHR_materials_clearcoat): a dielectric layer of its own roughness.

use glam::{DVec3, Vec3};

use super::fresnel::Fresnel;
use super::ggx::reflect;
use super::reflection::{Microfacets, Reflection};

/// The index of refraction of a clearcoat.
const IOR: f32 = 1.5;

/// A clearcoat of some strength.
#[derive(Clone, Debug, PartialEq)]
pub struct Clearcoat {
    strength: f32,
    microfacets: Microfacets,
    reflection: Reflection,
}

impl Clearcoat {
    /// The clearcoat of a strength above 0 and a roughness.
    pub fn new(strength: f32, roughness: f32) -> Self {
        let microfacets = Microfacets::new(roughness, 0.0);
        let fresnel = Fresnel::dielectric(1.0, IOR, 1.0, Vec3::ONE);
        Self { strength, microfacets, reflection: Reflection::new(&microfacets, fresnel) }
    }

    /// Returns f |cos θi|; 0 of a smooth one.
    pub fn evaluate(&self, wo: DVec3, wi: DVec3) -> f32 {
        let (once, cosine) = self.microfacets.single(wo, wi);
        let multiple = self.reflection.multiple.x * self.microfacets.multiple(wo, wi) as f32;
        self.strength * (self.reflection.fresnel.at(cosine).x * once as f32 + multiple)
    }

    /// Returns the share of the light from `wo` that it reflects.
    pub fn albedo(&self, wo: DVec3) -> f32 {
        self.strength * self.reflection.albedo(&self.microfacets, wo).x
    }

    /// True if its reflection is a delta lobe.
    pub fn is_smooth(&self) -> bool {
        self.microfacets.ggx.is_none()
    }

    /// Samples its reflection; `None` below the surface.
    pub fn sample(&self, wo: DVec3, u: [f64; 2]) -> Option<DVec3> {
        let h = self.microfacets.ggx.map_or(DVec3::Z, |ggx| ggx.sample(wo, u));
        let wi = reflect(wo, h);
        (wi.z > 0.0).then_some(wi)
    }

    /// Returns the density of `wi` among its samples.
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.microfacets.pdf(wo, wi)
    }
}
