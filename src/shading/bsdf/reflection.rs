//! The reflection of microfacets, once and many times.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::energy::{Energy, alpha, mean_reflectance, of_schlick};
use super::fresnel::{COSINES, Fresnel};
use super::ggx::Ggx;

/// The microfacets of a surface: their distribution, and how much light they reflect at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets {
    /// The distribution; `None` on a smooth surface.
    pub ggx: Option<Ggx>,
    /// The albedos.
    pub energy: Energy,
}

impl Microfacets {
    /// The microfacets of a roughness, which is greater along x by the anisotropy.
    pub fn new(roughness: f32, anisotropy: f32) -> Self {
        let (roughness, anisotropy) = (f64::from(roughness), f64::from(anisotropy));
        let ggx = Ggx::new(alpha(roughness, anisotropy));
        Self { ggx, energy: Energy::new(roughness, anisotropy) }
    }

    /// Returns what mirrors that reflect everything send from `wi` to `wo` at once, f |cos θi|
    /// = D G₂ / (4 cos θo) (glTF 2.0, B.3.1), and the cosine to the microfacet.
    pub fn single(&self, wo: DVec3, wi: DVec3) -> (f64, f64) {
        let h = (wo + wi).normalize_or(DVec3::Z);
        let value = self.ggx.map_or(0.0, |ggx| ggx.density(h) * ggx.visibility(wo, wi));
        (value, wo.dot(h).clamp(0.0, 1.0))
    }

    /// Returns what they send after more than one reflection, f |cos θi|
    /// = (1 − E(ωo)) (1 − E(ωi)) cos θi / (π (1 − E)) with the mean E (Kulla and Conty, 2017).
    pub fn multiple(&self, wo: DVec3, wi: DVec3) -> f64 {
        if self.ggx.is_none() {
            return 0.0;
        }
        let lost = |share: f32| f64::from((1.0 - share).max(0.0));
        let mean = lost(self.energy.mean().all);
        if mean <= 0.0 {
            return 0.0;
        }
        let [o, i] = [wo, wi].map(|w| lost(self.energy.moments(w).all));
        o * i / mean * wi.z.abs() / PI
    }

    /// Returns the density of `wi` among the reflected directions that are sampled.
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let h = (wo + wi).normalize_or(DVec3::Z);
        self.ggx.map_or(0.0, |ggx| ggx.reflected_density(wo, h))
    }
}

/// A reflectance of microfacets.
#[derive(Clone, Debug, PartialEq)]
pub struct Reflection {
    /// The reflectance of each.
    pub fresnel: Fresnel,
    /// The factor of what is reflected more than once.
    pub multiple: Vec3,
    /// The mean over all directions of the reflectance of a microfacet.
    pub mean_reflectance: Vec3,
    /// The mean over all directions of [`strongest_albedo`](Self::strongest_albedo).
    mean_strongest: f32,
}

impl Reflection {
    /// The reflection of microfacets by this reflectance.
    pub fn new(microfacets: &Microfacets, fresnel: Fresnel) -> Self {
        let energy = &microfacets.energy;
        let mean_reflectance = mean_reflectance(&fresnel);
        let multiple = multiple_factor(energy, mean_reflectance);
        let once = match fresnel.reflectances() {
            None => energy.mean_albedo(&fresnel),
            Some(reflectances) => energy.mean_albedo_of(&strongest(reflectances)),
        };
        let rest = (1.0 - energy.mean().all).max(0.0);
        let mean_strongest = (once + multiple * rest).max_element().min(1.0);
        Self { fresnel, multiple, mean_reflectance, mean_strongest }
    }

    /// The reflection of a base that the material does not have.
    pub fn none() -> Self {
        Self {
            fresnel: Fresnel::conductor(Vec3::ZERO),
            multiple: Vec3::ZERO,
            mean_reflectance: Vec3::ZERO,
            mean_strongest: 0.0,
        }
    }

    /// Returns the mean over all directions of [`strongest_albedo`](Self::strongest_albedo).
    pub fn mean_strongest(&self) -> f32 {
        self.mean_strongest
    }

    /// Returns the share of the light from `wo` that is reflected, however often.
    pub fn albedo(&self, microfacets: &Microfacets, wo: DVec3) -> Vec3 {
        let moments = microfacets.energy.moments(wo);
        let once = match self.fresnel.schlick() {
            Some(schlick) => of_schlick(schlick, moments),
            None => microfacets.energy.albedo(wo, &self.fresnel),
        };
        let rest = (1.0 - moments.all).max(0.0);
        (once + self.multiple * rest).clamp(Vec3::ZERO, Vec3::ONE)
    }

    /// Returns the same with the reflectance of the colour that is reflected most, which may be another
    /// one at each microfacet: what a base below gets is the rest, so that it does not take on the
    /// complement of a colour (KHR_materials_specular, KHR_materials_iridescence).
    pub fn strongest_albedo(&self, microfacets: &Microfacets, wo: DVec3) -> f32 {
        let Some(reflectances) = self.fresnel.reflectances() else {
            return self.albedo(microfacets, wo).max_element();
        };
        let once = match microfacets.energy {
            Energy::Smooth => self.fresnel.at(wo.z.abs()),
            energy => energy.albedo_of(wo, &strongest(reflectances)),
        };
        let rest = (1.0 - microfacets.energy.moments(wo).all).max(0.0);
        (once + self.multiple * rest).max_element().min(1.0)
    }

    /// Returns the factor of a Lambertian base below that gets what is not reflected:
    /// (1 − R(ωo)) (1 − R(ωi)) / (1 − R) with the mean R (Kulla and Conty, 2017).
    pub fn base_factor(&self, microfacets: &Microfacets, wo: DVec3, wi: DVec3) -> f32 {
        let mean = 1.0 - self.mean_strongest;
        if mean <= 1e-6 {
            return 0.0;
        }
        let [o, i] = [wo, wi].map(|w| 1.0 - self.strongest_albedo(microfacets, w));
        o * (i / mean)
    }
}

/// Returns the reflectances of the colour that is reflected most, for all colours.
fn strongest(reflectances: &[Vec3; COSINES]) -> [Vec3; COSINES] {
    reflectances.map(|reflectance| Vec3::splat(reflectance.max_element()))
}

/// Returns the factor of light that is reflected more than once, F² E / (1 − F (1 − E)) with the mean
/// reflectance F and the mean E (Kulla and Conty, 2017, with the F² of Hill, 2018).
pub fn multiple_factor(energy: &Energy, mean_reflectance: Vec3) -> Vec3 {
    let all = energy.mean().all.min(1.0);
    let rest = Vec3::ONE - mean_reflectance * (1.0 - all);
    (mean_reflectance * mean_reflectance * all / rest).min(Vec3::ONE)
}
