//! The checks before a rendering: of its outputs, and of whether there is anything to render.

use std::path::PathBuf;

use crate::cli::args::Render;
use crate::cli::render_plan::RenderPlan;
use crate::cli::render_stats::Geometry;
use crate::cli::{load_report, paths};
use crate::error::{Error, Result};
use crate::film::View;
use crate::load::LoadReport;
use crate::scene::{Scene, animation::PosedScene};
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
    // All of them distinct, writable, and of a format that the flags apply to.
    for (i, path) in outputs.iter().enumerate() {
        write::check(path)?;
        if outputs[..i].iter().any(|other| paths::is_same(other, path)) {
            return Err(Error::input("this output is given twice").at(path).help("give it once"));
        }
    }
    let formats = outputs.iter().map(|path| Format::from_path(path)).collect::<Result<Vec<_>>>()?;
    check_format_flags(arguments, &formats)?;
    Ok(outputs)
}

/// Checks that flags for one format, or for the beauty view, have an effect.
fn check_format_flags(arguments: &Render, formats: &[Format]) -> Result<()> {
    let has_exr = formats.contains(&Format::Exr);
    let has_other = formats.iter().any(|&format| format != Format::Exr);
    let is_beauty = arguments.view == View::Beauty;
    let for_exr = "applies to EXR, and no output is an .exr";
    let not_for_exr = "does not apply to EXR, which stores the radiance itself";
    let for_beauty = "applies to the beauty view only: other views are one sample of raw values";
    let Render { half, exposure, tone, adaptive, threshold, .. } = arguments;
    // Each flag, whether it is given, whether it has an effect, and why it has none otherwise.
    let flags = [
        ("--half", *half, has_exr, for_exr),
        ("--exposure", exposure.is_some(), has_other, not_for_exr),
        ("--tone", tone.is_some(), has_other, not_for_exr),
        ("--exposure", exposure.is_some(), is_beauty, for_beauty),
        ("--tone", tone.is_some(), is_beauty, for_beauty),
        ("--half", *half, is_beauty, for_beauty),
        ("--spp", arguments.trace.spp.is_some(), is_beauty, for_beauty),
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

/// Poses every frame and checks its files before any frame is rendered. Returns the scene of the
/// first frame. Numbers that are out of bounds in a pose are only found when it is rendered.
pub fn check_frames(scene: &Scene, plan: &RenderPlan) -> Result<Scene> {
    let mut poses = PosedScene::new(scene);
    for (i, frame) in plan.frames.iter().enumerate() {
        poses.pose(frame.time)?;
        let files: Vec<PathBuf> = plan.files(frame.number).collect();
        paths::check_not_a_texture(scene, &files)?;
        if i == 0 {
            files.iter().try_for_each(|path| write::check(path))?;
        }
    }
    paths::check_not_a_texture(scene, &plan.movies)?;
    poses.pose(plan.frames.first().map_or(0.0, |frame| frame.time))?;
    Ok(poses.into_scene())
}

/// True if no frame of a rendering has anything that a ray can hit.
///
/// # Errors
/// When a frame cannot be posed.
pub fn is_empty(scene: &Scene, plan: &RenderPlan) -> Result<bool> {
    let mut poses = PosedScene::new(scene);
    for frame in &plan.frames {
        if !Geometry::new(poses.pose(frame.time)?).is_empty() {
            return Ok(false);
        }
    }
    // Nothing is missing where no frame is to be rendered.
    Ok(!plan.frames.is_empty())
}

/// Returns the error that a scene has nothing that a ray can hit, with what its files have lost.
pub fn nothing_to_render(report: &LoadReport) -> Error {
    Error::failed("there is nothing in the scene that a ray can hit, so the image would be empty")
        .listing(load_report::losses(report))
        .help("add a sphere, a plane or a model with faces; for an image of the background alone, `--allow-empty`")
}
