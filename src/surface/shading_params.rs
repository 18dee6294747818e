//! Shading parameters: a material at one point, with its textures looked up.

use glam::Vec3;

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
    let lookup = TextureLookup { scene, context };
    let mut params = match &material.metallic {
        Some(metallic) => lookup.metallic(metallic).shading_params(),
        None => lookup.phong(material),
    };
    if material.emission != Vec3::ZERO {
        params.emission = material.emission * lookup.color(material.emission_map);
        if material.unlit {
            params.emission *= context.vertex_color;
        }
    }
    match &material.coverage {
        Some(coverage) if coverage.mode == AlphaMode::Blend => {
            params.with_alpha(coverage.evaluate(&scene.textures, &context.point, context.alpha))
        }
        _ => params,
    }
}

/// Evaluates ambient occlusion: the share of ambient light that arrives at a point with this texture
/// context.
pub fn ambient_occlusion(scene: &Scene, material: &Material, context: &TextureContext) -> f32 {
    let lookup = TextureLookup { scene, context };
    material.occlusion_map.map_or(1.0, |occlusion| {
        1.0 + occlusion.strength * (lookup.channel(Some(occlusion.map)) - 1.0)
    })
}

/// A lookup of the textures of a scene at one point.
struct TextureLookup<'a> {
    scene: &'a Scene,
    context: &'a TextureContext,
}

impl TextureLookup<'_> {
    /// Looks up a colour; white without a map.
    fn color(&self, map: Option<TextureId>) -> Vec3 {
        map.map_or(Vec3::ONE, |id| {
            self.scene.textures[id.0 as usize].sample(&self.context.point).truncate()
        })
    }

    /// Looks up a channel; 1 without a map.
    fn channel(&self, map: Option<Channel>) -> f32 {
        map.map_or(1.0, |map| {
            let color = self.scene.textures[map.texture.0 as usize].sample(&self.context.point);
            color[usize::from(map.channel & 3)]
        })
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

    /// Evaluates a metallic-roughness material. Shares are at most 1, also from a float texture.
    fn metallic(&self, maps: &MetallicRoughnessMaps) -> MetallicRoughness {
        let share = |factor: f32, map| (factor * self.channel(map)).min(1.0);
        let factors = &maps.factors;
        let base = self.context.checker.unwrap_or(factors.base);
        MetallicRoughness {
            base: base * self.color(maps.base) * self.context.vertex_color,
            metallic: share(factors.metallic, maps.metallic),
            roughness: share(factors.roughness, maps.roughness),
            specular: share(factors.specular, maps.specular),
            specular_color: factors.specular_color * self.color(maps.specular_color),
            transmission: share(factors.transmission, maps.transmission),
            ior: factors.ior,
        }
    }
}
