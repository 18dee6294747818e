//! Ambient occlusion: the share of the light from all around that arrives at the surfaces of a wave, by a fixed
//! set of rays.
//!
//! The rays of one sample of a pixel are the same for all pixels, so that there is no noise, and those of its next
//! sample lie between them. The share is a ratio: the light of the environment along the rays that nothing blocks,
//! by that along all of them. So a surface that nothing covers has all of the light, whatever the number of rays.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::geometry::sampling::{sobol_point, tangents};
use crate::geometry::{LANES, Lanes};
use crate::integrator::pbr_surfaces::PbrHit;
use crate::integrator::shadow_rays::ShadowQueue;
use crate::integrator::wave::Wave;
use crate::integrator::wave_surfaces::{LitSurface16, WaveSurfaces};
use crate::integrator::{Counts, Integrator};
use crate::scene::Environment;

/// The roughness by which the environment is blurred along a ray, which stands for many directions.
pub(super) const BLUR: f32 = 0.5;

/// The least albedo of a rough reflection that has rays of its own; another one is occluded like diffuse light.
const MIN_REFLECTION: f32 = 0.1;

/// Memory for the rays of ambient occlusion.
#[derive(Default)]
pub(super) struct AmbientOcclusion {
    queue: ShadowQueue,
    /// For each lane of each lit block the light along its rays, and that of those that nothing blocks.
    sums: Vec<[Lanes<f32>; 2]>,
    /// The light along the ray of each lane that is traced now.
    weights: Vec<Lanes<f32>>,
}

/// The light whose occlusion is found.
#[derive(Clone, Copy, PartialEq)]
enum Arriving {
    /// Light on diffuse surfaces, with the cosine of its angle to the normal.
    Diffuse,
    /// Light that the microfacets of rough surfaces reflect.
    Reflection,
}

impl AmbientOcclusion {
    /// Sets the shares of ambient light that arrive at the surfaces of a wave, for this sample of the pixels.
    pub fn find(
        &mut self,
        integrator: &Integrator<'_>,
        sample: usize,
        wave: &Wave,
        surfaces: &mut WaveSurfaces,
        counts: &mut Counts,
    ) {
        self.trace(integrator, sample, Arriving::Diffuse, wave, surfaces, counts);
        let (lit, pbr) = surfaces.lit_mut();
        for (lit, sums) in lit.iter_mut().zip(&self.sums) {
            for i in (0..LANES).filter(|&i| lit.scatters[i]) {
                lit.ambient[i] = share(sums, i);
            }
            pbr.hits[lit.pbr.clone()].iter_mut().for_each(|hit| {
                hit.reflection_share = lit.ambient[hit.lane];
            });
        }
        if !pbr.hits.iter().any(has_rays) {
            return;
        }
        self.trace(integrator, sample, Arriving::Reflection, wave, surfaces, counts);
        let (lit, pbr) = surfaces.lit_mut();
        for (lit, sums) in lit.iter().zip(&self.sums) {
            let hits = pbr.hits[lit.pbr.clone()].iter_mut();
            hits.filter(|hit| has_rays(hit)).for_each(|hit| {
                hit.reflection_share = share(sums, hit.lane);
            });
        }
    }

    /// Traces the rays of the surfaces, and adds up the light along them.
    fn trace(
        &mut self,
        integrator: &Integrator<'_>,
        sample: usize,
        arriving: Arriving,
        wave: &Wave,
        surfaces: &WaveSurfaces,
        counts: &mut Counts,
    ) {
        let environment = integrator.scene.environment.as_ref();
        let count = integrator.scene.film.ambient_occlusion;
        let total = count * integrator.samples.offsets.len() as u32;
        let lit = surfaces.lit();
        self.sums.clear();
        self.sums.resize(lit.len(), [[0.0; LANES]; 2]);
        self.weights.resize(lit.len(), [0.0; LANES]);
        for ray in 0..count {
            let u = sobol_point(sample as u32 * count + ray, total);
            self.queue.clear();
            for (lit, weights) in lit.iter().zip(&mut self.weights) {
                *weights = [0.0; LANES];
                let directions = match arriving {
                    Arriving::Diffuse => diffuse_directions(lit, u),
                    Arriving::Reflection => reflected_directions(integrator, surfaces, lit, u),
                };
                push_rays(&mut self.queue, wave, lit, &directions);
                for i in 0..LANES {
                    if let Some(direction) = directions[i] {
                        weights[i] = light_along(environment, direction);
                    }
                }
            }
            // Transparent surfaces block nothing.
            let rays = &self.queue.rays;
            let occluded = &mut self.queue.occluded;
            integrator.occluded(rays, occluded, counts);
            for (block, (sums, weights)) in self.sums.iter_mut().zip(&self.weights).enumerate() {
                for i in 0..LANES {
                    counts.rays.shadow += u64::from(weights[i] > 0.0);
                    sums[0][i] += weights[i];
                    let is_open = !self.queue.occluded[block * LANES + i];
                    sums[1][i] += if is_open { weights[i] } else { 0.0 };
                }
            }
        }
    }
}

/// True if a surface's reflection has rays of its own.
fn has_rays(hit: &PbrHit) -> bool {
    hit.blurred.albedos.reflection.max_element() >= MIN_REFLECTION
}

/// Returns the share of the light that arrives.
fn share([all, open]: &[Lanes<f32>; 2], i: usize) -> f32 {
    if all[i] > 0.0 { open[i] / all[i] } else { 1.0 }
}

/// Returns the light along a ray: more than 0 also where all is dark.
fn light_along(environment: Option<&Environment>, direction: DVec3) -> f32 {
    let Some(environment) = environment else { return 1.0 };
    let toward = (environment.to_map * direction).as_vec3();
    environment.filtered().reflection(toward, BLUR).element_sum().max(f32::MIN_POSITIVE)
}

/// Returns the directions of rays from diffuse surfaces, spread by their cosine.
fn diffuse_directions(lit: &LitSurface16, [u, v]: [f64; 2]) -> Lanes<Option<DVec3>> {
    let (radius, (sin, cos)) = (u.sqrt(), (TAU * v).sin_cos());
    let height = (1.0 - u).sqrt();
    std::array::from_fn(|i| {
        lit.scatters[i].then(|| {
            let normal = lit.surface.normal(i);
            let [x, y] = tangents(normal);
            x * (radius * cos) + y * (radius * sin) + normal * height
        })
    })
}

/// Returns the directions that the microfacets of rough surfaces mirror.
fn reflected_directions(
    integrator: &Integrator<'_>,
    surfaces: &WaveSurfaces,
    lit: &LitSurface16,
    u: [f64; 2],
) -> Lanes<Option<DVec3>> {
    let mut directions = [None; LANES];
    let pbr = &surfaces.pbr;
    for hit in pbr.hits[lit.pbr.clone()].iter().filter(|hit| has_rays(hit)) {
        let wi = pbr.bsdf(hit, &integrator.materials).sample_reflection(hit.wo, u);
        directions[hit.lane] = wi.map(|wi| hit.frame * wi);
    }
    directions
}

/// Adds the rays from the surfaces of a block; lanes without a direction get rays that hit nothing, and so do those
/// whose direction leads into the surface.
fn push_rays(
    queue: &mut ShadowQueue,
    wave: &Wave,
    lit: &LitSurface16,
    directions: &Lanes<Option<DVec3>>,
) {
    let hits = &wave.hits.blocks()[lit.block];
    let viewers = wave.rays.blocks()[lit.block].direction.map(|axis| axis.map(|x| -x));
    let (rays, departure) = queue.rays.push_shadow_block(viewers);
    for axis in 0..3 {
        rays.origin[axis] = lit.surface.position[axis];
    }
    for i in 0..LANES {
        let direction = directions[i].unwrap_or(DVec3::Y);
        for axis in 0..3 {
            rays.direction[axis][i] = direction[axis];
        }
        rays.tmax[i] = if directions[i].is_some() { f64::INFINITY } else { 0.0 };
        departure.is_back[i] = lit.surface.geometric_normal(i).dot(direction) <= 0.0;
    }
    departure.id.geometry = hits.id.geometry;
    departure.id.primitive = hits.id.primitive;
    departure.id.instance = hits.id.instance;
}
