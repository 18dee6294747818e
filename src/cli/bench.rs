//! `envers bench`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;

use crate::cli::load::{Input, Loading, Tracing};
use crate::cli::values::{BackendName, PrecisionName, SampleRange, sample_range, size, wait};
use crate::cli::{Outcome, Verdict, output, report};
use crate::error::{Error, Result};
use crate::intersect::Precision;
use crate::measure::bench::{self, Options, Samples, Setup};
use crate::scene::Scene;
use crate::scene::check::MAX_SPP;
use crate::write;

/// The longer side of a quick picture, at most.
const QUICK_SIDE: u32 = 320;

#[derive(Args)]
#[command(after_help = "\
Every mode (backend, precision, quality of Embree's trees, samples per pixel) is run several times, in turns, and its picture held \
against a reference: certified, with many samples. The folder gets bench.json, bench.csv, \
time-vs-error.svg and report.html, one page that holds everything.

Examples:
  envers bench scene.toml --out out/bench
  envers bench scene.toml --out out/bench --spp 1,2,4,8,16,32 --reference-spp 256 --runs 15
  envers bench model.glb --out out/bench --quick")]
pub struct Bench {
    /// A scene file (.toml) or a model (.gltf, .glb, .obj)
    pub scene: PathBuf,
    /// Folder for the report; made if it is not there
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Fewer samples, fewer runs, and a picture of at most 320 pixels a side, unless they are given
    #[arg(long)]
    pub quick: bool,
    /// Size of the picture in pixels, such as 1920x1080 [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Samples per pixel, such as 1,4,16 [default: 1,4,16; quick 1,4]
    #[arg(long, value_name = "N,…", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SPP)), allow_negative_numbers = true)]
    pub spp: Vec<u32>,
    /// Adaptive samples per pixel, such as 1..25,4..36 [default: these; quick 1..9; only what the
    /// reference has as many of]
    #[arg(long, value_name = "MIN..MAX,…", value_delimiter = ',', value_parser = sample_range, allow_negative_numbers = true)]
    pub adaptive: Vec<SampleRange>,
    /// Samples per pixel of the reference [default: 64; quick 16]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SPP)), allow_negative_numbers = true)]
    pub reference_spp: Option<u32>,
    /// Runs of each mode [default: 5; quick 3]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000), allow_negative_numbers = true)]
    pub runs: Option<u32>,
    /// How long the runs of one mode may take together; a mode that is too slow has fewer runs, or
    /// none
    #[arg(long, value_name = "SECONDS", value_parser = wait, default_value = "60", allow_negative_numbers = true)]
    pub budget: Duration,
    /// Only this backend [default: all that are built in]
    #[arg(long, value_enum)]
    pub backend: Option<BackendName>,
    /// Camera, by name or by index from 0 [default: the first]
    #[arg(long, value_name = "NAME|INDEX")]
    pub camera: Option<String>,
    /// Threads [default: all there are]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true)]
    pub threads: Option<u16>,
    #[command(flatten)]
    pub loading: Loading,
    /// Print no progress and no warnings
    #[arg(short, long)]
    pub quiet: bool,
}

pub fn run(arguments: &Bench) -> Outcome {
    check_folder(&arguments.out)?;
    let tracing = tracing(arguments);
    let Input { mut scene, report: loaded, camera } = tracing.load()?;
    if arguments.quick && arguments.size.is_none() {
        scene.film.size = quick_size(scene.film.size);
    }
    let options = options(arguments, camera)?;
    let files = ["bench.json", "bench.csv", "time-vs-error.svg", "report.html"];
    let files = files.map(|name| arguments.out.join(name));
    std::fs::create_dir_all(&arguments.out).map_err(|e| Error::io("make", &arguments.out, &e))?;
    files.iter().try_for_each(|path| write::check_file(path))?;
    if !arguments.quiet {
        warnings(&scene, loaded.warnings, &options).iter().for_each(|w| report::warning(w));
    }

    let bar = report::progress_bar(arguments.quiet);
    let step = |share: f32| bar.set_position((share * 1000.0) as u64);
    let name = arguments.scene.file_name().unwrap_or_default().to_string_lossy();
    let found = bench::bench(&name, &scene, &options, &step);
    bar.finish_and_clear();
    let found = found.map_err(|e| e.at(&arguments.scene))?;
    let svg = bench::plot(&found)?;
    let page = bench::page(&found, &svg)?;
    let [json, csv, plot, html] = &files;
    output::write_json(json, &found)?;
    for (path, text) in [(csv, found.csv()), (plot, svg), (html, page)] {
        write::write_atomically(path, |out| out.write_all(text.as_bytes()))?;
    }
    output::print(&format!("{found}{}\n", html.display()))?;
    Ok(Verdict::Good)
}

/// Checks that the folder is one, or is not there yet.
fn check_folder(path: &Path) -> Result<()> {
    if path.exists() && !path.is_dir() {
        return Err(Error::input("this is a file, not a folder").at(path).help("name a folder"));
    }
    Ok(())
}

/// What loads the scene as the other commands do.
fn tracing(arguments: &Bench) -> Tracing {
    Tracing {
        scene: arguments.scene.clone(),
        size: arguments.size,
        spp: None,
        max_depth: None,
        camera: arguments.camera.clone(),
        time: None,
        precision: PrecisionName::Fast,
        threads: arguments.threads,
        loading: arguments.loading.clone(),
        strict: false,
        quiet: arguments.quiet,
    }
}

fn options(arguments: &Bench, camera: usize) -> Result<Options> {
    let (spp, adaptive, reference_spp, runs) = match arguments.quick {
        true => (&[1, 4][..], &[(1, 9)][..], 16, 3),
        false => (&[1, 4, 16][..], &[(1, 25), (4, 36)][..], 64, 5),
    };
    let reference_spp = arguments.reference_spp.unwrap_or(reference_spp);
    let mut spp = if arguments.spp.is_empty() { spp.to_vec() } else { arguments.spp.clone() };
    spp.sort_unstable();
    spp.dedup();
    let mut adaptive: Vec<(u32, u32)> = match arguments.adaptive.is_empty() {
        true => adaptive.iter().copied().filter(|&(_, max)| max <= reference_spp).collect(),
        false => arguments.adaptive.iter().map(|range| (range.min, range.max)).collect(),
    };
    adaptive.sort_unstable();
    adaptive.dedup();
    let regular = spp.into_iter().map(Samples::Regular);
    let adaptive = adaptive.into_iter().map(|(min, max)| Samples::Adaptive(min, max));
    let mut options = Options {
        samples: regular.chain(adaptive).collect(),
        reference_spp,
        runs: arguments.runs.unwrap_or(runs),
        budget: arguments.budget,
        threads: arguments.threads.map_or(0, usize::from),
        camera,
        setups: Setup::all(),
    };
    if let Some(name) = arguments.backend {
        let backend = name.backend()?;
        options.setups.retain(|setup| setup.backend == backend);
    }
    options.check()?;
    Ok(options)
}

/// As large as asked for, but no side longer than [`QUICK_SIDE`].
fn quick_size(size: [u32; 2]) -> [u32; 2] {
    let longer = size[0].max(size[1]);
    let scale = f64::from(QUICK_SIDE) / f64::from(longer.max(QUICK_SIDE));
    size.map(|side| (f64::from(side) * scale).round().max(1.0) as u32)
}

fn warnings(scene: &Scene, mut warnings: Vec<String>, options: &Options) -> Vec<String> {
    let f32_rays = options
        .setups
        .iter()
        .any(|setup| setup.backend.name() != "rust" && setup.precision == Precision::Fast);
    warnings.extend(report::precision_warnings(scene, f32_rays));
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quick_pictures_keep_their_shape_and_small_ones_their_size() {
        assert_eq!(quick_size([1000, 500]), [320, 160]);
        assert_eq!(quick_size([64, 48]), [64, 48]);
        assert_eq!(quick_size([1, 9000]), [1, 320]);
    }
}
