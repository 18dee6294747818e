//! The path tracer: the radiance along camera rays by random light paths, without any bias.
//!
//! Each path goes from surface to surface. At each the light of one source is added if nothing is in between
//! (next-event estimation), and the path goes on in a direction that is sampled by the BSDF. What both ways may find
//! is weighted by the balance heuristic (Veach, *Robust Monte Carlo Methods for Light Transport Simulation*, 1997,
//! chapter 9). All paths of a tile that have the same number of surfaces form a wave.

mod extension;
mod light_sampler;
mod sampler;
mod shadows;
mod vertex;

use glam::Vec3;

use crate::geometry::{HitBatch, LANES, RayBatch};
use crate::integrator::alpha::AlphaSums;
use crate::integrator::counts::NotFiniteCause;
use crate::integrator::radiance::{DARK, Radiance16, lane, set_lane};
use crate::integrator::tiling::Tile;
use crate::integrator::wave::Wave;
use crate::integrator::{Counts, Integrator, null_interfaces};
use crate::intersect::Coherence;
use crate::scene::{LightKind, Scene};
use light_sampler::LightSampler;
use sampler::Sampler;
use shadows::LightQueue;

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
}
