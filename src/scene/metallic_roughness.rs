//! The metallic-roughness materials of glTF, and the Lambert and Phong materials that approximate them
//! (see docs/formats.md).

use std::ops::RangeInclusive;

use glam::Vec3;

use crate::scene::{Channel, ShadingParams, TextureId};

/// The range of shininess: roughness 1 would give 0, and roughness 0 infinity.
const SHININESS: std::ops::RangeInclusive<f32> = 1.0..=10_000.0;

/// The roughness from which on a metal mirrors nothing: its reflections are too blurred to show.
const ROUGH: f32 = 0.4;

/// The parameters of a metallic-roughness material at one point of a surface: those of the glTF 2.0
/// specification (3.9) and of its extensions for materials. The default is that of glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetallicRoughness {
    /// The base colour, linear Rec. 709, in \[0, 1\].
    pub base_color: Vec3,
    /// The metalness, in \[0, 1\].
    pub metallic: f32,
    /// The roughness, in \[0, 1\]; its square is α.
    pub roughness: f32,
    /// The index of refraction, at least 1, or 0 for a surface that reflects everything
    /// (KHR_materials_ior).
    pub ior: f32,
    /// The strength of a dielectric's reflection, in \[0, 1\] (KHR_materials_specular).
    pub specular: f32,
    /// The colour of a dielectric's reflection at normal incidence, at least 0 (KHR_materials_specular).
    pub specular_color: Vec3,
    /// The share of the light in the base of a dielectric that is transmitted, in \[0, 1\]
    /// (KHR_materials_transmission).
    pub transmission: f32,
    /// True for a surface without an inside, through which light goes straight; false for the boundary of
    /// a volume (KHR_materials_volume).
    pub is_thin: bool,
    /// The strength of the clearcoat, in \[0, 1\] (KHR_materials_clearcoat).
    pub clearcoat: f32,
    /// The roughness of the clearcoat, in \[0, 1\].
    pub clearcoat_roughness: f32,
    /// The colour of the sheen, in \[0, 1\] (KHR_materials_sheen).
    pub sheen_color: Vec3,
    /// The roughness of the sheen, in \[0, 1\].
    pub sheen_roughness: f32,
    /// The strength of the anisotropy, in \[0, 1\] (KHR_materials_anisotropy).
    pub anisotropy: f32,
    /// The angle from the tangent to the direction of more roughness, in radians, counter-clockwise.
    pub anisotropy_rotation: f32,
    /// The strength of the iridescence, in \[0, 1\] (KHR_materials_iridescence).
    pub iridescence: f32,
    /// The index of refraction of the thin film, at least 1.
    pub iridescence_ior: f32,
    /// The thickness of the thin film in nanometres, at least 0.
    pub iridescence_thickness: f32,
    /// The dispersion, 20 divided by the Abbe number, at least 0 (KHR_materials_dispersion).
    pub dispersion: f32,
    /// The share of the diffuse light that is transmitted, in \[0, 1\]
    /// (KHR_materials_diffuse_transmission).
    pub diffuse_transmission: f32,
    /// The colour of the diffuse light that is transmitted, in \[0, 1\].
    pub diffuse_transmission_color: Vec3,
}

impl Default for MetallicRoughness {
    fn default() -> Self {
        Self {
            base_color: Vec3::ONE,
            metallic: 1.0,
            roughness: 1.0,
            ior: 1.5,
            specular: 1.0,
            specular_color: Vec3::ONE,
            transmission: 0.0,
            is_thin: true,
            clearcoat: 0.0,
            clearcoat_roughness: 0.0,
            sheen_color: Vec3::ZERO,
            sheen_roughness: 0.0,
            anisotropy: 0.0,
            anisotropy_rotation: 0.0,
            iridescence: 0.0,
            iridescence_ior: 1.3,
            iridescence_thickness: 400.0,
            dispersion: 0.0,
            diffuse_transmission: 0.0,
            diffuse_transmission_color: Vec3::ONE,
        }
    }
}

impl MetallicRoughness {
    /// Returns the parameters with each at the nearest value in its range; one that is not a number is
    /// glTF's default.
    pub fn in_range(&self) -> Self {
        let default = Self::default();
        let number = |x: f32, default: f32| if x.is_nan() { default } else { x };
        let share = |x: f32, default: f32| number(x, default).clamp(0.0, 1.0);
        let color = |color: Vec3, default: Vec3| {
            Vec3::from_array(std::array::from_fn(|i| share(color[i], default[i])))
        };
        let finite = |x: f32, default: f32, least: f32| number(x, default).clamp(least, 1e6);
        Self {
            base_color: color(self.base_color, default.base_color),
            metallic: share(self.metallic, default.metallic),
            roughness: share(self.roughness, default.roughness),
            ior: if self.ior == 0.0 { 0.0 } else { finite(self.ior, default.ior, 1.0) },
            specular: share(self.specular, default.specular),
            specular_color: self.specular_color.map(|x| finite(x, 1.0, 0.0)),
            transmission: share(self.transmission, default.transmission),
            is_thin: self.is_thin,
            clearcoat: share(self.clearcoat, default.clearcoat),
            clearcoat_roughness: share(self.clearcoat_roughness, default.clearcoat_roughness),
            sheen_color: color(self.sheen_color, default.sheen_color),
            sheen_roughness: share(self.sheen_roughness, default.sheen_roughness),
            anisotropy: share(self.anisotropy, default.anisotropy),
            anisotropy_rotation: finite(self.anisotropy_rotation, 0.0, -1e6),
            iridescence: share(self.iridescence, default.iridescence),
            iridescence_ior: finite(self.iridescence_ior, default.iridescence_ior, 1.0),
            iridescence_thickness: finite(self.iridescence_thickness, 400.0, 0.0),
            dispersion: finite(self.dispersion, default.dispersion, 0.0),
            diffuse_transmission: share(self.diffuse_transmission, default.diffuse_transmission),
            diffuse_transmission_color: color(self.diffuse_transmission_color, Vec3::ONE),
        }
    }

    /// The Lambert and Phong parameters that approximate it.
    pub fn shading_params(&self) -> ShadingParams {
        // A dielectric's reflectance, the mirror-like part of a metal's, and what is transmitted.
        let head_on = (self.specular_color * reflectance_at_normal_incidence(self.ior))
            .min(Vec3::ONE)
            * self.specular;
        let base = self.base_color.min(Vec3::ONE);
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
            diffuse: self.base_color * share,
            specular: head_on.lerp(self.base_color, self.metallic),
            shininess: shininess(self.roughness),
            emission: Vec3::ZERO,
            reflect,
            transmit,
        }
    }
}

/// A metallic-roughness material with textures: factors, and the maps that they are multiplied with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MetallicRoughnessMaps {
    /// The factors.
    pub factors: MetallicRoughness,
    /// The map of the base colour.
    pub base_color: Option<TextureId>,
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
    /// The map of the strength of the clearcoat.
    pub clearcoat: Option<Channel>,
    /// The map of the roughness of the clearcoat.
    pub clearcoat_roughness: Option<Channel>,
    /// The map of the colour of the sheen.
    pub sheen_color: Option<TextureId>,
    /// The map of the roughness of the sheen.
    pub sheen_roughness: Option<Channel>,
    /// The map of the anisotropy: red and green from 0 to 1 are the cosine and the sine, from −1 to 1, of an
    /// angle that is added to the rotation; blue is a factor of the strength.
    pub anisotropy: Option<TextureId>,
    /// The map of the strength of the iridescence.
    pub iridescence: Option<Channel>,
    /// The map of the thickness of the thin film: from the minimum at 0 to that of the factors at 1.
    pub iridescence_thickness: Option<Channel>,
    /// The thickness of the thin film, in nanometres, where its map is 0.
    pub iridescence_thickness_minimum: f32,
    /// The map of the share of the diffuse light that is transmitted.
    pub diffuse_transmission: Option<Channel>,
    /// The map of the colour of the diffuse light that is transmitted.
    pub diffuse_transmission_color: Option<TextureId>,
}

impl MetallicRoughnessMaps {
    /// A material with these factors and no maps.
    pub fn new(factors: MetallicRoughness) -> Self {
        Self { factors, ..Self::default() }
    }

    /// Returns the channels that it maps.
    pub(super) fn channels(&self) -> impl Iterator<Item = Channel> {
        let channels = [
            self.metallic,
            self.roughness,
            self.specular,
            self.transmission,
            self.clearcoat,
            self.clearcoat_roughness,
            self.sheen_roughness,
            self.iridescence,
            self.iridescence_thickness,
            self.diffuse_transmission,
        ];
        channels.into_iter().flatten()
    }

    /// True if it reflects as a mirror anywhere.
    pub(super) fn may_reflect(&self) -> bool {
        let MetallicRoughness { metallic, roughness, transmission, ior, .. } = self.factors;
        let is_sharp = self.roughness.is_some() || mirror_share(roughness) > 0.0;
        (metallic > 0.0 && is_sharp) || (ior == 0.0 && transmission > 0.0)
    }

    /// True if it reflects light anywhere so sharply that physically based shading traces the reflected rays.
    pub(super) fn may_reflect_sharply(&self) -> bool {
        let MetallicRoughness { roughness, clearcoat, clearcoat_roughness, .. } = self.factors;
        let is_sharp =
            |map: Option<Channel>, roughness| map.is_some() || ray_share(roughness) > 0.0;
        is_sharp(self.roughness, roughness)
            || (clearcoat > 0.0 && is_sharp(self.clearcoat_roughness, clearcoat_roughness))
    }

    /// The ranges of the roughnesses by which an environment is blurred in its reflections, and in what it
    /// transmits.
    pub(crate) fn blurred_roughnesses(&self) -> impl Iterator<Item = RangeInclusive<f32>> {
        let factors = self.factors.in_range();
        let range = |map: Option<Channel>, roughness: f32, is_traced: bool| {
            // Where rays are traced, what they see is blurred less.
            let is_fixed = map.is_none() && !is_traced && ray_share(roughness) == 0.0;
            if is_fixed { roughness..=roughness } else { 0.0..=roughness }
        };
        let base = range(self.roughness, factors.roughness, self.may_transmit());
        let clearcoat = factors.clearcoat > 0.0;
        let clearcoat =
            clearcoat.then(|| range(self.clearcoat_roughness, factors.clearcoat_roughness, false));
        std::iter::once(base).chain(clearcoat)
    }

    /// True if it transmits light anywhere.
    pub(crate) fn may_transmit(&self) -> bool {
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

/// The share of a physically based reflection that a reflected ray sees, which meets other objects; the rest is
/// that of the environment, filtered by the roughness. It is 1 up to a roughness of 0.15, and 0 from 0.3 on.
/// The formula is ours.
pub(crate) fn ray_share(roughness: f32) -> f32 {
    const FULL: f32 = 0.15;
    const NONE: f32 = 0.3;
    let x = ((NONE - roughness) / (NONE - FULL)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
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
