//! The Whitted loop: from the eye to the surfaces, and from there to the lights and on.
//!
//! Rays go through the intersector in batches. A strip of the picture is worked off tile by tile,
//! in each tile sample by sample: all primary rays of a sample form a wave; of what they hit, for
//! each light, all shadow rays go out with the radiance that waits on them (`shade`); and what
//! mirrors and glass send on forms the next wave (`follow`). A pixel's sum therefore has one
//! order, whatever the tiles and threads. Of an adaptive picture some pixels then get more samples
//! (`adaptive`).

mod adaptive;
mod bodies;
mod clearance;
mod counts;
mod details;
mod follow;
mod look;
mod radiance;
#[cfg(test)]
mod reversal;
mod samples;
mod scatter;
mod shade;
mod shadow;
mod tiling;

use glam::Vec3;

use crate::film::{Pixel, View};
use crate::geometry::{Geometry, Hit, HitBatch, LANES, Ray, RayBatch};
use crate::intersect::{Coherence, Intersector, Query};
use crate::scene::{Camera, Feature, FilmSettings, Material, RayGenerator, Scene, SceneFeatures};
use crate::surface::Surface;
use adaptive::{Note, PixelRecords};
pub use adaptive::{PixelRecord, STEPS};
use bodies::{InteriorList, NestedDielectrics};
use clearance::TransmissiveBounds;
pub use counts::{Counts, FeatureCounts, NotFinite, RayCounts};
use details::PixelCone;
use follow::PathState;
use look::{CachedMaterial, GeometryDetails};
use radiance::{Add, DARK, Develop, Radiance, put};
use samples::SamplePattern;
pub use samples::{sample_positions, sample_steps};
use shade::WaveLighting;
use tiling::Tile;
pub use tiling::Tiling;

/// Makes the pixels of one picture.
pub struct Integrator<'a> {
    scene: &'a Scene,
    intersector: &'a dyn Intersector,
    rays: RayGenerator,
    view: View,
    tiling: Tiling,
    /// Where in a pixel its samples lie.
    series: SamplePattern,
    /// From which difference on colours disagree, if any pixels get more samples than others.
    threshold: Option<f32>,
    /// Whether any surface is a mirror or lets light through: only then are rays followed.
    follows: bool,
    /// Whether any surface lets light through.
    transmits: bool,
    /// Whether textures, checkers or vertex colours are asked for anywhere.
    has_details: bool,
    /// How wide a ray from the eye is, where it is asked how much of a picture it sees.
    lens: Option<PixelCone>,
    /// Whether meshes are asked for normals of their vertices.
    has_smooth_normals: bool,
    /// Whether materials are asked for highlights.
    has_highlights: bool,
    /// Whether shadow rays go out, to each light.
    asks: Vec<bool>,
    details: GeometryDetails,
    /// How each material looks.
    looks: Vec<CachedMaterial>,
    /// What the processor can do at once.
    arch: pulp::Arch,
    bodies: NestedDielectrics,
    /// The bodies that the eye is in, if it is one point.
    eye: Option<InteriorList>,
    /// Whether rays may be absorbed, or meet what is no surface for them.
    may_pass: bool,
    /// Whether those from the eye may.
    may_pass_first: bool,
    /// Where light may go through anything on its way to a surface.
    clearance: TransmissiveBounds,
}

/// Memory that a thread uses again and again.
#[derive(Default)]
pub struct Scratch {
    tile: Tile,
    wave: Wave,
    light: WaveLighting,
    next: Wave,
    /// The radiance of the tile's pixels: of one sample, and the sum of all.
    sample: Vec<Radiance>,
    sum: Vec<Radiance>,
    notes: PixelRecords,
}

/// Rays that go through the intersector together, and what they hit.
#[derive(Default)]
struct Wave {
    rays: RayBatch,
    hits: HitBatch,
    /// Where each ray comes from and what it is worth; empty where all are whole samples, from an
    /// eye that is one point.
    paths: Vec<PathState>,
}

impl<'a> Integrator<'a> {
    /// An integrator for the scene's film settings, which looks through `camera`.
    pub fn new(
        scene: &'a Scene,
        intersector: &'a dyn Intersector,
        camera: &Camera,
        view: View,
        tiling: Tiling,
    ) -> Self {
        // Debug views are not averages: one sample.
        let film = match view {
            View::Beauty => scene.film.clone(),
            _ => FilmSettings { spp: 1, adaptive: None, ..scene.film.clone() },
        };
        let rays = camera.rays(scene.film.size);
        let needs = SceneFeatures::of(scene);
        let must = |work| needs.uses(work);
        let bodies = NestedDielectrics::of(scene);
        let eye = match bodies.is_empty() {
            true => Some(InteriorList::default()),
            false => rays.eye().map(|eye| bodies.holding(eye, scene, intersector)),
        };
        Self {
            scene,
            intersector,
            rays,
            view,
            tiling,
            series: SamplePattern::of(&film),
            threshold: film.adaptive.map(|adaptive| adaptive.threshold),
            follows: must(Feature::Reflection) || must(Feature::Refraction),
            transmits: must(Feature::Refraction),
            has_details: [
                Feature::Uv,
                Feature::Checkers,
                Feature::VertexColors,
                Feature::NormalMaps,
            ]
            .into_iter()
            .any(must),
            lens: must(Feature::Mipmaps).then(|| PixelCone::of(&rays, &film)),
            has_smooth_normals: must(Feature::SmoothNormals),
            has_highlights: must(Feature::Highlights),
            asks: scene.lights.iter().map(|light| light.casts_shadow()).collect(),
            details: GeometryDetails::of(scene),
            looks: scene
                .materials
                .iter()
                .map(|material| CachedMaterial::of(scene, material))
                .collect(),
            arch: pulp::Arch::new(),
            may_pass: eye.as_ref() != Some(&InteriorList::default())
                || bodies.may_hide()
                || follow::may_be_clear(scene),
            may_pass_first: match &eye {
                Some(eye) => {
                    // In empty space nothing hides a surface.
                    let is_clear = |m: &Material| m.is_clear_in(1.0);
                    *eye != InteriorList::default() || scene.materials_in_use().any(is_clear)
                }
                None => true,
            },
            clearance: TransmissiveBounds::of(scene),
            bodies,
            eye,
        }
    }

    /// Makes the rows of the strip that begins at row `first`; `pixels` are whole rows. Of an
    /// adaptive picture they become the sums of every pixel's first samples, and `seen`, as many,
    /// what these saw; otherwise `seen` is empty.
    pub fn strip(
        &self,
        first: usize,
        pixels: &mut [Pixel],
        seen: &mut [PixelRecord],
        scratch: &mut Scratch,
    ) -> Counts {
        let width = self.scene.film.size[0] as usize;
        let rows = pixels.len() / width;
        let mut counts = Counts::default();
        for (left, columns) in self.tiles(width) {
            scratch.tile.set([left, first], [columns, rows], self.tiling.block);
            self.tile(scratch, &mut counts);
            let Scratch { tile, sum: sums, notes, .. } = &*scratch;
            let share = if self.is_adaptive() { 1.0 } else { 1.0 / self.series.steps[0] as f32 };
            self.arch.dispatch(Develop { tile, sums, share, left, width, pixels });
            if self.is_adaptive() {
                let mut of_tile = notes.seen.iter();
                for [x, y, length] in tile.runs.iter().map(|run| run.map(|n| n as usize)) {
                    let to = &mut seen[y * width + left + x..][..length];
                    to.iter_mut().zip(&mut of_tile).for_each(|(to, seen)| *to = *seen);
                }
            }
        }
        counts
    }

    /// The tiles of a strip: where each begins, and how many columns it has.
    fn tiles(&self, width: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
        let widest = self.tiling.columns;
        (0..width).step_by(widest).map(move |left| (left, widest.min(width - left)))
    }

    /// Works out the pixels of a tile: the first samples of each.
    fn tile(&self, scratch: &mut Scratch, counts: &mut Counts) {
        scratch.sum.clear();
        scratch.sum.resize(scratch.tile.places.len(), DARK);
        scratch.notes.begin();
        let samples = self.series.steps[0];
        for sample in &self.series.offsets[..samples] {
            self.sample(*sample, scratch, counts);
        }
    }

    /// Adds one sample of each pixel of a tile.
    fn sample(&self, offset: [f64; 2], scratch: &mut Scratch, counts: &mut Counts) {
        let Scratch { tile, wave, sum, notes, .. } = scratch;
        self.arch.dispatch(Aim { at: &self.rays, tile, offset, rays: &mut wave.rays });
        wave.rays.truncate(tile.count);
        wave.paths.clear();
        self.closest(&wave.rays, Coherence::Coherent, &mut wave.hits, counts);
        counts.rays.primary += wave.rays.len() as u64;
        counts.hits += wave.hits.count() as u64;
        if self.view != View::Beauty {
            for i in 0..wave.rays.len() {
                let value = self.debug(&wave.rays.ray(i), wave.hits.get(i).as_ref());
                put(&mut sum[i / LANES], i % LANES, value);
            }
            return;
        }
        if self.is_adaptive() {
            self.arch.dispatch(Note { scene: self.scene, wave, notes });
        }
        if self.follows {
            self.follow(scratch, counts);
        } else {
            let Scratch { wave, light, sample, .. } = scratch;
            self.shade(wave, light, counts);
            light.take_samples(sample, counts);
        }
        if let Some(threshold) = self.threshold {
            scratch.notes.take_colors(&scratch.sample, threshold);
        }
        if self.series.offsets.len() == 1 && !self.follows {
            // The one sample is the sum; what is not a number becomes dark at the end.
            std::mem::swap(&mut scratch.sum, &mut scratch.sample);
            return;
        }
        let infinite = &mut counts.not_finite.sum;
        self.arch.dispatch(Add { samples: &scratch.sample, sums: &mut scratch.sum, infinite });
    }

    /// Finds what rays hit.
    fn closest(
        &self,
        rays: &RayBatch,
        coherence: Coherence,
        hits: &mut HitBatch,
        counts: &mut Counts,
    ) {
        self.intersector.closest_batch(rays, coherence, hits);
        counts.work.count_tests(self.scene, self.intersector, Query::Closest, rays);
    }

    /// Finds which shadow rays are kept from their ends.
    fn occluded(&self, rays: &RayBatch, blocked: &mut Vec<bool>, counts: &mut Counts) {
        self.intersector.occluded_batch(rays, Coherence::Coherent, blocked);
        counts.work.count_tests(self.scene, self.intersector, Query::Occluded, rays);
    }

    /// The value of a debug view.
    fn debug(&self, ray: &Ray, hit: Option<&Hit>) -> Vec3 {
        match (self.view, hit) {
            (View::Depth, None) => Vec3::INFINITY,
            (_, None) | (View::Beauty, _) => Vec3::ZERO,
            (View::Normal, Some(hit)) => Surface::new(self.scene, ray, hit).normal.as_vec3(),
            (View::Depth, Some(hit)) => {
                // Infinite is what nothing is.
                Vec3::splat((hit.t * ray.direction.length()).min(f64::from(f32::MAX)) as f32)
            }
            (View::Id, Some(hit)) => {
                let geometry = match hit.id.geometry {
                    Geometry::Spheres => 1.0,
                    Geometry::Planes => 2.0,
                    Geometry::Mesh(i) => 3.0 + i as f32,
                };
                Vec3::new(geometry, hit.id.primitive as f32, hit.id.instance as f32)
            }
        }
    }
}

/// The rays from the eye through some pixels.
struct Aim<'a> {
    at: &'a RayGenerator,
    tile: &'a Tile,
    /// Where in each pixel.
    offset: [f64; 2],
    rays: &'a mut RayBatch,
}

impl pulp::WithSimd for Aim<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let ([dx, dy], [left, top]) = (self.offset, self.tile.place);
        let all = self.rays.resize_blocks(self.tile.places.len());
        for (lines, [columns, rows]) in all.iter_mut().zip(&self.tile.places) {
            let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                // The first sum is exact, so that the tiling does not matter.
                x[i] = (columns[i] + left) + dx;
                y[i] = (rows[i] + top) + dy;
            }
            self.at.ray16(&x, &y, lines);
        }
    }
}

impl Wave {
    fn clear(&mut self) {
        self.rays.clear();
        self.paths.clear();
    }

    /// Takes off the rays from the one at `at` on.
    fn split_off(&mut self, at: usize) -> Self {
        let mut second = Self { paths: self.paths.split_off(at), ..Self::default() };
        (at..self.rays.len()).for_each(|i| second.rays.push(&self.rays.ray(i)));
        self.rays.truncate(at);
        second
    }
}
