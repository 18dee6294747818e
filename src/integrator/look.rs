//! What shading reads of a material, close together.

use glam::Vec3;

use crate::geometry::{Geometry, Hit};
use crate::scene::{Material, Scene, TextureId};
use crate::shading::Reflectance;
use crate::surface::Detail;

/// A material as it looks where no texture, checker or vertex colour tells otherwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// What of the light it scatters, less what is seen in it and through it.
    pub reflectance: Reflectance,
    /// What it sends out itself.
    pub emission: Vec3,
    /// The share that is neither reflected nor let through.
    rest: Vec3,
    /// Whether all of it is finite.
    pub is_finite: bool,
    /// Whether a texture has a part in it.
    pub is_textured: bool,
    /// Whether rays are followed from it.
    pub is_followed: bool,
}

impl Look {
    pub fn of(material: &Material) -> Self {
        let is_followed = material.is_followed();
        let rest = match is_followed {
            true => (Vec3::ONE - material.reflect - material.transmit).max(Vec3::ZERO),
            false => Vec3::ONE,
        };
        let reflectance = Reflectance {
            diffuse: material.diffuse * rest,
            specular: material.specular * rest,
            shininess: material.shininess,
        };
        let (emission, is_textured) = (material.emission, material.is_textured());
        let is_finite = emission.is_finite() && reflectance.diffuse.is_finite();
        Self { reflectance, emission, rest, is_finite, is_textured, is_followed }
    }

    /// Emission and diffuse reflectance with the detail of a point.
    #[inline(never)]
    pub fn with(&self, scene: &Scene, material: &Material, detail: &Detail) -> (Vec3, Vec3) {
        let texture = |map: Option<TextureId>| {
            map.map_or(Vec3::ONE, |id| scene.textures[id.0 as usize].color(detail.uv))
        };
        let diffuse = detail.checker.unwrap_or(material.diffuse);
        let diffuse = diffuse * texture(material.diffuse_map) * detail.tint * self.rest;
        let emission = match material.emission == Vec3::ZERO {
            true => Vec3::ZERO,
            false => material.emission * texture(material.emission_map),
        };
        (emission, diffuse)
    }
}

/// Whether any surface of the scene has a detail: a texture, a checker or vertex colours.
pub(super) fn has_detail(scene: &Scene) -> bool {
    scene.materials_in_use().any(|m| m.is_textured())
        || scene.planes.iter().any(|plane| plane.checker.is_some())
        || scene.meshes.iter().any(|mesh| !mesh.colors.is_empty())
}

/// Whether what was hit, whose material looks like this, has a detail.
#[inline(always)]
pub(super) fn is_detailed(scene: &Scene, look: &Look, hit: &Hit) -> bool {
    look.is_textured
        || match hit.id.geometry {
            Geometry::Spheres => false,
            Geometry::Planes => scene.planes[hit.id.primitive as usize].checker.is_some(),
            Geometry::Mesh(mesh) => !scene.meshes[mesh as usize].colors.is_empty(),
        }
}
