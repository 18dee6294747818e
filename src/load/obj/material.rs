//! An MTL material on a Lambert and Phong surface, as docs/formats.md explains.

use std::path::Path;

use glam::Vec3;

use super::illumination::Illumination;
use super::map::Map;
use super::textures::Textures;
use crate::load::diagnostics::Diagnostics;
use crate::scene::{
    AlphaMode, Channel, Coverage, Material, MaterialId, MetallicRoughness, MetallicRoughnessMaps,
    NormalMap, Scene, ShininessMap, TextureId, Transfer,
};

/// The range of shininess that is drawn.
const SHININESS: std::ops::RangeInclusive<f32> = 1.0..=10_000.0;
/// The index of refraction of what is no glass and names none.
const IOR: f32 = 1.5;

/// A material being made.
pub struct Maker<'a, 'g> {
    /// What [`clean`](super::mtl::clean) has left of it.
    pub source: &'a tobj::Material,
    /// That of its MTL file.
    pub folder: &'a Path,
    /// Where its textures are added.
    pub textures: &'a mut Textures<'g>,
    /// Where it is added next.
    pub scene: &'a mut Scene,
    /// What cannot be drawn is said here.
    pub tally: &'a mut Diagnostics,
}

impl<'a> Maker<'a, '_> {
    /// The material.
    pub fn make(mut self) -> Material {
        let source = self.source;
        let mut material = Material { name: source.name.clone(), ..Material::default() };
        material.diffuse_map = self.color_map(source.diffuse_texture.as_deref());
        if let Some(diffuse) = source.diffuse {
            material.diffuse = Vec3::from(diffuse);
        } else if material.diffuse_map.is_some() {
            material.diffuse = Vec3::ONE;
        }
        // Models 0 and 1 are those without a highlight.
        if source.illumination_model.is_none_or(|model| model > 1) {
            self.highlight(&mut material);
        }
        material.emission_map = self.color_map(self.other("map_Ke"));
        let whole = if material.emission_map.is_some() { Vec3::ONE } else { Vec3::ZERO };
        material.emission = source.emissive.map_or(whole, Vec3::from);
        self.light_beyond(&mut material);
        // Programs write 0 that mean no highlight: one of that exponent would be everywhere.
        if source.shininess == Some(0.0) && material.shininess_map.is_none() {
            (material.specular, material.specular_map) = (Vec3::ZERO, None);
        }
        self.normals(&mut material);
        material
    }

    fn highlight(&mut self, material: &mut Material) {
        let source = self.source;
        material.specular_map = self.color_map(source.specular_texture.as_deref());
        let whole = if material.specular_map.is_some() { Vec3::ONE } else { Vec3::ZERO };
        material.specular = source.specular.map_or(whole, Vec3::from);
        if let Some(shininess) = source.shininess {
            material.shininess = shininess.clamp(*SHININESS.start(), *SHININESS.end());
        }
        let map = self.channel(source.shininess_texture.as_deref());
        material.shininess_map = map.map(ShininessMap::Factor);
    }

    /// Mirrors, glass, opacity and metal.
    fn light_beyond(&mut self, material: &mut Material) {
        let illumination = self.illumination();
        let name = || format!("`{}`", self.source.name);
        let opacity_map = self.source.dissolve_texture.as_deref();
        if illumination.is_glass() {
            let count = u64::from(opacity_map.is_some());
            let reason = "{} textures of opacity are not read: their materials are glass";
            self.tally.unsupported(reason, count, name);
            return illumination.apply(material);
        }
        if illumination.opacity == 0.0 {
            self.tally.add("{} materials have an opacity of 0 and cannot be seen", 1, name);
        }
        let metallic = self.metallic(material);
        if opacity_map.is_none() && metallic.is_none() {
            return illumination.apply(material);
        }
        // The picture, or what the metal reflects, is weighed with the opacity point by point.
        Illumination { opacity: 1.0, ..illumination }.apply(material);
        if let Some(maps) = metallic {
            material.specular_map = None;
            material.shininess_map = None;
            material.set_metallic_roughness(maps);
        }
        let map = self.channel(opacity_map);
        if map.is_none() && illumination.opacity == 1.0 {
            return;
        }
        (material.thin, material.ior) = (true, 1.0);
        let mode = AlphaMode::Blend;
        material.coverage = Some(Coverage { alpha: illumination.opacity, map, mode });
        if opacity_map.and_then(Map::parse).is_some_and(|map| map.channel.is_none()) {
            self.textures.prefer_alpha(self.id());
        }
    }

    /// Roughness and metalness, where anything is said of them; a map counts in place of its value,
    /// since programs write any value beside it.
    fn metallic(&mut self, material: &Material) -> Option<MetallicRoughnessMaps> {
        let [pr, pm, map_pr, map_pm] = ["Pr", "Pm", "map_Pr", "map_Pm"].map(|key| self.other(key));
        if [pr, pm, map_pr, map_pm].iter().all(Option::is_none) {
            return None;
        }
        let [roughness, metallic] = [map_pr, map_pm].map(|map| self.channel(map));
        let value = |text: Option<&str>| text.and_then(|t| t.parse().ok()).map(|x: f32| x.min(1.0));
        let factor = |map: Option<Channel>, text, missing| match map {
            Some(_) => 1.0,
            None => value(text).unwrap_or(missing),
        };
        // The roughness whose highlight is as wide as that of Ns: 2/α² − 2 with α = roughness².
        let of_phong = (2.0 / (material.shininess + 2.0)).powf(0.25);
        let factors = MetallicRoughness {
            base: material.diffuse,
            metallic: factor(metallic, pm, 0.0),
            roughness: factor(roughness, pr, of_phong),
            specular: 1.0,
            specular_color: Vec3::ONE,
            transmission: 0.0,
            ior: self.source.optical_density.filter(|n| (1.0..=100.0).contains(n)).unwrap_or(IOR),
        };
        let base = material.diffuse_map;
        Some(MetallicRoughnessMaps {
            base,
            metallic,
            roughness,
            ..MetallicRoughnessMaps::new(factors)
        })
    }

    /// `norm`, or a `bump` that turns out to be a picture of normals, as many programs write it.
    fn normals(&mut self, material: &mut Material) {
        let norm = self.other("norm").and_then(Map::parse);
        let bump = self.source.normal_texture.as_deref().and_then(Map::parse);
        if let Some(map) = norm {
            let texture = self.texture(&map, Transfer::None);
            material.normal_map = Some(NormalMap { texture, scale: map.gain.unwrap_or(1.0) });
        } else if let Some(map) = bump {
            let texture = self.texture(&map, Transfer::None);
            let scale = map.gain.unwrap_or(1.0);
            self.textures.may_be_normals(self.id(), texture, scale, &self.source.name);
        }
    }

    /// The number that the material will have.
    fn id(&self) -> MaterialId {
        MaterialId(self.scene.materials.len() as u32)
    }

    fn other(&self, key: &str) -> Option<&'a str> {
        self.source.unknown_param.get(key).map(String::as_str)
    }

    /// A texture of colours.
    fn color_map(&mut self, value: Option<&str>) -> Option<TextureId> {
        let map = Map::parse(value?)?;
        let channel = u64::from(map.channel.is_some());
        let reason = "the option `-imfchan` of {} textures of colours is not read";
        self.tally.unsupported(reason, channel, || format!("`{}`", value.unwrap_or_default()));
        self.say_gain(&map);
        Some(self.texture(&map, Transfer::Srgb))
    }

    /// One channel of a texture: red, where its options name none.
    fn channel(&mut self, value: Option<&str>) -> Option<Channel> {
        let map = Map::parse(value?)?;
        self.say_gain(&map);
        Some(Channel {
            texture: self.texture(&map, Transfer::None),
            channel: map.channel.unwrap_or(0),
        })
    }

    fn say_gain(&mut self, map: &Map) {
        let reason = "the option `-bm` of {} textures that are no bumps is not read";
        self.tally.unsupported(reason, u64::from(map.gain.is_some()), || format!("`{}`", map.file));
    }

    fn texture(&mut self, map: &Map, transfer: Transfer) -> TextureId {
        for option in &map.ignored {
            let reason = format!("the option `{option}` of {{}} textures is not read");
            self.tally.unsupported(&reason, 1, || format!("`{}`", map.file));
        }
        self.textures.get(map, transfer, self.folder, self.scene)
    }

    fn illumination(&mut self) -> Illumination {
        let transparency = self.other("Tr").and_then(|t| t.parse().ok()).unwrap_or(0.0f32);
        let filter = self.other("Tf").map(|tf| {
            let mut numbers = tf.split_whitespace().flat_map(str::parse);
            Vec3::from_array([0; 3].map(|_| numbers.next().unwrap_or(0.0)))
        });
        let mut illumination = Illumination {
            model: self.source.illumination_model.unwrap_or(2),
            opacity: self.source.dissolve.unwrap_or(1.0 - transparency).clamp(0.0, 1.0),
            filter,
            ior: self.source.optical_density,
        };
        // MeshLab and others write the opacity there, and seldom another one than 1.
        if self.source.dissolve.is_none() && transparency == 1.0 && !illumination.is_glass() {
            let reason = "{} materials have `Tr 1` and no `d`: they are drawn opaque, as the \
                          programs that write it mean them";
            self.tally.add(reason, 1, || format!("`{}`", self.source.name));
            illumination.opacity = 1.0;
        }
        illumination
    }
}
