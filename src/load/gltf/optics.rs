//! Light that goes on from a glTF material: metals that mirror, transmission, volumes, alpha.

use glam::Vec3;
use gltf::json::extensions::material::Volume;
use gltf::json::material::AlphaMode;
use gltf::json::validation::Checked;

use super::material::{Maker, NOT_SAMPLED, unit};
use crate::error::Result;
use crate::scene::{Material, TextureId, Transfer};

/// The index of refraction of what names none.
const IOR: f32 = 1.5;

/// From this roughness on a metal mirrors nothing: what it reflects is too blurred to show.
const ROUGH: f32 = 0.4;

/// The share of what a surface reflects that is as sharp as in a mirror: (1 − α/0.16)² with
/// α = roughness², and 0 from roughness 0.4 on. Ours: smooth at either end.
pub fn sharpness(roughness: f32) -> f32 {
    let ratio = unit(roughness) / ROUGH;
    let rest = (1.0 - ratio * ratio).max(0.0);
    rest * rest
}

/// The share that a surface of this index reflects head-on, by Fresnel's law.
pub fn head_on(ior: f32) -> f32 {
    let r = (ior - 1.0) / (ior + 1.0);
    r * r
}

/// KHR_materials_transmission, with what other extensions say of it.
pub struct Transmission {
    /// The share of the light that enters, and is not scattered.
    pub share: f32,
    /// The index of refraction; 0 reflects everything.
    pub ior: f32,
    /// What a body absorbs per unit of length; none for a thin wall.
    pub inside: Option<Vec3>,
}

impl Transmission {
    /// Lets a share of the light through, coloured by `tint`.
    pub fn apply(&self, tint: Vec3, material: &mut Material) {
        let transmit = tint * self.share;
        if self.ior == 0.0 {
            material.reflect += transmit;
            return;
        }
        material.transmit = transmit;
        material.ior = f64::from(self.ior);
        material.thin = self.inside.is_none();
        material.absorption = self.inside.unwrap_or_default();
    }
}

/// What a volume absorbs per unit of length, −ln(attenuationColor) / attenuationDistance; none
/// where it has no thickness, and so no inside.
fn absorption(volume: &Volume) -> Option<Vec3> {
    // No light at all would take infinite absorption; a millionth is as dark.
    const BLACK: f32 = 1e-6;
    const MOST: f32 = 1e30;
    let distance = volume.attenuation_distance.0;
    // What is no distance absorbs nothing.
    let distance = if distance > 0.0 { distance.max(f32::MIN_POSITIVE) } else { f32::INFINITY };
    let per_unit = |color: f32| -> f32 {
        let color = if color.is_nan() { 1.0 } else { color.clamp(BLACK, 1.0) };
        (-color.ln() / distance).clamp(0.0, MOST)
    };
    (volume.thickness_factor.0 > 0.0).then(|| Vec3::from(volume.attenuation_color.0.map(per_unit)))
}

/// Makes a material cover only `alpha` of what lies behind it; the rest is seen straight through.
fn cover(material: &mut Material, alpha: f32) {
    material.reflect *= alpha;
    material.emission *= alpha;
    material.transmit = Vec3::splat(1.0 - alpha);
    material.ior = 1.0;
    material.thin = true;
}

impl Maker<'_, '_> {
    /// KHR_materials_transmission, _volume and _ior.
    pub fn transmission(&mut self) -> Result<Transmission> {
        let extensions = self.source.extensions.as_ref();
        let mut ior = extensions.and_then(|e| e.ior.as_ref()).map_or(IOR, |e| e.ior.0);
        if ior != 0.0 && !(1.0..=100.0).contains(&ior) {
            let at = &self.at;
            self.tally.add(
                "{} indices of refraction are not from 1 to 100 and become 1.5",
                1,
                || format!("{at}.extensions.KHR_materials_ior.ior"),
            );
            ior = IOR;
        }
        let mut share = 0.0;
        if let Some(e) = extensions.and_then(|e| e.transmission.as_ref()) {
            share = unit(e.transmission_factor.0);
            if share > 0.0
                && let Some(info) = &e.transmission_texture
            {
                let place = format!(
                    "{}.extensions.KHR_materials_transmission.transmissionTexture",
                    self.at
                );
                share *= self.mean(info, Transfer::None, &place, NOT_SAMPLED)?[0];
            }
        }
        let inside = extensions.and_then(|e| e.volume.as_ref()).and_then(absorption);
        Ok(Transmission { share, ior, inside })
    }

    /// The colour of what is mirrored or seen through: each of its shares at most 1.
    pub fn tint(&mut self, base: Vec3) -> Result<Vec3> {
        let mut tint = base;
        if let Some(info) = &self.source.pbr_metallic_roughness.base_color_texture {
            let place = format!("{}.pbrMetallicRoughness.baseColorTexture", self.at);
            let reason = "{} textures colour what is mirrored or seen through by their mean alone";
            let [r, g, b, _] = self.mean(info, Transfer::Srgb, &place, reason)?;
            tint *= Vec3::new(r, g, b);
        }
        Ok(tint.min(Vec3::ONE))
    }

    /// What shines through by alpha: by the factor alone, since the picture's is not read yet.
    pub fn alpha(&mut self, factor: f32, picture: Option<TextureId>, material: &mut Material) {
        let picture = picture.map(|id| &self.scene.textures[id.0 as usize].image.texels);
        let pictured = || picture.is_some_and(|texels| texels.iter().any(|texel| texel[3] < 255));
        let (alpha, reason) = match self.source.alpha_mode {
            Checked::Valid(AlphaMode::Mask) => {
                let cutoff = self.source.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
                let alpha = if factor < cutoff { 0.0 } else { 1.0 };
                (alpha, "{} materials cut out by the alpha of their picture are drawn whole")
            }
            Checked::Valid(AlphaMode::Blend) => {
                (factor, "{} materials are drawn as if their picture had no alpha")
            }
            Checked::Valid(AlphaMode::Opaque) | Checked::Invalid => return,
        };
        let at = &self.at;
        if alpha > 0.0 && pictured() {
            self.tally.unsupported(reason, 1, || at.clone());
        }
        if alpha == 1.0 {
            return;
        }
        if material.transmit == Vec3::ZERO {
            cover(material, alpha);
        } else {
            let reason = "{} materials transmit light and have alpha: the alpha is left out";
            self.tally.unsupported(reason, 1, || at.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_smooth_surfaces_are_sharp() {
        assert_eq!([0.0, 0.4, 0.5, 1.0, f32::NAN].map(sharpness), [1.0, 0.0, 0.0, 0.0, 0.0]);
        // α/0.16 = ¼.
        assert!((sharpness(0.2) - 0.5625).abs() < 1e-6);
        let values: Vec<f32> = (0..=100).map(|i| -sharpness(i as f32 / 100.0)).collect();
        assert!(values.is_sorted());
    }

    #[test]
    fn glass_reflects_a_twenty_fifth_head_on() {
        assert!((head_on(1.5) - 0.04).abs() < 1e-8);
        assert_eq!(head_on(0.0), 1.0);
    }
}
