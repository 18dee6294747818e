//! The extensions of metallic-roughness materials that the `gltf` crate leaves as JSON: clearcoat, sheen,
//! anisotropy, iridescence, dispersion and diffuse transmission.

use gltf::json::{Value, texture::Info};

use super::reader::{MaterialReader, clamped};
use crate::error::Result;
use crate::load::gltf::import::texture_reference::TextureReference;
use crate::scene::{Channel, MetallicRoughnessMaps, NormalMap, TextureId, Transfer};

/// Sets the parameters of these extensions, and returns the normal map of the clearcoat.
///
/// # Errors
/// When a reference to a texture leads nowhere.
pub fn read(
    reader: &mut MaterialReader,
    maps: &mut MetallicRoughnessMaps,
) -> Result<Option<NormalMap>> {
    sheen(reader, maps)?;
    anisotropy(reader, maps)?;
    iridescence(reader, maps)?;
    diffuse_transmission(reader, maps)?;
    if let Some(extension) = Extension::of(reader, "KHR_materials_dispersion") {
        maps.factors.dispersion = extension.at_least_0("dispersion", 0.0);
    }
    clearcoat(reader, maps)
}

fn clearcoat(
    reader: &mut MaterialReader,
    maps: &mut MetallicRoughnessMaps,
) -> Result<Option<NormalMap>> {
    let Some(extension) = Extension::of(reader, "KHR_materials_clearcoat") else { return Ok(None) };
    maps.factors.clearcoat = extension.share("clearcoatFactor", 0.0);
    if maps.factors.clearcoat == 0.0 {
        return Ok(None);
    }
    maps.factors.clearcoat_roughness = extension.share("clearcoatRoughnessFactor", 0.0);
    maps.clearcoat = extension.channel(reader, "clearcoatTexture", 0)?;
    maps.clearcoat_roughness = extension.channel(reader, "clearcoatRoughnessTexture", 1)?;
    let key = "clearcoatNormalTexture";
    let Some(texture) = extension.texture(reader, key, Transfer::None)? else { return Ok(None) };
    reader.needed.tangents = true;
    let scale = extension.value.get(key).and_then(|info| info.get("scale")).and_then(Value::as_f64);
    Ok(Some(NormalMap { texture, scale: scale.map_or(1.0, |scale| scale as f32) }))
}

fn sheen(reader: &mut MaterialReader, maps: &mut MetallicRoughnessMaps) -> Result<()> {
    let Some(extension) = Extension::of(reader, "KHR_materials_sheen") else { return Ok(()) };
    let color = extension.numbers("sheenColorFactor", [0.0; 3]);
    maps.factors.sheen_color = reader.color(color, extension.path("sheenColorFactor"));
    maps.factors.sheen_roughness = extension.share("sheenRoughnessFactor", 0.0);
    maps.sheen_color = extension.texture(reader, "sheenColorTexture", Transfer::Srgb)?;
    maps.sheen_roughness = extension.channel(reader, "sheenRoughnessTexture", 3)?;
    Ok(())
}

fn anisotropy(reader: &mut MaterialReader, maps: &mut MetallicRoughnessMaps) -> Result<()> {
    let Some(extension) = Extension::of(reader, "KHR_materials_anisotropy") else { return Ok(()) };
    maps.factors.anisotropy = extension.share("anisotropyStrength", 0.0);
    if maps.factors.anisotropy == 0.0 {
        return Ok(());
    }
    maps.factors.anisotropy_rotation = extension.number("anisotropyRotation", 0.0);
    maps.anisotropy = extension.texture(reader, "anisotropyTexture", Transfer::None)?;
    // The direction of the brush is that of the tangents.
    reader.needed.tangents = true;
    Ok(())
}

fn iridescence(reader: &mut MaterialReader, maps: &mut MetallicRoughnessMaps) -> Result<()> {
    let Some(extension) = Extension::of(reader, "KHR_materials_iridescence") else { return Ok(()) };
    maps.factors.iridescence = extension.share("iridescenceFactor", 0.0);
    if maps.factors.iridescence == 0.0 {
        return Ok(());
    }
    maps.factors.iridescence_ior = extension.at_least_0("iridescenceIor", 1.3).max(1.0);
    maps.factors.iridescence_thickness = extension.at_least_0("iridescenceThicknessMaximum", 400.0);
    maps.iridescence_thickness_minimum = extension.at_least_0("iridescenceThicknessMinimum", 100.0);
    maps.iridescence = extension.channel(reader, "iridescenceTexture", 0)?;
    maps.iridescence_thickness = extension.channel(reader, "iridescenceThicknessTexture", 1)?;
    Ok(())
}

fn diffuse_transmission(
    reader: &mut MaterialReader,
    maps: &mut MetallicRoughnessMaps,
) -> Result<()> {
    let name = "KHR_materials_diffuse_transmission";
    let Some(extension) = Extension::of(reader, name) else { return Ok(()) };
    maps.factors.diffuse_transmission = extension.share("diffuseTransmissionFactor", 0.0);
    if maps.factors.diffuse_transmission == 0.0 {
        return Ok(());
    }
    let key = "diffuseTransmissionColorFactor";
    let color = extension.numbers(key, [1.0; 3]);
    maps.factors.diffuse_transmission_color = reader.color(color, extension.path(key));
    maps.diffuse_transmission = extension.channel(reader, "diffuseTransmissionTexture", 3)?;
    let key = "diffuseTransmissionColorTexture";
    maps.diffuse_transmission_color = extension.texture(reader, key, Transfer::Srgb)?;
    Ok(())
}

/// An extension of a material, as JSON. A property that is not what it should be counts as missing; the check
/// of the file reports it.
struct Extension<'a> {
    name: &'static str,
    value: &'a Value,
}

impl<'a> Extension<'a> {
    /// Returns an extension of the material that is read, if it has it.
    fn of(reader: &MaterialReader<'_, 'a>, name: &'static str) -> Option<Self> {
        let value = reader.extensions?.others.get(name)?;
        Some(Self { name, value })
    }

    /// Returns the path of a property within the material.
    fn path(&self, key: &str) -> String {
        format!("extensions.{}.{key}", self.name)
    }

    fn number(&self, key: &str, default: f32) -> f32 {
        let number = self.value.get(key).and_then(Value::as_f64).map(|x| x as f32);
        number.filter(|x| x.is_finite()).unwrap_or(default)
    }

    fn share(&self, key: &str, default: f32) -> f32 {
        clamped(self.number(key, default))
    }

    fn at_least_0(&self, key: &str, default: f32) -> f32 {
        self.number(key, default).max(0.0)
    }

    fn numbers(&self, key: &str, default: [f32; 3]) -> [f32; 3] {
        let Some(list) = self.value.get(key).and_then(Value::as_array) else { return default };
        let number = |i: usize| list.get(i).and_then(Value::as_f64).map(|x| x as f32);
        std::array::from_fn(|i| number(i).unwrap_or(default[i]))
    }

    fn texture(
        &self,
        reader: &mut MaterialReader,
        key: &str,
        transfer: Transfer,
    ) -> Result<Option<TextureId>> {
        let info = self.value.get(key).cloned();
        let Some(info) =
            info.and_then(|info| gltf::json::deserialize::from_value::<Info>(info).ok())
        else {
            return Ok(None);
        };
        let reference = TextureReference::from_info(&info);
        reader.texture(reference, transfer, self.path(key)).map(Some)
    }

    fn channel(
        &self,
        reader: &mut MaterialReader,
        key: &str,
        channel: u8,
    ) -> Result<Option<Channel>> {
        let texture = self.texture(reader, key, Transfer::None)?;
        Ok(texture.map(|texture| Channel { texture, channel }))
    }
}
