//! The evaluation of the physically based surfaces that a wave hit, before any light falls on them.

use glam::Vec3;

use crate::geometry::{Hit, LANES};
use crate::integrator::counts::{FeatureCounts, NotFiniteCause};
use crate::integrator::opaque_surfaces::OpaqueMaterial;
use crate::integrator::pbr_surfaces::{self, PbrHits, SurfacePoint};
use crate::integrator::radiance::{WaveRadiance, set_lane};
use crate::integrator::wave::Wave;
use crate::integrator::wave_surfaces::{LitSurface16, SpecularHit, WaveSurfaces, context_on_wave};
use crate::integrator::{Integrator, simd};
use crate::surface::{self, TextureContext};

/// Computes what the opaque surfaces of a wave reflect from all around, once their normals are known.
pub(super) fn set_opaque_viewers(arch: pulp::Arch, wave: &Wave, surfaces: &mut WaveSurfaces) {
    let (blocks, pbr) = surfaces.lit_mut();
    simd::dispatch(
        arch,
        #[inline(always)]
        || {
            for lit in blocks.iter_mut() {
                let Some(index) = lit.opaque else { continue };
                let opaque = &mut pbr.opaque[index];
                let incoming = &wave.rays.blocks()[lit.block].direction;
                let ambient = opaque.set_viewer(&lit.surface, incoming);
                for channel in 0..3 {
                    for i in 0..LANES {
                        let x = &mut lit.diffuse[channel][i];
                        *x = if opaque.is_opaque[i] { ambient[channel][i] } else { *x };
                    }
                }
            }
        },
    );
}

/// Evaluates the physically based surface that the ray in lane `i` of a block hit, with its textures, and sets what it
/// emits. A function of its own, so that the loop over others stays small.
#[inline(never)]
#[allow(clippy::too_many_arguments, reason = "it is the body of a loop")]
pub(super) fn evaluate<const TEXTURES: bool>(
    integrator: &Integrator<'_>,
    wave: &Wave,
    i: usize,
    hit: &Hit,
    lit: &mut LitSurface16,
    radiance: &mut WaveRadiance,
    (pbr_hits, specular_hits): (&mut PbrHits, &mut Vec<SpecularHit>),
    counts: &mut FeatureCounts,
) {
    let (scene, cache) = (integrator.scene, &integrator.materials);
    let (ray, id) = (lit.block * LANES + i, lit.surface.material[i]);
    let (material, cached) = (&scene.materials[id.0 as usize], cache.get(id));
    counts.pbr += 1;
    // Textures, a checker and vertex colours are evaluated at the point, where they count.
    let mut context = TextureContext::default();
    let is_varied = TEXTURES && cache.varies_on(cached, hit);
    if is_varied {
        let surface = lit.surface.surface(i, hit.id);
        context = context_on_wave(integrator, wave, ray, hit, &surface, counts);
        cache.count_lookups(cached, hit, counts);
        if cached.has_normal_map {
            let normal = surface::mapped_normal(scene, &surface, hit, &context.point);
            lit.has_mapped_normals |= normal != surface.normal;
            lit.surface.set_normal(i, normal);
        }
    }
    // The parameters, and the surface as one that is shaded side by side with others, if it is.
    let varied;
    let mut varied_here = None;
    let (pbr, opaque) = match cache.pbr(id).filter(|_| !is_varied) {
        Some(cached) => (&cached.params, cached.opaque),
        None => {
            varied = surface::pbr_params(scene, material, &context);
            varied_here = Some(&varied);
            (&varied, if cache.has_opaque { OpaqueMaterial::new(&varied) } else { None })
        }
    };
    let (params, alpha) = (pbr.shading_params(), pbr.alpha);
    lit.ambient[i] = pbr.ambient;
    let is_finite = params.emission.is_finite() && pbr.factors.base_color.is_finite();
    if !(is_finite && lit.surface.position(i).is_finite()) {
        radiance.mark_not_finite(lit.block, i, NotFiniteCause::Surface);
        return;
    }
    set_lane(&mut radiance.blocks[lit.block], i, params.emission);
    set_lane(&mut lit.specular, i, Vec3::ZERO);
    lit.scatters[i] = true;
    if let Some(opaque) = opaque {
        let index = *lit.opaque.get_or_insert_with(|| pbr_hits.add_opaque(&opaque, false));
        pbr_hits.opaque[index].set(i, &opaque);
        return;
    }
    // Any other surface by itself. Ambient light comes from all around.
    let surface = lit.surface.surface(i, hit.id);
    let at = SurfacePoint { ray, hit, surface: &surface, context: &context };
    let traced = pbr_surfaces::evaluate(integrator, wave, &at, varied_here, pbr_hits);
    let Some(hit) = pbr_hits.hits.last() else { return };
    let albedos = &hit.blurred.albedos;
    let ambient = albedos.diffuse + albedos.reflection + albedos.clearcoat + albedos.sheen;
    set_lane(&mut lit.diffuse, i, ambient * alpha);
    if cached.spawns_rays && (!traced.is_empty() || alpha < 1.0) {
        pbr_hits.traced.push(traced);
        specular_hits.push(SpecularHit { ray: ray as u32, surface, params });
    }
}
