//! The conversion of MTL materials to Lambert and Phong surfaces, or physically based ones, as
//! docs/formats.md explains.

use std::f32::consts::TAU;
use std::path::Path;

use glam::Vec3;

use super::illumination::Illumination;
use super::texture_map::TextureMap;
use super::textures::Textures;
use crate::load::diagnostics::Diagnostics;
use crate::scene::{
    AlphaMode, Channel, Coverage, Material, MaterialId, MetallicRoughness, MetallicRoughnessMaps,
    NormalMap, Scene, ShadingModel, ShininessMap, TextureId, Transfer,
};

/// The range of shininess that is supported.
const SHININESS: std::ops::RangeInclusive<f32> = 1.0..=10_000.0;
/// The default index of refraction of materials that are no glass.
const DEFAULT_IOR: f32 = 1.5;

/// Returns a colour of tobj's in f32.
fn color(color: [f64; 3]) -> Vec3 {
    Vec3::from_array(color.map(|x| x as f32))
}

/// A material that is being built.
pub struct MaterialBuilder<'a, 'g> {
    /// The material of the MTL file, as tobj has it.
    pub source: &'a tobj::Material,
    /// The folder of the MTL file.
    pub folder: &'a Path,
    /// The shading model; none for the one that the material's statements ask for.
    pub shading: Option<ShadingModel>,
    /// The textures of all materials.
    pub textures: &'a mut Textures<'g>,
    /// The scene that it is added to next.
    pub scene: &'a mut Scene,
    /// The diagnostics.
    pub diagnostics: &'a mut Diagnostics,
}

impl<'a> MaterialBuilder<'a, '_> {
    /// Builds the material.
    pub fn build(mut self) -> Material {
        let source = self.source;
        let mut material = Material { name: source.name.clone(), ..Material::default() };
        material.diffuse_map = self.color_map(source.diffuse_texture.as_deref());
        if let Some(diffuse) = source.diffuse {
            material.diffuse = color(diffuse);
        } else if material.diffuse_map.is_some() {
            material.diffuse = Vec3::ONE;
        }
        let illumination = self.illumination();
        if !illumination.is_glass() {
            self.show_image_beside_black(&mut material);
        }
        // Models 0 and 1 are those without a highlight.
        if source.illumination_model.is_none_or(|model| model > 1) {
            self.set_highlight(&mut material);
        }
        material.emission_map = self.color_map(self.statement("map_Ke"));
        let default = if material.emission_map.is_some() { Vec3::ONE } else { Vec3::ZERO };
        material.emission = source.emissive.map_or(default, color);
        self.set_transport(illumination, &mut material);
        // Programs write 0 that mean no highlight: one of that exponent would be everywhere.
        if source.shininess == Some(0.0) && material.shininess_map.is_none() {
            (material.specular, material.specular_map) = (Vec3::ZERO, None);
        }
        self.set_normal_map(&mut material);
        // Images of highlights and emission keep their factor: programs mean 0 that write it there.
        let maps =
            [(material.specular_map, source.specular), (material.emission_map, source.emissive)];
        let lost = maps.iter().filter(|(map, factor)| map.is_some() && *factor == Some([0.0; 3]));
        let reason =
            "{} images of highlights or emission are multiplied by 0 (`Ks`, `Ke`) and not seen";
        self.diagnostics.add(reason, lost.count() as u64, || format!("`{}`", source.name));
        material
    }

    /// Shows an image that a black `Kd` would hide: programs write `Kd 0 0 0` beside one and mean
    /// that the image alone counts.
    fn show_image_beside_black(&mut self, material: &mut Material) {
        if material.diffuse_map.is_none() || material.diffuse != Vec3::ZERO {
            return;
        }
        material.diffuse = Vec3::ONE;
        let reason = "{} materials have `Kd 0 0 0` beside an image: the image is shown as it is, as \
                      the programs that write it mean it";
        self.diagnostics.add(reason, 1, || format!("`{}`", self.source.name));
    }

    /// Sets the specular colour and the shininess.
    fn set_highlight(&mut self, material: &mut Material) {
        let source = self.source;
        material.specular_map = self.color_map(source.specular_texture.as_deref());
        let default = if material.specular_map.is_some() { Vec3::ONE } else { Vec3::ZERO };
        material.specular = source.specular.map_or(default, color);
        if let Some(shininess) = source.shininess {
            material.shininess = (shininess as f32).clamp(*SHININESS.start(), *SHININESS.end());
        }
        let map = self.channel(source.shininess_texture.as_deref());
        material.shininess_map = map.map(ShininessMap::Factor);
    }

    /// Sets all that is no diffuse or specular reflection: mirrors, glass, opacity and metal.
    fn set_transport(&mut self, illumination: Illumination, material: &mut Material) {
        let name = || format!("`{}`", self.source.name);
        let opacity_map = self.source.dissolve_texture.as_deref();
        // Glass.
        if illumination.is_glass() {
            let count = u64::from(opacity_map.is_some());
            let reason = "{} textures of opacity are not read: their materials are glass";
            self.diagnostics.unsupported(reason, count, name);
            return illumination.apply(material);
        }
        if illumination.opacity == 0.0 {
            self.diagnostics.add("{} materials have an opacity of 0 and cannot be seen", 1, name);
        }
        // Mirrors and clear sheets, where nothing differs from point to point.
        let metallic = self.metallic(material);
        if opacity_map.is_none() && metallic.is_none() {
            return illumination.apply(material);
        }
        // The map, or the metal's reflection, is weighed with the opacity point by point.
        Illumination { opacity: 1.0, ..illumination }.apply(material);
        if let Some(maps) = metallic {
            material.specular_map = None;
            material.shininess_map = None;
            material.shading = self.shading.unwrap_or(ShadingModel::Pbr);
            material.set_metallic_roughness(maps);
        }
        let map = self.channel(opacity_map);
        if map.is_none() && illumination.opacity == 1.0 {
            return;
        }
        (material.thin, material.ior) = (true, 1.0);
        let mode = AlphaMode::Blend;
        material.coverage = Some(Coverage { alpha: illumination.opacity, map, mode });
        if opacity_map.and_then(TextureMap::parse).is_some_and(|map| map.channel.is_none()) {
            self.textures.prefer_alpha(self.id());
        }
    }

    /// Returns roughness and metalness, where a statement sets them; a map counts in place of its
    /// value, since programs write any value beside it.
    fn metallic(&mut self, material: &Material) -> Option<MetallicRoughnessMaps> {
        let [pr, pm, map_pr, map_pm] =
            ["Pr", "Pm", "map_Pr", "map_Pm"].map(|key| self.statement(key));
        let has_statement = [pr, pm, map_pr, map_pm].iter().any(Option::is_some);
        if !has_statement && self.shading != Some(ShadingModel::Pbr) {
            return None;
        }
        // Maps, and factors beside them.
        let [roughness, metallic] = [map_pr, map_pm].map(|map| self.channel(map));
        let value = |text: Option<&str>| text.and_then(|t| t.parse().ok()).map(|x: f32| x.min(1.0));
        let factor = |map: Option<Channel>, text, missing| match map {
            Some(_) => 1.0,
            None => value(text).unwrap_or(missing),
        };
        // The roughness whose highlight is as wide as that of Ns: 2/α² − 2 with α = roughness².
        let default_roughness = (2.0 / (material.shininess + 2.0)).powf(0.25);
        let factors = MetallicRoughness {
            base_color: material.diffuse,
            metallic: factor(metallic, pm, 0.0),
            roughness: factor(roughness, pr, default_roughness),
            ior: self
                .source
                .optical_density
                .map(|ior| ior as f32)
                .filter(|n| (1.0..=100.0).contains(n))
                .unwrap_or(DEFAULT_IOR),
            ..MetallicRoughness::default()
        };
        let base_color = material.diffuse_map;
        let factors = self.with_layers(factors);
        Some(MetallicRoughnessMaps {
            base_color,
            metallic,
            roughness,
            ..MetallicRoughnessMaps::new(factors)
        })
    }

    /// Returns a material with the sheen, the clearcoat and the anisotropy that statements set.
    fn with_layers(&self, factors: MetallicRoughness) -> MetallicRoughness {
        let number = |key: &str| -> f32 {
            let value = self.statement(key).and_then(|text| text.parse().ok());
            value.filter(|x: &f32| x.is_finite()).unwrap_or(0.0)
        };
        let share = |key: &str| number(key).clamp(0.0, 1.0);
        MetallicRoughness {
            sheen_color: Vec3::splat(share("Ps")),
            sheen_roughness: factors.roughness,
            clearcoat: share("Pc"),
            clearcoat_roughness: share("Pcr"),
            anisotropy: share("aniso"),
            // In turns, as the extension for physically based rendering has it.
            anisotropy_rotation: number("anisor") * TAU,
            ..factors
        }
    }

    /// Sets the normal map: `norm`, or a `bump` that turns out to be a normal map.
    fn set_normal_map(&mut self, material: &mut Material) {
        let norm = self.statement("norm").and_then(TextureMap::parse);
        let is_norm = norm.is_some();
        let bump = || self.source.normal_texture.as_deref().and_then(TextureMap::parse);
        let Some(map) = norm.or_else(bump) else { return };
        let scale = map.bump_scale.unwrap_or(1.0);
        let normal_map = NormalMap { texture: self.texture(&map, Transfer::None), scale };
        if is_norm {
            material.normal_map = Some(normal_map);
        } else {
            self.textures.add_bump(self.id(), normal_map);
        }
    }

    /// Returns the id that the material will have.
    fn id(&self) -> MaterialId {
        MaterialId(self.scene.materials.len() as u32)
    }

    /// Returns the value of a statement that tobj has no field for.
    fn statement(&self, key: &str) -> Option<&'a str> {
        self.source.unknown_param.get(key).map(String::as_str)
    }

    /// Returns a texture of colours.
    fn color_map(&mut self, value: Option<&str>) -> Option<TextureId> {
        let map = TextureMap::parse(value?)?;
        let channel = u64::from(map.channel.is_some());
        let reason = "the option `-imfchan` of {} textures of colours is not read";
        self.diagnostics
            .unsupported(reason, channel, || format!("`{}`", value.unwrap_or_default()));
        self.warn_of_bump_scale(&map);
        Some(self.texture(&map, Transfer::Srgb))
    }

    /// Returns one channel of a texture: red, where its options name none.
    fn channel(&mut self, value: Option<&str>) -> Option<Channel> {
        let map = TextureMap::parse(value?)?;
        self.warn_of_bump_scale(&map);
        Some(Channel {
            texture: self.texture(&map, Transfer::None),
            channel: map.channel.unwrap_or(0),
        })
    }

    /// Warns of a `-bm` on a texture that is no bump.
    fn warn_of_bump_scale(&mut self, map: &TextureMap) {
        let reason = "the option `-bm` of {} textures that are no bumps is not read";
        self.diagnostics
            .unsupported(reason, u64::from(map.bump_scale.is_some()), || format!("`{}`", map.file));
    }

    /// Returns the texture of a statement, and warns of options that are not read.
    fn texture(&mut self, map: &TextureMap, transfer: Transfer) -> TextureId {
        for option in &map.ignored {
            let reason = format!("the option `{option}` of {{}} textures is not read");
            self.diagnostics.unsupported(&reason, 1, || format!("`{}`", map.file));
        }
        self.textures.texture(map, transfer, self.folder, self.scene)
    }

    /// Returns the statements about light that is not scattered, as the programs mean them that wrote
    /// them; a warning says where that is not what they say.
    fn illumination(&mut self) -> Illumination {
        let source = self.source;
        let mut illumination = Illumination::read(source);
        let mut mend = |is_odd: bool, reason: &str| {
            self.diagnostics.add(reason, u64::from(is_odd), || format!("`{}`", source.name));
            is_odd
        };
        // An image of opacity beside a 0 counts alone.
        let has_map = source.dissolve_texture.is_some() && !illumination.is_glass();
        let reason = "{} materials have an opacity of 0 beside an image of it: the image alone \
                      counts, as the programs that write it mean it";
        if mend(has_map && illumination.opacity == 0.0, reason) {
            illumination.opacity = 1.0;
        }
        // MeshLab and others write the opacity as `Tr`, and seldom another one than 1.
        let reason = "{} materials have `Tr 1` and no `d`: they are drawn opaque, as the programs \
                      that write it mean them";
        if mend(source.dissolve.is_none() && illumination.is_invisible(), reason) {
            illumination.opacity = 1.0;
            return illumination;
        }
        // Maya writes a white filter for whatever is opaque.
        let reason = "{} materials would be clear glass that nobody sees, by `illum` and a white \
                      `Tf` alone: they are drawn opaque, as the programs that write it mean them";
        mend(illumination.is_idle_filter(), reason);
        illumination
    }
}
