//! The surfaces that a wave hit, as they are evaluated and lit.

use std::ops::Range;

use crate::geometry::{Hit, Lanes};
use crate::integrator::Integrator;
use crate::integrator::counts::FeatureCounts;
use crate::integrator::pbr_surfaces::PbrHits;
use crate::integrator::wave::Wave;
use crate::scene::ShadingParams;
use crate::surface::{Surface, Surface16, TextureContext};

/// The surfaces that a wave hit.
#[derive(Default)]
pub(super) struct WaveSurfaces {
    /// Blocks of surfaces that scatter light, and memory for more.
    pub blocks: Vec<LitSurface16>,
    /// The number of blocks in use.
    pub count: usize,
    /// The physically based surfaces, by block and lane.
    pub pbr: PbrHits,
    /// The mirrors and the glass, by ray.
    pub specular: Vec<SpecularHit>,
}

/// A block of sixteen surfaces, some of which scatter light.
#[derive(Default)]
#[repr(C, align(64))]
pub(super) struct LitSurface16 {
    /// The block of the wave that hit them.
    pub block: usize,
    /// Their positions, normals and materials.
    pub surface: Surface16,
    /// The physically based ones, in the list of all.
    pub pbr: Range<usize>,
    /// The opaque physically based ones, in the list of blocks of these.
    pub opaque: Option<usize>,
    /// True for each one that scatters any light.
    pub scatters: Lanes<bool>,
    /// The share of light scattered to all sides.
    pub diffuse: [Lanes<f32>; 3],
    /// The share of light in the highlight.
    pub specular: [Lanes<f32>; 3],
    /// Phong's exponents.
    pub shininess: Lanes<f32>,
    /// The share of the ambient light that arrives.
    pub ambient: Lanes<f32>,
    /// True if a normal map has bent any normal.
    pub has_mapped_normals: bool,
    /// True if any may have a highlight.
    pub has_highlights: bool,
    /// The exponent of all highlights, if they share one and it is an integer.
    pub common_exponent: Option<u32>,
}

/// A surface that may send light on, as a mirror or glass does.
pub(super) struct SpecularHit {
    /// The number of the ray in its wave.
    pub ray: u32,
    /// The surface; its normal is the one that a normal map gives.
    pub surface: Surface,
    /// The shading parameters there.
    pub params: ShadingParams,
}

impl WaveSurfaces {
    /// Returns the blocks of surfaces that scatter light, and the physically based surfaces, to be changed.
    pub fn lit_mut(&mut self) -> (&mut [LitSurface16], &mut PbrHits) {
        (&mut self.blocks[..self.count], &mut self.pbr)
    }

    /// Returns the blocks of surfaces that scatter light.
    pub fn lit(&self) -> &[LitSurface16] {
        &self.blocks[..self.count]
    }
}

/// Returns the texture context of what ray `ray` of a wave hit.
pub(super) fn context_on_wave(
    integrator: &Integrator<'_>,
    wave: &Wave,
    ray: usize,
    hit: &Hit,
    surface: &Surface,
    counts: &mut FeatureCounts,
) -> TextureContext {
    let (lod, is_textured) =
        (&integrator.texture_lod, integrator.materials.get(surface.material).is_textured);
    let mut footprint = None;
    if is_textured && lod.is_needed() {
        counts.mipmaps += 1;
        let (ray, path) = (wave.rays.ray(ray), wave.paths.get(ray));
        let cone = path.map_or_else(|| lod.camera_cone(&ray), |path| path.cone);
        footprint = lod.footprint(&ray, hit, surface, &cone);
    }
    TextureContext::new(integrator.scene, hit, surface, is_textured, footprint.as_ref())
}
