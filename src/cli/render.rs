//! The subcommand `envers render`.

use std::path::PathBuf;
use std::process::ExitCode;

use crate::cli::args::Render;
use crate::cli::flag_values::SampleRange;
use crate::cli::paths::InputFiles;
use crate::cli::render_plan::RenderPlan;
use crate::cli::render_stats::{RenderStats, RenderTotals};
use crate::cli::scene_args::SceneInput;
use crate::cli::{messages, output, render_checks};
use crate::error::{Error, Result};
use crate::film::View;
use crate::integrator::{MAX_LAYERS, NotFinite};
use crate::intersect::{Backend, Precision};
use crate::load::add_ground;
use crate::render::{Elapsed, RenderOptions, Renderer, Rendering, Statistics, Stopwatch};
use crate::scene::{AdaptiveSampling, FilmSettings, Scene};
use crate::write::{self, Movie, Settings};

pub fn run(arguments: &Render) -> Result<ExitCode> {
    let stopwatch = Stopwatch::start();

    // Check the flags, then load the scene and apply them.
    let input = &arguments.trace.input;
    let outputs = render_checks::output_paths(arguments)?;
    let SceneInput { mut scene, report, camera } = arguments.trace.load()?;
    if arguments.ground {
        add_ground(&mut scene, input.up.unwrap_or_default().direction());
    }
    set_samples(&mut scene.film, arguments)?;
    // Debug views have no alpha.
    scene.film.transparent |= arguments.transparent;
    scene.film.transparent &= arguments.view == View::Beauty;
    scene.film.exposure = arguments.exposure.unwrap_or(scene.film.exposure);
    scene.film.tone = arguments.tone.unwrap_or(scene.film.tone);
    let plan = RenderPlan::new(arguments, &scene, outputs)?;
    render_checks::check_formats(&plan, &scene.film)?;
    render_checks::check_files(arguments, &plan, &InputFiles::of_scene(&scene, &report))?;
    let (first, is_empty) =
        render_checks::check_poses(&scene, &plan).map_err(|e| e.at(&input.scene))?;
    if is_empty && !arguments.allow_empty {
        return Err(render_checks::nothing_to_render(&report).at(&input.scene));
    }
    let load = stopwatch.elapsed();

    // Open the backend before anything is built for it. Warn of what the picture may suffer from.
    let backend = arguments.backend.unwrap_or_default();
    backend.check()?;
    let options = RenderOptions {
        backend: Some(backend),
        precision: arguments.trace.precision,
        quality: arguments.bvh,
        threads: input.threads(),
        camera,
        view: arguments.view,
        ..RenderOptions::default()
    };
    let has_f32_rays = backend != Backend::Rust && options.precision == Precision::Fast;
    let mut warnings = messages::scene_warnings(&report, &first, has_f32_rays);
    if arguments.backend.is_none() {
        warnings.extend(fallback_warning());
    }
    if !input.quiet {
        warnings.iter().for_each(|w| messages::warning(w));
    }

    // Render the frames, and write each when it is done.
    let bar = messages::progress_bar(input.quiet);
    let mut writer = FrameWriter::new(&plan, &scene, &options, arguments)?;
    let times: Vec<f64> = plan.frames.iter().map(|frame| frame.time).collect();
    Renderer::new(&scene)
        .options(options.clone())
        .on_progress(|share| messages::set_progress(&bar, share))
        .render_frames(&times, |i, frame| writer.write(i, frame))
        .map_err(|e| e.at(&input.scene))?;
    bar.finish_and_clear();
    let totals = writer.into_totals()?;

    // Report what the frames brought to light, the statistics and the summary.
    let before = warnings.len();
    warnings.extend(not_finite_warnings(&totals.statistics.counts.not_finite));
    warnings.extend(layers_warning(totals.statistics.counts.beyond_layers));
    warnings.extend(image_warning(&first, is_empty, &options, &totals));
    let total = stopwatch.elapsed();
    if !input.quiet {
        warnings.iter().skip(before).for_each(|w| messages::warning(w));
    }
    if let Some(path) = &arguments.stats {
        let stats = RenderStats::new(&first, &report, &totals, [load, total], warnings);
        output::write_json(path, &stats)?;
    }
    if !input.quiet && output::stdout_is_free(arguments.stats.as_ref()) {
        output::print(&plan.summary(total.wall.as_secs_f64()))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Applies the flags for the number of samples.
fn set_samples(film: &mut FilmSettings, arguments: &Render) -> Result<()> {
    if arguments.view != View::Beauty {
        (film.spp, film.adaptive) = (1, None);
    }
    // The flag sets the range, and leaves the threshold of the scene.
    if let Some(SampleRange { min, max }) = arguments.adaptive {
        let threshold =
            film.adaptive.map_or(AdaptiveSampling::THRESHOLD, |adaptive| adaptive.threshold);
        (film.spp, film.adaptive) = (min, Some(AdaptiveSampling { max, threshold }));
    }
    let Some(threshold) = arguments.threshold else { return Ok(()) };
    let adaptive = film.adaptive.as_mut().ok_or_else(|| {
        Error::input("--threshold needs adaptive sampling")
            .help("add `--adaptive 1..25`, or leave out --threshold")
    })?;
    adaptive.threshold = threshold;
    Ok(())
}

/// The writer of all frames.
struct FrameWriter<'a> {
    plan: &'a RenderPlan,
    settings: Settings,
    movies: Vec<Movie>,
    totals: RenderTotals,
}

impl<'a> FrameWriter<'a> {
    /// Creates the animated images.
    fn new(
        plan: &'a RenderPlan,
        scene: &Scene,
        options: &RenderOptions,
        arguments: &Render,
    ) -> Result<Self> {
        let frames = plan.frames.len();
        // The animated images, each of which is one file for all frames.
        let FilmSettings { size, transparent, .. } = scene.film;
        let movie =
            |path: &PathBuf| Movie::create(path, size, transparent, frames as u32, plan.fps);
        let totals = RenderTotals {
            statistics: Statistics::zero(options),
            frames,
            images: 0,
            is_black: true,
            write: Elapsed::default(),
        };
        let settings = Settings {
            half: arguments.half,
            quality: arguments.quality.unwrap_or(Settings::JPEG_QUALITY),
            metadata: metadata(scene, options),
            ..Settings::from_film(&scene.film)
        };
        let movies = plan.movies.iter().map(movie).collect::<Result<_>>()?;
        Ok(Self { plan, settings, movies, totals })
    }

    /// Writes a frame.
    fn write(&mut self, index: usize, rendering: Rendering) -> Result<()> {
        // The settings of this frame, whose time the metadata of an animation tells.
        let stopwatch = Stopwatch::start();
        let frame = self.plan.frames[index];
        let mut settings = self.settings.clone();
        if frame.number.is_some() {
            settings.metadata.push(("time".to_owned(), format!("{} s", frame.time)));
        }
        // The stills and the next picture of each animated image.
        for path in self.plan.files(frame.number) {
            write::write(&rendering.film, &path, &settings)?;
            self.totals.images += 1;
        }
        for movie in &mut self.movies {
            movie.push(&rendering.film, &settings)?;
            self.totals.images += 1;
        }
        // The sums over all frames. A picture is black if every byte of its PNG rounds to 0.
        let darkest = 0.5 / 255.0 / self.settings.exposure.exp2();
        let is_black = |pixel: &[f32; 3]| pixel.iter().all(|&x| f64::from(x) <= darkest);
        self.totals.is_black &= rendering.film.pixels.iter().all(is_black);
        self.totals.statistics.add(&rendering.statistics);
        self.totals.write += stopwatch.elapsed();
        Ok(())
    }

    /// Completes the animated images.
    fn into_totals(mut self) -> Result<RenderTotals> {
        let stopwatch = Stopwatch::start();
        self.movies.into_iter().try_for_each(Movie::finish)?;
        self.totals.write += stopwatch.elapsed();
        Ok(self.totals)
    }
}

/// Returns a warning if rays are traced in Rust because Embree, which is built in, cannot be opened.
fn fallback_warning() -> Option<String> {
    #[cfg(feature = "embree")]
    return Backend::Embree.check().err().map(|error| {
        format!("{}: rays are traced by the slower backend `rust` instead", error.message())
    });
    #[cfg(not(feature = "embree"))]
    None
}

/// Returns a warning if the image is empty or black, with the likely cause.
fn image_warning(
    scene: &Scene,
    is_empty: bool,
    options: &RenderOptions,
    totals: &RenderTotals,
) -> Option<String> {
    // Nothing was hit.
    let counts = &totals.statistics.counts;
    if counts.rays.primary == 0 {
        return None; // Every frame was skipped.
    }
    if counts.hits == 0 {
        if is_empty {
            return Some("the image is empty: there is nothing in the scene".to_owned());
        }
        let camera = scene.cameras[options.camera].position;
        let bounds = scene.bounds();
        if counts.work.culling > 0 {
            return Some(
                "the image is empty: all that the camera sees is the back of one-sided materials \
                 (`--double-sided` shows it)"
                    .to_owned(),
            );
        }
        let center = match bounds.is_empty() {
            true => String::new(),
            false => format!(", whose centre is {}", bounds.center()),
        };
        return Some(format!(
            "the image is empty: the camera at {camera} sees nothing of the scene{center}"
        ));
    }
    // Something was hit, and is black for want of light.
    if options.view != View::Beauty {
        return None;
    }
    let is_emissive = scene.materials.iter().any(|m| m.emission != glam::Vec3::ZERO);
    if scene.lights.is_empty() && !is_emissive {
        let no_light = "the scene has no light, so surfaces are black";
        return Some(format!("{no_light} (add a [[light]], or `emission` to a material)"));
    }
    let black = "the image is completely black: the lights may be behind the surfaces, in their \
                 shadow, or too weak at this distance (try `--exposure 4`)";
    totals.is_black.then(|| black.to_owned())
}

/// The causes of samples that are not finite (light, surface, sum), and what helps.
const NOT_FINITE_CAUSES: [&str; 3] = [
    "the light that reaches a surface is not finite: a light with `falloff = \"inverse_square\"` is on \
     it or very close to it",
    "a surface's colour or position is not finite: the product of its material and vertex colours is \
     beyond f32, or the hit is too far away on a plane",
    "finite values multiply or add up to more than f32 can store: lower the intensity of the lights, \
     or what the materials reflect and emit",
];

/// Returns a warning for each cause of samples that are not finite, with what helps.
fn not_finite_warnings(counts: &NotFinite) -> impl Iterator<Item = String> {
    let counts = [counts.light, counts.surface, counts.sum].into_iter().zip(NOT_FINITE_CAUSES);
    let found = counts.filter(|(count, _)| *count > 0);
    found.map(|(count, cause)| {
        format!("{count} samples were left out of the image, because {cause}")
    })
}

/// Returns a warning if rays were cut off behind too many layers.
fn layers_warning(count: u64) -> Option<String> {
    (count > 0).then(|| {
        format!(
            "{count} rays are black behind {MAX_LAYERS} transparent layers, the most that are shown one \
             behind the other"
        )
    })
}

/// Returns the image's metadata: all that determines it, and not the time, the host, the number of
/// threads or the backend.
fn metadata(scene: &Scene, options: &RenderOptions) -> Vec<(String, String)> {
    let [width, height] = scene.film.size;
    let camera = options.camera;
    let mut entries = vec![
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("size", format!("{width}x{height}")),
        ("spp", scene.film.spp.to_string()),
    ];
    // What only adaptive sampling depends on.
    if let Some(AdaptiveSampling { max, threshold }) = scene.film.adaptive {
        entries.push(("adaptive", format!("{}..{max}", scene.film.spp)));
        entries.push(("threshold", threshold.to_string()));
    }
    entries.extend([
        ("max_depth", scene.film.max_depth.to_string()),
        ("cutoff", scene.film.cutoff.to_string()),
    ]);
    // What is the rule is left out.
    if !scene.film.soft_terminator {
        entries.push(("soft_terminator", "false".to_owned()));
    }
    if scene.film.transparent {
        entries.push(("transparent", "true".to_owned()));
    }
    entries.extend([
        ("camera", format!("{camera} {}", scene.cameras[camera].name).trim().to_owned()),
        ("view", format!("{:?}", options.view).to_lowercase()),
        ("precision", options.precision.name().to_owned()),
        ("png_exposure", scene.film.exposure.to_string()),
        ("png_tone", scene.film.tone.name().to_owned()),
        ("png_transfer", format!("{:?}", scene.film.transfer).to_lowercase()),
    ]);
    entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}
