//! What shading reads of a material, close together.

use glam::Vec3;

use crate::geometry::{Geometry, Hit};
use crate::integrator::counts::FeatureCounts;
use crate::scene::{Material, Mesh, Scene, ShadingParams};
use crate::shading::Reflectance;
use crate::surface::{self, TextureContext};

/// A material as it looks where no texture, checker or vertex colour tells otherwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct CachedMaterial {
    /// What it does with light.
    pub finish: ShadingParams,
    /// What of the light it scatters, less what is seen in it and through it.
    pub reflectance: Reflectance,
    /// Whether all of it is finite.
    pub is_finite: bool,
    /// Whether it is asked for a highlight.
    pub shines: bool,
    /// Whether it is asked for texture coordinates.
    pub is_textured: bool,
    /// Whether it is asked for a normal map.
    pub has_normals: bool,
    /// Whether it is asked where it sends light on.
    pub is_followed: bool,
}

impl CachedMaterial {
    pub fn of(scene: &Scene, material: &Material) -> Self {
        // A material that nothing is made of may have pictures that were not read.
        let finish = match material.is_textured() {
            true => material.shading_params(),
            false => surface::shading_params(scene, material, &TextureContext::default()),
        };
        let reflectance = scattered(&finish);
        Self {
            finish,
            reflectance,
            is_finite: finish.emission.is_finite() && reflectance.diffuse.is_finite(),
            shines: reflectance.specular != Vec3::ZERO || material.metallic.is_some(),
            is_textured: material.is_textured(),
            has_normals: material.normal_map.is_some(),
            is_followed: material.spawns_rays(),
        }
    }
}

/// What of the light a surface scatters: of the share that is neither reflected nor let through.
pub(super) fn scattered(finish: &ShadingParams) -> Reflectance {
    let rest = (Vec3::ONE - finish.reflect - finish.transmit).max(Vec3::ZERO);
    Reflectance {
        diffuse: finish.diffuse * rest,
        specular: finish.specular * rest,
        shininess: finish.shininess,
    }
}

/// Which planes and meshes are asked for details of their points.
pub(super) struct GeometryDetails {
    /// For a checker, each plane.
    planes: Vec<bool>,
    /// For colours of their vertices, each mesh.
    meshes: Vec<bool>,
}

impl GeometryDetails {
    pub fn of(scene: &Scene) -> Self {
        let checkers = scene.planes.iter().map(|plane| plane.checker.is_some());
        let has = |mesh: &Mesh| !(mesh.colors.is_empty() && mesh.alphas.is_empty());
        let colors = scene.meshes.iter().map(|mesh| has(mesh));
        Self { planes: checkers.collect(), meshes: colors.collect() }
    }

    /// Whether what was hit, whose material looks like this, is asked for any.
    #[inline(always)]
    pub fn are_asked(&self, look: &CachedMaterial, hit: &Hit) -> bool {
        look.is_textured || look.has_normals || self.of_geometry(hit)
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
    pub fn count(&self, look: &CachedMaterial, hit: &Hit, work: &mut FeatureCounts) {
        work.uv += u64::from(look.is_textured);
        let of_kind = match hit.id.geometry {
            Geometry::Planes => &mut work.checkers,
            _ => &mut work.vertex_colors,
        };
        *of_kind += u64::from(self.of_geometry(hit));
    }
}
