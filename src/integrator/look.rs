//! What shading reads of a material, close together.

use glam::Vec3;

use crate::geometry::{Geometry, Hit};
use crate::integrator::counts::WorkCounts;
use crate::scene::{Material, Scene, Skips, TextureId, Work};
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
    /// Whether it is asked for a highlight.
    pub shines: bool,
    /// Whether it is asked for texture coordinates.
    pub is_textured: bool,
    /// Whether it is asked where it sends light on.
    pub is_followed: bool,
}

impl Look {
    pub fn of(material: &Material, skips: Skips) -> Self {
        let rest = (Vec3::ONE - material.reflect - material.transmit).max(Vec3::ZERO);
        let reflectance = Reflectance {
            diffuse: material.diffuse * rest,
            specular: material.specular * rest,
            shininess: material.shininess,
        };
        let emission = material.emission;
        Self {
            reflectance,
            emission,
            rest,
            is_finite: emission.is_finite() && reflectance.diffuse.is_finite(),
            shines: skips.does(Work::Highlights, reflectance.specular != Vec3::ZERO),
            is_textured: skips.does(Work::Uv, material.is_textured()),
            is_followed: skips.does(Work::Reflection, material.is_followed()),
        }
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

/// Which planes and meshes are asked for details of their points.
pub(super) struct Details {
    /// For a checker, each plane.
    planes: Vec<bool>,
    /// For colours of their vertices, each mesh.
    meshes: Vec<bool>,
}

impl Details {
    pub fn of(scene: &Scene, skips: Skips) -> Self {
        let checkers = scene.planes.iter().map(|plane| plane.checker.is_some());
        let colors = scene.meshes.iter().map(|mesh| !mesh.colors.is_empty());
        Self {
            planes: checkers.map(|has| skips.does(Work::Checkers, has)).collect(),
            meshes: colors.map(|has| skips.does(Work::VertexColors, has)).collect(),
        }
    }

    /// Whether what was hit, whose material looks like this, is asked for any.
    #[inline(always)]
    pub fn are_asked(&self, look: &Look, hit: &Hit) -> bool {
        look.is_textured || self.of_geometry(hit)
    }

    #[inline(always)]
    fn of_geometry(&self, hit: &Hit) -> bool {
        match hit.id.geometry {
            Geometry::Spheres => false,
            Geometry::Planes => self.planes[hit.id.primitive as usize],
            Geometry::Mesh(mesh) => self.meshes[mesh as usize],
        }
    }

    /// Counts what is asked for.
    pub fn count(&self, look: &Look, hit: &Hit, work: &mut WorkCounts) {
        work.uv += u64::from(look.is_textured);
        let of_kind = match hit.id.geometry {
            Geometry::Planes => &mut work.checkers,
            _ => &mut work.vertex_colors,
        };
        *of_kind += u64::from(self.of_geometry(hit));
    }
}
