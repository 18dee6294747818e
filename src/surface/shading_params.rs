//! What a material does with light at one point, with its maps applied.

use glam::Vec3;

use super::TextureContext;
use crate::scene::{
    AlphaMode, Channel, Material, MetallicRoughness, MetallicRoughnessMaps, Scene, ShadingParams,
    ShininessMap, TextureId, shininess,
};

/// What a material of a scene does with light at a point of this detail.
///
/// # Panics
/// When a texture of the material is not one of the scene.
pub fn shading_params(
    scene: &Scene,
    material: &Material,
    detail: &TextureContext,
) -> ShadingParams {
    let maps = Maps { scene, detail };
    let mut finish = match &material.metallic {
        Some(metallic) => maps.metallic(metallic).shading_params(),
        None => maps.phong(material),
    };
    if material.emission != Vec3::ZERO {
        finish.emission = material.emission * maps.color(material.emission_map);
        if material.unlit {
            finish.emission *= detail.tint;
        }
    }
    match &material.coverage {
        Some(coverage) if coverage.mode == AlphaMode::Blend => {
            finish.with_alpha(coverage.evaluate(&scene.textures, &detail.point, detail.alpha))
        }
        _ => finish,
    }
}

/// The share of the ambient light that comes to a point of this detail.
pub fn occlusion(scene: &Scene, material: &Material, detail: &TextureContext) -> f32 {
    let maps = Maps { scene, detail };
    material.occlusion_map.map_or(1.0, |occlusion| {
        1.0 + occlusion.strength * (maps.channel(Some(occlusion.map)) - 1.0)
    })
}

/// The maps of a material at a point.
struct Maps<'a> {
    scene: &'a Scene,
    detail: &'a TextureContext,
}

impl Maps<'_> {
    fn color(&self, map: Option<TextureId>) -> Vec3 {
        map.map_or(Vec3::ONE, |id| {
            self.scene.textures[id.0 as usize].sample(&self.detail.point).truncate()
        })
    }

    fn channel(&self, map: Option<Channel>) -> f32 {
        map.map_or(1.0, |map| {
            let color = self.scene.textures[map.texture.0 as usize].sample(&self.detail.point);
            color[usize::from(map.channel & 3)]
        })
    }

    fn phong(&self, material: &Material) -> ShadingParams {
        let plain = material.shading_params();
        let diffuse = self.detail.checker.unwrap_or(plain.diffuse);
        ShadingParams {
            diffuse: diffuse * self.color(material.diffuse_map) * self.detail.tint,
            specular: plain.specular * self.color(material.specular_map),
            shininess: match material.shininess_map {
                None => plain.shininess,
                Some(ShininessMap::Factor(map)) => {
                    (plain.shininess * self.channel(Some(map))).max(1.0)
                }
                Some(ShininessMap::Gloss(map, factor)) => {
                    shininess(1.0 - factor * self.channel(Some(map)))
                }
            },
            emission: Vec3::ZERO,
            ..plain
        }
    }

    /// The parameters here; those that are shares at most 1, whatever a float picture says.
    fn metallic(&self, maps: &MetallicRoughnessMaps) -> MetallicRoughness {
        let share = |factor: f32, map| (factor * self.channel(map)).min(1.0);
        let factors = &maps.factors;
        let base = self.detail.checker.unwrap_or(factors.base);
        MetallicRoughness {
            base: base * self.color(maps.base) * self.detail.tint,
            metallic: share(factors.metallic, maps.metallic),
            roughness: share(factors.roughness, maps.roughness),
            specular: share(factors.specular, maps.specular),
            specular_color: factors.specular_color * self.color(maps.specular_color),
            transmission: share(factors.transmission, maps.transmission),
            ior: factors.ior,
        }
    }
}
