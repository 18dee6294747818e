//! Opaque, isotropic bases without layers, as most surfaces have them: the same model in few numbers, and
//! sixteen surfaces side by side.

use std::array;

use glam::Vec3;

use super::Bsdf;
use super::base::Base;
use super::energy::{Energy, Isotropic};
use crate::geometry::{LANES, Lanes};

/// The least cosine of a direction to the viewer.
const MIN_COSINE: f32 = 1e-3;

/// The BSDF of an opaque base that is isotropic, not smooth and under no layer. Metal and dielectric have the same
/// microfacets, so that their mixture has one reflectance by Schlick's formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpaqueBsdf {
    energy: Isotropic,
    alpha_squared: f32,
    /// The reflectance of microfacets at normal incidence, and how much more it is at grazing angles.
    f0: Vec3,
    rise: Vec3,
    /// The factor of the light that is reflected more than once.
    multiple: Vec3,
    /// 1/(1 − E), with the mean E of what is reflected once.
    inverse_lost: f32,
    /// The same three numbers of the dielectric alone, in the colour that it reflects most: what it takes from its
    /// diffuse base.
    covering: [f32; 3],
    /// 1/(1 − R), with the mean R of what the dielectric reflects.
    inverse_uncovered: f32,
    /// The colour of the diffuse base times its share.
    diffuse: Vec3,
}

impl Bsdf {
    /// Returns the BSDF as that of an opaque, isotropic, rough base without layers, if it is one.
    pub fn opaque(&self) -> Option<OpaqueBsdf> {
        if self.layers.is_empty() { self.base.opaque() } else { None }
    }
}

impl Base {
    /// Returns the base as an opaque and isotropic one, if it is.
    fn opaque(&self) -> Option<OpaqueBsdf> {
        let (Energy::Isotropic(energy), Some(ggx)) =
            (self.microfacets.energy, self.microfacets.ggx)
        else {
            return None;
        };
        let (metal, share) = (self.metal, self.diffuse);
        if self.transmissive > 0.0 || self.diffuse_transmission > 0.0 {
            return None;
        }
        let [conductor, conductor_90] = self.conductor.fresnel.schlick()?;
        let [dielectric, dielectric_90] = self.dielectric.fresnel.schlick()?;
        let rest = |mean: f32| if mean < 1.0 - 1e-6 { 1.0 / (1.0 - mean) } else { 0.0 };
        // The strongest channel is the same at all angles, since all are equal at grazing ones.
        let strongest = dielectric.max_element();
        Some(OpaqueBsdf {
            energy,
            alpha_squared: (ggx.max_alpha() * ggx.max_alpha()) as f32,
            f0: conductor * metal + dielectric * share,
            rise: (conductor_90 - conductor) * metal + (dielectric_90 - dielectric) * share,
            multiple: self.conductor.multiple * metal + self.dielectric.multiple * share,
            inverse_lost: rest(energy.mean().all),
            covering: [
                strongest,
                dielectric_90.max_element() - strongest,
                self.dielectric.multiple.max_element(),
            ],
            inverse_uncovered: rest(self.dielectric.mean_strongest()),
            diffuse: self.color * share,
        })
    }
}

/// Sixteen opaque BSDFs side by side, and the direction from which each is seen.
#[derive(Clone)]
#[repr(C, align(64))]
pub struct OpaqueBsdf16 {
    energy: Lanes<Isotropic>,
    alpha_squared: Lanes<f32>,
    f0: [Lanes<f32>; 3],
    rise: [Lanes<f32>; 3],
    multiple: [Lanes<f32>; 3],
    inverse_lost: Lanes<f32>,
    covering: [Lanes<f32>; 3],
    inverse_uncovered: Lanes<f32>,
    diffuse: [Lanes<f32>; 3],
    /// The cosine of the angle between the normal and the viewer.
    cosine: Lanes<f32>,
    /// The shares that the direction to the viewer leaves for other lobes.
    viewer: Remainder16,
}

/// The shares of the light along directions that are left for other lobes.
#[derive(Clone, Copy, Default)]
#[repr(C, align(64))]
struct Remainder16 {
    /// 1 − E: the share that one reflection off mirrors loses.
    lost: Lanes<f32>,
    /// The share that the dielectric leaves for its base.
    uncovered: Lanes<f32>,
}

impl OpaqueBsdf16 {
    /// The same BSDF in all lanes.
    #[inline(always)]
    pub fn splat(bsdf: &OpaqueBsdf) -> Self {
        let lanes = |color: [f32; 3]| color.map(|x| [x; LANES]);
        Self {
            energy: [bsdf.energy; LANES],
            alpha_squared: [bsdf.alpha_squared; LANES],
            f0: lanes(bsdf.f0.to_array()),
            rise: lanes(bsdf.rise.to_array()),
            multiple: lanes(bsdf.multiple.to_array()),
            inverse_lost: [bsdf.inverse_lost; LANES],
            covering: lanes(bsdf.covering),
            inverse_uncovered: [bsdf.inverse_uncovered; LANES],
            diffuse: lanes(bsdf.diffuse.to_array()),
            cosine: [1.0; LANES],
            viewer: Remainder16::default(),
        }
    }

    /// Sets the BSDF in one lane.
    pub fn set(&mut self, i: usize, bsdf: &OpaqueBsdf) {
        self.energy[i] = bsdf.energy;
        self.alpha_squared[i] = bsdf.alpha_squared;
        self.inverse_lost[i] = bsdf.inverse_lost;
        self.inverse_uncovered[i] = bsdf.inverse_uncovered;
        for channel in 0..3 {
            self.f0[channel][i] = bsdf.f0[channel];
            self.rise[channel][i] = bsdf.rise[channel];
            self.multiple[channel][i] = bsdf.multiple[channel];
            self.covering[channel][i] = bsdf.covering[channel];
            self.diffuse[channel][i] = bsdf.diffuse[channel];
        }
    }

    /// Sets the cosines of the angles between the normals and the viewer, and returns the shares of the light from
    /// there that are reflected off microfacets and diffusely.
    #[inline(always)]
    pub fn set_viewer(&mut self, cosine: &Lanes<f32>) -> [[Lanes<f32>; 3]; 2] {
        for i in 0..LANES {
            self.cosine[i] = cosine[i].clamp(MIN_COSINE, 1.0);
        }
        let [all, grazing] = self.moments(&self.cosine);
        self.viewer = self.remainder(&all, &grazing);
        let (mut reflected, mut diffuse) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for channel in 0..3 {
            for i in 0..LANES {
                reflected[channel][i] = self.f0[channel][i] * all[i]
                    + self.rise[channel][i] * grazing[i]
                    + self.multiple[channel][i] * self.viewer.lost[i];
                diffuse[channel][i] = self.diffuse[channel][i] * self.viewer.uncovered[i];
            }
        }
        [reflected, diffuse]
    }

    /// Returns π f |cos θi|: what goes to the viewer of light from directions with these cosines, at least 0, to the
    /// normals and to the directions of the viewer. Its formulas are those of the BSDF, glTF 2.0, appendix B.
    #[inline(always)]
    pub fn evaluate(&self, cosine: &Lanes<f32>, to_viewer: &Lanes<f32>) -> [Lanes<f32>; 3] {
        let [all, grazing] = self.moments(cosine);
        let left = self.remainder(&all, &grazing);
        let (mut once, mut schlick) = ([0.0; LANES], [0.0; LANES]);
        let (mut multiple, mut diffuse) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let (o, l, a2) = (self.cosine[i], cosine[i].max(1e-6), self.alpha_squared[i]);
            // The microfacet is half-way between both directions, whose sum has a length of √(2 + 2 ωo·ωi).
            let half = (0.5 + 0.5 * to_viewer[i]).clamp(1e-7, 1.0).sqrt();
            let normal = (0.5 * (o + l) / half).min(1.0);
            // π D, and G₂/(4 cos θo).
            let square = normal * normal * (a2 - 1.0) + 1.0;
            let density = a2 / (square * square);
            let length = |z: f32| (a2 + (1.0 - a2) * z * z).sqrt();
            once[i] = density * 0.5 * l / (o * length(l) + l * length(o));
            let x = 1.0 - half;
            schlick[i] = once[i] * (x * x * x * x * x);
            multiple[i] = self.viewer.lost[i] * left.lost[i] * self.inverse_lost[i] * l;
            diffuse[i] = self.viewer.uncovered[i] * left.uncovered[i];
            diffuse[i] *= self.inverse_uncovered[i] * l;
        }
        let mut value = [[0.0; LANES]; 3];
        for channel in 0..3 {
            for i in 0..LANES {
                value[channel][i] = self.f0[channel][i] * once[i]
                    + self.rise[channel][i] * schlick[i]
                    + self.multiple[channel][i] * multiple[i]
                    + self.diffuse[channel][i] * diffuse[i];
            }
        }
        value
    }

    /// Returns the moments of directions by their cosines.
    #[inline(always)]
    fn moments(&self, cosine: &Lanes<f32>) -> [Lanes<f32>; 2] {
        let root: Lanes<f32> = array::from_fn(|i| cosine[i].clamp(0.0, 1.0).sqrt());
        let (mut all, mut grazing) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let moments = self.energy[i].moments_by_root(root[i]);
            (all[i], grazing[i]) = (moments.all, moments.grazing);
        }
        [all, grazing]
    }

    /// Returns the shares that directions with these moments leave.
    #[inline(always)]
    fn remainder(&self, all: &Lanes<f32>, grazing: &Lanes<f32>) -> Remainder16 {
        let mut left = Remainder16::default();
        let [f0, rise, multiple] = &self.covering;
        for i in 0..LANES {
            let lost = (1.0 - all[i]).max(0.0);
            left.lost[i] = lost;
            let covered = f0[i] * all[i] + rise[i] * grazing[i] + multiple[i] * lost;
            left.uncovered[i] = (1.0 - covered).max(0.0);
        }
        left
    }
}
