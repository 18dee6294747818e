//! The material of a surface: by Lambert and Phong, with mirrors and glass, or physically based.

use glam::Vec3;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::{AlphaMode, Channel, Coverage, MetallicRoughnessMaps, ShadingParams, TextureId};

/// The index of a material in `Scene::materials`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialId(pub u32);

/// The shading model of a material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum ShadingModel {
    /// Lambert's and Phong's, as in the tutorial.
    #[default]
    Phong,
    /// The physically based one of glTF's metallic-roughness materials.
    Pbr,
}

/// A material. A physically based one has `shading` and `metallic` set ([`Material::is_pbr`]); the fields
/// from `diffuse` to `transmit`, except the emission, then are Lambert's and Phong's approximation of it, which
/// only shadows through it have.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name, unique in a scene file; model files may repeat names.
    pub name: String,
    /// The shading model.
    pub shading: ShadingModel,
    /// The share of light scattered in all directions, linear Rec. 709; without Lambert's 1/π, as in
    /// the tutorial.
    pub diffuse: Vec3,
    /// The texture that multiplies `diffuse`.
    pub diffuse_map: Option<TextureId>,
    /// The share of light in the highlight, linear Rec. 709.
    pub specular: Vec3,
    /// The texture that multiplies `specular`.
    pub specular_map: Option<TextureId>,
    /// Phong's exponent, the tutorial's α, above 0: the greater, the smaller the highlight.
    pub shininess: f32,
    /// The texture that varies `shininess`.
    pub shininess_map: Option<ShininessMap>,
    /// The emitted radiance, linear Rec. 709; it illuminates nothing else unless `illuminates`.
    pub emission: Vec3,
    /// The texture that multiplies `emission`.
    pub emission_map: Option<TextureId>,
    /// True if the colours of a mesh's vertices multiply `emission`: an unlit surface shows its colour
    /// as radiance.
    pub unlit: bool,
    /// True if what it emits lights other surfaces: spheres and instances of the material are lights, by
    /// samples of their surfaces. A mesh emits from its front, and from its back unless
    /// `cull_back_faces`. Planes illuminate nothing.
    pub illuminates: bool,
    /// The share of light reflected as by a mirror, linear Rec. 709.
    pub reflect: Vec3,
    /// The share of light transmitted as through glass, linear Rec. 709, of which Fresnel's law
    /// reflects a part. `reflect` and `transmit` are at most 1 together.
    pub transmit: Vec3,
    /// The index of refraction of its inside, relative to empty space, in \[0.01, 100\].
    pub ior: f64,
    /// The absorption coefficient of its inside: light falls to e^(−absorption) per unit of length.
    pub absorption: Vec3,
    /// True for a thin sheet without an inside: light goes straight through.
    pub thin: bool,
    /// The priority where dielectrics overlap: the one with the greater priority fills the point; of two
    /// equal ones, the smaller.
    pub priority: i32,
    /// True if a sphere is lit on its inside too. Planes and meshes always are, on the side that the
    /// viewer sees.
    pub double_sided: bool,
    /// True if the viewer does not see the back faces of a mesh, but what lies beyond them, as in glTF
    /// unless a material is `doubleSided`. Shadows have both sides.
    pub cull_back_faces: bool,
    /// The normal map.
    pub normal_map: Option<NormalMap>,
    /// The normal map of the clearcoat, which without one has the surface's own normal.
    pub clearcoat_normal_map: Option<NormalMap>,
    /// The map of ambient occlusion.
    pub occlusion_map: Option<OcclusionMap>,
    /// The alpha coverage, if the surface may cover less than all that lies behind it.
    pub coverage: Option<Coverage>,
    /// The metallic-roughness material: physically based shading evaluates it; of Lambert and Phong, diffuse,
    /// specular, shininess, reflect and transmit are computed from it at each point where a map or a vertex
    /// colour counts.
    pub metallic: Option<Box<MetallicRoughnessMaps>>,
}

/// A texture that varies the shininess.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ShininessMap {
    /// The shininess is multiplied by the channel, and at least 1.
    Factor(Channel),
    /// The shininess is that of a surface of roughness 1 − factor · channel.
    Gloss(Channel, f32),
}

/// A texture of normals in tangent space: red, green and blue from 0 to 1 are x, y and z from −1 to
/// 1; x points along u, y up in the image and z out of the surface, as in glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// The texture; its colours are linear.
    pub texture: TextureId,
    /// The factor of x and y.
    pub scale: f32,
}

/// A texture of ambient occlusion: ambient light is multiplied by 1 + strength · (channel − 1). Other
/// light is not affected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OcclusionMap {
    /// The texture's channel.
    pub map: Channel,
    /// The strength, in \[0, 1\].
    pub strength: f32,
}

/// An iterator over references, shared or mutable, to the ids of a material's textures.
macro_rules! texture_ids {
    ($material:ident, $as_ref:ident, $as_deref:ident) => {{
        let own = [
            $material.diffuse_map.$as_ref(),
            $material.specular_map.$as_ref(),
            $material.shininess_map.$as_ref().map(|map| match map {
                ShininessMap::Factor(Channel { texture, .. })
                | ShininessMap::Gloss(Channel { texture, .. }, _) => texture,
            }),
            $material.emission_map.$as_ref(),
            $material.normal_map.$as_ref().map(|NormalMap { texture, .. }| texture),
            $material.clearcoat_normal_map.$as_ref().map(|NormalMap { texture, .. }| texture),
            $material
                .occlusion_map
                .$as_ref()
                .map(|OcclusionMap { map: Channel { texture, .. }, .. }| texture),
            $material
                .coverage
                .$as_ref()
                .and_then(|coverage| coverage.map.$as_ref().map(|Channel { texture, .. }| texture)),
        ];
        let metallic = $material.metallic.$as_deref().map(|maps| {
            [
                maps.base_color.$as_ref(),
                maps.specular_color.$as_ref(),
                maps.metallic.$as_ref().map(|Channel { texture, .. }| texture),
                maps.roughness.$as_ref().map(|Channel { texture, .. }| texture),
                maps.specular.$as_ref().map(|Channel { texture, .. }| texture),
                maps.transmission.$as_ref().map(|Channel { texture, .. }| texture),
                maps.clearcoat.$as_ref().map(|Channel { texture, .. }| texture),
                maps.clearcoat_roughness.$as_ref().map(|Channel { texture, .. }| texture),
                maps.sheen_color.$as_ref(),
                maps.sheen_roughness.$as_ref().map(|Channel { texture, .. }| texture),
                maps.anisotropy.$as_ref(),
                maps.iridescence.$as_ref().map(|Channel { texture, .. }| texture),
                maps.iridescence_thickness.$as_ref().map(|Channel { texture, .. }| texture),
                maps.diffuse_transmission.$as_ref().map(|Channel { texture, .. }| texture),
                maps.diffuse_transmission_color.$as_ref(),
            ]
        });
        own.into_iter().chain(metallic.into_iter().flatten()).flatten()
    }};
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            shading: ShadingModel::Phong,
            diffuse: Vec3::splat(0.8),
            diffuse_map: None,
            specular: Vec3::ZERO,
            specular_map: None,
            shininess: 50.0,
            shininess_map: None,
            emission: Vec3::ZERO,
            emission_map: None,
            unlit: false,
            illuminates: false,
            reflect: Vec3::ZERO,
            transmit: Vec3::ZERO,
            ior: 1.5,
            absorption: Vec3::ZERO,
            thin: false,
            priority: 0,
            double_sided: false,
            cull_back_faces: false,
            normal_map: None,
            clearcoat_normal_map: None,
            occlusion_map: None,
            coverage: None,
            metallic: None,
        }
    }
}

/// Materials for common surfaces.
///
/// ```
/// use envers::scene::Material;
/// use glam::Vec3;
///
/// let brick = Material::matte(Vec3::new(0.6, 0.2, 0.1));
/// let (gold, window) = (Material::mirror(Vec3::new(1.0, 0.8, 0.3)), Material::glass(1.5));
/// let lamp = Material { name: "lamp".into(), ..Material::emissive(Vec3::splat(5.0)) };
/// assert!(!brick.spawns_rays() && !lamp.spawns_rays());
/// assert!(gold.may_reflect() && window.is_dielectric());
/// ```
impl Material {
    /// A matte material, which scatters this share of light in all directions (linear Rec. 709).
    pub fn matte(color: Vec3) -> Self {
        Self { diffuse: color, ..Self::default() }
    }

    /// A mirror, which reflects this share of light and scatters nothing.
    pub fn mirror(color: Vec3) -> Self {
        Self { reflect: color, ..Self::matte(Vec3::ZERO) }
    }

    /// Clear glass with this index of refraction, which is about 1.5 for window glass.
    pub fn glass(ior: f64) -> Self {
        Self { transmit: Vec3::ONE, ior, ..Self::matte(Vec3::ZERO) }
    }

    /// A material that emits this radiance and scatters nothing; it illuminates nothing else, as long as
    /// `illuminates` is not set.
    pub fn emissive(radiance: Vec3) -> Self {
        Self { emission: radiance, ..Self::matte(Vec3::ZERO) }
    }

    /// The shading parameters where no texture or vertex colour changes them.
    pub fn shading_params(&self) -> ShadingParams {
        let Self { diffuse, specular, shininess, emission, reflect, transmit, .. } = *self;
        ShadingParams { diffuse, specular, shininess, emission, reflect, transmit }
    }

    /// Makes it a metallic-roughness material, in its shading model. By Lambert and Phong it is a plain one if
    /// nothing but its base colour varies, which then is the diffuse colour.
    pub fn set_metallic_roughness(&mut self, maps: MetallicRoughnessMaps) {
        let ShadingParams { diffuse, specular, shininess, reflect, transmit, .. } =
            maps.factors.shading_params();
        (self.diffuse, self.specular, self.shininess) = (diffuse, specular, shininess);
        (self.reflect, self.transmit) = (reflect, transmit);
        let is_plain = self.shading == ShadingModel::Phong
            && MetallicRoughnessMaps { base_color: None, ..maps.clone() }
                == MetallicRoughnessMaps::new(maps.factors)
            && maps.factors.metallic == 0.0
            && maps.factors.transmission == 0.0;
        self.diffuse_map = if is_plain { maps.base_color } else { None };
        self.metallic = (!is_plain).then(|| Box::new(maps));
    }

    /// Multiplies its base colour, as the colours of a mesh's vertices do: what an unlit material emits,
    /// the base of a metallic-roughness material, or else the diffuse colour. A lit base is at most 1.
    pub(crate) fn multiply_base(&mut self, color: Vec3) {
        if self.unlit {
            self.emission *= color;
        } else if let Some(mut maps) = self.metallic.take() {
            let base = &mut maps.factors.base_color;
            *base = (*base * color).min(Vec3::ONE);
            self.set_metallic_roughness(*maps);
        } else {
            self.diffuse = (self.diffuse * color).min(Vec3::ONE);
        }
    }

    /// True if it is physically based.
    #[inline]
    pub fn is_pbr(&self) -> bool {
        self.shading == ShadingModel::Pbr && self.metallic.is_some()
    }

    /// True if its objects are lights: it emits light, and that illuminates other surfaces.
    pub fn is_light(&self) -> bool {
        self.illuminates && self.emission != Vec3::ZERO
    }

    /// True if it reflects as a mirror anywhere, or so sharply that reflected rays are traced.
    pub fn may_reflect(&self) -> bool {
        let is_pbr = self.is_pbr();
        self.reflect != Vec3::ZERO
            || self
                .metallic
                .as_ref()
                .is_some_and(|maps| maps.may_reflect() || (is_pbr && maps.may_reflect_sharply()))
    }

    /// True if it transmits light anywhere, other than through what a mask cuts out.
    pub fn may_transmit(&self) -> bool {
        self.transmit != Vec3::ZERO
            || self.metallic.as_ref().is_some_and(|m| m.may_transmit())
            || self.coverage.is_some_and(|c| c.mode == AlphaMode::Blend)
    }

    /// True if it sends secondary rays anywhere: reflected or transmitted.
    pub fn spawns_rays(&self) -> bool {
        self.may_reflect() || self.may_transmit()
    }

    /// True if its object is a dielectric: transmissive, with an inside.
    pub fn is_dielectric(&self) -> bool {
        self.may_transmit() && !self.thin
    }

    /// True if light may pass through it unchanged, between two media with this index of refraction.
    pub fn is_clear_in(&self, ior: f64) -> bool {
        // What it transmits may differ from point to point.
        let is_clear = if self.metallic.is_some() || self.coverage.is_some() {
            self.may_transmit()
        } else {
            self.transmit == Vec3::ONE && self.emission == Vec3::ZERO
        };
        is_clear && self.ior == ior
    }

    /// The dispersion of what is behind its surface: 20 divided by the Abbe number, or 0.
    pub(crate) fn dispersion(&self) -> f32 {
        let maps = self.metallic.as_ref().filter(|_| self.is_pbr() && !self.thin);
        maps.map_or(0.0, |maps| maps.factors.in_range().dispersion)
    }

    /// True if it blocks all light, from either side.
    pub fn blocks_light(&self) -> bool {
        !self.may_transmit() && !self.passes_light_from_behind()
    }

    /// True if light passes through it from behind, as the viewer does: an unlit surface is a backdrop,
    /// such as a sky that surrounds a model, and keeps no light out.
    pub fn passes_light_from_behind(&self) -> bool {
        self.unlit && self.cull_back_faces
    }

    /// True if a mask cuts holes into it.
    pub fn is_masked(&self) -> bool {
        self.coverage.is_some_and(|c| matches!(c.mode, AlphaMode::Mask { .. }))
    }

    /// True if it has a texture, so that shading needs texture coordinates.
    pub fn is_textured(&self) -> bool {
        self.textures().next().is_some()
    }

    /// The textures; one that is used twice is listed twice.
    pub fn textures(&self) -> impl Iterator<Item = TextureId> {
        texture_ids!(self, as_ref, as_deref).copied()
    }

    /// The ids of the textures, mutable.
    pub fn textures_mut(&mut self) -> impl Iterator<Item = &mut TextureId> {
        texture_ids!(self, as_mut, as_deref_mut)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::MetallicRoughness;

    /// A material with a different texture for each map.
    fn full() -> Material {
        let mut next = 0;
        let mut id = || {
            next += 1;
            TextureId(next - 1)
        };
        let mut channel = || Channel { texture: id(), channel: 0 };
        Material {
            diffuse_map: Some(channel().texture),
            specular_map: Some(channel().texture),
            shininess_map: Some(ShininessMap::Factor(channel())),
            emission_map: Some(channel().texture),
            normal_map: Some(NormalMap { texture: channel().texture, scale: 1.0 }),
            clearcoat_normal_map: Some(NormalMap { texture: channel().texture, scale: 1.0 }),
            occlusion_map: Some(OcclusionMap { map: channel(), strength: 1.0 }),
            coverage: Some(Coverage { alpha: 1.0, map: Some(channel()), mode: AlphaMode::Blend }),
            metallic: Some(Box::new(MetallicRoughnessMaps {
                factors: MetallicRoughness::default(),
                base_color: Some(channel().texture),
                specular_color: Some(channel().texture),
                metallic: Some(channel()),
                roughness: Some(channel()),
                specular: Some(channel()),
                transmission: Some(channel()),
                clearcoat: Some(channel()),
                clearcoat_roughness: Some(channel()),
                sheen_color: Some(channel().texture),
                sheen_roughness: Some(channel()),
                anisotropy: Some(channel().texture),
                iridescence: Some(channel()),
                iridescence_thickness: Some(channel()),
                iridescence_thickness_minimum: 0.0,
                diffuse_transmission: Some(channel()),
                diffuse_transmission_color: Some(channel().texture),
            })),
            ..Material::default()
        }
    }

    #[test]
    fn constructors_set_one_share_and_scatter_nothing_else() {
        let color = Vec3::new(0.1, 0.2, 0.3);
        let black = Material { diffuse: Vec3::ZERO, ..Material::default() };
        assert_eq!(Material::matte(color), Material { diffuse: color, ..Material::default() });
        assert_eq!(Material::mirror(color), Material { reflect: color, ..black.clone() });
        assert_eq!(Material::emissive(color), Material { emission: color, ..black.clone() });
        let glass = Material { transmit: Vec3::ONE, ior: 1.33, ..black };
        assert_eq!(Material::glass(1.33), glass);
    }

    #[test]
    fn every_texture_of_a_material_is_listed() {
        let all: Vec<u32> = full().textures().map(|id| id.0).collect();
        assert_eq!(all, (0..23).collect::<Vec<_>>());
    }

    #[test]
    fn every_texture_of_a_material_can_be_changed() {
        let mut material = full();
        material.textures_mut().for_each(|id| id.0 += 100);
        let all: Vec<u32> = material.textures().map(|id| id.0).collect();
        assert_eq!(all, (100..123).collect::<Vec<_>>());
    }
}
