//! Tables of the directional albedo of microfacets, by single reflections; computed at first use.
//!
//! A single reflection loses the light that hits microfacets again. What is lost comes back in a lobe of
//! multiple scattering (Kulla and Conty, 2017), which needs the directional albedo E(ωo) of a single
//! reflection without Fresnel's factor. With it, the albedo is linear in the reflectance at each cosine
//! between direction and microfacet. So the tables hold E and the share of Schlick's (1 − c)⁵ in it, and
//! for other reflectances a factor for each of a row of cosines.

mod anisotropic;
mod isotropic;
mod moments;

use glam::{DVec3, Vec3};

use self::anisotropic::Anisotropic;
pub use self::anisotropic::alpha;
use self::isotropic::CosineWeights;
pub use self::isotropic::Isotropic;
pub use self::moments::Moments;
use super::fresnel::{COSINES, Fresnel, grazing};
use super::ggx::Ggx;
use super::table::Place;

/// The albedos of microfacets with one roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Energy {
    /// A smooth surface, which each reflection leaves.
    Smooth,
    /// An isotropic surface.
    Isotropic(Isotropic),
    /// An anisotropic surface.
    Anisotropic(Anisotropic),
}

impl Energy {
    /// The albedos of a surface with a roughness, which is greater along x by the anisotropy.
    pub fn new(roughness: f64, anisotropy: f64) -> Self {
        if Ggx::new(alpha(roughness, anisotropy)).is_none() {
            Self::Smooth
        } else if anisotropy > 0.0 {
            Self::Anisotropic(Anisotropic::new(roughness, anisotropy))
        } else {
            Self::Isotropic(Isotropic::new(roughness))
        }
    }

    /// Returns the shares of the light from `wo` that come back from one reflection.
    pub fn moments(&self, wo: DVec3) -> Moments {
        match self {
            Self::Smooth => Moments { all: 1.0, grazing: grazing(wo.z.abs()) as f32 },
            Self::Isotropic(energy) => energy.moments(wo),
            Self::Anisotropic(energy) => energy.moments(wo),
        }
    }

    /// Returns the mean of the shares over all directions, with weight cos θ/π.
    pub fn mean(&self) -> Moments {
        match self {
            Self::Smooth => Moments { all: 1.0, grazing: 1.0 / 21.0 },
            Self::Isotropic(energy) => energy.mean(),
            Self::Anisotropic(energy) => energy.mean(),
        }
    }

    /// Returns the light from `wo` that comes back from one reflection with this reflectance.
    pub fn albedo(&self, wo: DVec3, fresnel: &Fresnel) -> Vec3 {
        match (fresnel.schlick(), fresnel.reflectances()) {
            (Some(schlick), _) => of_schlick(schlick, self.moments(wo)),
            (_, Some(_)) if *self == Self::Smooth => fresnel.at(wo.z.abs()),
            (_, reflectances) => reflectances.map_or(Vec3::ZERO, |r| self.albedo_of(wo, r)),
        }
    }

    /// Returns the same for reflectances that are given at evenly spread cosines from 0 to 1.
    pub fn albedo_of(&self, wo: DVec3, reflectances: &[Vec3; COSINES]) -> Vec3 {
        match self {
            Self::Smooth => {
                let ends = Place::new(wo.z.abs(), COSINES).ends();
                ends.iter().map(|(k, weight)| reflectances[*k] * *weight).sum()
            }
            Self::Isotropic(energy) => weighted(&energy.weights(wo), reflectances),
            Self::Anisotropic(energy) => {
                // How the cosines are spread is taken from an isotropic surface that is alike.
                let alike = energy.isotropic();
                let ratio = energy.moments(wo).all / alike.moments(wo).all;
                (weighted(&alike.weights(wo), reflectances) * ratio).min(Vec3::ONE)
            }
        }
    }

    /// Returns the mean over all directions of what comes back from one reflection.
    pub fn mean_albedo(&self, fresnel: &Fresnel) -> Vec3 {
        match (fresnel.schlick(), fresnel.reflectances()) {
            (Some(schlick), _) => of_schlick(schlick, self.mean()),
            (_, reflectances) => reflectances.map_or(Vec3::ZERO, |r| self.mean_albedo_of(r)),
        }
    }

    /// Returns the same for reflectances that are given at evenly spread cosines from 0 to 1.
    pub fn mean_albedo_of(&self, reflectances: &[Vec3; COSINES]) -> Vec3 {
        match self {
            Self::Smooth => weighted(&smooth_mean_weights(), reflectances),
            Self::Isotropic(energy) => weighted(&energy.mean_weights(), reflectances),
            Self::Anisotropic(energy) => {
                let alike = energy.isotropic();
                let ratio = energy.mean().all / alike.mean().all;
                (weighted(&alike.mean_weights(), reflectances) * ratio).min(Vec3::ONE)
            }
        }
    }
}

/// Returns the mean of a reflectance over all directions, with weight cos θ/π.
pub fn mean_reflectance(fresnel: &Fresnel) -> Vec3 {
    Energy::Smooth.mean_albedo(fresnel)
}

/// The factors of the reflectance at each cosine in its mean over all directions: the integrals of 2c
/// times the interpolation between nodes at distance h.
fn smooth_mean_weights() -> CosineWeights {
    let h = 1.0 / (COSINES - 1) as f32;
    let mut weights: CosineWeights = std::array::from_fn(|k| 2.0 * h * h * k as f32);
    weights[0] = h * h / 3.0;
    weights[COSINES - 1] = h - h * h / 3.0;
    weights
}

/// Returns what Schlick's reflectance F₀ + (F₉₀ − F₀)(1 − c)⁵ makes of the shares.
pub fn of_schlick([f0, f90]: [Vec3; 2], moments: Moments) -> Vec3 {
    f0 * moments.all + (f90 - f0) * moments.grazing
}

/// Returns the sum of reflectances with these factors.
fn weighted(weights: &CosineWeights, reflectances: &[Vec3; COSINES]) -> Vec3 {
    weights.iter().zip(reflectances).map(|(weight, reflectance)| *reflectance * *weight).sum()
}
