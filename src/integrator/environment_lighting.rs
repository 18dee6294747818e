//! The light of the environment: what rays that hit nothing see, and what surfaces reflect of it.
//!
//! The pictures have no noise. Diffuse light is the irradiance by the normal. What a rough surface reflects is the
//! filtered environment in the mirrored direction, times the surface's albedo (the split-sum approximation of
//! Karis, *Real Shading in Unreal Engine 4*, 2013).

use glam::{DVec3, Mat3, Vec3};

use crate::geometry::LANES;
use crate::integrator::Integrator;
use crate::integrator::ambient_occlusion::BLUR;
use crate::integrator::counts::FeatureCounts;
use crate::integrator::opaque_surfaces::OpaqueLobes;
use crate::integrator::pbr_surfaces::PbrHit;
use crate::integrator::radiance::{DARK, WaveRadiance, set_lane};
use crate::integrator::wave::Wave;
use crate::integrator::wave_surfaces::{LitSurface16, WaveSurfaces};
use crate::scene::{Environment, SHARPEST_REFLECTION, Scene};

/// Filters the environment of a scene, if there is one, for what its materials reflect.
pub(super) fn prepare(scene: &Scene) {
    let Some(environment) = &scene.environment else { return };
    let filtered = environment.filtered();
    if scene.film.ambient_occlusion > 0 {
        filtered.prepare(BLUR..=BLUR);
    }
    for material in scene.materials_in_use() {
        match material.metallic.as_deref().filter(|_| material.is_pbr()) {
            Some(maps) => maps.blurred_roughnesses().for_each(|range| filtered.prepare(range)),
            None if material.specular != Vec3::ZERO => filtered.prepare(0.0..=1.0),
            None => {}
        }
    }
}

/// Sets the radiance along the rays of a wave that hit nothing to that of the environment, but for camera rays
/// in an environment that these do not see.
pub(super) fn set_background(
    environment: &Environment,
    wave: &Wave,
    radiance: &mut WaveRadiance,
    counts: &mut FeatureCounts,
) {
    for (block, hits) in wave.hits.blocks().iter().enumerate() {
        for i in (0..LANES).filter(|&i| hits.t[i] == f64::INFINITY) {
            let ray = block * LANES + i;
            if ray >= wave.rays.len() {
                break;
            }
            let path = wave.paths.get(ray);
            if environment.visible || path.is_some_and(|path| path.depth > 0) {
                let (_, direction) = wave.rays.blocks()[block].origin_and_direction(i);
                counts.environment += 1;
                let roughness = path.map_or(0.0, |path| path.roughness);
                set_lane(&mut radiance.blocks[block], i, seen(environment, direction, roughness));
            }
        }
    }
}

/// Returns the radiance from a direction, as a surface of this roughness blurs it.
fn seen(environment: &Environment, direction: DVec3, roughness: f32) -> Vec3 {
    if roughness <= 0.0 {
        return environment.radiance(direction);
    }
    let blurred = reflected(environment, direction, roughness.max(SHARPEST_REFLECTION));
    if roughness >= SHARPEST_REFLECTION {
        return blurred;
    }
    environment.radiance(direction).lerp(blurred, roughness / SHARPEST_REFLECTION)
}

fn reflected(environment: &Environment, direction: DVec3, roughness: f32) -> Vec3 {
    let direction = (environment.to_map * direction).as_vec3();
    environment.filtered().reflection(direction, roughness) * environment.intensity
}

/// Adds the light of the environment that the surfaces of a wave reflect.
pub(super) fn add(
    integrator: &Integrator<'_>,
    environment: &Environment,
    wave: &Wave,
    surfaces: &WaveSurfaces,
    radiance: &mut WaveRadiance,
    counts: &mut FeatureCounts,
) {
    let to_map = environment.to_map.as_mat3();
    for lit in surfaces.lit() {
        let mut added = DARK;
        let hits = &surfaces.pbr.hits[lit.pbr.clone()];
        let mut by_lambert = lit.scatters;
        hits.iter().for_each(|hit| by_lambert[hit.lane] = false);
        counts.environment += lit.scatters.iter().filter(|is| **is).count() as u64;
        if let Some(opaque) = lit.opaque.map(|index| &surfaces.pbr.opaque[index]) {
            for i in (0..LANES).filter(|&i| opaque.is_opaque[i]) {
                by_lambert[i] = false;
                let lobes = opaque.lobes(i);
                set_lane(&mut added, i, by_lobes(environment, &to_map, lit, i, &lobes));
            }
        }
        for i in (0..LANES).filter(|&i| by_lambert[i]) {
            let (_, incoming) = wave.rays.blocks()[lit.block].origin_and_direction(i);
            set_lane(&mut added, i, by_phong(integrator, environment, lit, i, incoming));
        }
        for hit in hits {
            set_lane(&mut added, hit.lane, by_bsdf(integrator, environment, lit, hit));
        }
        radiance.add_block(lit.block, &added, &lit.scatters);
    }
}

/// Returns what a surface of Lambert's and Phong's model reflects. The environment counts as directional lights
/// all around, each of an intensity of its radiance times its solid angle divided by π.
fn by_phong(
    integrator: &Integrator<'_>,
    environment: &Environment,
    lit: &LitSurface16,
    i: usize,
    incoming: DVec3,
) -> Vec3 {
    let color = |lanes: &[[f32; LANES]; 3]| Vec3::new(lanes[0][i], lanes[1][i], lanes[2][i]);
    let normal = lit.surface.normal(i);
    let albedo = color(&lit.diffuse);
    let share = arriving(integrator, lit.ambient[i], albedo);
    let diffuse = albedo * environment.diffuse_light(normal) * share;
    let specular = color(&lit.specular);
    if !integrator.features.highlights || specular == Vec3::ZERO {
        return diffuse;
    }
    // The integral of (r·ℓ)^α over all directions is 2π/(α + 1).
    let exponent = lit.shininess[i];
    let share = 2.0 / (exponent + 1.0) * lit.ambient[i];
    let roughness = (2.0 / (exponent + 2.0)).powf(0.25).clamp(SHARPEST_REFLECTION, 1.0);
    let mirrored = crate::shading::reflect(incoming.normalize(), normal);
    diffuse + specular * reflected(environment, mirrored, roughness) * share
}

/// Returns what an opaque physically based surface reflects.
#[inline(always)]
fn by_lobes(
    environment: &Environment,
    to_map: &Mat3,
    lit: &LitSurface16,
    i: usize,
    lobes: &OpaqueLobes,
) -> Vec3 {
    let filtered = environment.filtered();
    let (open, normal) = (lit.ambient[i], *to_map * lit.surface.normal(i).as_vec3());
    let diffuse = lobes.diffuse * filtered.diffuse(normal) * open;
    let light = filtered.reflection(*to_map * lobes.mirrored, lobes.roughness);
    let share = specular_occlusion(open, lobes.cosine, lobes.roughness);
    (diffuse + lobes.reflection * light * share) * environment.intensity
}

/// Returns what a physically based surface reflects, but for what reflected rays see.
fn by_bsdf(
    integrator: &Integrator<'_>,
    environment: &Environment,
    lit: &LitSurface16,
    hit: &PbrHit,
) -> Vec3 {
    let (lobes, i) = (&hit.blurred, hit.lane);
    let albedos = &lobes.albedos;
    let normal = lit.surface.normal(i);
    let mut sum = (albedos.diffuse + albedos.sheen) * environment.diffuse_light(normal);
    if albedos.diffuse_transmission != Vec3::ZERO {
        sum += albedos.diffuse_transmission * environment.diffuse_light(-normal);
    }
    sum *= arriving(integrator, lit.ambient[i], albedos.diffuse);
    if albedos.reflection != Vec3::ZERO {
        let light = reflected(environment, lobes.mirrored, lobes.roughness);
        let share = if integrator.has_ambient_occlusion() {
            arriving(integrator, hit.reflection_share, albedos.reflection)
        } else {
            let cosine = hit.wo.z.abs() as f32;
            Vec3::splat(specular_occlusion(lit.ambient[i], cosine, hit.blurred.roughness))
        };
        sum += albedos.reflection * light * share;
    }
    if albedos.clearcoat != Vec3::ZERO {
        let roughness = lobes.clearcoat_roughness.max(SHARPEST_REFLECTION);
        sum += albedos.clearcoat * reflected(environment, lobes.clearcoat_mirrored, roughness);
    }
    sum * hit.alpha
}

/// Returns the share of the light that arrives where this share is not occluded. What occludes it by rays is lit,
/// too: as in a cavity of this albedo, each reflection in it again sends a share to the surface, and the sum of the
/// series is v / (1 − a (1 − v)).
fn arriving(integrator: &Integrator<'_>, open: f32, albedo: Vec3) -> Vec3 {
    if open >= 1.0 || !integrator.has_ambient_occlusion() {
        return Vec3::splat(open);
    }
    let albedo = albedo.clamp(Vec3::ZERO, Vec3::splat(0.98));
    Vec3::splat(open) / (Vec3::ONE - albedo * (1.0 - open))
}

/// Returns the share of a reflection that arrives where this share of diffuse light does (Lagarde and
/// de Rousiers, *Moving Frostbite to Physically Based Rendering*, 2014).
fn specular_occlusion(ambient: f32, cosine: f32, roughness: f32) -> f32 {
    if ambient >= 1.0 {
        return 1.0;
    }
    let exponent = (-16.0 * roughness - 1.0).exp2();
    ((cosine + ambient).powf(exponent) - 1.0 + ambient).clamp(0.0, 1.0)
}
