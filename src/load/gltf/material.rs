//! glTF's metallic-roughness materials on a Lambert and Phong shader, as docs/formats.md explains.

use std::collections::HashMap;
use std::sync::Arc;

use glam::Vec3;
use gltf::json;
use gltf::json::texture::Info;

use super::buffers::get;
use super::optics::{self, Transmission};
use super::texture::{Textures, UvMap};
use crate::error::Result;
use crate::load::tally::Tally;
use crate::scene::{Image, Material, MaterialId, Scene, TextureId, Transfer};

/// The range of shininess: roughness 1 would give 0, and roughness 0 infinity.
const SHININESS: std::ops::RangeInclusive<f32> = 1.0..=10_000.0;
/// What is said of the means of textures.
pub const NOT_SAMPLED: &str = "{} textures of roughness, metalness, gloss or transmission are not \
                           sampled yet: their mean holds for all of the surface";

/// The materials of a file, made when a primitive first uses them.
pub struct Materials<'a> {
    root: &'a json::Root,
    textures: Textures<'a>,
    made: HashMap<Option<usize>, Made>,
    texture_ids: HashMap<usize, TextureId>,
    /// How often each value of each channel stands in a picture, by its address.
    counts: HashMap<*const Image, Box<[[u64; 256]; 4]>>,
}

/// A material of the scene, and how its textures take their coordinates.
#[derive(Clone)]
pub struct Made {
    /// The material.
    pub id: MaterialId,
    /// Its texture coordinates, where it has a texture.
    pub uv: Option<UvMap>,
}

impl<'a> Materials<'a> {
    /// The materials of a file.
    pub fn new(root: &'a json::Root, textures: Textures<'a>) -> Self {
        Self {
            root,
            textures,
            made: HashMap::new(),
            texture_ids: HashMap::new(),
            counts: HashMap::new(),
        }
    }

    /// The material of index `index`, or the one for primitives that name none.
    pub fn get(
        &mut self,
        index: Option<usize>,
        by: &str,
        scene: &mut Scene,
        tally: &mut Tally,
    ) -> Result<Made> {
        if let Some(made) = self.made.get(&index) {
            return Ok(made.clone());
        }
        let made = match index {
            // The standard's default is a rough white metal, which nobody means who names no
            // material; ours is the neutral grey of an OBJ without one.
            None => Made { id: scene.add_material(Material::default()), uv: None },
            Some(i) => {
                let source = get(&self.root.materials, i, "material", by)?;
                Maker { source, at: format!("materials[{i}]"), all: self, scene, tally }.make()?
            }
        };
        self.made.insert(index, made.clone());
        Ok(made)
    }
}

/// A material being made.
pub struct Maker<'m, 'a> {
    pub source: &'a json::Material,
    pub at: String,
    all: &'m mut Materials<'a>,
    pub scene: &'m mut Scene,
    pub tally: &'m mut Tally,
}

impl<'a> Maker<'_, 'a> {
    fn make(mut self) -> Result<Made> {
        let source = self.source;
        let mut material =
            Material { name: source.name.clone().unwrap_or_default(), ..Material::default() };
        let extensions = source.extensions.as_ref();
        let old = extensions.and_then(|e| e.pbr_specular_glossiness.as_ref());
        let uv = match old {
            Some(old) => self.specular_glossiness(old, &mut material)?,
            None => self.metallic_roughness(&mut material)?,
        };
        let picture = material.diffuse_map;
        let uv = if extensions.is_some_and(|e| e.unlit.is_some()) {
            material.emission = self.base_color();
            material.emission_map = material.diffuse_map.take();
            (material.diffuse, material.specular) = (Vec3::ZERO, Vec3::ZERO);
            (material.reflect, material.transmit) = (Vec3::ZERO, Vec3::ZERO);
            uv
        } else {
            self.emission(&mut material, uv)?
        };
        let base = self.source.pbr_metallic_roughness.base_color_factor.0;
        let [.., alpha] = old.map_or(base, |old| old.diffuse_factor.0);
        self.alpha(unit(alpha), picture, &mut material);
        Ok(Made { id: self.scene.add_material(material), uv })
    }

    fn base_color(&mut self) -> Vec3 {
        let [r, g, b, _] = self.source.pbr_metallic_roughness.base_color_factor.0;
        self.color([r, g, b], "pbrMetallicRoughness.baseColorFactor")
    }

    fn metallic_roughness(&mut self, material: &mut Material) -> Result<Option<UvMap>> {
        let pbr = &self.source.pbr_metallic_roughness;
        let base = self.base_color();
        let (mut metallic, mut roughness) = (pbr.metallic_factor.0, pbr.roughness_factor.0);
        if let Some(info) = &pbr.metallic_roughness_texture {
            let [r, m] = self.mean_roughness_and_metalness(info)?;
            roughness *= r;
            metallic *= m;
        }
        let metallic = unit(metallic);
        let transmission = self.transmission()?;
        material.specular = Vec3::splat(optics::head_on(transmission.ior)).lerp(base, metallic);
        material.shininess = shininess(roughness);
        let mirror = metallic * optics::sharpness(roughness);
        let through = (1.0 - metallic) * transmission.share;
        if mirror > 0.0 || through > 0.0 {
            let tint = self.tint(base)?;
            material.reflect = tint * mirror;
            Transmission { share: through, ..transmission }.apply(tint, material);
        }
        if through > 0.0 && optics::sharpness(roughness) == 0.0 {
            let at = &self.at;
            self.tally.unsupported("{} frosted materials are drawn clear", 1, || at.clone());
        }
        // What is left of the whole is scattered; the share that glTF means is within it.
        let rest = Vec3::ONE - material.reflect - material.transmit;
        let scattered = (1.0 - metallic) * (1.0 - transmission.share);
        material.diffuse =
            base * rest.map(|x| if x > 0.0 { (scattered / x).min(1.0) } else { 0.0 });
        let Some(info) = &pbr.base_color_texture else { return Ok(None) };
        material.diffuse_map = Some(self.texture(info, "pbrMetallicRoughness.baseColorTexture")?);
        Ok(Some(UvMap::of(info)))
    }

    /// KHR_materials_pbrSpecularGlossiness, which is close to Phong as it stands.
    fn specular_glossiness(
        &mut self,
        old: &'a json::extensions::material::PbrSpecularGlossiness,
        material: &mut Material,
    ) -> Result<Option<UvMap>> {
        let [r, g, b, _] = old.diffuse_factor.0;
        let extension = "extensions.KHR_materials_pbrSpecularGlossiness";
        material.diffuse = self.color([r, g, b], &format!("{extension}.diffuseFactor"));
        material.specular =
            self.color(old.specular_factor.0, &format!("{extension}.specularFactor"));
        material.shininess = shininess(1.0 - old.glossiness_factor.0);
        if let Some(info) = &old.specular_glossiness_texture {
            let place = format!("{}.{extension}.specularGlossinessTexture", self.at);
            let [r, g, b, a] = self.mean(info, Transfer::Srgb, &place, NOT_SAMPLED)?;
            material.specular *= Vec3::new(r, g, b);
            material.shininess = shininess(1.0 - old.glossiness_factor.0 * a);
        }
        let Some(info) = &old.diffuse_texture else { return Ok(None) };
        material.diffuse_map = Some(self.texture(info, &format!("{extension}.diffuseTexture"))?);
        Ok(Some(UvMap::of(info)))
    }

    fn emission(&mut self, material: &mut Material, uv: Option<UvMap>) -> Result<Option<UvMap>> {
        let extensions = self.source.extensions.as_ref();
        let strength = extensions
            .and_then(|e| e.emissive_strength.as_ref())
            .map_or(1.0, |e| e.emissive_strength.0);
        let factor = self.source.emissive_factor.0.map(|f| f * strength);
        material.emission = self.color(factor, "emissiveFactor");
        let Some(info) = &self.source.emissive_texture else { return Ok(uv) };
        if material.emission == Vec3::ZERO {
            return Ok(uv);
        }
        let own = UvMap::of(info);
        if uv.as_ref().is_some_and(|uv| *uv != own) {
            self.tally.say(format!(
                "{}: the emissive texture is laid on by the base colour's texture coordinates, \
                 not by its own",
                self.at
            ));
        }
        material.emission_map = Some(self.texture(info, "emissiveTexture")?);
        Ok(uv.or(Some(own)))
    }

    fn texture(&mut self, info: &Info, place: &str) -> Result<TextureId> {
        let index = info.index.value();
        if let Some(&id) = self.all.texture_ids.get(&index) {
            return Ok(id);
        }
        let by = format!("{}.{place}.index", self.at);
        let texture = self.all.textures.get(index, Transfer::Srgb, &by, self.tally)?;
        let id = self.scene.add_texture(texture);
        self.all.texture_ids.insert(index, id);
        Ok(id)
    }

    /// The texture gives roughness in green and metalness in blue. It isn't sampled yet; its mean
    /// is nearer to what the file means than its factors alone, which are usually 1.
    fn mean_roughness_and_metalness(&mut self, info: &Info) -> Result<[f32; 2]> {
        let place = format!("{}.pbrMetallicRoughness.metallicRoughnessTexture", self.at);
        let [_, green, blue, _] = self.mean(info, Transfer::None, &place, NOT_SAMPLED)?;
        Ok([green, blue])
    }

    /// The mean of a texture's four channels; `reason` is why no more of it is used.
    pub fn mean(
        &mut self,
        info: &Info,
        transfer: Transfer,
        place: &str,
        reason: &str,
    ) -> Result<[f32; 4]> {
        let by = format!("{place}.index");
        let texture = self.all.textures.get(info.index.value(), transfer, &by, self.tally)?;
        self.tally.unsupported(reason, 1, || place.to_owned());
        // Any number of materials can name one picture.
        let counts = self.all.counts.entry(Arc::as_ptr(&texture.image)).or_insert_with(|| {
            let mut counts = Box::new([[0u64; 256]; 4]);
            for texel in &texture.image.texels {
                for (count, &value) in counts.iter_mut().zip(texel) {
                    count[usize::from(value)] += 1;
                }
            }
            counts
        });
        let total = texture.image.texels.len().max(1) as f64;
        Ok(std::array::from_fn(|channel| {
            let curve = if channel == 3 { Transfer::None } else { transfer };
            let value = |i: usize| f64::from(curve.decode(i as f32 / 255.0));
            let sum: f64 =
                counts[channel].iter().enumerate().map(|(i, &n)| n as f64 * value(i)).sum();
            (sum / total) as f32
        }))
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

/// α = roughness², and the Phong exponent whose highlight is as wide: 2/α² − 2.
fn shininess(roughness: f32) -> f32 {
    let alpha = unit(roughness) * unit(roughness);
    (2.0 / (alpha * alpha) - 2.0).clamp(*SHININESS.start(), *SHININESS.end())
}

/// A factor within [0, 1]; what is no number is 1, the default.
pub fn unit(x: f32) -> f32 {
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
}
