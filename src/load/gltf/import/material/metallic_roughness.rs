//! Metallic-roughness materials: the core's, with KHR_materials_ior, _specular, _transmission and
//! _volume, and with the extensions that only physically based shading shows.

use glam::Vec3;
use gltf::json::extensions::material::Volume;

use super::layers;
use super::reader::{MaterialReader, clamped};
use crate::error::Result;
use crate::scene::{
    Material, MetallicRoughness, MetallicRoughnessMaps, ShadingModel, TextureId, mirror_share,
};

/// The index of refraction of materials that name none.
const DEFAULT_IOR: f32 = 1.5;

/// Sets the parameters of a metallic-roughness material, and returns its base colour texture.
pub fn read(reader: &mut MaterialReader, material: &mut Material) -> Result<Option<TextureId>> {
    let pbr = &reader.source.pbr_metallic_roughness;
    let key = "pbrMetallicRoughness";

    // The factors, those of extensions at their defaults.
    let base = reader
        .color_texture(pbr.base_color_texture.as_ref(), format_args!("{key}.baseColorTexture"))?;
    let factors = MetallicRoughness {
        base_color: base_color(reader),
        metallic: clamped(pbr.metallic_factor.0),
        roughness: clamped(pbr.roughness_factor.0),
        ior: ior(reader),
        ..MetallicRoughness::default()
    };
    let mut maps =
        MetallicRoughnessMaps { base_color: base, ..MetallicRoughnessMaps::new(factors) };

    // Roughness is in the green channel, and metalness in the blue; a factor of 0 leaves nothing of
    // the map.
    let info = pbr.metallic_roughness_texture.as_ref();
    let key = format!("{key}.metallicRoughnessTexture");
    maps.roughness = reader.channel(info.filter(|_| factors.roughness > 0.0), 1, &key)?;
    maps.metallic = reader.channel(info.filter(|_| factors.metallic > 0.0), 2, &key)?;

    // The extensions change the factors and add maps.
    specular(reader, &mut maps)?;
    transmission(reader, material.shading, &mut maps)?;
    if material.shading == ShadingModel::Pbr {
        material.clearcoat_normal_map = layers::read(reader, &mut maps)?;
    }
    // Behind a surface that transmits light is a medium, or nothing.
    if maps.may_transmit() {
        volume(reader, &mut maps.factors, material);
    }
    material.set_metallic_roughness(maps);
    Ok(base)
}

/// Returns the base colour factor.
pub fn base_color(reader: &mut MaterialReader) -> Vec3 {
    let [r, g, b, _] = reader.source.pbr_metallic_roughness.base_color_factor.0;
    reader.color([r, g, b], "pbrMetallicRoughness.baseColorFactor")
}

/// Returns the index of refraction of KHR_materials_ior; 0 reflects everything.
fn ior(reader: &mut MaterialReader) -> f32 {
    let ior = reader.extensions.and_then(|e| e.ior.as_ref()).map_or(DEFAULT_IOR, |e| e.ior.0);
    if ior == 0.0 || (1.0..=100.0).contains(&ior) {
        return ior;
    }
    let reason = "{} indices of refraction are not from 1 to 100 and become 1.5";
    let path = || format!("{}.extensions.KHR_materials_ior.ior", reader.path);
    reader.diagnostics.add(reason, 1, path);
    DEFAULT_IOR
}

/// Sets the parameters of KHR_materials_specular.
fn specular(reader: &mut MaterialReader, maps: &mut MetallicRoughnessMaps) -> Result<()> {
    let Some(source) = reader.extensions.and_then(|e| e.specular.as_ref()) else { return Ok(()) };
    let key = |key: &str| format!("extensions.KHR_materials_specular.{key}");
    maps.factors.specular = clamped(source.specular_factor.0);
    maps.factors.specular_color =
        reader.color(source.specular_color_factor.0, key("specularColorFactor"));
    maps.specular = reader.channel(source.specular_texture.as_ref(), 3, key("specularTexture"))?;
    maps.specular_color = reader
        .color_texture(source.specular_color_texture.as_ref(), key("specularColorTexture"))?;
    Ok(())
}

/// Sets the parameters of KHR_materials_transmission.
fn transmission(
    reader: &mut MaterialReader,
    shading: ShadingModel,
    maps: &mut MetallicRoughnessMaps,
) -> Result<()> {
    let Some(source) = reader.extensions.and_then(|e| e.transmission.as_ref()) else {
        return Ok(());
    };
    maps.factors.transmission = clamped(source.transmission_factor.0);
    if maps.factors.transmission == 0.0 {
        return Ok(());
    }
    let key = "extensions.KHR_materials_transmission.transmissionTexture";
    maps.transmission = reader.channel(source.transmission_texture.as_ref(), 0, key)?;
    // The light that such a rough surface transmits is too blurred to be drawn sharp.
    let is_sharp = mirror_share(maps.factors.roughness) > 0.0;
    if shading == ShadingModel::Phong && !is_sharp && maps.factors.metallic < 1.0 {
        reader.report_unsupported(if maps.roughness.is_none() {
            "{} frosted materials are drawn clear"
        } else {
            "{} materials that transmit light are drawn clear where they are rough"
        });
    }
    Ok(())
}

/// Sets what is behind the surface of a material that transmits light: the medium of
/// KHR_materials_volume, or nothing.
fn volume(reader: &MaterialReader, factors: &mut MetallicRoughness, material: &mut Material) {
    let absorption = reader.extensions.and_then(|e| e.volume.as_ref()).and_then(absorption);
    // A surface without a volume behind it is a thin sheet, which does not refract.
    material.thin = absorption.is_none();
    factors.is_thin = material.thin;
    material.absorption = absorption.unwrap_or_default();
    material.ior = f64::from(factors.ior);
}

/// Returns the absorption of a volume per unit of length, −ln(attenuationColor) /
/// attenuationDistance; `None` if it has no thickness, and so no inside.
fn absorption(volume: &Volume) -> Option<Vec3> {
    // Black would take infinite absorption; a millionth is as dark.
    const BLACK: f32 = 1e-6;
    const MAX: f32 = 1e30;
    let distance = volume.attenuation_distance.0;
    // A distance that is not above 0 absorbs nothing.
    let distance = if distance > 0.0 { distance.max(f32::MIN_POSITIVE) } else { f32::INFINITY };
    let per_unit = |color: f32| -> f32 {
        let color = if color.is_nan() { 1.0 } else { color.clamp(BLACK, 1.0) };
        (-color.ln() / distance).clamp(0.0, MAX)
    };
    (volume.thickness_factor.0 > 0.0).then(|| Vec3::from(volume.attenuation_color.0.map(per_unit)))
}
