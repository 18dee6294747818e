//! The renderer: from a scene to a picture, with threads, progress and statistics.

mod options;
mod pool;
mod rendering;
mod stopwatch;
mod trace;

use std::borrow::Cow;

use crate::error::{Error, Result};
use crate::film::{Film, View};
use crate::intersect::{
    Backend, BuildQuality, BuildStats, Intersector, IntersectorBuilder, Precision,
};
use crate::scene::{Scene, animation::PosedScene};
use crate::write;

pub use options::RenderOptions;
pub use pool::in_pool;
pub use rendering::{Rendering, Statistics};
pub use stopwatch::{Elapsed, Stopwatch};
pub use trace::Traced;

use trace::{Progress, trace};

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

    /// Sets whether the background is transparent: see [`FilmSettings::transparent`](crate::scene::FilmSettings).
    pub fn transparent(mut self, transparent: bool) -> Self {
        self.scene.to_mut().film.transparent = transparent;
        self
    }

    /// Sets the backend that finds the hits.
    pub fn backend(mut self, backend: Backend) -> Self {
        self.options.backend = Some(backend);
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
        Film::check_memory(scene.film.size, scene.film.transparent)?;
        let posed = scene.animation.is_some().then(|| scene.at_time(0.0)).transpose()?;
        let scene = posed.as_ref().unwrap_or(scene);
        in_pool(options.threads, || {
            let threads = rayon::current_num_threads();
            let mut builder =
                IntersectorBuilder::new(options.backend(), options.precision, threads)
                    .with_quality(options.build_quality(scene));
            let stopwatch = Stopwatch::start();
            let intersector = builder.build(scene)?;
            let (quality, built) = (builder.quality(), (builder.stats(), stopwatch.elapsed()));
            Ok(render_scene(scene, options, &*intersector, quality, built, &*self.progress))
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
        Film::check_memory(scene.film.size, scene.film.transparent)?;
        in_pool(options.threads, || {
            let (backend, precision) = (options.backend(), options.precision);
            let threads = rayon::current_num_threads();
            let moves = scene.animation.as_ref().is_some_and(|a| a.moves_geometry());
            // Frames in which rays can hit something else share the trees of the meshes.
            let builder = if moves {
                let bounds = scene.bounds_over_time();
                IntersectorBuilder::for_frames(backend, precision, threads, bounds)
            } else {
                IntersectorBuilder::new(backend, precision, threads)
            };
            let mut builder = builder.with_quality(options.build_quality(scene));
            // One intersector serves all frames if only lights and cameras move.
            let mut shared: Option<Box<dyn Intersector + '_>> = None;
            let mut poses = PosedScene::new(scene);
            for (i, &time) in times.iter().enumerate() {
                // Pose the scene, and check what moved.
                poses.pose(time)?;
                if scene.animation.is_some() {
                    let help = || format!("at {time:.3} s of its animation");
                    poses.check().map_err(|e| e.help(help()))?;
                }
                let posed = poses.scene();
                let share = |of_frame: f32| {
                    (self.progress)((i as f32 + of_frame) / times.len() as f32);
                };
                // Build or update the intersector, unless the one that all frames share is there already.
                let (stopwatch, before) = (Stopwatch::start(), builder.stats());
                let own;
                let mut built = None;
                let intersector: &dyn Intersector = if moves {
                    own = builder.build(posed)?;
                    &*own
                } else if let Some(shared) = &shared {
                    built = Some(BuildStats::reused(before.meshes_built));
                    &**shared
                } else {
                    &**shared.insert(builder.build(scene)?)
                };
                let built = built.unwrap_or_else(|| builder.stats() - before);
                let (quality, built) = (builder.quality(), (built, stopwatch.elapsed()));
                // Render the frame.
                each(i, render_scene(posed, options, intersector, quality, built, &share))?;
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

/// Renders a checked scene with an intersector that is built, and assembles the statistics with those of
/// the build.
fn render_scene(
    scene: &Scene,
    options: &RenderOptions,
    intersector: &dyn Intersector,
    quality: Option<BuildQuality>,
    (built, build): (BuildStats, Elapsed),
    progress: &Progress<'_>,
) -> Rendering {
    let Traced { film, counts, elapsed } = trace(scene, options, intersector, progress);
    let statistics = Statistics {
        backend: intersector.name(),
        backend_version: intersector.version(),
        precision: options.precision,
        quality,
        threads: rayon::current_num_threads(),
        counts,
        built,
        build,
        render: elapsed,
    };
    Rendering { film, settings: write::Settings::from_film(&scene.film), statistics }
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
