//! The renderer: from a scene to a picture, with threads, progress and statistics.

use std::borrow::Cow;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::film::{Film, View};
use crate::integrator::{Counts, Integrator, PixelRecord, RefineStrip, Scratch, Tiling};
use crate::intersect::{
    Backend, BuildQuality, BuildStats, Intersector, IntersectorBuilder, Precision,
};
use crate::scene::Scene;
use crate::scene::animation::PosedScene;
use crate::write;

/// The options of a rendering; size, samples and background are the scene's film settings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RenderOptions {
    /// The backend that finds the hits.
    pub backend: Backend,
    /// The precision of the hits.
    pub precision: Precision,
    /// The quality of Embree's trees; `None` chooses it by the number of rays to come.
    pub quality: Option<BuildQuality>,
    /// The number of threads; 0 means all there are.
    pub threads: usize,
    /// The index of the scene's camera.
    pub camera: usize,
    /// The view: the beauty, or a debug view.
    pub view: View,
    /// The tiles that the picture is cut into.
    pub tiling: Tiling,
}

/// A picture, with its statistics and with the settings by which it is saved.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Rendering {
    /// The picture.
    pub film: Film,
    /// The settings by which [`save`](Rendering::save) encodes the film: those of the scene.
    pub settings: write::Settings,
    /// Counts and times.
    pub statistics: Statistics,
}

impl Rendering {
    /// Saves the picture as PNG or EXR, by the extension of `path`.
    ///
    /// # Errors
    /// When the extension names no format, or the file cannot be written; an old file at `path` is
    /// left as it was.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        write::write(&self.film, path.as_ref(), &self.settings)
    }
}

/// The counts and times of a rendering.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Statistics {
    /// The name of the intersector.
    pub backend: &'static str,
    /// The version of the library that traces.
    pub backend_version: String,
    /// The precision of the hits.
    pub precision: Precision,
    /// The quality of Embree's trees; `None` without Embree.
    pub quality: Option<BuildQuality>,
    /// The number of threads.
    pub threads: usize,
    /// Rays and other counts.
    pub counts: Counts,
    /// Counts of what was built for the intersector, and of what was reused.
    pub built: BuildStats,
    /// The time to build the intersector.
    pub build: Duration,
    /// The time from the first ray to the last pixel.
    pub render: Duration,
}

impl Statistics {
    /// Zeroed statistics, to which those of frames are added.
    pub fn zero(options: &RenderOptions) -> Self {
        Self {
            backend: options.backend.name(),
            backend_version: String::new(),
            precision: options.precision,
            quality: None,
            threads: options.threads,
            counts: Counts::default(),
            built: BuildStats::default(),
            build: Duration::ZERO,
            render: Duration::ZERO,
        }
    }

    /// Adds the statistics of another frame of the same animation.
    pub fn add(&mut self, other: &Statistics) {
        self.backend = other.backend;
        self.backend_version.clone_from(&other.backend_version);
        self.threads = other.threads;
        self.quality = other.quality;
        self.counts += other.counts;
        self.built += other.built;
        self.build += other.build;
        self.render += other.render;
    }
}

/// A callback that is told the share of the work that is done, in (0, 1]; any thread may call it.
type Progress<'s> = dyn Fn(f32) + Sync + 's;

/// A renderer of one scene.
///
/// ```
/// use envers::{Camera, Light, Material, Projection, Renderer, Scene, Sphere};
/// use envers::glam::{DVec3, Vec3};
///
/// let mut scene = Scene::default();
/// let red = scene.add_material(Material::matte(Vec3::new(0.8, 0.1, 0.1)));
/// scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, red));
/// scene.lights.push(Light::sun(DVec3::new(-1.0, -1.0, -1.0)));
/// let projection = Projection::FovY(40f64.to_radians());
/// scene.cameras.push(Camera::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, projection)?);
/// let rendering = Renderer::new(&scene).size([64, 48]).samples(4).render()?;
/// assert!(rendering.film.pixel(32, 24)[0] > 0.1);
/// # Ok::<(), envers::Error>(())
/// ```
pub struct Renderer<'s> {
    scene: Cow<'s, Scene>,
    options: RenderOptions,
    progress: Box<Progress<'s>>,
}

impl<'s> Renderer<'s> {
    /// A renderer with the scene's own film settings and the default options.
    pub fn new(scene: &'s Scene) -> Self {
        let (scene, options) = (Cow::Borrowed(scene), RenderOptions::default());
        Self { scene, options, progress: Box::new(|_| {}) }
    }

    /// Sets all options at once.
    pub fn options(self, options: RenderOptions) -> Self {
        Self { options, ..self }
    }

    /// Sets the size of the picture, in pixels.
    pub fn size(mut self, size: [u32; 2]) -> Self {
        self.scene.to_mut().film.size = size;
        self
    }

    /// Sets the number of samples of each pixel, the same for all; at least 1.
    pub fn samples(mut self, samples: u32) -> Self {
        let film = &mut self.scene.to_mut().film;
        film.spp = samples;
        film.adaptive = None;
        self
    }

    /// Sets the backend that finds the hits.
    pub fn backend(mut self, backend: Backend) -> Self {
        self.options.backend = backend;
        self
    }

    /// Sets the precision of the hits.
    pub fn precision(mut self, precision: Precision) -> Self {
        self.options.precision = precision;
        self
    }

    /// Sets the quality of Embree's trees.
    pub fn quality(mut self, quality: BuildQuality) -> Self {
        self.options.quality = Some(quality);
        self
    }

    /// Sets the number of threads; 0 means all there are.
    pub fn threads(mut self, threads: usize) -> Self {
        self.options.threads = threads;
        self
    }

    /// Sets the camera, by its index in the scene.
    pub fn camera(mut self, index: usize) -> Self {
        self.options.camera = index;
        self
    }

    /// Sets the view.
    pub fn view(mut self, view: View) -> Self {
        self.options.view = view;
        self
    }

    /// Sets a callback that is told the share of the work that is done, in (0, 1]. Any thread may call
    /// it.
    pub fn on_progress(self, progress: impl Fn(f32) + Sync + 's) -> Self {
        Self { progress: Box::new(progress), ..self }
    }

    /// Renders the scene; an animated one at time 0.
    ///
    /// # Errors
    /// When the scene is not valid, has no such camera, or the intersector cannot be built.
    pub fn render(&self) -> Result<Rendering> {
        let (scene, options) = (&*self.scene, &self.options);
        scene.check()?;
        check_camera(scene, options.camera)?;
        let posed = scene.animation.is_some().then(|| scene.at_time(0.0)).transpose()?;
        let scene = posed.as_ref().unwrap_or(scene);
        in_pool(options.threads, || {
            let threads = rayon::current_num_threads();
            let mut builder = IntersectorBuilder::new(options.backend, options.precision, threads)
                .with_quality(quality(scene, options));
            let start = Instant::now();
            let intersector = builder.build(scene)?;
            let built = BuildRecord::new(start, &builder, builder.stats());
            Ok(render_scene(scene, options, &*intersector, built, &*self.progress))
        })
    }

    /// Renders the scene at each of several times, in seconds, and hands each picture to `each`
    /// with its index before the next is begun. The intersector is updated only for what moves.
    ///
    /// The progress callback is told the share of the whole that is done.
    ///
    /// # Errors
    /// When the scene is not valid at one of the times, as for [`render`](Renderer::render), and
    /// the errors of `each`; nothing after that is rendered.
    pub fn render_frames(
        &self,
        times: &[f64],
        mut each: impl FnMut(usize, Rendering) -> Result<()> + Send,
    ) -> Result<()> {
        let (scene, options) = (&*self.scene, &self.options);
        scene.check()?;
        check_camera(scene, options.camera)?;
        in_pool(options.threads, || {
            let (backend, precision) = (options.backend, options.precision);
            let threads = rayon::current_num_threads();
            let moves = scene.animation.as_ref().is_some_and(|a| a.moves_geometry());
            let builder = if moves {
                let bounds = scene.bounds_over_time();
                IntersectorBuilder::for_frames(backend, precision, threads, bounds)
            } else {
                IntersectorBuilder::new(backend, precision, threads)
            };
            let mut builder = builder.with_quality(quality(scene, options));
            // One intersector serves all frames if only lights and cameras move.
            let mut shared: Option<Box<dyn Intersector + '_>> = None;
            let mut poses = PosedScene::new(scene);
            for (i, &time) in times.iter().enumerate() {
                // Pose the scene, and check what moved.
                poses.pose(time)?;
                if scene.animation.is_some() {
                    poses
                        .check()
                        .map_err(|e| e.help(format!("at {time:.3} s of its animation")))?;
                }
                let posed = poses.scene();
                let share = |of_frame: f32| {
                    (self.progress)((i as f32 + of_frame) / times.len() as f32);
                };
                // Build or update the intersector, and render.
                let start = Instant::now();
                let before = builder.stats();
                let rendering = if moves {
                    let intersector = builder.build(posed)?;
                    let built = BuildRecord::new(start, &builder, builder.stats() - before);
                    render_scene(posed, options, &*intersector, built, &share)
                } else if let Some(intersector) = &shared {
                    let reused = BuildStats::reused(before.meshes_built);
                    let built = BuildRecord::new(start, &builder, reused);
                    render_scene(posed, options, &**intersector, built, &share)
                } else {
                    let intersector = shared.insert(builder.build(scene)?);
                    let built = BuildRecord::new(start, &builder, builder.stats());
                    render_scene(posed, options, &**intersector, built, &share)
                };
                each(i, rendering)?;
            }
            Ok(())
        })
    }

    /// Renders the scene, which must be valid, with an intersector that was built for it, on the current
    /// rayon pool. An animated scene is rendered as it is stored, without a pose.
    ///
    /// # Panics
    /// When the scene has no such camera.
    pub fn render_with(&self, intersector: &dyn Intersector) -> Traced {
        trace(&self.scene, &self.options, intersector, &*self.progress)
    }
}

impl std::fmt::Debug for Renderer<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Renderer").field("options", &self.options).finish_non_exhaustive()
    }
}

/// A film that was traced, with its counts and the time from the first ray to the last pixel.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Traced {
    /// The picture.
    pub film: Film,
    /// Rays and other counts.
    pub counts: Counts,
    /// The time from the first ray to the last pixel.
    pub duration: Duration,
}

/// The build of an intersector: quality, counts and time.
struct BuildRecord {
    quality: Option<BuildQuality>,
    stats: BuildStats,
    duration: Duration,
}

impl BuildRecord {
    fn new(start: Instant, builder: &IntersectorBuilder, stats: BuildStats) -> Self {
        Self { quality: builder.quality(), stats, duration: start.elapsed() }
    }
}

/// Chooses the quality of a scene's trees, unless the options set it, by the number of its primary rays
/// and their shadow rays. All frames of an animation count, also when only some are rendered: a frame
/// must not depend on which others are.
fn quality(scene: &Scene, options: &RenderOptions) -> BuildQuality {
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

/// Renders a checked scene with an intersector that is built, and assembles the statistics.
fn render_scene(
    scene: &Scene,
    options: &RenderOptions,
    intersector: &dyn Intersector,
    build: BuildRecord,
    progress: &Progress<'_>,
) -> Rendering {
    let Traced { film, counts, duration } = trace(scene, options, intersector, progress);
    let statistics = Statistics {
        backend: intersector.name(),
        backend_version: intersector.version(),
        precision: options.precision,
        quality: build.quality,
        threads: rayon::current_num_threads(),
        counts,
        built: build.stats,
        build: build.duration,
        render: duration,
    };
    Rendering { film, settings: write::Settings::from_film(&scene.film), statistics }
}

/// Traces a checked scene with an intersector that is built, on the current rayon pool.
///
/// # Panics
/// When the scene has no such camera.
fn trace(
    scene: &Scene,
    options: &RenderOptions,
    intersector: &dyn Intersector,
    progress: &Progress<'_>,
) -> Traced {
    let size = scene.film.size;
    let mut film = Film::new(size, options.view);
    let camera = &scene.cameras[options.camera];
    let RenderOptions { view, tiling, .. } = *options;
    let integrator = Integrator::new(scene, intersector, camera, view, tiling);

    // Threads share strips of whole rows.
    let rows = tiling.rows;
    let strip = size[0] as usize * rows;
    let strips = film.pixels.len().div_ceil(strip);
    let passes = if integrator.is_adaptive() { 2 } else { 1 };
    let (counts, done) = (Mutex::new(Counts::default()), AtomicU64::new(0));
    let finish_strip = |of_strip: Counts| {
        // A poisoned lock still holds the counts; the panic that caused it is reported anyway.
        *counts.lock().unwrap_or_else(|e| e.into_inner()) += of_strip;
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress(done as f32 / (passes * strips) as f32);
    };

    // First pass: the samples that every pixel has, and a record of what they hit where more follow.
    let start = Instant::now();
    let recorded = if passes == 2 { film.pixels.len() } else { 0 };
    let mut records = vec![PixelRecord::default(); recorded];
    let mut record_strips: Vec<&mut [PixelRecord]> = records.chunks_mut(strip).collect();
    record_strips.resize_with(strips, Default::default);
    let first_pass = film.pixels.par_chunks_mut(strip).zip(record_strips).enumerate();
    first_pass.for_each_init(Scratch::default, |scratch, (i, (pixels, records))| {
        finish_strip(integrator.render_strip(i * rows, pixels, records, scratch));
    });

    // Second pass: more samples for the pixels that disagree with themselves or their neighbours.
    if passes == 2 {
        let refined = integrator.pixels_to_refine(&film.pixels, &records);
        let pixels = film.pixels.par_chunks_mut(strip).enumerate();
        let parts = pixels.zip(records.par_chunks(strip).zip(refined.par_chunks(strip)));
        parts.for_each_init(Scratch::default, |scratch, ((i, pixels), (records, refined))| {
            let strip = RefineStrip { first_row: i * rows, pixels, records, refined };
            finish_strip(integrator.refine_strip(strip, scratch));
        });
    }
    let counts = counts.into_inner().unwrap_or_else(|e| e.into_inner());
    Traced { film, counts, duration: start.elapsed() }
}

/// Runs `work` on `threads` threads; 0 means all there are. The current rayon pool is used if it has
/// as many, and a new pool otherwise.
///
/// # Errors
/// When the threads cannot be started, and the errors of `work`.
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
/// When it does not.
pub fn check_camera(scene: &Scene, index: usize) -> Result<()> {
    if index < scene.cameras.len() {
        return Ok(());
    }
    Err(Error::input(format!("there is no camera {index}; the scene has {}", scene.cameras.len())))
}
