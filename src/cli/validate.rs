//! `envers validate`.

use crate::cli::args::Validate;
use crate::cli::{Outcome, Verdict, files, output, report};
use crate::measure;
use crate::scene::Transfer;
use crate::write::{self, Settings};

pub fn run(arguments: &Validate) -> Outcome {
    output::check_json(arguments.json.as_ref())?;
    output::check_png(arguments.heatmap.as_ref())?;
    let (scene, camera) = arguments.tracing.load()?;
    files::check_not_a_texture(&scene, &arguments.heatmap)?;
    if !arguments.tracing.quiet {
        scene.warnings.iter().for_each(|w| report::warning(w));
    }
    let found = measure::validate(&scene, camera, arguments.tracing.threads())?;
    if output::stdout_is_free(arguments.json.as_ref()) {
        output::print(&format!("{found}\n"))?;
    }
    if let Some(path) = &arguments.json {
        output::write_json(path, &found)?;
    }
    if let Some(path) = &arguments.heatmap {
        let settings = Settings { transfer: Transfer::None, ..Settings::default() };
        write::write(&found.heatmap, path, &settings)?;
    }
    Ok(if found.passed { Verdict::Good } else { Verdict::Bad })
}
