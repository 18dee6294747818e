//! The extension of paths by a vertex: the light that is found at the end of a ray, and the ray by which a path goes on.

use glam::{DVec3, Vec3};

use super::sampler::SurfaceNumbers;
use super::shadows;
use super::vertex::PathVertex;
use super::{PathHistory, PathSamples, PathScratch, PathTracer};
use crate::geometry::{Hit, Ray};
use crate::integrator::counts::NotFiniteCause;
use crate::integrator::radiance::{lane, set_lane};
use crate::integrator::secondary_rays::MAX_LAYERS;
use crate::integrator::wave::{PathState, Wave};
use crate::integrator::{Counts, Integrator, wave_surfaces};
use crate::scene::IncidentLight;
use crate::surface::{self, RayCone, Surface, TextureContext};

/// The number of surfaces that a path has before it may end by chance.
const FIRST_ROULETTE: u32 = 3;
/// The greatest probability with which a path goes on by chance.
const MOST_LIKELY: f64 = 0.95;
/// The widening of the cone of a ray that a surface scattered, for the level of detail of textures.
const SCATTERED_SPREAD: f32 = 0.1;

/// A ray of a path, and the surface that it hit.
struct Arrival<'w> {
    ray: Ray,
    hit: Hit,
    path: &'w PathState,
    history: PathHistory,
    numbers: SurfaceNumbers,
}

impl Integrator<'_> {
    /// Adds what path `i` of a wave sees at the end of its ray, samples a light there, and lets the path go on.
    pub(super) fn extend(
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
