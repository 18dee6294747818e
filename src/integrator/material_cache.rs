//! The materials of a scene as shading reads them, close together.

use glam::{DVec3, Vec3};

use crate::geometry::{Geometry, Hit};
use crate::integrator::counts::FeatureCounts;
use crate::integrator::opaque_surfaces::OpaqueMaterial;
use crate::scene::{Material, MaterialId, Mesh, Scene, ShadingParams};
use crate::shading::{Bsdf, LobeAlbedos, Reflectance};
use crate::surface::{self, PbrParams, TextureContext};

/// The materials of a scene, and where textures, checkers or vertex colours change them.
pub(super) struct MaterialCache {
    materials: Vec<CachedMaterial>,
    /// The physically based materials, as they are where nothing changes them.
    pbr: Vec<Option<CachedPbr>>,
    /// True for each plane with a checker.
    has_checker: Vec<bool>,
    /// True for each mesh with vertex colours.
    has_vertex_colors: Vec<bool>,
    /// True if opaque surfaces are shaded side by side: not where rays find how much each reflects.
    pub has_opaque: bool,
}

/// A physically based material as it is where no texture, checker or vertex colour changes it.
pub(super) struct CachedPbr {
    /// The parameters.
    pub params: PbrParams,
    /// The BSDF.
    pub bsdf: Bsdf,
    /// The material as one that is shaded side by side with others, if it is.
    pub opaque: Option<OpaqueMaterial>,
    /// The albedos of its lobes from the outside, at evenly spread cosines from 0 to 1; empty where they depend on
    /// more than the cosine, and where they are not needed.
    albedos: Vec<LobeAlbedos>,
}

/// The number of cosines for which albedos are stored.
const COSINES: usize = 65;

impl CachedPbr {
    /// A material; `has_opaque` if opaque surfaces are shaded side by side.
    fn new(scene: &Scene, material: &Material, has_opaque: bool) -> Self {
        let params = surface::pbr_params(scene, material, &TextureContext::default());
        let bsdf = Bsdf::new(&params.factors, 1.0);
        let opaque = OpaqueMaterial::new(&params).filter(|_| has_opaque);
        let albedo = |i: usize| {
            let cosine = (i as f64 / (COSINES - 1) as f64).max(1e-3);
            bsdf.lobe_albedos(DVec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine))
        };
        let is_by_cosine = params.factors.anisotropy == 0.0 && opaque.is_none();
        let count = if is_by_cosine { COSINES } else { 0 };
        Self { albedos: (0..count).map(albedo).collect(), params, bsdf, opaque }
    }

    /// Returns the albedos of the lobes for light from `wo`.
    pub fn lobe_albedos(&self, wo: DVec3) -> LobeAlbedos {
        if wo.z <= 0.0 || self.albedos.is_empty() {
            return self.bsdf.lobe_albedos(wo);
        }
        let place = wo.z.min(1.0) as f32 * (COSINES - 1) as f32;
        let node = (place as usize).min(COSINES - 2);
        self.albedos[node].lerp(&self.albedos[node + 1], place - node as f32)
    }
}

/// A material as it is where no texture, checker or vertex colour changes it.
#[derive(Clone, Copy, Debug)]
pub(super) struct CachedMaterial {
    /// The shading parameters.
    pub params: ShadingParams,
    /// The reflectance toward lights, by these parameters.
    pub reflectance: Reflectance,
    /// True if the parameters are finite.
    pub is_finite: bool,
    /// True if it may have a highlight.
    pub has_highlight: bool,
    /// True if it needs texture coordinates.
    pub is_textured: bool,
    /// True if it has a normal map.
    pub has_normal_map: bool,
    /// True if it may send light on.
    pub spawns_rays: bool,
    /// True if it is physically based.
    pub is_pbr: bool,
}

impl CachedMaterial {
    fn new(scene: &Scene, material: &Material) -> Self {
        // A material that nothing is made of may have textures that were not read.
        let params = if material.is_textured() {
            material.shading_params()
        } else {
            surface::shading_params(scene, material, &TextureContext::default())
        };
        let reflectance = scattered_reflectance(&params);
        Self {
            params,
            reflectance,
            is_finite: params.emission.is_finite() && reflectance.diffuse.is_finite(),
            has_highlight: !material.is_pbr()
                && (reflectance.specular != Vec3::ZERO || material.metallic.is_some()),
            is_textured: material.is_textured(),
            has_normal_map: material.normal_map.is_some(),
            spawns_rays: material.spawns_rays(),
            is_pbr: material.is_pbr(),
        }
    }
}

/// Returns the reflectance of the share of the light that a surface neither mirrors nor transmits.
pub(super) fn scattered_reflectance(params: &ShadingParams) -> Reflectance {
    let share = (Vec3::ONE - params.reflect - params.transmit).max(Vec3::ZERO);
    Reflectance {
        diffuse: params.diffuse * share,
        specular: params.specular * share,
        shininess: params.shininess,
    }
}

impl MaterialCache {
    /// Builds the cache of a scene.
    pub fn new(scene: &Scene) -> Self {
        let cached = |material| CachedMaterial::new(scene, material);
        let has_opaque = scene.film.ambient_occlusion == 0;
        let pbr = |material: &Material| {
            let is_cached = material.is_pbr() && !material.is_textured();
            is_cached.then(|| CachedPbr::new(scene, material, has_opaque))
        };
        let has_colors = |mesh: &Mesh| !(mesh.colors.is_empty() && mesh.alphas.is_empty());
        Self {
            materials: scene.materials.iter().map(cached).collect(),
            pbr: scene.materials.iter().map(pbr).collect(),
            has_checker: scene.planes.iter().map(|plane| plane.checker.is_some()).collect(),
            has_vertex_colors: scene.meshes.iter().map(|mesh| has_colors(mesh)).collect(),
            has_opaque,
        }
    }

    /// Returns a material.
    #[inline(always)]
    pub fn get(&self, id: MaterialId) -> &CachedMaterial {
        &self.materials[id.0 as usize]
    }

    /// Returns a physically based material, if it is one that has no texture.
    #[inline(always)]
    pub fn pbr(&self, id: MaterialId) -> Option<&CachedPbr> {
        self.pbr[id.0 as usize].as_ref()
    }

    /// True if a material differs from point to point on the primitive that was hit.
    #[inline(always)]
    pub fn varies_on(&self, material: &CachedMaterial, hit: &Hit) -> bool {
        material.is_textured || material.has_normal_map || self.is_colored(hit)
    }

    /// True if the primitive that was hit has a checker or vertex colours.
    #[inline(always)]
    fn is_colored(&self, hit: &Hit) -> bool {
        match hit.id.geometry {
            Geometry::Spheres => false,
            Geometry::Planes => self.has_checker[hit.id.primitive as usize],
            Geometry::Mesh(mesh) => self.has_vertex_colors[mesh as usize],
        }
    }

    /// Counts the lookups for a point at which a material varies.
    pub fn count_lookups(&self, material: &CachedMaterial, hit: &Hit, counts: &mut FeatureCounts) {
        counts.uv += u64::from(material.is_textured);
        counts.normal_maps += u64::from(material.has_normal_map);
        let colors = match hit.id.geometry {
            Geometry::Planes => &mut counts.checkers,
            _ => &mut counts.vertex_colors,
        };
        *colors += u64::from(self.is_colored(hit));
    }
}
