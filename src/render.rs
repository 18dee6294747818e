//! A picture from a scene: threads, progress, statistics.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::film::{Film, View};
use crate::integrator::{Counts, Integrator, PixelRecord, Scratch, Tiling};
use crate::intersect::{
    Backend, BuildQuality, BuildStats, Intersector, IntersectorBuilder, Precision,
};
use crate::scene::Scene;
use crate::scene::animation::Poses;

/// How to make a picture; size, samples and background stand in the scene's film settings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Who finds the hits.
    pub backend: Backend,
    /// How far the hits can be trusted.
    pub precision: Precision,
    /// How good Embree's trees are; nothing for what suits the number of rays to come.
    pub quality: Option<BuildQuality>,
    /// How many threads; 0 means all there are.
    pub threads: usize,
    /// Which of the scene's cameras.
    pub camera: usize,
    /// What the picture shows.
    pub view: View,
    /// How it is cut into batches.
    pub tiling: Tiling,
}

/// A picture, and what it took.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The picture.
    pub film: Film,
    /// What was counted and timed.
    pub statistics: Statistics,
}

/// What making a picture took.
#[derive(Clone, Debug)]
pub struct Statistics {
    /// The intersector's name and version.
    pub backend: (&'static str, String),
    /// How far the hits can be trusted.
    pub precision: Precision,
    /// How good Embree's trees were; nothing where there was no Embree.
    pub quality: Option<BuildQuality>,
    /// Threads used.
    pub threads: usize,
    /// Rays and other counts.
    pub counts: Counts,
    /// What was built for the intersector, and what was kept.
    pub built: BuildStats,
    /// Time to build the intersector.
    pub build: Duration,
    /// Time from the first ray to the last pixel.
    pub render: Duration,
}

impl Statistics {
    /// What nothing took, to add frames to.
    pub fn none(options: &Options) -> Self {
        Self {
            backend: (options.backend.name(), String::new()),
            precision: options.precision,
            quality: None,
            threads: options.threads,
            counts: Counts::default(),
            built: BuildStats::default(),
            build: Duration::ZERO,
            render: Duration::ZERO,
        }
    }

    /// Adds what another frame of the same animation took.
    pub fn add(&mut self, other: &Statistics) {
        (self.backend, self.threads) = (other.backend.clone(), other.threads);
        self.quality = other.quality;
        self.counts += other.counts;
        self.built += other.built;
        self.build += other.build;
        self.render += other.render;
    }
}

/// Renders a scene; of an animated one, the first moment.
///
/// `progress` is called with the share done, in (0, 1], from whichever thread finished a part.
///
/// # Errors
/// When the scene is not valid, has no such camera, or the intersector cannot be built.
pub fn render(
    scene: &Scene,
    options: &Options,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Rendering> {
    scene.check()?;
    check_camera(scene, options.camera)?;
    let posed = scene.animation.is_some().then(|| scene.at(0.0)).transpose()?;
    let scene = posed.as_ref().unwrap_or(scene);
    in_pool(options.threads, || {
        let threads = rayon::current_num_threads();
        let mut builder = IntersectorBuilder::new(options.backend, options.precision, threads)
            .with_quality(quality(scene, options));
        let start = Instant::now();
        let intersector = builder.build(scene)?;
        let made = Made::new(start, &builder, builder.stats());
        Ok(picture(scene, options, &*intersector, made, progress))
    })
}

/// Renders a scene at each of several times, in seconds, and hands each picture to `each` with its
/// index before the next is begun. Of the intersector only what moves is placed again.
///
/// `progress` is called with the share of the whole that is done, in (0, 1].
///
/// # Errors
/// When the scene is not valid at one of the times, as for [`render`], and what `each` returns;
/// nothing after that is rendered.
pub fn render_frames(
    scene: &Scene,
    times: &[f64],
    options: &Options,
    progress: &(dyn Fn(f32) + Sync),
    each: &mut (dyn FnMut(usize, Rendering) -> Result<()> + Send),
) -> Result<()> {
    scene.check()?;
    check_camera(scene, options.camera)?;
    in_pool(options.threads, || {
        let (backend, precision) = (options.backend, options.precision);
        let threads = rayon::current_num_threads();
        let moves = scene.animation.as_ref().is_some_and(|a| a.moves_geometry());
        let mut builder = match moves {
            true => IntersectorBuilder::for_frames(
                backend,
                precision,
                threads,
                scene.bounds_over_time(),
            ),
            false => IntersectorBuilder::new(backend, precision, threads),
        }
        .with_quality(quality(scene, options));
        // Where lights and cameras alone move, one intersector serves all frames.
        let mut still: Option<Box<dyn Intersector + '_>> = None;
        let mut poses = Poses::new(scene);
        for (i, &time) in times.iter().enumerate() {
            poses.pose(time)?;
            if scene.animation.is_some() {
                poses.check().map_err(|e| e.help(format!("at {time:.3} s of its animation")))?;
            }
            let posed = poses.scene();
            let share = |of_frame: f32| progress((i as f32 + of_frame) / times.len() as f32);
            let start = Instant::now();
            let before = builder.stats();
            let rendering = if moves {
                let intersector = builder.build(posed)?;
                let made = Made::new(start, &builder, builder.stats() - before);
                picture(posed, options, &*intersector, made, &share)
            } else if let Some(intersector) = &still {
                let made = Made::new(start, &builder, BuildStats::reused(before.meshes_built));
                picture(posed, options, &**intersector, made, &share)
            } else {
                let intersector = still.insert(builder.build(scene)?);
                let made = Made::new(start, &builder, builder.stats());
                picture(posed, options, &**intersector, made, &share)
            };
            each(i, rendering)?;
        }
        Ok(())
    })
}

/// How an intersector was made.
struct Made {
    quality: Option<BuildQuality>,
    built: BuildStats,
    took: Duration,
}

impl Made {
    fn new(start: Instant, builder: &IntersectorBuilder, built: BuildStats) -> Self {
        Self { quality: builder.quality(), built, took: start.elapsed() }
    }
}

/// How good the trees of a scene should be, where the options leave it open: by its primary rays and
/// their shadow rays, which can be told beforehand. All frames of an animation count, also when
/// only some are asked for: a frame must not depend on which are rendered with it.
fn quality(scene: &Scene, options: &Options) -> BuildQuality {
    let (spp, lights) = match options.view {
        View::Beauty => {
            (scene.film.spp, scene.lights.iter().filter(|light| light.casts_shadow()).count())
        }
        _ => (1, 0),
    };
    let frames = scene.animation.as_ref().map_or(1, |animation| animation.frames);
    let [width, height] = scene.film.size;
    let factors = [width, height, spp, frames, 1 + lights as u32];
    let rays = factors.into_iter().map(u64::from).fold(1, u64::saturating_mul);
    options.quality.unwrap_or(BuildQuality::for_rays(rays, scene.primitive_count()))
}

/// A picture of a checked scene, by an intersector that is there.
fn picture(
    scene: &Scene,
    options: &Options,
    intersector: &dyn Intersector,
    made: Made,
    progress: &(dyn Fn(f32) + Sync),
) -> Rendering {
    let (film, counts, render) = with_intersector(scene, options, intersector, progress);
    let backend = (intersector.name(), intersector.version());
    let threads = rayon::current_num_threads();
    let precision = options.precision;
    let Made { quality, built, took: build } = made;
    let statistics =
        Statistics { backend, precision, quality, threads, counts, built, build, render };
    Rendering { film, statistics }
}

/// Renders a checked scene with an intersector that is there already, on the current rayon pool.
///
/// # Panics
/// When the scene has no such camera.
pub fn with_intersector(
    scene: &Scene,
    options: &Options,
    intersector: &dyn Intersector,
    progress: &(dyn Fn(f32) + Sync),
) -> (Film, Counts, Duration) {
    let size = scene.film.size;
    let mut film = Film::new(size, options.view);
    let camera = &scene.cameras[options.camera];
    let Options { view, tiling, .. } = *options;
    let integrator = Integrator::new(scene, intersector, camera, view, tiling);
    let rows = tiling.rows;
    let strip = size[0] as usize * rows;
    let strips = film.pixels.len().div_ceil(strip);
    let passes = if integrator.is_adaptive() { 2 } else { 1 };
    let (counts, done) = (Mutex::new(Counts::default()), AtomicU64::new(0));
    let tell = |here: Counts| {
        // A poisoned lock still holds the counts; the panic that caused it is reported anyway.
        *counts.lock().unwrap_or_else(|e| e.into_inner()) += here;
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress(done as f32 / (passes * strips) as f32);
    };
    let start = Instant::now();
    let mut seen = vec![PixelRecord::default(); if passes == 2 { film.pixels.len() } else { 0 }];
    let mut of_strips: Vec<&mut [PixelRecord]> = seen.chunks_mut(strip).collect();
    of_strips.resize_with(strips, Default::default);
    let first_pass = film.pixels.par_chunks_mut(strip).zip(of_strips).enumerate();
    first_pass.for_each_init(Scratch::default, |scratch, (i, (pixels, seen))| {
        tell(integrator.strip(i * rows, pixels, seen, scratch));
    });
    if passes == 2 {
        let doubtful = integrator.pixels_to_refine(&film.pixels, &seen);
        let pixels = film.pixels.par_chunks_mut(strip).enumerate();
        let parts = pixels.zip(seen.par_chunks(strip).zip(doubtful.par_chunks(strip)));
        parts.for_each_init(Scratch::default, |scratch, ((i, pixels), (seen, doubtful))| {
            tell(integrator.refine(i * rows, (pixels, seen, doubtful), scratch));
        });
    }
    let counts = counts.into_inner().unwrap_or_else(|e| e.into_inner());
    (film, counts, start.elapsed())
}

/// Runs `work` on `threads` threads; 0 means all there are. They are those of the current rayon pool
/// where that has so many, and else a pool of their own.
///
/// # Errors
/// When the threads cannot be started, and what `work` returns.
pub fn in_pool<T: Send>(threads: usize, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    if threads == 0 || threads == rayon::current_num_threads() {
        return work();
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| Error::failed(format!("cannot start {threads} threads: {e}")))?
        .install(work)
}

/// Checks that the scene has camera `index`.
///
/// # Errors
/// When it has not.
pub fn check_camera(scene: &Scene, index: usize) -> Result<()> {
    if index < scene.cameras.len() {
        return Ok(());
    }
    Err(Error::input(format!("there is no camera {index}; the scene has {}", scene.cameras.len())))
}
