//! The metallic-roughness materials of glTF, expressed as Lambert and Phong materials (see
//! docs/formats.md).

use glam::Vec3;

use crate::scene::{Channel, ShadingParams, TextureId};

/// The range of shininess: roughness 1 would give 0, and roughness 0 infinity.
const SHININESS: std::ops::RangeInclusive<f32> = 1.0..=10_000.0;

/// The roughness from which on a metal mirrors nothing: its reflections are too blurred to show.
const ROUGH: f32 = 0.4;

/// The parameters of a metallic-roughness material at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetallicRoughness {
    /// The base colour, linear Rec. 709.
    pub base: Vec3,
    /// The metalness, in \[0, 1\].
    pub metallic: f32,
    /// The roughness, in \[0, 1\].
    pub roughness: f32,
    /// The strength of a dielectric's reflection, in \[0, 1\] (KHR_materials_specular).
    pub specular: f32,
    /// The colour of a dielectric's reflection (KHR_materials_specular).
    pub specular_color: Vec3,
    /// The share of the light that enters and is not scattered (KHR_materials_transmission).
    pub transmission: f32,
    /// The index of refraction; at 0 everything is reflected.
    pub ior: f32,
}

impl MetallicRoughness {
    /// The Lambert and Phong parameters that approximate it.
    pub fn shading_params(&self) -> ShadingParams {
        // A dielectric's reflectance, the mirror-like part of a metal's, and what is transmitted.
        let head_on = (self.specular_color * reflectance_at_normal_incidence(self.ior))
            .min(Vec3::ONE)
            * self.specular;
        let base = self.base.min(Vec3::ONE);
        let mut reflect = base * (self.metallic * mirror_share(self.roughness));
        let mut transmit = base * ((1.0 - self.metallic) * self.transmission);
        if self.ior == 0.0 {
            reflect += transmit;
            transmit = Vec3::ZERO;
        }
        // The rest is scattered, of which the share that glTF gives is diffuse.
        let rest = Vec3::ONE - reflect - transmit;
        let scattered = (1.0 - self.metallic) * (1.0 - self.transmission);
        let share = rest.map(|x| if x > 0.0 { (scattered / x).min(1.0) } else { 0.0 });
        ShadingParams {
            diffuse: self.base * share,
            specular: head_on.lerp(self.base, self.metallic),
            shininess: shininess(self.roughness),
            emission: Vec3::ZERO,
            reflect,
            transmit,
        }
    }
}

/// A metallic-roughness material with textures: factors, and the maps that they are multiplied with.
#[derive(Clone, Debug, PartialEq)]
pub struct MetallicRoughnessMaps {
    /// The factors.
    pub factors: MetallicRoughness,
    /// The map of the base colour.
    pub base: Option<TextureId>,
    /// The map of the metalness.
    pub metallic: Option<Channel>,
    /// The map of the roughness.
    pub roughness: Option<Channel>,
    /// The map of the strength of a dielectric's reflection.
    pub specular: Option<Channel>,
    /// The map of the colour of a dielectric's reflection.
    pub specular_color: Option<TextureId>,
    /// The map of the transmission.
    pub transmission: Option<Channel>,
}

impl MetallicRoughnessMaps {
    /// A material with these factors and no maps.
    pub fn new(factors: MetallicRoughness) -> Self {
        Self {
            factors,
            base: None,
            metallic: None,
            roughness: None,
            specular: None,
            specular_color: None,
            transmission: None,
        }
    }

    /// True if it reflects as a mirror anywhere.
    pub(super) fn may_reflect(&self) -> bool {
        let MetallicRoughness { metallic, roughness, transmission, ior, .. } = self.factors;
        let is_sharp = self.roughness.is_some() || mirror_share(roughness) > 0.0;
        (metallic > 0.0 && is_sharp) || (ior == 0.0 && transmission > 0.0)
    }

    /// True if it transmits light anywhere.
    pub(super) fn may_transmit(&self) -> bool {
        let MetallicRoughness { metallic, transmission, ior, .. } = self.factors;
        transmission > 0.0 && ior != 0.0 && (metallic < 1.0 || self.metallic.is_some())
    }
}

/// The Phong exponent whose highlight is as wide as that of a roughness: 2/α² − 2 with α = roughness²,
/// from 1 to 10000.
pub fn shininess(roughness: f32) -> f32 {
    let alpha = clamped_factor(roughness) * clamped_factor(roughness);
    (2.0 / (alpha * alpha) - 2.0).clamp(*SHININESS.start(), *SHININESS.end())
}

/// The share of a surface's reflection that is as sharp as a mirror's: (1 − α/0.16)² with
/// α = roughness², and 0 from roughness 0.4 on. The formula is ours; it is smooth at either end.
pub(crate) fn mirror_share(roughness: f32) -> f32 {
    let ratio = clamped_factor(roughness) / ROUGH;
    let rest = (1.0 - ratio * ratio).max(0.0);
    rest * rest
}

/// The reflectance at normal incidence of a surface with this index of refraction, by Fresnel's law.
fn reflectance_at_normal_incidence(ior: f32) -> f32 {
    let r = (ior - 1.0) / (ior + 1.0);
    r * r
}

/// Clamps a factor to [0, 1]; a NaN becomes 1, the default.
fn clamped_factor(x: f32) -> f32 {
    if x.is_nan() { 1.0 } else { x.clamp(0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shininess_follows_the_formula_within_its_range() {
        assert!((shininess(0.5) - 30.0).abs() < 1e-4);
        assert_eq!([0.0, 1.0, -3.0, f32::NAN].map(shininess), [1e4, 1.0, 1e4, 1.0]);
    }

    #[test]
    fn only_smooth_surfaces_are_sharp() {
        assert_eq!([0.0, 0.4, 0.5, 1.0, f32::NAN].map(mirror_share), [1.0, 0.0, 0.0, 0.0, 0.0]);
        // α/0.16 = ¼.
        assert!((mirror_share(0.2) - 0.5625).abs() < 1e-6);
        let values: Vec<f32> = (0..=100).map(|i| -mirror_share(i as f32 / 100.0)).collect();
        assert!(values.is_sorted());
    }

    #[test]
    fn glass_reflects_a_twenty_fifth_head_on() {
        assert!((reflectance_at_normal_incidence(1.5) - 0.04).abs() < 1e-8);
        assert_eq!(reflectance_at_normal_incidence(0.0), 1.0);
    }
}
