//! glTF's metallic-roughness materials on a Lambert and Phong surface, as docs/formats.md explains.

use glam::Vec3;

use crate::scene::{Channel, TextureId};

/// The range of shininess: roughness 1 would give 0, and roughness 0 infinity.
const SHININESS: std::ops::RangeInclusive<f32> = 1.0..=10_000.0;

/// From this roughness on a metal mirrors nothing: what it reflects is too blurred to show.
const ROUGH: f32 = 0.4;

/// What becomes of light at one point of a surface, linear Rec. 709; the fields are those of
/// [`Material`](crate::scene::Material).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingParams {
    /// Share scattered to all sides.
    pub diffuse: Vec3,
    /// Share in the highlight.
    pub specular: Vec3,
    /// Phong's exponent.
    pub shininess: f32,
    /// Radiance of its own.
    pub emission: Vec3,
    /// Share seen in it as in a mirror.
    pub reflect: Vec3,
    /// Share seen through it.
    pub transmit: Vec3,
}

impl ShadingParams {
    /// Of a surface that covers only `alpha` of what lies behind it, and lets nothing through by
    /// itself: the rest is seen straight through.
    pub fn with_alpha(self, alpha: f32) -> Self {
        Self {
            emission: self.emission * alpha,
            reflect: self.reflect * alpha,
            transmit: Vec3::splat(1.0 - alpha),
            ..self
        }
    }

    /// Whether light goes on from it, off it or through it.
    pub fn spawns_rays(&self) -> bool {
        self.reflect != Vec3::ZERO || self.transmit != Vec3::ZERO
    }
}

/// The parameters of a metallic-roughness material at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetallicRoughness {
    /// The base colour, linear Rec. 709.
    pub base: Vec3,
    /// How much of a metal it is, in \[0, 1\].
    pub metallic: f32,
    /// Its roughness, in \[0, 1\].
    pub roughness: f32,
    /// KHR_materials_specular: how strongly what is no metal reflects, in \[0, 1\], and its colour.
    pub specular: f32,
    /// The colour of that.
    pub specular_color: Vec3,
    /// KHR_materials_transmission: the share of the light that enters and is not scattered.
    pub transmission: f32,
    /// The index of refraction; at 0 everything is reflected.
    pub ior: f32,
}

impl MetallicRoughness {
    /// What it does with light.
    pub fn shading_params(&self) -> ShadingParams {
        let head_on = (self.specular_color * reflectance_at_normal_incidence(self.ior))
            .min(Vec3::ONE)
            * self.specular;
        let tint = self.base.min(Vec3::ONE);
        let mut reflect = tint * (self.metallic * mirror_share(self.roughness));
        let mut transmit = tint * ((1.0 - self.metallic) * self.transmission);
        if self.ior == 0.0 {
            reflect += transmit;
            transmit = Vec3::ZERO;
        }
        // What is left of the whole is scattered; the share that glTF means is within it.
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

/// A metallic-roughness material of which some parameters differ from point to point: factors, and
/// the maps that they are multiplied with.
#[derive(Clone, Debug, PartialEq)]
pub struct MetallicRoughnessMaps {
    /// The factors.
    pub factors: MetallicRoughness,
    /// The base colour.
    pub base: Option<TextureId>,
    /// How much of a metal it is.
    pub metallic: Option<Channel>,
    /// The roughness.
    pub roughness: Option<Channel>,
    /// How strongly what is no metal reflects.
    pub specular: Option<Channel>,
    /// The colour of that.
    pub specular_color: Option<TextureId>,
    /// The share that is transmitted.
    pub transmission: Option<Channel>,
}

impl MetallicRoughnessMaps {
    /// These factors everywhere.
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

    /// Whether it is a mirror anywhere.
    pub(super) fn may_reflect(&self) -> bool {
        let MetallicRoughness { metallic, roughness, transmission, ior, .. } = self.factors;
        let is_sharp = self.roughness.is_some() || mirror_share(roughness) > 0.0;
        (metallic > 0.0 && is_sharp) || (ior == 0.0 && transmission > 0.0)
    }

    /// Whether it lets light through anywhere.
    pub(super) fn may_transmit(&self) -> bool {
        let MetallicRoughness { metallic, transmission, ior, .. } = self.factors;
        transmission > 0.0 && ior != 0.0 && (metallic < 1.0 || self.metallic.is_some())
    }
}

/// α = roughness², and the Phong exponent whose highlight is as wide: 2/α² − 2, from 1 to 10000.
pub fn shininess(roughness: f32) -> f32 {
    let alpha = clamped_factor(roughness) * clamped_factor(roughness);
    (2.0 / (alpha * alpha) - 2.0).clamp(*SHININESS.start(), *SHININESS.end())
}

/// The share of what a surface reflects that is as sharp as in a mirror: (1 − α/0.16)² with
/// α = roughness², and 0 from roughness 0.4 on. Ours: smooth at either end.
pub fn mirror_share(roughness: f32) -> f32 {
    let ratio = clamped_factor(roughness) / ROUGH;
    let rest = (1.0 - ratio * ratio).max(0.0);
    rest * rest
}

/// The share that a surface of this index reflects head-on, by Fresnel's law.
fn reflectance_at_normal_incidence(ior: f32) -> f32 {
    let r = (ior - 1.0) / (ior + 1.0);
    r * r
}

/// A factor within [0, 1]; what is no number is 1, the default.
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
