//! The loop of the integrator: the way of a tile from its camera rays to its pixels.

use crate::film::{Pixel, View};
use crate::geometry::{HitBatch, RayBatch};
use crate::integrator::adaptive_sampling::{PixelRecord, PixelRecords};
use crate::integrator::alpha::AlphaSums;
use crate::integrator::ambient_occlusion::AmbientOcclusion;
use crate::integrator::light_sources::LightSource;
use crate::integrator::path::{PathSamples, PathScratch, PathTracer};
use crate::integrator::pixel_sums::PixelSums;
use crate::integrator::radiance::{GROUP, Radiance16, WaveRadiance};
use crate::integrator::shadow_rays::ShadowQueue;
use crate::integrator::tiling::Tile;
use crate::integrator::transmissive_shadows::TransmissiveShadows;
use crate::integrator::wave::{Wave, WaveQueue};
use crate::integrator::wave_surfaces::WaveSurfaces;
use crate::integrator::{
    Counts, Integrator, back_faces, camera_rays, debug_view, direct_lighting, environment_lighting,
    null_interfaces, secondary_rays, surface_evaluation, transmissive_shadows,
};
use crate::intersect::{Coherence, Query};
use crate::scene::LightKind;

/// Memory that a thread uses again and again.
#[derive(Default)]
pub struct Scratch {
    pub(super) tile: Tile,
    waves: WaveQueue,
    surfaces: WaveSurfaces,
    occlusion: AmbientOcclusion,
    radiance: WaveRadiance,
    shadows: ShadowMemory,
    paths: PathScratch,
    /// One sample of each pixel of the tile.
    samples: Vec<Radiance16>,
    /// The sums of their samples.
    pub(super) sums: PixelSums,
    /// The sums of their alpha, in a transparent picture.
    pub(super) alpha: AlphaSums,
    pub(super) records: PixelRecords,
}

/// Memory for the shadow rays to one light.
#[derive(Default)]
struct ShadowMemory {
    shadows: ShadowQueue,
    glass: TransmissiveShadows,
}

impl Integrator<'_> {
    /// Renders the strip that begins at row `first_row`; `pixels` are whole rows, and `alpha`, as many, is
    /// theirs if the picture has alpha, and else empty. In an adaptive picture they become the means of
    /// every pixel's first samples, and `records`, as many, the records of these; otherwise `records` is
    /// empty.
    pub fn render_strip(
        &self,
        first_row: usize,
        pixels: &mut [Pixel],
        alpha: &mut [f32],
        records: &mut [PixelRecord],
        scratch: &mut Scratch,
    ) -> Counts {
        let width = self.scene.film.size[0] as usize;
        let rows = pixels.len() / width;
        let mut counts = Counts::default();
        for column in (0..width).step_by(self.tiling.columns) {
            // The first samples of each pixel of a tile.
            scratch.tile.set(&self.tiling, [column, first_row], [width, rows]);
            scratch.sums.clear();
            scratch.alpha.clear();
            scratch.records.clear();
            for step in 0..=self.samples.first {
                self.trace_step(step, scratch, &mut counts);
            }
            // Their means, and, where more may follow, their records.
            let Scratch { tile, sums, records: tile_records, .. } = &*scratch;
            let samples = self.samples.steps[self.samples.first];
            sums.write(self.arch, tile, samples, pixels, width);
            if self.has_alpha {
                scratch.alpha.write(tile, samples, alpha, width);
            }
            if self.is_adaptive() {
                let mut read = tile_records.records.iter();
                for run in &tile.runs {
                    let written = records[tile.run_in_strip(run, width)].iter_mut();
                    written.zip(&mut read).for_each(|(to, from)| *to = *from);
                }
            }
        }
        counts
    }

    /// Traces the samples of one step of each pixel of a tile, and adds them to the sums of those before.
    pub(super) fn trace_step(&self, step: usize, scratch: &mut Scratch, counts: &mut Counts) {
        let steps = &self.samples.steps;
        let taken = if step == 0 { 0 } else { steps[step - 1] };
        // Wherever a step may be the last of a pass, a regular picture, too, goes on from what a film
        // stores: so the two are equal to the bit.
        if taken > 0 {
            scratch.sums.round_means(self.arch, taken);
            scratch.alpha.round_means(taken);
        }
        // Four at a time, and one by one what is left.
        let (groups, rest) = self.samples.offsets[taken..steps[step]].as_chunks::<GROUP>();
        let groups = groups.iter().map(|group| &group[..]).chain(rest.chunks(1));
        let mut samples = taken..;
        for group in groups {
            scratch.sums.begin_group(self.arch);
            for sample in samples.by_ref().take(group.len()) {
                self.trace_sample(sample, scratch, counts);
            }
        }
    }

    /// Traces one sample of each pixel of a tile, of this index, and adds it to the sums of its group.
    fn trace_sample(&self, sample: usize, scratch: &mut Scratch, counts: &mut Counts) {
        if let Some(tracer) = &self.path_tracer {
            self.trace_path_sample(tracer, sample, scratch, counts);
            return;
        }
        let position = self.samples.offsets[sample];
        let Scratch {
            tile,
            waves,
            surfaces,
            occlusion,
            radiance,
            samples,
            sums,
            alpha,
            records,
            ..
        } = scratch;
        // Camera rays, one through each pixel.
        let mut wave = &mut waves.current;
        wave.paths.clear();
        wave.sample = sample;
        camera_rays::generate(self.arch, &self.camera, tile, position, &mut wave.rays);
        // Closest hits.
        self.visible_hits(&wave.rays, Coherence::Coherent, &mut wave.hits, counts);
        counts.rays.primary += wave.rays.len() as u64;
        counts.hits += wave.hits.count() as u64;
        // Debug views show the hits themselves.
        if self.view != View::Beauty {
            debug_view::set_pixels(self.scene, self.view, wave, &mut sums.group);
            return;
        }
        // What is left uncovered is taken away from alpha as it is found.
        if self.has_alpha {
            alpha.begin_sample(tile.count);
        }
        // Adaptive sampling compares what the samples of a pixel hit.
        if self.is_adaptive() {
            records.record_hits(self.arch, self.scene, wave);
        }
        // Camera rays may start in a dielectric.
        if self.media.may_alter_camera_rays {
            null_interfaces::begin_paths(self, wave, samples);
        }
        loop {
            // Rays may go straight on through null interfaces, and be absorbed on their way.
            if self.media.may_alter_rays {
                null_interfaces::cross(self, wave, counts);
            }
            // Surfaces, with what they emit.
            surface_evaluation::evaluate(self, wave, surfaces, radiance, &mut counts.work);
            // The share of the light from all around that arrives.
            if self.has_ambient_occlusion() {
                occlusion.find(self, sample, wave, surfaces, counts);
            }
            // The environment, where a ray hits nothing, and as surfaces reflect it.
            if let Some(environment) = &self.scene.environment {
                let counts = &mut counts.work;
                environment_lighting::set_background(environment, wave, radiance, counts);
                environment_lighting::add(self, environment, wave, surfaces, radiance, counts);
            }
            // A transparent background brings no light, and covers nothing.
            if self.has_alpha {
                alpha.uncover(wave, radiance);
            }
            // For each light: contributions, shadow rays, and what they let through.
            self.light_surfaces(sample, wave, surfaces, radiance, &mut scratch.shadows, counts);
            // The radiance that comes back along the rays joins the samples of the pixels.
            radiance.add_to_samples(wave, samples, counts);
            // Secondary rays form the next wave.
            if !self.features.secondary_rays {
                break;
            }
            secondary_rays::spawn(self, wave, surfaces, &mut waves.next, counts);
            if !waves.advance() {
                break;
            }
            wave = &mut waves.current;
            self.visible_hits(&wave.rays, Coherence::Incoherent, &mut wave.hits, counts);
        }
        // Adaptive sampling compares the colours, too.
        if let Some(threshold) = self.contrast_threshold {
            records.compare_radiance(samples, threshold);
        }
        // Sums of samples.
        if self.samples.offsets.len() == 1 && !self.features.secondary_rays {
            // The only sample is the sum; what is NaN becomes black in the end.
            std::mem::swap(&mut sums.group, samples);
            return;
        }
        sums.add(self.arch, samples, &mut counts.not_finite.sum);
    }

    /// Traces one path through each pixel of a tile, and adds what it finds to the sums of its group.
    fn trace_path_sample(
        &self,
        tracer: &PathTracer<'_>,
        sample: usize,
        scratch: &mut Scratch,
        counts: &mut Counts,
    ) {
        let Scratch { tile, waves, samples, sums, alpha, paths, .. } = scratch;
        if self.has_alpha {
            alpha.begin_sample(tile.count);
        }
        let wave = &mut waves.current;
        wave.sample = sample;
        let alpha = self.has_alpha.then_some(alpha);
        let of_paths = PathSamples { radiance: &mut *samples, alpha };
        self.trace_paths(tracer, tile, wave, of_paths, paths, counts);
        sums.add(self.arch, samples, &mut counts.not_finite.sum);
    }

    /// Adds the light of each source, for this sample of the pixels, that the surfaces of the current
    /// wave reflect.
    fn light_surfaces(
        &self,
        sample: usize,
        wave: &Wave,
        surfaces: &WaveSurfaces,
        radiance: &mut WaveRadiance,
        memory: &mut ShadowMemory,
        counts: &mut Counts,
    ) {
        let ShadowMemory { shadows, glass } = memory;
        for (i, source) in self.light_sources.of_sample(sample).enumerate() {
            if i > 0 && i % GROUP == 0 {
                radiance.begin_group(self.arch);
            }
            if let LightSource::Light(light) = source
                && light.kind == LightKind::Ambient
            {
                let has_occlusion = self.features.textures || self.has_ambient_occlusion();
                direct_lighting::add_ambient(light, surfaces, has_occlusion, radiance);
                continue;
            }
            // Contributions: of a light that casts shadows, they wait for shadow rays.
            direct_lighting::reflect(self, &source, wave, surfaces, radiance, shadows, counts);
            if shadows.rays.is_empty() {
                continue;
            }
            // Shadow rays: occluded, or attenuated by glass.
            counts.rays.shadow += shadows.count();
            if !self.features.transmission {
                self.occluded(&shadows.rays, &mut shadows.occluded, counts);
            } else if !transmissive_shadows::find_layers(
                self,
                source.shadow(),
                shadows,
                glass,
                counts,
            ) {
                self.occluded(&shadows.rays, &mut shadows.occluded, counts);
                transmissive_shadows::attenuate(
                    self,
                    source.shadow(),
                    wave,
                    shadows,
                    glass,
                    counts,
                );
            }
            // The contributions that arrive.
            shadows.add_light(self.arch, radiance);
        }
        radiance.add_groups();
    }

    /// Finds what the viewer sees along rays: their closest hits, but for the back faces of one-sided
    /// surfaces.
    pub(super) fn visible_hits(
        &self,
        rays: &RayBatch,
        coherence: Coherence,
        hits: &mut HitBatch,
        counts: &mut Counts,
    ) {
        self.closest_hits(rays, coherence, hits, counts);
        if !self.back_faces.is_empty() {
            back_faces::pass_back_faces(self, rays, hits, counts);
        }
    }

    /// Finds the closest hits of rays.
    pub(super) fn closest_hits(
        &self,
        rays: &RayBatch,
        coherence: Coherence,
        hits: &mut HitBatch,
        counts: &mut Counts,
    ) {
        self.intersector.closest_batch(rays, coherence, hits);
        let has_filter = self.intersector.uses_filter(Query::Closest, rays);
        counts.work.add_extra_tests(self.scene, has_filter, rays);
    }

    /// Finds which shadow rays are occluded.
    pub(super) fn occluded(&self, rays: &RayBatch, occluded: &mut Vec<bool>, counts: &mut Counts) {
        self.intersector.occluded_batch(rays, Coherence::Coherent, occluded);
        let has_filter = self.intersector.uses_filter(Query::Occluded, rays);
        counts.work.add_extra_tests(self.scene, has_filter, rays);
    }
}
