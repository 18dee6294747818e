//! The subcommand `envers bench`.

use std::process::ExitCode;

use crate::cli::paths::{self, InputFiles};
use crate::cli::{args::Bench, flag_values::SampleRange, messages, output, scene_args::SceneInput};
use crate::error::{Error, Result};
use crate::intersect::{Backend, Precision};
use crate::measure::bench::{self, BenchOptions, Samples, Setup};
use crate::write;

/// The longest side of a quick picture in pixels.
const QUICK_SIDE: u32 = 320;

pub fn run(arguments: &Bench) -> Result<ExitCode> {
    // Check the folder, and load the scene as it is at the first frame.
    let out = &arguments.out;
    if out.exists() && !out.is_dir() {
        return Err(Error::input("this is a file, not a folder").at(out).help("name a folder"));
    }
    let input = &arguments.input;
    let SceneInput { scene, report, camera } = input.load(&input.options(), false)?;
    let mut scene = scene.at_time(0.0)?;
    if arguments.quick && input.size.is_none() {
        scene.film.size = quick_size(scene.film.size);
    }
    let options = options(arguments, camera)?;

    // Make the folder, and check that all files of the report can be written.
    let files = ["bench.json", "bench.csv", "time-vs-error.svg", "report.html"];
    let files = files.map(|name| out.join(name));
    std::fs::create_dir_all(out).map_err(|e| Error::writing(out, &e))?;
    write::check_files(&files)?;
    paths::check_outputs(&files, &InputFiles::of_scene(&scene, &report))?;
    // Warn of lost precision, and of meshes that coincide if any mode has f32 rays.
    if !input.quiet {
        let has_f32_rays =
            |setup: &Setup| setup.backend != Backend::Rust && setup.precision == Precision::Fast;
        let has_f32_rays = options.setups.iter().any(has_f32_rays);
        let warnings = messages::scene_warnings(&report, &scene, has_f32_rays);
        warnings.iter().for_each(|w| messages::warning(w));
    }

    // Run the modes.
    let bar = messages::progress_bar(input.quiet);
    let name = input.scene.file_name().unwrap_or_default().to_string_lossy();
    let progress = |share| messages::set_progress(&bar, share);
    let results = bench::run(&name, &scene, &options, &progress);
    bar.finish_and_clear();
    let results = results.map_err(|e| e.at(&input.scene))?;

    // Write the report.
    let svg = bench::plot(&results)?;
    let page = bench::html(&results, &svg)?;
    let [json, csv, plot, html] = &files;
    output::write_json(json, &results)?;
    for (path, text) in [(csv, results.csv()), (plot, svg), (html, page)] {
        write::write_atomically(path, |out| out.write_all(text.as_bytes()))?;
    }
    output::print(&format!("{results}{}\n", html.display()))?;
    Ok(ExitCode::SUCCESS)
}

/// Returns the options of the benchmark.
///
/// # Errors
/// When they are inconsistent.
fn options(arguments: &Bench, camera: usize) -> Result<BenchOptions> {
    // The defaults, and the flags for everything but samples and backends.
    let mut options = if arguments.quick { BenchOptions::quick() } else { BenchOptions::default() };
    let reference_spp = arguments.reference_spp.unwrap_or(options.reference_spp);
    options.runs = arguments.runs.unwrap_or(options.runs);
    (options.budget, options.threads) = (arguments.budget, arguments.input.threads());
    (options.reference_spp, options.camera) = (reference_spp, camera);

    // The samples of the flags, or the default ones that the reference has as many of.
    let Bench { spp, adaptive, .. } = arguments;
    let adaptive_samples = |&SampleRange { min, max }: &_| Samples::Adaptive { min, max };
    let samples = &mut options.samples;
    samples.retain(|samples| match samples {
        Samples::Regular(_) => spp.is_empty(),
        Samples::Adaptive { max, .. } => adaptive.is_empty() && *max <= reference_spp,
    });
    samples.extend(spp.iter().copied().map(Samples::Regular));
    samples.extend(adaptive.iter().map(adaptive_samples));
    samples.sort_unstable();
    samples.dedup();

    // The setups of one backend, or of all.
    if let Some(backend) = arguments.backend {
        backend.check()?;
        options.setups.retain(|setup| setup.backend == backend);
    }
    options.check()?;
    Ok(options)
}

/// Returns a size of the same proportions, with no side longer than [`QUICK_SIDE`].
fn quick_size(size: [u32; 2]) -> [u32; 2] {
    let longer = size[0].max(size[1]);
    let scale = f64::from(QUICK_SIDE) / f64::from(longer.max(QUICK_SIDE));
    size.map(|side| (f64::from(side) * scale).round().max(1.0) as u32)
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
