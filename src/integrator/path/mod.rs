//! The path tracer: the radiance along camera rays by random light paths, without any bias.
//!
//! Each path goes from surface to surface. At each the light of one source is added if nothing is in between
//! (next-event estimation), and the path goes on in a direction that is sampled by the BSDF. What both ways may find
//! is weighted by the balance heuristic (Veach, *Robust Monte Carlo Methods for Light Transport Simulation*, 1997,
//! chapter 9). All paths of a tile that have the same number of surfaces form a wave.

mod light_sampler;
mod sampler;
mod shadows;
mod vertex;

use glam::{DVec3, Vec3};

use crate::geometry::{Hit, HitBatch, LANES, Ray, RayBatch};
use crate::integrator::alpha::AlphaSums;
use crate::integrator::counts::NotFiniteCause;
use crate::integrator::radiance::{DARK, Radiance16, lane, set_lane};
use crate::integrator::secondary_rays::MAX_LAYERS;
use crate::integrator::tiling::Tile;
use crate::integrator::wave::{PathState, Wave};
use crate::integrator::{Counts, Integrator, null_interfaces, wave_surfaces};
use crate::intersect::Coherence;
use crate::scene::{IncidentLight, LightKind, Scene};
use crate::surface::{self, RayCone, Surface, TextureContext};
use light_sampler::LightSampler;
use sampler::{Sampler, SurfaceNumbers};
use shadows::LightQueue;
use vertex::PathVertex;

/// The number of surfaces that a path has before it may end by chance.
const FIRST_ROULETTE: u32 = 3;
/// The greatest probability with which a path goes on by chance.
const MOST_LIKELY: f64 = 0.95;
/// The widening of the cone of a ray that a surface scattered, for the level of detail of textures.
const SCATTERED_SPREAD: f32 = 0.1;

/// The lights of a scene as paths find them, and the seed of their random numbers.
pub(super) struct PathTracer<'a> {
    lights: LightSampler<'a>,
    /// The light from all sides that nothing but surfaces blocks.
    ambient: Vec3,
    seed: u32,
}

/// The history of a path at one of its rays, beside its state in a wave.
#[derive(Clone, Copy, Debug)]
struct PathHistory {
    /// The density of its direction, per steradian; 0 if it is that of the camera, or of a sharp lobe.
    pdf: f64,
    /// True once a surface scattered it otherwise than as a sharp mirror or as clear glass does.
    has_scattered: bool,
    /// The number of surfaces before.
    surfaces: u32,
}

/// The samples that paths add to: one of each pixel of a tile.
pub(super) struct PathSamples<'s> {
    /// The radiance.
    pub radiance: &'s mut Vec<Radiance16>,
    /// The alpha, in a transparent picture.
    pub alpha: Option<&'s mut AlphaSums>,
}

/// A ray of a path, and the surface that it hit.
struct Arrival<'w> {
    ray: Ray,
    hit: Hit,
    path: &'w PathState,
    history: PathHistory,
    numbers: SurfaceNumbers,
}

/// Memory that a thread uses again and again.
#[derive(Default)]
pub(super) struct PathScratch {
    histories: Vec<PathHistory>,
    next_histories: Vec<PathHistory>,
    next: Wave,
    samplers: Vec<Sampler>,
    lights: LightQueue,
    not_finite: Vec<(u32, NotFiniteCause)>,
}

impl<'a> PathTracer<'a> {
    /// Prepares a scene.
    pub fn new(scene: &'a Scene, seed: u32) -> Self {
        let ambient = scene.lights.iter().filter(|light| light.kind == LightKind::Ambient);
        let ambient = ambient.map(|light| light.intensity).sum();
        Self { lights: LightSampler::new(scene), ambient, seed }
    }
}

impl Integrator<'_> {
    /// Traces one path through each pixel of a tile, for the wave's sample of each.
    pub(super) fn trace_paths(
        &self,
        tracer: &PathTracer<'_>,
        tile: &Tile,
        wave: &mut Wave,
        mut samples: PathSamples<'_>,
        scratch: &mut PathScratch,
        counts: &mut Counts,
    ) {
        self.begin_paths(tracer, tile, wave, scratch, counts);
        samples.radiance.clear();
        samples.radiance.resize(wave.rays.blocks().len(), DARK);
        loop {
            // Rays may go straight on through null interfaces, and be absorbed on their way.
            if self.media.may_alter_rays {
                null_interfaces::cross(self, wave, counts);
            }
            scratch.next.rays.clear();
            scratch.next.paths.clear();
            scratch.next_histories.clear();
            scratch.lights.clear();
            for i in 0..wave.rays.len() {
                self.extend(tracer, i, wave, &mut samples, scratch, counts);
            }
            scratch.lights.add_light(self, samples.radiance, &mut scratch.not_finite, counts);
            // The rays that go on form the next wave.
            std::mem::swap(wave, &mut scratch.next);
            std::mem::swap(&mut scratch.histories, &mut scratch.next_histories);
            if wave.rays.is_empty() {
                break;
            }
            self.find_hits(wave, &scratch.histories, counts);
        }
        // Each sample counts once.
        for (sample, cause) in scratch.not_finite.drain(..) {
            let (block, i) = (sample as usize / LANES, sample as usize % LANES);
            if !lane(&samples.radiance[block], i).is_nan() {
                cause.count(counts);
                set_lane(&mut samples.radiance[block], i, Vec3::NAN);
            }
        }
    }

    /// Sets a wave to camera rays and their hits.
    fn begin_paths(
        &self,
        tracer: &PathTracer<'_>,
        tile: &Tile,
        wave: &mut Wave,
        scratch: &mut PathScratch,
        counts: &mut Counts,
    ) {
        let sample = wave.sample;
        wave.paths.clear();
        wave.rays.clear();
        scratch.samplers.clear();
        scratch.histories.clear();
        for i in 0..tile.count {
            let pixels = &tile.pixels[i / LANES];
            let column = tile.origin[0] + pixels.columns[i % LANES] as usize;
            let row = tile.origin[1] + pixels.rows[i % LANES] as usize;
            let sampler = Sampler::new(tracer.seed, [column as u32, row as u32], sample as u32);
            let [[x, y], lens] = sampler.camera();
            let ray = self.camera.ray_through_lens(column as f64 + x, row as f64 + y, lens);
            wave.rays.push(&ray);
            scratch.samplers.push(sampler);
            scratch.histories.push(PathHistory { pdf: 0.0, has_scattered: false, surfaces: 0 });
        }
        wave.paths = (0..wave.rays.len()).map(|i| wave.path(i, self)).collect();
        self.visible_hits(&wave.rays, Coherence::Coherent, &mut wave.hits, counts);
        counts.rays.primary += wave.rays.len() as u64;
        counts.hits += wave.hits.count() as u64;
    }

    /// Finds the closest hits of a wave. Back faces of one-sided surfaces are there for rays that a surface has
    /// scattered, as they are for shadow rays.
    fn find_hits(&self, wave: &mut Wave, histories: &[PathHistory], counts: &mut Counts) {
        self.closest_hits(&wave.rays, Coherence::Incoherent, &mut wave.hits, counts);
        if self.back_faces.is_empty() {
            return;
        }
        let (mut rays, mut hits, mut indices) = (RayBatch::default(), HitBatch::default(), vec![]);
        for i in (0..histories.len()).filter(|&i| !histories[i].has_scattered) {
            rays.push(&wave.rays.ray(i));
            indices.push(i);
        }
        if indices.is_empty() {
            return;
        }
        self.visible_hits(&rays, Coherence::Incoherent, &mut hits, counts);
        for (&i, hit) in indices.iter().zip(hits.iter()) {
            wave.hits.set(i, hit);
        }
    }

    /// Adds what path `i` of a wave sees at the end of its ray, samples a light there, and lets the path go on.
    fn extend(
        &self,
        tracer: &PathTracer<'_>,
        i: usize,
        wave: &Wave,
        samples: &mut PathSamples<'_>,
        scratch: &mut PathScratch,
        counts: &mut Counts,
    ) {
        let (ray, path, history) = (wave.rays.ray(i), &wave.paths[i], scratch.histories[i]);
        let mut add = |light: Vec3, weight: f64, not_finite: &mut Vec<_>| {
            let light = (path.throughput * light.as_dvec3() * weight).as_vec3();
            let (block, i) = path.sample_lane();
            if light.is_finite() {
                let sum = lane(&samples.radiance[block], i) + light;
                set_lane(&mut samples.radiance[block], i, sum);
            } else {
                not_finite.push((path.sample, NotFiniteCause::Surface));
            }
        };
        let Some(hit) = wave.hits.get(i) else {
            // A transparent background brings no light, and covers nothing.
            if let Some(alpha) = samples.alpha.as_mut().filter(|_| path.depth == 0) {
                alpha.uncover_sample(path.sample, path.throughput.element_sum() / 3.0);
                return;
            }
            let (light, weight) = self.seen_beyond(tracer, &ray, path, &history);
            add(light, weight, &mut scratch.not_finite);
            return;
        };
        // The surface.
        let mut surface = Surface::new(self.scene, &ray, &hit);
        let cached = self.materials.get(surface.material);
        let is_varied = self.materials.varies_on(cached, &hit);
        let mut context = TextureContext::default();
        if is_varied {
            let counts = &mut counts.work;
            context = wave_surfaces::context_on_wave(self, wave, i, &hit, &surface, counts);
            self.materials.count_lookups(cached, &hit, counts);
            if cached.has_normal_map {
                let point = &context.point;
                surface.normal = surface::mapped_normal(self.scene, &surface, &hit, point);
            }
        }
        let vertex = PathVertex::new(self, &ray, &hit, surface, &context, is_varied, path);
        // The light that it emits: none from the side from which it is not seen.
        let is_culled = self.back_faces.culled_side(hit.id) == Some(vertex.surface.side);
        let is_picture = vertex.is_unlit && history.has_scattered;
        if vertex.emission != Vec3::ZERO && !is_culled && !is_picture {
            let weight = if history.pdf > 0.0 && !vertex.is_unlit {
                let by_light =
                    tracer.lights.pdf_of_hit(ray.origin, ray.direction, &hit, &vertex.surface);
                history.pdf / (history.pdf + by_light)
            } else {
                1.0
            };
            add(vertex.emission, weight, &mut scratch.not_finite);
        }
        let depth = path.depth;
        if vertex.is_unlit || depth > self.scene.film.max_depth {
            return;
        }
        let numbers = scratch.samplers[path.sample as usize].surface(history.surfaces);
        let arrival = Arrival { ray, hit, path, history, numbers };
        self.queue_light(tracer, &vertex, &arrival, scratch);
        self.go_on(&vertex, &arrival, scratch, counts);
    }

    /// Returns what a ray sees that hits nothing, and its weight.
    fn seen_beyond(
        &self,
        tracer: &PathTracer<'_>,
        ray: &Ray,
        path: &PathState,
        history: &PathHistory,
    ) -> (Vec3, f64) {
        let film = &self.scene.film;
        // Layers that it went straight through do not count.
        let is_camera = path.depth == 0;
        match &self.scene.environment {
            Some(environment) if environment.visible || !is_camera => {
                let by_light = if history.pdf > 0.0 {
                    tracer.lights.pdf_of_environment(ray.origin, ray.direction.normalize())
                } else {
                    0.0
                };
                let weight =
                    if by_light > 0.0 { history.pdf / (history.pdf + by_light) } else { 1.0 };
                let ambient = if history.has_scattered { tracer.ambient } else { Vec3::ZERO };
                // Ambient light is found in this way only.
                let light =
                    environment.radiance(ray.direction) + ambient / weight.max(1e-12) as f32;
                (light, weight)
            }
            // The background is a picture behind all, and lights nothing.
            _ if history.has_scattered => (tracer.ambient, 1.0),
            _ => (film.background, 1.0),
        }
    }

    /// Samples a light for a vertex, and queues what it gives until it is known whether it is blocked.
    fn queue_light(
        &self,
        tracer: &PathTracer<'_>,
        vertex: &PathVertex<'_>,
        arrival: &Arrival<'_>,
        scratch: &mut PathScratch,
    ) {
        let Arrival { ray, path, numbers, .. } = arrival;
        let position = vertex.surface.position;
        let &SurfaceNumbers { light, light_part, light_direction, .. } = numbers;
        let Some(sample) = tracer.lights.sample(position, light, light_part, light_direction)
        else {
            return;
        };
        let (value, pdf) = vertex.evaluate(sample.toward.normalize());
        // A light that no scattered ray meets is found in this way only.
        let weight = if sample.pdf > 0.0 { sample.pdf / (sample.pdf + pdf) } else { 1.0 };
        let light = (path.throughput * (value * sample.weighted).as_dvec3() * weight).as_vec3();
        if light == Vec3::ZERO {
            return;
        }
        if !light.is_finite() {
            scratch.not_finite.push((path.sample, NotFiniteCause::Light));
            return;
        }
        let incident = IncidentLight {
            toward: sample.toward,
            is_bounded: sample.is_bounded,
            intensity: Vec3::ZERO,
        };
        let shadow_ray = vertex.surface.shadow_ray(ray.direction, &incident);
        scratch.lights.push(&shadow_ray, path.sample, light, sample.casts_shadow);
    }

    /// Lets a path go on from a vertex, if it does.
    fn go_on(
        &self,
        vertex: &PathVertex<'_>,
        arrival: &Arrival<'_>,
        scratch: &mut PathScratch,
        counts: &mut Counts,
    ) {
        let Arrival { ray, hit, path, history, numbers } = arrival;
        let Some(next) = vertex.sample(ray, hit, numbers.lobe, numbers.direction) else { return };
        let mut throughput = path.throughput * next.weight.as_dvec3();
        if !(throughput.is_finite() && next.pdf.is_finite()) {
            scratch.not_finite.push((path.sample, NotFiniteCause::Surface));
            return;
        }
        // A layer is passed as if it were not there, and does not count for depth.
        let is_layer = next.ray.continuation.is_some()
            && shadows::is_layer(&self.scene.materials[vertex.surface.material.0 as usize]);
        let (depth, layers) =
            (path.depth + u32::from(!is_layer), path.layers + u32::from(is_layer));
        // At the greatest depth scattered rays still find light that may be sampled; sharp ones show nothing more.
        let is_sharp = next.pdf <= 0.0;
        if depth > self.scene.film.max_depth && is_sharp && !is_layer {
            return;
        }
        if layers > MAX_LAYERS {
            counts.beyond_layers += 1;
            return;
        }
        // Paths of little weight end by chance.
        if history.surfaces >= FIRST_ROULETTE && !is_layer {
            let survives = throughput.max_element().min(MOST_LIKELY);
            if numbers.roulette >= survives {
                return;
            }
            throughput /= survives;
        }
        if throughput == DVec3::ZERO {
            return;
        }
        *(if next.is_transmission {
            &mut counts.rays.refraction
        } else {
            &mut counts.rays.reflection
        }) += 1;
        let length = hit.t * ray.direction.length();
        let lod = &self.texture_lod;
        let cone = if is_sharp {
            lod.spawned_cone(&path.cone, length, self.scene, &vertex.surface, next.is_transmission)
        } else {
            RayCone { width: path.cone.width_at(length), spread: SCATTERED_SPREAD }
        };
        let cone = if next.ray.continuation.is_some() { path.cone } else { cone };
        scratch.next.rays.push(&next.ray);
        scratch.next.paths.push(PathState {
            sample: path.sample,
            depth,
            layers,
            throughput,
            interior: next.interior,
            cone,
            roughness: 0.0,
        });
        scratch.next_histories.push(PathHistory {
            pdf: if is_layer { history.pdf } else { next.pdf },
            has_scattered: history.has_scattered || !is_sharp,
            surfaces: history.surfaces + 1,
        });
    }
}
