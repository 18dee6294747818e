//! Shading parameters: a material at one point, with its textures looked up.

use std::cell::Cell;

use glam::{Vec3, Vec4};

use super::TextureContext;
use crate::scene::{
    AlphaMode, Channel, Material, MetallicRoughness, MetallicRoughnessMaps, Scene, ShadingParams,
    ShininessMap, TextureId, shininess,
};

/// Evaluates the shading parameters of a material at a point with this texture context.
///
/// # Panics
/// When a texture of the material is not one of the scene.
pub fn shading_params(
    scene: &Scene,
    material: &Material,
    context: &TextureContext,
) -> ShadingParams {
    let lookup = TextureLookup::new(scene, context);
    let mut params = match &material.metallic {
        Some(metallic) => lookup.metallic(metallic).shading_params(),
        None => lookup.phong(material),
    };
    params.emission = lookup.emission(material);
    match &material.coverage {
        Some(coverage) if coverage.mode == AlphaMode::Blend => {
            params.with_alpha(coverage.evaluate(&scene.textures, &context.point, context.alpha))
        }
        _ => params,
    }
}

/// The parameters of a physically based material at one point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PbrParams {
    /// The factors, with their maps looked up.
    pub factors: MetallicRoughness,
    /// The emitted radiance, of what is covered.
    pub emission: Vec3,
    /// The share of what lies behind that the surface covers.
    pub alpha: f32,
    /// The share of ambient light that arrives, by an occlusion map.
    pub ambient: f32,
}

impl PbrParams {
    /// The emission, and what the surface leaves uncovered, as the parameters of a surface that does nothing else.
    pub fn shading_params(&self) -> ShadingParams {
        ShadingParams {
            diffuse: Vec3::ZERO,
            specular: Vec3::ZERO,
            shininess: 1.0,
            emission: self.emission,
            reflect: Vec3::ZERO,
            transmit: Vec3::splat(1.0 - self.alpha),
        }
    }
}

/// Evaluates a physically based material at a point with this texture context.
///
/// # Panics
/// When a texture of the material is not one of the scene, or the material is not physically based.
pub fn pbr_params(scene: &Scene, material: &Material, context: &TextureContext) -> PbrParams {
    let lookup = TextureLookup::new(scene, context);
    let maps = material.metallic.as_deref().expect("a physically based material");
    let emission = lookup.emission(material);
    let alpha = match &material.coverage {
        Some(coverage) if coverage.mode == AlphaMode::Blend => {
            coverage.evaluate(&scene.textures, &context.point, context.alpha)
        }
        _ => 1.0,
    };
    let factors = lookup.all_layers(maps);
    let ambient = lookup.ambient_occlusion(material);
    PbrParams { factors, emission: emission * alpha, alpha, ambient }
}

/// Evaluates ambient occlusion: the share of ambient light that arrives at a point with this texture
/// context.
pub fn ambient_occlusion(scene: &Scene, material: &Material, context: &TextureContext) -> f32 {
    let lookup = TextureLookup::new(scene, context);
    lookup.ambient_occlusion(material)
}

/// A lookup of the textures of a scene at one point.
struct TextureLookup<'a> {
    scene: &'a Scene,
    context: &'a TextureContext,
    /// The last texture that was looked up, and what it has there: roughness, metalness and occlusion are often
    /// channels of one.
    last: Cell<Option<(TextureId, Vec4)>>,
}

impl<'a> TextureLookup<'a> {
    fn new(scene: &'a Scene, context: &'a TextureContext) -> Self {
        Self { scene, context, last: Cell::new(None) }
    }

    /// Looks up a texture.
    fn texture(&self, id: TextureId) -> Vec4 {
        match self.last.get() {
            Some((last, color)) if last == id => color,
            _ => {
                let color = self.scene.textures[id.0 as usize].sample(&self.context.point);
                self.last.set(Some((id, color)));
                color
            }
        }
    }

    /// Looks up a colour; white without a map.
    fn color(&self, map: Option<TextureId>) -> Vec3 {
        map.map_or(Vec3::ONE, |id| self.texture(id).truncate())
    }

    /// Looks up a channel; 1 without a map.
    fn channel(&self, map: Option<Channel>) -> f32 {
        map.map_or(1.0, |map| self.texture(map.texture)[usize::from(map.channel & 3)])
    }

    /// Evaluates the share of ambient light that arrives.
    fn ambient_occlusion(&self, material: &Material) -> f32 {
        material.occlusion_map.map_or(1.0, |occlusion| {
            1.0 + occlusion.strength * (self.channel(Some(occlusion.map)) - 1.0)
        })
    }

    /// Evaluates what a material emits.
    fn emission(&self, material: &Material) -> Vec3 {
        if material.emission == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let emission = material.emission * self.color(material.emission_map);
        if material.unlit { emission * self.context.vertex_color } else { emission }
    }

    /// Evaluates a Lambert and Phong material.
    fn phong(&self, material: &Material) -> ShadingParams {
        let factors = material.shading_params();
        let diffuse = self.context.checker.unwrap_or(factors.diffuse);
        ShadingParams {
            diffuse: diffuse * self.color(material.diffuse_map) * self.context.vertex_color,
            specular: factors.specular * self.color(material.specular_map),
            shininess: match material.shininess_map {
                None => factors.shininess,
                Some(ShininessMap::Factor(map)) => {
                    (factors.shininess * self.channel(Some(map))).max(1.0)
                }
                Some(ShininessMap::Gloss(map, factor)) => {
                    shininess(1.0 - factor * self.channel(Some(map)))
                }
            },
            emission: Vec3::ZERO,
            ..factors
        }
    }

    /// Evaluates a metallic-roughness material with all of its layers.
    fn all_layers(&self, maps: &MetallicRoughnessMaps) -> MetallicRoughness {
        let share = |factor: f32, map| (factor * self.channel(map)).min(1.0);
        let factors = self.metallic(maps);
        let (mut anisotropy, mut rotation) = (factors.anisotropy, factors.anisotropy_rotation);
        if let Some(map) = maps.anisotropy {
            let Vec3 { x, y, z } = self.color(Some(map));
            anisotropy *= z;
            rotation += (2.0 * y - 1.0).atan2(2.0 * x - 1.0);
        }
        let film = maps.iridescence_thickness.map_or(factors.iridescence_thickness, |map| {
            let (thinnest, thickest) =
                (maps.iridescence_thickness_minimum, factors.iridescence_thickness);
            thinnest + (thickest - thinnest) * self.channel(Some(map))
        });
        MetallicRoughness {
            clearcoat: share(factors.clearcoat, maps.clearcoat),
            clearcoat_roughness: share(factors.clearcoat_roughness, maps.clearcoat_roughness),
            sheen_color: factors.sheen_color * self.color(maps.sheen_color),
            sheen_roughness: share(factors.sheen_roughness, maps.sheen_roughness),
            anisotropy,
            anisotropy_rotation: rotation,
            iridescence: share(factors.iridescence, maps.iridescence),
            iridescence_thickness: film,
            diffuse_transmission: share(factors.diffuse_transmission, maps.diffuse_transmission),
            diffuse_transmission_color: factors.diffuse_transmission_color
                * self.color(maps.diffuse_transmission_color),
            ..factors
        }
    }

    /// Evaluates a metallic-roughness material without the layers of extensions. Shares are at most 1, also from a float texture.
    fn metallic(&self, maps: &MetallicRoughnessMaps) -> MetallicRoughness {
        let share = |factor: f32, map| (factor * self.channel(map)).min(1.0);
        let factors = &maps.factors;
        let base = self.context.checker.unwrap_or(factors.base_color);
        MetallicRoughness {
            base_color: base * self.color(maps.base_color) * self.context.vertex_color,
            metallic: share(factors.metallic, maps.metallic),
            roughness: share(factors.roughness, maps.roughness),
            specular: share(factors.specular, maps.specular),
            specular_color: factors.specular_color * self.color(maps.specular_color),
            transmission: share(factors.transmission, maps.transmission),
            ..*factors
        }
    }
}
