//! glTF's materials, physically based or as Lambert and Phong materials, as docs/formats.md explains.

mod layers;
mod metallic_roughness;
mod reader;

use std::collections::HashMap;

use glam::Vec3;
use gltf::json::extensions::material::PbrSpecularGlossiness;
use gltf::json::material::AlphaMode as Mode;
use gltf::json::{self, validation::Checked};

use self::metallic_roughness::base_color;
pub use self::reader::NeededAttributes;
use self::reader::{MaterialReader, clamped};
use super::texture::Textures;
use super::texture_reference::TextureReference;
use crate::error::Result;
use crate::load::diagnostics::Diagnostics;
use crate::load::gltf::json::lookup;
use crate::scene::{
    AlphaMode, Channel, Coverage, Material, MaterialId, NormalMap, OcclusionMap, Scene,
    ShadingModel, ShininessMap, TextureId, Transfer, shininess,
};

/// The materials of a file, each imported when a primitive first uses it.
pub struct Materials<'a> {
    root: &'a json::Root,
    /// The textures of the materials.
    pub textures: Textures<'a>,
    /// True if all are the default material, whatever the file says.
    pub geometry_only: bool,
    /// The shading model of metallic-roughness materials.
    pub shading: ShadingModel,
    /// The materials so far, each with the vertex attributes that it needs.
    imported: HashMap<Option<usize>, (MaterialId, NeededAttributes)>,
}

impl<'a> Materials<'a> {
    /// The materials of a file, of which none is imported.
    pub fn new(
        root: &'a json::Root,
        textures: Textures<'a>,
        geometry_only: bool,
        shading: ShadingModel,
    ) -> Self {
        Self { root, textures, geometry_only, shading, imported: HashMap::new() }
    }

    /// Returns the material with an index, or that of primitives that name none, and the vertex
    /// attributes that it needs. The reference to it is at the JSON path `by`.
    ///
    /// # Errors
    /// When the reference, or one that it leads to, leads nowhere.
    pub fn material(
        &mut self,
        index: Option<usize>,
        by: &str,
        scene: &mut Scene,
        diagnostics: &mut Diagnostics,
    ) -> Result<(MaterialId, NeededAttributes)> {
        let index = index.filter(|_| !self.geometry_only);
        if let Some(known) = self.imported.get(&index) {
            return Ok(known.clone());
        }
        // Each material is read once, when a primitive first uses it.
        let (material, needed) = match index {
            // The standard's default is a rough white metal, which nobody means who names no
            // material; ours is the neutral grey of an OBJ without one.
            None => {
                let geometry_only = self.geometry_only;
                let needed = NeededAttributes { geometry_only, ..Default::default() };
                (Material::default(), needed)
            }
            Some(i) => {
                let source = lookup(&self.root.materials, i, "material", by)?;
                let mut reader = MaterialReader {
                    source,
                    extensions: source.extensions.as_ref(),
                    path: format!("materials[{i}]"),
                    needed: NeededAttributes::default(),
                    textures: &mut self.textures,
                    scene,
                    diagnostics,
                };
                (read(&mut reader, self.shading)?, reader.needed)
            }
        };
        // All primitives of the material share its id.
        let imported = (scene.add_material(material), needed);
        self.imported.insert(index, imported.clone());
        Ok(imported)
    }
}

/// Reads a material; a metallic-roughness one gets this shading model.
fn read(reader: &mut MaterialReader, shading: ShadingModel) -> Result<Material> {
    let MaterialReader { source, extensions, .. } = *reader;
    let mut material =
        Material { name: source.name.clone().unwrap_or_default(), ..Material::default() };

    // The base: metallic and rough, or specular and glossy.
    let glossy = extensions.and_then(|e| e.pbr_specular_glossiness.as_ref());
    let base_map = match glossy {
        Some(glossy) => specular_glossiness(reader, glossy, &mut material)?,
        None => {
            material.shading = shading;
            metallic_roughness::read(reader, &mut material)?
        }
    };

    // An unlit material shows its base colour as it is.
    if extensions.is_some_and(|e| e.unlit.is_some()) {
        material = Material {
            name: material.name,
            emission: base_color(reader),
            emission_map: base_map,
            unlit: true,
            diffuse: Vec3::ZERO,
            ..Material::default()
        };
    } else {
        emission_and_relief(reader, &mut material)?;
    }

    // One-sided surfaces are seen from their fronts only. A body of glass has an inside, too.
    material.cull_back_faces = !source.double_sided && !material.may_transmit();

    // The alpha of the base covers the surface.
    let base = source.pbr_metallic_roughness.base_color_factor.0;
    let [.., alpha] = glossy.map_or(base, |glossy| glossy.diffuse_factor.0);
    coverage(reader, clamped(alpha), base_map, &mut material);
    Ok(material)
}

/// Sets the parameters of KHR_materials_pbrSpecularGlossiness, which is close to Phong as it is;
/// returns the diffuse texture.
fn specular_glossiness(
    reader: &mut MaterialReader,
    source: &PbrSpecularGlossiness,
    material: &mut Material,
) -> Result<Option<TextureId>> {
    let key = |key: &str| format!("extensions.KHR_materials_pbrSpecularGlossiness.{key}");
    // The factors.
    let [r, g, b, _] = source.diffuse_factor.0;
    material.diffuse = reader.color([r, g, b], key("diffuseFactor"));
    material.specular = reader.color(source.specular_factor.0, key("specularFactor"));
    let gloss = clamped(source.glossiness_factor.0);
    material.shininess = shininess(1.0 - gloss);

    // One texture has the specular colour, and the gloss in its alpha channel.
    let info = source.specular_glossiness_texture.as_ref();
    material.specular_map = reader.color_texture(info, key("specularGlossinessTexture"))?;
    material.shininess_map = material
        .specular_map
        .map(|texture| ShininessMap::Gloss(Channel { texture, channel: 3 }, gloss));

    // The other has the diffuse colour.
    let info = source.diffuse_texture.as_ref();
    material.diffuse_map = reader.color_texture(info, key("diffuseTexture"))?;
    Ok(material.diffuse_map)
}

/// Sets the emission, the normal map and the occlusion, which go with either base.
fn emission_and_relief(reader: &mut MaterialReader, material: &mut Material) -> Result<()> {
    // The light that the surface gives by itself. A factor of 0 leaves nothing of the map.
    let source = reader.source;
    let extension = reader.extensions.and_then(|e| e.emissive_strength.as_ref());
    let strength = extension.map_or(1.0, |e| e.emissive_strength.0);
    material.emission =
        reader.color(source.emissive_factor.0.map(|f| f * strength), "emissiveFactor");
    // What is brighter than white is meant to be a light.
    material.illuminates = strength > 1.0 && material.emission != Vec3::ZERO;
    let info = source.emissive_texture.as_ref().filter(|_| material.emission != Vec3::ZERO);
    material.emission_map = reader.color_texture(info, "emissiveTexture")?;

    // A normal map follows the tangents of the mesh.
    if let Some(info) = &source.normal_texture {
        let reference = TextureReference::from_normal(info);
        let texture = reader.texture(reference, Transfer::None, "normalTexture")?;
        let scale = if info.scale.is_finite() { info.scale } else { 1.0 };
        material.normal_map = Some(NormalMap { texture, scale });
        reader.needed.tangents = true;
    }

    // Occlusion is in the red channel.
    if let Some(info) = &source.occlusion_texture {
        let reference = TextureReference::from_occlusion(info);
        let texture = reader.texture(reference, Transfer::None, "occlusionTexture")?;
        let map = Channel { texture, channel: 0 };
        material.occlusion_map = Some(OcclusionMap { map, strength: clamped(info.strength.0) });
    }
    Ok(())
}

/// Sets the alpha coverage, by a factor and the alpha of the base colour texture.
fn coverage(
    reader: &mut MaterialReader,
    alpha: f32,
    base_map: Option<TextureId>,
    material: &mut Material,
) {
    // The mode says whether alpha counts, and how.
    let mode = match reader.source.alpha_mode {
        Checked::Valid(Mode::Opaque) | Checked::Invalid => return,
        Checked::Valid(Mode::Mask) => {
            let cutoff = reader.source.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
            AlphaMode::Mask { cutoff }
        }
        Checked::Valid(Mode::Blend) if material.may_transmit() => {
            let reason = "{} materials transmit light and have alpha: the alpha is left out";
            return reader.report_unsupported(reason);
        }
        // A blended surface lets light through, and does not refract it.
        Checked::Valid(Mode::Blend) => {
            (material.thin, material.ior) = (true, 1.0);
            AlphaMode::Blend
        }
    };

    // Factor, map and vertex colours are multiplied when the surface is hit.
    reader.needed.alpha = true;
    let map = base_map.map(|texture| Channel { texture, channel: 3 });
    material.coverage = Some(Coverage { alpha, map, mode });
}
