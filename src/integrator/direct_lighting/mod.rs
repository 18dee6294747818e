//! The direct lighting of the surfaces of a wave: what they reflect of one light, if nothing is in
//! between, and the shadow rays that ask whether anything is.

mod incident_light;
mod reflected;
#[cfg(test)]
mod tests;

use glam::Vec3;

use crate::geometry::{Hit16, LANES, Lanes};
use crate::integrator::counts::FeatureCounts;
use crate::integrator::light_sources::LightSource;
use crate::integrator::material_cache::MaterialCache;
use crate::integrator::pbr_surfaces::PbrHit;
use crate::integrator::radiance::{Radiance16, WaveRadiance, all_finite, any, lane, set_lane};
use crate::integrator::shadow_rays::{PendingLight, ShadowQueue};
use crate::integrator::wave::Wave;
use crate::integrator::wave_surfaces::{LitSurface16, WaveSurfaces};
use crate::integrator::{Counts, Integrator, ShadingFeatures, simd};
use crate::scene::Light;
use incident_light::IncidentLight16;
use reflected::{PbrLanes, Reflected16};

/// The radiance due to incident light that is not finite. No finite factors make NaN.
const NOT_FINITE_LIGHT: Vec3 = Vec3::NAN;

/// Adds the ambient light that the surfaces of a wave reflect.
pub(super) fn add_ambient(
    light: &Light,
    surfaces: &WaveSurfaces,
    has_occlusion: bool,
    radiance: &mut WaveRadiance,
) {
    for lit in surfaces.lit() {
        let mut reflected = lit.diffuse;
        for channel in 0..3 {
            reflected[channel].iter_mut().for_each(|x| *x *= light.intensity[channel]);
            if has_occlusion {
                reflected[channel].iter_mut().zip(lit.ambient).for_each(|(x, share)| *x *= share);
            }
        }
        radiance.add_block(lit.block, &reflected, &lit.scatters);
    }
}

/// Works out what the surfaces of a wave reflect of a light source. For one that casts shadows it is
/// queued in `shadows` with a shadow ray for each surface; else it is added to the radiance.
pub(super) fn reflect(
    integrator: &Integrator<'_>,
    source: &LightSource<'_>,
    wave: &Wave,
    surfaces: &WaveSurfaces,
    radiance: &mut WaveRadiance,
    shadows: &mut ShadowQueue,
    counts: &mut Counts,
) {
    // The loop is compiled for what a scene has, and for each instruction set.
    let counts = &mut counts.work;
    shadows.clear();
    let has_soft_terminator = integrator.features.soft_terminator;
    let ShadingFeatures { pbr, highlights, .. } = integrator.features;
    let reflect = match (pbr, highlights, has_soft_terminator) {
        (false, false, false) => dispatch_blocks::<false, false, false>,
        (false, false, true) => dispatch_blocks::<false, false, true>,
        (false, true, false) => dispatch_blocks::<false, true, false>,
        (false, true, true) => dispatch_blocks::<false, true, true>,
        (true, _, false) => dispatch_blocks::<true, true, false>,
        (true, _, true) => dispatch_blocks::<true, true, true>,
    };
    let materials = &integrator.materials;
    reflect(integrator.arch, source, wave, (surfaces, materials), radiance, shadows, counts);
}

fn dispatch_blocks<const PBR: bool, const HIGHLIGHTS: bool, const SOFT_TERMINATOR: bool>(
    arch: pulp::Arch,
    source: &LightSource<'_>,
    wave: &Wave,
    surfaces: (&WaveSurfaces, &MaterialCache),
    radiance: &mut WaveRadiance,
    shadows: &mut ShadowQueue,
    counts: &mut FeatureCounts,
) {
    simd::dispatch(
        arch,
        #[inline(always)]
        || {
            reflect_blocks::<PBR, HIGHLIGHTS, SOFT_TERMINATOR>(
                source, wave, surfaces, radiance, shadows, counts,
            )
        },
    );
}

#[inline(always)]
fn reflect_blocks<const PBR: bool, const HIGHLIGHTS: bool, const SOFT_TERMINATOR: bool>(
    source: &LightSource<'_>,
    wave: &Wave,
    (surfaces, materials): (&WaveSurfaces, &MaterialCache),
    radiance: &mut WaveRadiance,
    shadows: &mut ShadowQueue,
    counts: &mut FeatureCounts,
) {
    let casts_shadow = source.casts_shadow();
    let mut lit_count = 0;
    let (mut incident, mut reflected) = (IncidentLight16::default(), Reflected16::default());
    for lit in surfaces.lit() {
        let hits = &wave.hits.blocks()[lit.block];
        // The light that arrives, and the share of it that goes to the viewer.
        incident.set(source, lit);
        let directions = &wave.rays.blocks()[lit.block].direction;
        let pbr = if PBR { &surfaces.pbr.hits[lit.pbr.clone()] } else { &[] };
        let bsdf = |hit: &PbrHit| surfaces.pbr.bsdf(hit, materials);
        let opaque = lit.opaque.map(|index| &surfaces.pbr.opaque[index]);
        let pbr = PbrLanes { hits: pbr, bsdf: &bsdf, opaque: if PBR { opaque } else { None } };
        reflected.set::<HIGHLIGHTS, SOFT_TERMINATOR>(lit, &pbr, &incident, directions, hits);
        if !any(&reflected.faces_light) {
            continue;
        }
        if HIGHLIGHTS && lit.has_highlights {
            counts.highlights += LANES as u64;
        }
        let mut contribution = [[0.0f32; LANES]; 3];
        for channel in 0..3 {
            for i in 0..LANES {
                contribution[channel][i] =
                    reflected.share[channel][i] * incident.intensity[channel][i];
            }
        }
        // Only lanes that are not black count.
        let mut is_lit = [false; LANES];
        for i in 0..LANES {
            let [r, g, b] = [contribution[0][i], contribution[1][i], contribution[2][i]];
            is_lit[i] = reflected.faces_light[i] & ((r != 0.0) | (g != 0.0) | (b != 0.0));
        }
        if !all_finite(&contribution) {
            mark_not_finite(&incident, &reflected, &mut contribution, &mut is_lit);
        } else if !any(&is_lit) {
            continue;
        }
        lit_count += u64::from(any(&is_lit));
        // Light that may be blocked waits for its shadow ray.
        if casts_shadow {
            let block = lit.block;
            shadows.pending.push(PendingLight { block, radiance: contribution, is_active: is_lit });
            let incoming = &wave.rays.blocks()[block].direction;
            spawn_shadow_rays(lit, incoming, hits, &incident, &reflected, &is_lit, shadows);
        } else {
            radiance.add_block(lit.block, &contribution, &is_lit);
        }
    }
    source.count(lit_count * LANES as u64, counts);
}

/// Spawns shadow rays from the lit surfaces of a block, seen along `incoming`, toward a light. The other
/// lanes get rays that hit nothing.
#[inline(always)]
fn spawn_shadow_rays(
    lit: &LitSurface16,
    incoming: &[Lanes<f64>; 3],
    hits: &Hit16,
    incident: &IncidentLight16,
    reflected: &Reflected16,
    is_lit: &Lanes<bool>,
    shadows: &mut ShadowQueue,
) {
    let mut viewers = *incoming;
    for axis in 0..3 {
        for i in 0..LANES {
            viewers[axis][i] = -viewers[axis][i];
        }
    }
    let (rays, departure) = shadows.rays.push_shadow_block(viewers);
    for axis in 0..3 {
        rays.origin[axis] = lit.surface.position[axis];
        rays.direction[axis] = incident.toward[axis];
    }
    for i in 0..LANES {
        rays.tmax[i] = if is_lit[i] { incident.tmax } else { 0.0 };
        // They leave their surfaces on the light's side.
        departure.is_back[i] = !reflected.is_light_in_front[i];
    }
    departure.id.geometry = hits.id.geometry;
    departure.id.primitive = hits.id.primitive;
    departure.id.instance = hits.id.instance;
}

/// Tells, in lanes that are not finite, the causes apart: makes them NaN where the incident light is
/// not finite, and infinite where the surface's share of it is not. What overflows only in their
/// product is infinite already.
#[cold]
fn mark_not_finite(
    incident: &IncidentLight16,
    reflected: &Reflected16,
    contribution: &mut Radiance16,
    is_lit: &mut Lanes<bool>,
) {
    for i in (0..LANES).filter(|&i| reflected.faces_light[i]) {
        let (share, intensity) = (lane(&reflected.share, i), lane(&incident.intensity, i));
        if share == Vec3::ZERO {
            is_lit[i] = false;
        } else if !intensity.is_finite() {
            set_lane(contribution, i, NOT_FINITE_LIGHT);
            is_lit[i] = true;
        } else if !share.is_finite() {
            set_lane(contribution, i, Vec3::INFINITY);
            is_lit[i] = true;
        }
    }
}
