//! The checks before a rendering: of its outputs, and of whether there is anything to render.

use std::path::PathBuf;

use crate::cli::args::Render;
use crate::cli::paths::{self, InputFiles};
use crate::cli::render_plan::RenderPlan;
use crate::cli::render_stats::Geometry;
use crate::cli::{load_report, output};
use crate::error::{Error, Result};
use crate::film::View;
use crate::load::LoadReport;
use crate::scene::{FilmSettings, Scene, animation::PosedScene};
use crate::write::{self, Format};

/// Returns the output files, after checking that they are distinct, writable, and of formats to
/// which the other flags apply.
pub fn output_paths(arguments: &Render) -> Result<Vec<PathBuf>> {
    // Without -o, a PNG in the current folder that is called like the scene.
    let mut outputs = arguments.output.clone();
    if outputs.is_empty() {
        let stem = arguments.trace.input.scene.file_stem().unwrap_or("out".as_ref());
        let mut path = PathBuf::from(stem);
        path.as_mut_os_string().push(".png");
        outputs.push(path);
    }
    // All of them writable, and of a format that the flags apply to.
    outputs.iter().try_for_each(|path| write::check(path))?;
    output::check_json(arguments.stats.as_ref())?;
    let all = outputs.iter().chain(&arguments.stats);
    paths::check_outputs(all, &InputFiles::named(&[&arguments.trace.input.scene]))?;
    let formats = outputs.iter().map(|path| Format::from_path(path)).collect::<Result<Vec<_>>>()?;
    check_format_flags(arguments, &formats)?;
    Ok(outputs)
}

/// Checks that flags for one format, or for the beauty view, have an effect.
fn check_format_flags(arguments: &Render, formats: &[Format]) -> Result<()> {
    let has_exr = formats.contains(&Format::Exr);
    let has_other = formats.iter().any(|&format| format != Format::Exr);
    let is_beauty = arguments.view == View::Beauty;
    let has_jpeg = formats.contains(&Format::Jpeg);
    let for_jpeg = "applies to JPEG, and no output is a .jpg";
    let for_exr = "applies to EXR, and no output is an .exr";
    let not_for_exr = "does not apply to EXR, which stores the radiance itself";
    let for_beauty = "applies to the beauty view only: other views are one sample of raw values";
    let Render { half, quality, exposure, tone, adaptive, threshold, transparent, .. } = arguments;
    // Each flag, whether it is given, whether it has an effect, and why it has none otherwise.
    let flags = [
        ("--half", *half, has_exr, for_exr),
        ("--quality", quality.is_some(), has_jpeg, for_jpeg),
        ("--exposure", exposure.is_some(), has_other, not_for_exr),
        ("--tone", tone.is_some(), has_other, not_for_exr),
        ("--exposure", exposure.is_some(), is_beauty, for_beauty),
        ("--tone", tone.is_some(), is_beauty, for_beauty),
        ("--half", *half, is_beauty, for_beauty),
        ("--spp", arguments.trace.spp.is_some(), is_beauty, for_beauty),
        ("--transparent", *transparent, is_beauty, for_beauty),
        ("--adaptive", adaptive.is_some(), is_beauty, for_beauty),
        ("--threshold", threshold.is_some(), is_beauty, for_beauty),
        ("--max-depth", arguments.trace.max_depth.is_some(), is_beauty, for_beauty),
    ];
    match flags.into_iter().find(|&(_, is_given, applies, _)| is_given && !applies) {
        Some((flag, .., reason)) => {
            Err(Error::input(format!("{flag} {reason}")).help(format!("leave out {flag}")))
        }
        None => Ok(()),
    }
}

/// Checks that the formats of all outputs can have pictures of this size, and alpha if the film has any.
///
/// # Errors
/// When one cannot.
pub fn check_formats(plan: &RenderPlan, film: &FilmSettings) -> Result<()> {
    let mut outputs = plan.stills.iter().chain(&plan.movies);
    outputs.try_for_each(|path| {
        let format = Format::from_path(path)?;
        format.check_size(film.size, path)?;
        if film.transparent { format.check_alpha(path) } else { Ok(()) }
    })
}

/// Checks the files of all frames, and the others, before any frame is rendered.
///
/// # Errors
/// When one cannot be written, is an input, or is also the file of another frame.
pub fn check_files(arguments: &Render, plan: &RenderPlan, inputs: &InputFiles) -> Result<()> {
    let files = || plan.frames.iter().flat_map(|frame| plan.files(frame.number));
    write::check_files(files())?;
    let others = plan.movies.iter().chain(&arguments.stats).cloned();
    paths::check_outputs(files().chain(others), inputs)
}

/// Poses every frame before any is rendered. Returns the scene of the first frame, and whether no frame has
/// anything that a ray can hit. Numbers that are out of bounds in a pose are only found when it is rendered.
///
/// # Errors
/// When a frame cannot be posed.
pub fn check_poses(scene: &Scene, plan: &RenderPlan) -> Result<(Scene, bool)> {
    let mut poses = PosedScene::new(scene);
    // Nothing is missing where no frame is to be rendered.
    let mut is_empty = !plan.frames.is_empty();
    for frame in &plan.frames {
        is_empty &= Geometry::new(poses.pose(frame.time)?).is_empty();
    }
    poses.pose(plan.frames.first().map_or(0.0, |frame| frame.time))?;
    Ok((poses.into_scene(), is_empty))
}

/// Returns the error that a scene has nothing that a ray can hit, with what its files have lost.
pub fn nothing_to_render(report: &LoadReport) -> Error {
    Error::failed("there is nothing in the scene that a ray can hit, so the image would be empty")
        .listing(load_report::losses(report))
        .help("add a sphere, a plane or a model with faces; for an image of the background alone, `--allow-empty`")
}
