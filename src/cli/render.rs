//! `envers render`.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::cli::args::Render;
use crate::cli::frames::Plan;
use crate::cli::json::Stats;
use crate::cli::load::Input;
use crate::cli::values::{SampleRange, ViewName};
use crate::cli::{Outcome, Verdict, files, output, report};
use crate::error::{Error, Result};
use crate::film::View;
use crate::integrator::NotFinite;
use crate::intersect::{Backend, Precision};
use crate::load;
use crate::render::{RenderOptions, Renderer, Rendering, Statistics};
use crate::scene::animation::PosedScene;
use crate::scene::{AdaptiveSampling, FilmSettings, Scene, Tone};
use crate::write::{self, Format, Movie, Settings};

pub fn run(arguments: &Render) -> Outcome {
    let start = Instant::now();
    let outputs = outputs(arguments)?;
    let backend = match arguments.backend {
        Some(name) => name.backend()?,
        None => Default::default(),
    };
    output::check_json(arguments.stats.as_ref())?;
    let Input { mut scene, report: loaded, camera } = arguments.tracing.load_animated()?;
    if arguments.ground {
        load::add_ground(&mut scene);
    }
    set_samples(&mut scene.film, arguments)?;
    scene.film.exposure = arguments.exposure.unwrap_or(scene.film.exposure);
    scene.film.tone = arguments.tone.map_or(scene.film.tone, Tone::from);
    let plan = Plan::new(arguments, &scene, outputs)?;
    let first = first(&scene, &plan).map_err(|e| e.at(&arguments.tracing.scene))?;
    let load_time = start.elapsed();

    let view = View::from(arguments.view);
    let threads = arguments.tracing.threads();
    let precision = arguments.tracing.precision.into();
    let quality = arguments.bvh.quality();
    let options =
        RenderOptions { backend, precision, quality, threads, camera, view, ..Default::default() };
    let progress = report::progress_bar(arguments.tracing.quiet);
    let settings = Settings {
        half: arguments.half,
        metadata: metadata(&scene, camera, view, precision),
        ..Settings::from_film(&scene.film)
    };
    let mut sink = Sink::new(&plan, settings, &options, scene.film.size)?;
    let times: Vec<f64> = plan.frames.iter().map(|(_, time)| *time).collect();
    let step = |share: f32| progress.set_position((share * 1000.0) as u64);
    Renderer::new(&scene)
        .options(options)
        .on_progress(step)
        .render_frames(&times, |i, frame| sink.take(i, frame))
        .map_err(|e| e.at(&arguments.tracing.scene))?;
    progress.finish_and_clear();
    let done = sink.finish()?;

    let mut warnings = loaded.warnings.clone();
    let f32_rays = backend != Backend::Rust && precision == Precision::Fast;
    warnings.extend(report::precision_warnings(&first, f32_rays));
    warnings.extend(oddities(&first, camera, view, &done));
    if !arguments.tracing.quiet {
        warnings.iter().for_each(|w| report::warning(w));
    }
    let total = start.elapsed();
    if !arguments.tracing.quiet && output::stdout_is_free(arguments.stats.as_ref()) {
        output::print(&plan.summary(total.as_secs_f64()))?;
    }
    if let Some(path) = &arguments.stats {
        let seconds = [load_time, done.write, total].map(|d| d.as_secs_f64());
        let (statistics, layers) = (&done.statistics, done.layers);
        let stats = Stats::new(&first, times.len(), &loaded, statistics, layers, seconds, warnings);
        output::write_json(path, &stats)?;
    }
    Ok(Verdict::Good)
}

/// Applies the flags that say how many samples pixels have.
fn set_samples(film: &mut FilmSettings, arguments: &Render) -> Result<()> {
    if arguments.view != ViewName::Beauty {
        (film.spp, film.adaptive) = (1, None);
    }
    if let Some(SampleRange { min, max }) = arguments.adaptive {
        let threshold =
            film.adaptive.map_or(AdaptiveSampling::THRESHOLD, |adaptive| adaptive.threshold);
        (film.spp, film.adaptive) = (min, Some(AdaptiveSampling { max, threshold }));
    }
    match (arguments.threshold, &mut film.adaptive) {
        (Some(threshold), Some(adaptive)) => adaptive.threshold = threshold,
        (Some(_), None) => {
            return Err(Error::input("--threshold is about adaptive samples, and there are none")
                .help("add `--adaptive 1..25`, or leave --threshold out"));
        }
        _ => {}
    }
    Ok(())
}

/// The first frame's scene. Each frame is posed, and its files are looked at, before any is rendered;
/// what only a check of its numbers finds, such as a way out of bounds, is found in its turn.
fn first(scene: &Scene, plan: &Plan) -> Result<Scene> {
    let mut poses = PosedScene::new(scene);
    for (i, (frame, time)) in plan.frames.iter().enumerate() {
        poses.pose(*time)?;
        let files: Vec<PathBuf> = plan.files(*frame).collect();
        files::check_not_a_texture(scene, &files)?;
        if i == 0 {
            files.iter().try_for_each(|path| write::check(path))?;
        }
    }
    files::check_not_a_texture(scene, &plan.movies)?;
    poses.pose(plan.frames.first().map_or(0.0, |(_, time)| *time))?;
    Ok(poses.into_scene())
}

/// Where the frames go.
struct Sink<'a> {
    plan: &'a Plan,
    settings: Settings,
    movies: Vec<Movie>,
    done: Done,
}

/// What all frames took, and what they show.
struct Done {
    statistics: Statistics,
    write: Duration,
    /// How many pictures were encoded.
    layers: u64,
    /// Whether there is nothing but black in any frame.
    is_black: bool,
}

impl<'a> Sink<'a> {
    fn new(
        plan: &'a Plan,
        settings: Settings,
        options: &RenderOptions,
        size: [u32; 2],
    ) -> Result<Self> {
        let frames = plan.frames.len() as u32;
        let movie = |path: &PathBuf| Movie::create(path, size, frames, plan.fps);
        let movies = plan.movies.iter().map(movie).collect::<Result<_>>()?;
        let statistics = Statistics::zero(options);
        let done = Done { statistics, write: Duration::ZERO, layers: 0, is_black: true };
        Ok(Self { plan, settings, movies, done })
    }

    /// Writes a frame.
    fn take(&mut self, index: usize, rendering: Rendering) -> Result<()> {
        let start = Instant::now();
        let (frame, time) = self.plan.frames[index];
        let mut settings = self.settings.clone();
        if frame.is_some() {
            settings.metadata.push(("time".to_owned(), format!("{time} s")));
        }
        for path in self.plan.files(frame) {
            write::write(&rendering.film, &path, &settings)?;
            self.done.layers += 1;
        }
        for movie in &mut self.movies {
            movie.push(&rendering.film, &settings)?;
            self.done.layers += 1;
        }
        let dark = 0.5 / 255.0 / self.settings.exposure.exp2();
        let is_dark = |pixel: &[f32; 3]| pixel.iter().all(|&x| f64::from(x) <= dark);
        self.done.is_black &= rendering.film.pixels.iter().all(is_dark);
        self.done.statistics.add(&rendering.statistics);
        self.done.write += start.elapsed();
        Ok(())
    }

    fn finish(mut self) -> Result<Done> {
        let start = Instant::now();
        self.movies.into_iter().try_for_each(Movie::finish)?;
        self.done.write += start.elapsed();
        Ok(self.done)
    }
}

/// The output files, checked: named, distinct, of a known format, and writable.
fn outputs(arguments: &Render) -> Result<Vec<PathBuf>> {
    let mut outputs = arguments.output.clone();
    if outputs.is_empty() {
        let name = arguments.tracing.scene.file_stem().unwrap_or("out".as_ref());
        let mut name = PathBuf::from(name);
        name.as_mut_os_string().push(".png");
        outputs.push(name);
    }
    for (i, path) in outputs.iter().enumerate() {
        write::check(path)?;
        if outputs[..i].iter().any(|other| files::same(other, path)) {
            return Err(Error::input("this output is named twice").at(path).help("name it once"));
        }
    }
    let formats = outputs.iter().map(|path| Format::from_path(path)).collect::<Result<Vec<_>>>()?;
    if arguments.half && !formats.contains(&Format::Exr) {
        return Err(Error::input("--half is about EXR, and no .exr is asked for")
            .help("add `-o NAME.exr`, or leave --half out"));
    }
    let shown =
        [("--exposure", arguments.exposure.is_some()), ("--tone", arguments.tone.is_some())];
    if let Some((flag, _)) = shown.iter().find(|(_, given)| *given)
        && formats.iter().all(|&format| format == Format::Exr)
    {
        return Err(Error::input(format!("{flag} is about PNG, and no .png is asked for"))
            .help("an EXR always holds the radiance itself"));
    }
    if arguments.view != ViewName::Beauty {
        let [exposure, tone] = shown;
        let flags = [
            exposure,
            tone,
            ("--half", arguments.half),
            ("--spp", arguments.tracing.spp.is_some()),
            ("--adaptive", arguments.adaptive.is_some()),
            ("--threshold", arguments.threshold.is_some()),
            ("--max-depth", arguments.tracing.max_depth.is_some()),
        ];
        if let Some((flag, _)) = flags.iter().find(|(_, given)| *given) {
            return Err(Error::input(format!("{flag} says nothing to a view other than beauty"))
                .help(format!("leave {flag} out: a view has one sample, 32 bits, raw values")));
        }
    }
    Ok(outputs)
}

/// What in a picture is probably not what was meant, with the likely cause.
fn oddities(scene: &Scene, camera: usize, view: View, done: &Done) -> Vec<String> {
    let counts = &done.statistics.counts;
    let mut found = Vec::new();
    found.extend(not_finite(&counts.not_finite));
    if counts.rays.primary == 0 {
        // Every frame was there already.
    } else if counts.hits == 0 {
        let bounds = scene.bounds();
        found.push(if bounds.is_empty() && scene.planes.is_empty() {
            "the picture is empty: nothing stands in the scene".to_owned()
        } else {
            format!(
                "the picture is empty: the camera at {} sees none of the scene, which is about {}",
                scene.cameras[camera].position,
                bounds.center()
            )
        });
    } else if view == View::Beauty {
        let emits = scene.materials.iter().any(|m| m.emission != glam::Vec3::ZERO);
        if scene.lights.is_empty() && !emits {
            found.push(
                "the scene has no light: what is hit stays black (add a [[light]], or `emission` \
                 to a material)"
                    .to_owned(),
            );
        } else if done.is_black {
            found.push(
                "the picture is wholly black: the lights may be behind the surfaces, in their \
                 shadow, or too weak at this distance (try `--exposure 4`)"
                    .to_owned(),
            );
        }
    }
    found
}

/// Says of samples that are not finite how many they are and, for each cause, what helps.
fn not_finite(counts: &NotFinite) -> impl Iterator<Item = String> {
    let NotFinite { light, surface, sum } = *counts;
    [
        (
            light,
            "the light that reaches a surface is not finite: a light with \
             `falloff = \"inverse_square\"` stands on it or very near it",
        ),
        (
            surface,
            "a surface's colour or position is not finite: its material times its vertex colours \
             is beyond f32, or it is met too far out on a plane",
        ),
        (
            sum,
            "finite terms multiply or add up to more than f32 holds: lower the intensity of the \
             lights, or what the materials reflect and emit",
        ),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, why)| format!("{count} samples were left out of the picture, because {why}"))
}

/// What determines the picture; never the time, the host, the threads or the backend.
fn metadata(
    scene: &Scene,
    camera: usize,
    view: View,
    precision: Precision,
) -> Vec<(String, String)> {
    let [width, height] = scene.film.size;
    let mut entries = vec![
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("size", format!("{width}x{height}")),
        ("spp", scene.film.spp.to_string()),
    ];
    if let Some(AdaptiveSampling { max, threshold }) = scene.film.adaptive {
        entries.push(("adaptive", format!("{}..{max}", scene.film.spp)));
        entries.push(("threshold", threshold.to_string()));
    }
    entries.extend([
        ("max_depth", scene.film.max_depth.to_string()),
        ("cutoff", scene.film.cutoff.to_string()),
        ("camera", format!("{camera} {}", scene.cameras[camera].name).trim().to_owned()),
        ("view", format!("{view:?}").to_lowercase()),
        ("precision", precision.name().to_owned()),
        ("png_exposure", scene.film.exposure.to_string()),
        ("png_tone", format!("{:?}", scene.film.tone).to_lowercase()),
        ("png_transfer", format!("{:?}", scene.film.transfer).to_lowercase()),
    ]);
    entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}
