//! The direct lighting of the surfaces of a wave: what they reflect of one light, if nothing is in
//! between, and the shadow rays that ask whether anything is.

mod incident_light;
#[cfg(test)]
mod tests;

use std::f32::consts::PI;

use glam::{DVec3, Vec3};

use crate::geometry::{Hit16, LANES, Lanes, PrimitiveId16};
use crate::integrator::counts::FeatureCounts;
use crate::integrator::light_sources::LightSource;
use crate::integrator::material_cache::MaterialCache;
use crate::integrator::pbr_surfaces::PbrHit;
use crate::integrator::radiance::{Radiance16, WaveRadiance, all_finite, any, lane, set_lane};
use crate::integrator::shadow_rays::{PendingLight, ShadowQueue};
use crate::integrator::surface_evaluation::{LitSurface16, WaveSurfaces};
use crate::integrator::wave::Wave;
use crate::integrator::{Counts, Integrator, ShadingFeatures, simd};
use crate::scene::Light;
use crate::shading::{self, Bsdf};
use crate::surface::Surface16;
use incident_light::IncidentLight16;

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
        let pbr = PbrLanes { hits: pbr, bsdf: &bsdf };
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

/// The physically based ones of sixteen surfaces, and their BSDFs.
struct PbrLanes<'a> {
    hits: &'a [PbrHit],
    bsdf: &'a dyn Fn(&PbrHit) -> &'a Bsdf,
}

/// The light that sixteen surfaces reflect to the viewer, in units of its intensity.
#[derive(Default)]
#[repr(C, align(64))]
struct Reflected16 {
    /// The shares.
    share: [Lanes<f32>; 3],
    /// True in each lane whose surface faces the light.
    faces_light: Lanes<bool>,
    /// True in each lane whose geometric normal points to the light's side.
    is_light_in_front: Lanes<bool>,
}

impl Reflected16 {
    /// Computes what surfaces, seen along `directions`, reflect of the incident light: Lambert's
    /// n·l, without 1/π, and Phong's max(0, r·l)^α with r = u − 2(u·n)n, both as in the tutorial
    /// (III.2, III.3; Bui Tuong Phong, *Illumination for Computer Generated Pictures*, 1975).
    /// A surface that faces away from the light reflects nothing.
    #[inline(always)]
    fn set<const HIGHLIGHTS: bool, const SOFT_TERMINATOR: bool>(
        &mut self,
        lit: &LitSurface16,
        pbr: &PbrLanes<'_>,
        incident: &IncidentLight16,
        directions: &[Lanes<f64>; 3],
        hits: &Hit16,
    ) {
        // The cosines of Lambert and Phong.
        let surface = &lit.surface;
        let (mut diffuse, mut mirrored) = ([0.0; LANES], [0.0; LANES]);
        let unit = shading::normalize_lanes(&incident.toward, &incident.arrives);
        let light = |i: usize| DVec3::new(unit[0][i], unit[1][i], unit[2][i]);
        for i in 0..LANES {
            diffuse[i] = shading::lambert(surface.normal(i), light(i));
        }
        if HIGHLIGHTS && lit.has_highlights {
            let view = shading::normalize_lanes(directions, &incident.arrives);
            for i in 0..LANES {
                let view = DVec3::new(view[0][i], view[1][i], view[2][i]);
                mirrored[i] = shading::phong(surface.normal(i), view, light(i));
            }
        }
        self.set_facing(lit, incident, &diffuse, hits);
        // Light from behind comes through what transmits it diffusely.
        for hit in pbr.hits.iter().filter(|hit| hit.is_translucent) {
            self.faces_light[hit.lane] = incident.arrives[hit.lane];
        }
        if !any(&self.faces_light) {
            return;
        }
        // The shares by the material's colours.
        for channel in 0..3 {
            for i in 0..LANES {
                self.share[channel][i] = lit.diffuse[channel][i] * diffuse[i] as f32;
            }
        }
        if HIGHLIGHTS && lit.has_highlights {
            self.add_highlights(lit, mirrored);
        }
        self.set_pbr(pbr, &unit);
        // Toward the terminator of a smooth mesh, light fades out.
        if SOFT_TERMINATOR && surface.has_triangles {
            self.fade_to_terminator(surface, &diffuse);
        }
    }

    /// Sets the shares of physically based surfaces. Intensities are irradiances divided by π, hence the factor.
    #[inline(always)]
    fn set_pbr(&mut self, pbr: &PbrLanes<'_>, toward: &[Lanes<f64>; 3]) {
        for hit in pbr.hits.iter().filter(|hit| self.faces_light[hit.lane]) {
            let i = hit.lane;
            let light = DVec3::new(toward[0][i], toward[1][i], toward[2][i]);
            let value = (pbr.bsdf)(hit).evaluate(hit.wo, hit.frame.transpose() * light);
            set_lane(&mut self.share, i, value * (PI * hit.alpha));
        }
    }

    /// Sets which surfaces face the light: by the cosine of the shading normal, and by the side of
    /// the geometric normal where the two may disagree.
    #[inline(always)]
    fn set_facing(
        &mut self,
        lit: &LitSurface16,
        incident: &IncidentLight16,
        cosine: &Lanes<f64>,
        hits: &Hit16,
    ) {
        let surface = &lit.surface;
        let mut geometric = [0.0; LANES];
        for i in 0..LANES {
            geometric[i] = surface.geometric_normal(i).dot(incident.toward(i));
        }
        for i in 0..LANES {
            self.faces_light[i] = incident.arrives[i] & ((cosine[i] > 0.0) | cosine[i].is_nan());
            self.is_light_in_front[i] = geometric[i] > 0.0;
        }
        if surface.has_triangles {
            for i in 0..LANES {
                // On a smooth-shaded mesh the shading normal may see a light that is behind the
                // surface itself.
                let facing = if surface.is_back[i] { -geometric[i] } else { geometric[i] };
                self.faces_light[i] &=
                    !((hits.id.geometry[i] >= PrimitiveId16::MESHES) & (facing <= 0.0));
            }
        }
        if lit.has_mapped_normals {
            // On anything else a normal from a normal map may see such a light.
            for i in 0..LANES {
                let facing = if surface.is_back[i] { -geometric[i] } else { geometric[i] };
                let is_inside_sphere =
                    surface.is_back[i] & (hits.id.geometry[i] == PrimitiveId16::SPHERES);
                self.faces_light[i] &= (facing > 0.0) | is_inside_sphere;
            }
        }
    }

    /// Adds Phong's highlights, by the cosines r·l.
    #[inline(always)]
    fn add_highlights(&mut self, lit: &LitSurface16, mirrored: Lanes<f64>) {
        let highlight = match lit.common_exponent {
            Some(exponent) => shading::power_lanes(mirrored, exponent),
            None => {
                let mut highlight = [0.0; LANES];
                for i in (0..LANES).filter(|&i| self.faces_light[i]) {
                    highlight[i] = shading::power(mirrored[i], lit.shininess[i]);
                }
                highlight
            }
        };
        for channel in 0..3 {
            for i in 0..LANES {
                let specular = lit.specular[channel][i];
                let product = specular * highlight[i] as f32;
                self.share[channel][i] += if specular == 0.0 { 0.0 } else { product };
            }
        }
    }

    /// Multiplies the shares on smooth meshes by g + g² − g³, with g = 1 − tan θ tan δ, where θ is the angle
    /// of the light and δ that of the faces about the point, both from the shading normal.
    ///
    /// This is the factor of Chiang, Li and Burley (*Taming the Shadow Terminator*, SIGGRAPH Talks 2019),
    /// g = (m·l) / ((n·l) (n·m)), for a face m that is turned from the light as far as any about the
    /// point. For the face that was hit itself it would make each of the flat faces visible; so it is as
    /// smooth as the normals are, and 0 before the light reaches the edge of a face that is turned away.
    #[inline(always)]
    fn fade_to_terminator(&mut self, surface: &Surface16, cosine: &Lanes<f64>) {
        let mut fade = [1.0; LANES];
        for i in 0..LANES {
            let tangent = (1.0 - cosine[i] * cosine[i]).max(0.0).sqrt() / cosine[i];
            let g = (1.0 - tangent * surface.spread[i]).max(0.0);
            let fades = (surface.spread[i] > 0.0) & (cosine[i] > 0.0);
            fade[i] = if fades { (g + g * g - g * g * g) as f32 } else { 1.0 };
        }
        for channel in &mut self.share {
            for i in 0..LANES {
                channel[i] *= fade[i];
            }
        }
    }
}
