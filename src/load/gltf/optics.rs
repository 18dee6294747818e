//! Light that goes on from a glTF material: transmission, volumes, alpha.

use glam::Vec3;
use gltf::json::extensions::material::Volume;
use gltf::json::material::AlphaMode as Mode;
use gltf::json::validation::Checked;

use super::material::{Maker, is_frosted, unit};
use crate::error::Result;
use crate::scene::{AlphaMode, Channel, Coverage, Material, MetallicRoughnessMaps, TextureId};

/// The index of refraction of what names none.
const IOR: f32 = 1.5;

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

impl Maker<'_, '_> {
    /// KHR_materials_ior; 0 reflects everything.
    pub fn ior(&mut self) -> f32 {
        let extensions = self.source.extensions.as_ref();
        let ior = extensions.and_then(|e| e.ior.as_ref()).map_or(IOR, |e| e.ior.0);
        if ior == 0.0 || (1.0..=100.0).contains(&ior) {
            return ior;
        }
        let at = &self.at;
        self.tally.add("{} indices of refraction are not from 1 to 100 and become 1.5", 1, || {
            format!("{at}.extensions.KHR_materials_ior.ior")
        });
        IOR
    }

    /// KHR_materials_transmission.
    pub fn transmission(&mut self, maps: &mut MetallicRoughnessMaps) -> Result<()> {
        let extensions = self.source.extensions.as_ref();
        let Some(source) = extensions.and_then(|e| e.transmission.as_ref()) else { return Ok(()) };
        maps.factors.transmission = unit(source.transmission_factor.0);
        if maps.factors.transmission == 0.0 {
            return Ok(());
        }
        if let Some(info) = &source.transmission_texture {
            let place = "extensions.KHR_materials_transmission.transmissionTexture";
            maps.transmission = Some(self.channel(info, 0, place)?);
        }
        if is_frosted(maps.factors.roughness) && maps.factors.metallic < 1.0 {
            let at = &self.at;
            let reason = match maps.roughness {
                None => "{} frosted materials are drawn clear",
                Some(_) => "{} materials that transmit light are drawn clear where they are rough",
            };
            self.tally.unsupported(reason, 1, || at.clone());
        }
        Ok(())
    }

    /// What is behind the surface of a material that transmits light: KHR_materials_volume, or
    /// nothing.
    pub fn inside(&mut self, material: &mut Material) {
        if !material.may_transmit() {
            return;
        }
        let extensions = self.source.extensions.as_ref();
        let inside = extensions.and_then(|e| e.volume.as_ref()).and_then(absorption);
        material.thin = inside.is_none();
        material.absorption = inside.unwrap_or_default();
        material.ior = f64::from(material.metallic.as_ref().map_or(IOR, |m| m.factors.ior));
    }

    /// How much the material covers, by its factor and the alpha of its base colour texture.
    pub fn alpha(&mut self, alpha: f32, picture: Option<TextureId>, material: &mut Material) {
        let mode = match self.source.alpha_mode {
            Checked::Valid(Mode::Opaque) | Checked::Invalid => return,
            Checked::Valid(Mode::Mask) => {
                let cutoff = self.source.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
                AlphaMode::Mask { cutoff }
            }
            Checked::Valid(Mode::Blend) if material.may_transmit() => {
                let at = &self.at;
                let reason = "{} materials transmit light and have alpha: the alpha is left out";
                self.tally.unsupported(reason, 1, || at.clone());
                return;
            }
            Checked::Valid(Mode::Blend) => {
                (material.thin, material.ior) = (true, 1.0);
                AlphaMode::Blend
            }
        };
        self.asks.alpha = true;
        let map = picture.map(|texture| Channel { texture, channel: 3 });
        material.coverage = Some(Coverage { alpha, map, mode });
    }
}
