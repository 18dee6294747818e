//! The evaluation of the surfaces that a wave hit: positions, normals and shading parameters, before
//! any light falls on them.

use glam::Vec3;

use crate::geometry::{Hit, Hit16, LANES, PrimitiveId16, Ray};
use crate::integrator::counts::{FeatureCounts, NotFiniteCause};
use crate::integrator::material_cache::scattered_reflectance;
use crate::integrator::pbr_evaluation;
use crate::integrator::pbr_surfaces::PbrHits;
use crate::integrator::radiance::{Radiance16, WaveRadiance, set_lane};
use crate::integrator::wave::Wave;
use crate::integrator::wave_surfaces::{LitSurface16, SpecularHit, WaveSurfaces, context_on_wave};
use crate::integrator::{Integrator, ShadingFeatures, simd};
use crate::scene::ShadingParams;
use crate::shading::{self, Reflectance};
use crate::surface::{self, RayCone, Surface, TextureContext};

/// Evaluates the surfaces that a wave hit, and sets its radiance to the background and to what
/// surfaces emit.
pub(super) fn evaluate(
    integrator: &Integrator<'_>,
    wave: &Wave,
    surfaces: &mut WaveSurfaces,
    radiance: &mut WaveRadiance,
    counts: &mut FeatureCounts,
) {
    // The loop is compiled for what a scene has, and for each instruction set: a function for each of
    // these, since in one that holds all of them the compiler inlines less.
    let ShadingFeatures { textures, smooth_normals, .. } = integrator.features;
    let evaluate = match (textures, smooth_normals) {
        (false, false) => dispatch_blocks::<false, false>,
        (false, true) => dispatch_blocks::<false, true>,
        (true, false) => dispatch_blocks::<true, false>,
        (true, true) => dispatch_blocks::<true, true>,
    };
    evaluate(integrator, wave, surfaces, radiance, counts);
    if integrator.features.pbr {
        pbr_evaluation::set_opaque_viewers(integrator.arch, wave, surfaces);
    }
}

fn dispatch_blocks<const TEXTURES: bool, const SMOOTH_NORMALS: bool>(
    integrator: &Integrator<'_>,
    wave: &Wave,
    surfaces: &mut WaveSurfaces,
    radiance: &mut WaveRadiance,
    counts: &mut FeatureCounts,
) {
    simd::dispatch(
        integrator.arch,
        #[inline(always)]
        || {
            evaluate_blocks::<TEXTURES, SMOOTH_NORMALS>(
                integrator, wave, surfaces, radiance, counts,
            )
        },
    );
}

#[inline(always)]
fn evaluate_blocks<const TEXTURES: bool, const SMOOTH_NORMALS: bool>(
    integrator: &Integrator<'_>,
    wave: &Wave,
    surfaces: &mut WaveSurfaces,
    radiance: &mut WaveRadiance,
    counts: &mut FeatureCounts,
) {
    let scene = integrator.scene;
    let background = scene.film.background;
    let WaveSurfaces { blocks, count, pbr, specular } = surfaces;
    specular.clear();
    pbr.clear();
    *count = 0;
    radiance.reset(wave.hits.blocks().len());
    for (block, hits) in wave.hits.blocks().iter().enumerate() {
        if *count == blocks.len() {
            blocks.push(LitSurface16::default());
        }
        let lit = &mut blocks[*count];
        // Positions, normals and materials.
        lit.surface.set::<SMOOTH_NORMALS>(scene, &wave.rays, block, hits);
        // Rays that hit nothing see the background.
        for channel in 0..3 {
            radiance.blocks[block][channel] = [background[channel]; LANES];
        }
        if !lit.surface.has_hits() {
            continue;
        }
        if SMOOTH_NORMALS {
            let is_triangle = |&&geometry: &&u32| geometry >= PrimitiveId16::MESHES;
            counts.smooth_normals += hits.id.geometry.iter().filter(is_triangle).count() as u64;
        }
        // Shading parameters; a block on which no light falls is overwritten by the next.
        lit.block = block;
        lit.opaque = None;
        let is_uniform = !TEXTURES
            && evaluate_uniform_block(
                integrator,
                hits,
                lit,
                pbr,
                &mut radiance.blocks[block],
                counts,
            );
        if !is_uniform {
            let secondary = (&mut *pbr, &mut *specular);
            evaluate_block::<TEXTURES>(integrator, wave, hits, lit, radiance, secondary, counts);
        }
        *count += usize::from(lit.scatters.contains(&true));
    }
}

/// Evaluates the shading parameters of sixteen surfaces, if they are all of one finite material
/// that sends no light on; returns false otherwise.
#[inline(always)]
fn evaluate_uniform_block(
    integrator: &Integrator<'_>,
    hits: &Hit16,
    lit: &mut LitSurface16,
    pbr_hits: &mut PbrHits,
    radiance: &mut Radiance16,
    counts: &mut FeatureCounts,
) -> bool {
    let first = lit.surface.material[0];
    let mut is_uniform = true;
    for i in 0..LANES {
        let [x, y, z] = lit.surface.position(i).to_array();
        is_uniform &= (hits.t[i] < f64::INFINITY)
            & (lit.surface.material[i] == first)
            & (x + y + z).is_finite();
    }
    if !is_uniform {
        return false;
    }
    let material = integrator.materials.get(first);
    if material.spawns_rays || !material.is_finite {
        return false;
    }
    let mut reflectance = material.reflectance;
    if material.is_pbr {
        let cached = integrator.materials.pbr(first);
        let Some(opaque) = cached.and_then(|cached| cached.opaque.as_ref()) else { return false };
        lit.opaque = Some(pbr_hits.add_opaque(opaque, true));
        counts.pbr += LANES as u64;
        // Its share of ambient light is known when all is set.
        reflectance = Reflectance { diffuse: Vec3::ONE, specular: Vec3::ZERO, shininess: 1.0 };
    }
    let Reflectance { diffuse, specular, shininess } = reflectance;
    for channel in 0..3 {
        lit.diffuse[channel] = [diffuse[channel]; LANES];
        lit.specular[channel] = [specular[channel]; LANES];
    }
    lit.pbr = 0..0;
    lit.scatters = [diffuse != Vec3::ZERO || specular != Vec3::ZERO; LANES];
    lit.shininess = [shininess; LANES];
    lit.ambient = [1.0; LANES];
    lit.has_mapped_normals = false;
    lit.has_highlights = material.has_highlight;
    lit.common_exponent = shading::integer_exponent(shininess);
    for channel in 0..3 {
        radiance[channel] = [material.params.emission[channel]; LANES];
    }
    true
}

/// Evaluates the shading parameters of sixteen surfaces one by one, with their textures.
#[inline(always)]
fn evaluate_block<const TEXTURES: bool>(
    integrator: &Integrator<'_>,
    wave: &Wave,
    hits: &Hit16,
    lit: &mut LitSurface16,
    radiance: &mut WaveRadiance,
    (pbr_hits, specular_hits): (&mut PbrHits, &mut Vec<SpecularHit>),
    counts: &mut FeatureCounts,
) {
    let (scene, cache) = (integrator.scene, &integrator.materials);
    lit.scatters = [false; LANES];
    lit.has_highlights = false;
    lit.has_mapped_normals = false;
    lit.ambient = [1.0; LANES];
    lit.pbr = pbr_hits.hits.len()..pbr_hits.hits.len();
    let mut exponent = None;
    let mut shares_exponent = true;
    for i in 0..LANES {
        let Some(hit) = hits.hit(i) else { continue };
        let ray = lit.block * LANES + i;
        let cached = cache.get(lit.surface.material[i]);
        if cached.is_pbr {
            let secondary = (&mut *pbr_hits, &mut *specular_hits);
            pbr_evaluation::evaluate::<TEXTURES>(
                integrator, wave, i, &hit, lit, radiance, secondary, counts,
            );
            continue;
        }
        let (mut params, mut reflectance) = (cached.params, cached.reflectance);
        let (mut is_finite, mut spawns_rays) = (cached.is_finite, cached.spawns_rays);
        // Textures, a checker and vertex colours are evaluated at the point, where they count.
        if TEXTURES && cache.varies_on(cached, &hit) {
            let material = &scene.materials[lit.surface.material[i].0 as usize];
            let surface = lit.surface.surface(i, hit.id);
            let context = context_on_wave(integrator, wave, ray, &hit, &surface, counts);
            cache.count_lookups(cached, &hit, counts);
            params = surface::shading_params(scene, material, &context);
            reflectance = scattered_reflectance(&params);
            is_finite = params.emission.is_finite() && reflectance.diffuse.is_finite();
            spawns_rays &= params.spawns_rays() || !material.spawns_rays();
            lit.ambient[i] = surface::ambient_occlusion(scene, material, &context);
            if cached.has_normal_map {
                let normal = surface::mapped_normal(scene, &surface, &hit, &context.point);
                lit.has_mapped_normals |= normal != surface.normal;
                lit.surface.set_normal(i, normal);
            }
        }
        if !(is_finite && lit.surface.position(i).is_finite()) {
            radiance.mark_not_finite(lit.block, i, NotFiniteCause::Surface);
            continue;
        }
        set_lane(&mut radiance.blocks[lit.block], i, params.emission);
        // The surface scatters light, and may send light on.
        let Reflectance { diffuse, specular, shininess } = reflectance;
        lit.scatters[i] = diffuse != Vec3::ZERO || specular != Vec3::ZERO;
        set_lane(&mut lit.diffuse, i, diffuse);
        set_lane(&mut lit.specular, i, specular);
        lit.shininess[i] = shininess;
        if cached.has_highlight {
            lit.has_highlights = true;
            shares_exponent &= *exponent.get_or_insert(shininess) == shininess;
        }
        if spawns_rays {
            let surface = lit.surface.surface(i, hit.id);
            specular_hits.push(SpecularHit { ray: ray as u32, surface, params });
        }
    }
    lit.pbr.end = pbr_hits.hits.len();
    lit.common_exponent = exponent.filter(|_| shares_exponent).and_then(shading::integer_exponent);
}

/// Evaluates the shading parameters of a surface that `ray`, with this cone, hit.
pub(super) fn shading_params_at(
    integrator: &Integrator<'_>,
    ray: &Ray,
    hit: &Hit,
    surface: &Surface,
    cone: &RayCone,
) -> ShadingParams {
    let (scene, cache) = (integrator.scene, &integrator.materials);
    let cached = cache.get(surface.material);
    if !integrator.features.textures || !cache.varies_on(cached, hit) {
        return cached.params;
    }
    let footprint = integrator.texture_lod.footprint(ray, hit, surface, cone);
    let context = TextureContext::new(scene, hit, surface, cached.is_textured, footprint.as_ref());
    surface::shading_params(scene, &scene.materials[surface.material.0 as usize], &context)
}
