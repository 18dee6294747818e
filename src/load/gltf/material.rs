//! glTF's materials on a Lambert and Phong shader, as docs/formats.md explains.

use std::collections::HashMap;

use glam::Vec3;
use gltf::json;
use gltf::json::texture::Info;

use super::buffers::get;
use super::slot::Slot;
use super::texture::Textures;
use crate::error::Result;
use crate::load::diagnostics::Diagnostics;
use crate::scene::{
    Channel, Material, MaterialId, MetallicRoughness, MetallicRoughnessMaps, NormalMap,
    OcclusionMap, Scene, ShininessMap, TextureId, Transfer, mirror_share, shininess,
};

/// The materials of a file, made when a primitive first uses them.
pub struct Materials<'a> {
    root: &'a json::Root,
    textures: Textures<'a>,
    made: HashMap<Option<usize>, Made>,
}

/// A material of the scene, and what it asks of a mesh.
#[derive(Clone)]
pub struct Made {
    /// The material.
    pub id: MaterialId,
    /// What it asks of a mesh.
    pub asks: Asks,
}

/// The attributes of vertices that a material asks for.
#[derive(Clone, Debug, Default)]
pub struct Asks {
    /// The TEXCOORD sets that place its textures: at most two.
    pub sets: Vec<u32>,
    /// Whether it has a normal map.
    pub tangents: bool,
    /// Whether alpha counts.
    pub alpha: bool,
}

impl<'a> Materials<'a> {
    /// The materials of a file.
    pub fn new(root: &'a json::Root, textures: Textures<'a>) -> Self {
        Self { root, textures, made: HashMap::new() }
    }

    /// The material of index `index`, or the one for primitives that name none.
    pub fn get(
        &mut self,
        index: Option<usize>,
        by: &str,
        scene: &mut Scene,
        tally: &mut Diagnostics,
    ) -> Result<Made> {
        if let Some(made) = self.made.get(&index) {
            return Ok(made.clone());
        }
        let made = match index {
            // The standard's default is a rough white metal, which nobody means who names no
            // material; ours is the neutral grey of an OBJ without one.
            None => Made { id: scene.add_material(Material::default()), asks: Asks::default() },
            Some(i) => {
                let source = get(&self.root.materials, i, "material", by)?;
                let (at, asks) = (format!("materials[{i}]"), Asks::default());
                Maker { source, at, asks, textures: &mut self.textures, scene, tally }.make()?
            }
        };
        self.made.insert(index, made.clone());
        Ok(made)
    }

    /// Decodes what the materials show.
    pub fn decode(self, scene: &mut Scene, tally: &mut Diagnostics) {
        self.textures.decode(scene, tally);
    }
}

/// A material being made.
pub struct Maker<'m, 'a> {
    pub source: &'a json::Material,
    pub at: String,
    pub asks: Asks,
    textures: &'m mut Textures<'a>,
    scene: &'m mut Scene,
    pub tally: &'m mut Diagnostics,
}

impl<'a> Maker<'_, 'a> {
    fn make(mut self) -> Result<Made> {
        let source = self.source;
        let mut material =
            Material { name: source.name.clone().unwrap_or_default(), ..Material::default() };
        let extensions = source.extensions.as_ref();
        let old = extensions.and_then(|e| e.pbr_specular_glossiness.as_ref());
        let base_map = match old {
            Some(old) => self.specular_glossiness(old, &mut material)?,
            None => self.metallic_roughness(&mut material)?,
        };
        if extensions.is_some_and(|e| e.unlit.is_some()) {
            material = Material {
                name: material.name,
                emission: self.base_color(),
                emission_map: base_map,
                unlit: true,
                diffuse: Vec3::ZERO,
                ..Material::default()
            };
        } else {
            self.emission(&mut material)?;
            self.normals(&mut material)?;
            self.occlusion(&mut material)?;
        }
        let base = self.source.pbr_metallic_roughness.base_color_factor.0;
        let [.., alpha] = old.map_or(base, |old| old.diffuse_factor.0);
        self.alpha(unit(alpha), base_map, &mut material);
        Ok(Made { id: self.scene.add_material(material), asks: self.asks })
    }

    fn base_color(&mut self) -> Vec3 {
        let [r, g, b, _] = self.source.pbr_metallic_roughness.base_color_factor.0;
        self.color([r, g, b], "pbrMetallicRoughness.baseColorFactor")
    }

    /// The core's material, with KHR_materials_specular, _transmission, _volume and _ior; and its
    /// base colour texture.
    fn metallic_roughness(&mut self, material: &mut Material) -> Result<Option<TextureId>> {
        let pbr = &self.source.pbr_metallic_roughness;
        let base_map = match &pbr.base_color_texture {
            Some(info) => {
                let place = "pbrMetallicRoughness.baseColorTexture";
                Some(self.texture(Slot::of(info), Transfer::Srgb, place)?)
            }
            None => None,
        };
        let factors = MetallicRoughness {
            base: self.base_color(),
            metallic: unit(pbr.metallic_factor.0),
            roughness: unit(pbr.roughness_factor.0),
            specular: 1.0,
            specular_color: Vec3::ONE,
            transmission: 0.0,
            ior: self.ior(),
        };
        let mut maps =
            MetallicRoughnessMaps { base: base_map, ..MetallicRoughnessMaps::new(factors) };
        if let Some(info) = &pbr.metallic_roughness_texture {
            let place = "pbrMetallicRoughness.metallicRoughnessTexture";
            // A factor of 0 leaves nothing of the map.
            if factors.roughness > 0.0 {
                maps.roughness = Some(self.channel(info, 1, place)?);
            }
            if factors.metallic > 0.0 {
                maps.metallic = Some(self.channel(info, 2, place)?);
            }
        }
        self.specular(&mut maps)?;
        self.transmission(&mut maps)?;
        material.set_metallic_roughness(maps);
        self.inside(material);
        Ok(base_map)
    }

    /// KHR_materials_specular.
    fn specular(&mut self, maps: &mut MetallicRoughnessMaps) -> Result<()> {
        let extensions = self.source.extensions.as_ref();
        let Some(source) = extensions.and_then(|e| e.specular.as_ref()) else { return Ok(()) };
        let place = |key: &str| format!("extensions.KHR_materials_specular.{key}");
        maps.factors.specular = unit(source.specular_factor.0);
        maps.factors.specular_color =
            self.color(source.specular_color_factor.0, &place("specularColorFactor"));
        if let Some(info) = &source.specular_texture {
            maps.specular = Some(self.channel(info, 3, &place("specularTexture"))?);
        }
        if let Some(info) = &source.specular_color_texture {
            let place = place("specularColorTexture");
            maps.specular_color = Some(self.texture(Slot::of(info), Transfer::Srgb, &place)?);
        }
        Ok(())
    }

    /// KHR_materials_pbrSpecularGlossiness, which is close to Phong as it stands; and its diffuse
    /// texture.
    fn specular_glossiness(
        &mut self,
        old: &'a json::extensions::material::PbrSpecularGlossiness,
        material: &mut Material,
    ) -> Result<Option<TextureId>> {
        let [r, g, b, _] = old.diffuse_factor.0;
        let extension = "extensions.KHR_materials_pbrSpecularGlossiness";
        material.diffuse = self.color([r, g, b], &format!("{extension}.diffuseFactor"));
        material.specular =
            self.color(old.specular_factor.0, &format!("{extension}.specularFactor"));
        let gloss = unit(old.glossiness_factor.0);
        material.shininess = shininess(1.0 - gloss);
        if let Some(info) = &old.specular_glossiness_texture {
            let place = format!("{extension}.specularGlossinessTexture");
            let texture = self.texture(Slot::of(info), Transfer::Srgb, &place)?;
            material.specular_map = Some(texture);
            material.shininess_map =
                Some(ShininessMap::Gloss(Channel { texture, channel: 3 }, gloss));
        }
        let Some(info) = &old.diffuse_texture else { return Ok(None) };
        let place = format!("{extension}.diffuseTexture");
        material.diffuse_map = Some(self.texture(Slot::of(info), Transfer::Srgb, &place)?);
        Ok(material.diffuse_map)
    }

    fn emission(&mut self, material: &mut Material) -> Result<()> {
        let extensions = self.source.extensions.as_ref();
        let strength = extensions
            .and_then(|e| e.emissive_strength.as_ref())
            .map_or(1.0, |e| e.emissive_strength.0);
        let factor = self.source.emissive_factor.0.map(|f| f * strength);
        material.emission = self.color(factor, "emissiveFactor");
        if material.emission != Vec3::ZERO
            && let Some(info) = &self.source.emissive_texture
        {
            let map = self.texture(Slot::of(info), Transfer::Srgb, "emissiveTexture")?;
            material.emission_map = Some(map);
        }
        Ok(())
    }

    fn normals(&mut self, material: &mut Material) -> Result<()> {
        let Some(info) = &self.source.normal_texture else { return Ok(()) };
        let texture = self.texture(Slot::of_normal(info), Transfer::None, "normalTexture")?;
        let scale = if info.scale.is_finite() { info.scale } else { 1.0 };
        material.normal_map = Some(NormalMap { texture, scale });
        self.asks.tangents = true;
        Ok(())
    }

    fn occlusion(&mut self, material: &mut Material) -> Result<()> {
        let Some(info) = &self.source.occlusion_texture else { return Ok(()) };
        let slot = Slot::of_occlusion(info);
        let texture = self.texture(slot, Transfer::None, "occlusionTexture")?;
        let map = Channel { texture, channel: 0 };
        material.occlusion_map = Some(OcclusionMap { map, strength: unit(info.strength.0) });
        Ok(())
    }

    /// A texture of the scene.
    fn texture(&mut self, slot: Slot, transfer: Transfer, place: &str) -> Result<TextureId> {
        let set = self.asks.sets.iter().position(|&set| set == slot.set).unwrap_or_else(|| {
            match self.asks.sets.len() {
                2 => {
                    let at = &self.at;
                    let reason = "{} textures are laid on by the first of more than two sets of \
                                  texture coordinates";
                    self.tally.unsupported(reason, 1, || format!("{at}.{place}"));
                    0
                }
                next => {
                    self.asks.sets.push(slot.set);
                    next
                }
            }
        });
        let by = format!("{}.{place}.index", self.at);
        self.textures.texture(slot, set as u8, transfer, &by, self.scene, self.tally)
    }

    /// A channel of a texture of data.
    pub fn channel(&mut self, info: &Info, channel: u8, place: &str) -> Result<Channel> {
        Ok(Channel { texture: self.texture(Slot::of(info), Transfer::None, place)?, channel })
    }

    /// A colour that the scene accepts: finite and not negative.
    fn color(&mut self, color: [f32; 3], place: &str) -> Vec3 {
        let sound = |x: f32| x.is_finite() && x >= 0.0;
        if !color.iter().all(|&x| sound(x)) {
            let at = &self.at;
            self.tally.add("{} colours are negative or not finite and become 0", 1, || {
                format!("{at}.{place}")
            });
        }
        Vec3::from(color.map(|x| if sound(x) { x } else { 0.0 }))
    }
}

/// Whether what a surface of this roughness sends on is too blurred to be drawn sharp.
pub fn is_frosted(roughness: f32) -> bool {
    mirror_share(roughness) == 0.0
}

/// A factor within [0, 1]; what is no number is 1, the default.
pub fn unit(x: f32) -> f32 {
    if x.is_nan() { 1.0 } else { x.clamp(0.0, 1.0) }
}
