//! Alpha coverage: where a surface is solid, cut out or see-through.

use crate::geometry::{Geometry, PrimitiveId};
use crate::scene::{Channel, Scene, Texture, TexturePoint};

/// The share of what lies behind it that a surface covers: its alpha, which is `alpha` times the map
/// times the alpha of a mesh's vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// The factor, in \[0, 1\].
    pub alpha: f32,
    /// The map that it is multiplied with.
    pub map: Option<Channel>,
    /// The meaning of alpha.
    pub mode: AlphaMode,
}

/// The meaning of alpha.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum AlphaMode {
    /// A mask: where alpha is below the cutoff no ray hits the surface; for meshes only.
    Mask {
        /// The least alpha at which the surface is solid.
        cutoff: f32,
    },
    /// A blend: the surface is seen by its share alpha, and what lies behind it by the rest. Its
    /// material is `thin`, has an `ior` of 1 and no `transmit` of its own.
    Blend,
}

impl Coverage {
    /// Evaluates alpha at a point, where that of the mesh's vertices is `vertex`.
    #[inline]
    pub fn evaluate(&self, textures: &[Texture], point: &TexturePoint, vertex: f32) -> f32 {
        let map = self.map.map_or(1.0, |map| {
            textures[map.texture.0 as usize].sample(point)[usize::from(map.channel)]
        });
        let alpha = self.alpha * map * vertex;
        // A NaN becomes 0.
        if alpha > 0.0 { alpha.min(1.0) } else { 0.0 }
    }
}

impl Scene {
    /// True if the mask of its material cuts the point (`u`, `v`) out of a triangle, so that no ray
    /// hits it there: the one alpha test of all intersectors.
    ///
    /// Alpha is sampled without mipmaps, whatever shading averages.
    ///
    /// # Panics
    /// When `id` is not a primitive of this scene.
    #[inline]
    pub fn is_cut_out(&self, id: PrimitiveId, u: f64, v: f64) -> bool {
        let Geometry::Mesh(mesh) = id.geometry else { return false };
        // A scene that is not checked yet may have an instance without a material.
        let material = self.instances[id.instance as usize].material.0 as usize;
        let Some(coverage) = self.materials.get(material).and_then(|m| m.coverage.as_ref()) else {
            return false;
        };
        let AlphaMode::Mask { cutoff } = coverage.mode else { return false };
        let mesh = &self.meshes[mesh as usize];
        let weights = [1.0 - u - v, u, v];
        let uv = mesh.uv(id.primitive, weights);
        let point = TexturePoint { uv, ..TexturePoint::default() };
        coverage.evaluate(&self.textures, &point, mesh.alpha(id.primitive, weights)) < cutoff
    }

    /// True if the material of an instance cuts holes into its mesh.
    pub(crate) fn is_masked(&self, instance: u32) -> bool {
        let material = self.instances[instance as usize].material.0 as usize;
        self.materials.get(material).is_some_and(|m| m.is_masked())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Channel, Filter, Image, Instance, Material, Mesh};
    use glam::DAffine3;

    /// A triangle whose texture is opaque on its left half only.
    fn half() -> Scene {
        let mut scene = Scene::default();
        let image = Image::from_bytes("", [2, 1], vec![[255; 4], [255, 255, 255, 100]]);
        let texture = Texture { filter: Filter::Nearest, ..Texture::new(image.into()) };
        let map = Some(Channel { texture: scene.add_texture(texture), channel: 3 });
        let coverage = Coverage { alpha: 1.0, map, mode: AlphaMode::Mask { cutoff: 0.5 } };
        let material = Material { coverage: Some(coverage), ..Material::default() };
        let material = scene.add_material(material);
        let mesh = scene.add_mesh(Mesh {
            positions: vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]].into(),
            uvs: vec![[0., 0.], [1., 0.], [0., 1.]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        });
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
        scene
    }

    const ID: PrimitiveId = PrimitiveId::triangle(0, 0, 0);

    #[test]
    fn a_mask_cuts_where_alpha_is_below_the_cutoff() {
        let scene = half();
        assert_eq!([0.4, 0.6].map(|u| scene.is_cut_out(ID, u, 0.1)), [false, true]);
    }

    #[test]
    fn alpha_at_the_cutoff_is_solid() {
        let mut scene = half();
        let mode = AlphaMode::Mask { cutoff: 100.0 / 255.0 };
        scene.materials[0].coverage.as_mut().unwrap().mode = mode;
        assert!(!scene.is_cut_out(ID, 0.6, 0.1));
    }

    #[test]
    fn the_factor_and_the_vertices_count() {
        let mut scene = half();
        std::sync::Arc::make_mut(&mut scene.meshes[0]).alphas = vec![1.0, 1.0, 0.0];
        assert_eq!([0.1, 0.9].map(|v| scene.is_cut_out(ID, 0.0, v)), [false, true]);
        scene.materials[0].coverage.as_mut().unwrap().alpha = 0.4;
        assert!(scene.is_cut_out(ID, 0.0, 0.1));
    }

    #[test]
    fn what_is_blended_is_not_cut() {
        let mut scene = half();
        scene.materials[0].coverage.as_mut().unwrap().mode = AlphaMode::Blend;
        assert!(!scene.is_cut_out(ID, 0.6, 0.1));
    }
}
