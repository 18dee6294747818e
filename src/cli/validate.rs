//! The subcommand `envers validate`.

use std::path::Path;
use std::process::ExitCode;

use serde::Serialize;

use crate::cli::paths::{self, InputFiles};
use crate::cli::{args::Validate, check_status, messages, output, scene_args::SceneInput};
use crate::error::Result;
use crate::intersect::Precision;
use crate::measure::{self, Validation};

/// The result of a validation: `validate --json`.
#[derive(Serialize)]
struct ValidationResult<'a> {
    #[serde(flatten)]
    validation: &'a Validation,
    /// The command that traces the worst ray again; null if there is no such ray.
    replay: Option<String>,
    warnings: &'a [String],
}

pub fn run(arguments: &Validate) -> Result<ExitCode> {
    // Check the outputs, and load the scene; a single ray is another command in all but name.
    output::check_json(arguments.json.as_ref())?;
    output::check_extension(arguments.heatmap.as_ref(), "png", "a heat map must be a PNG")?;
    let input = &arguments.trace.input;
    let options = input.options().provenance(arguments.ray.is_some());
    let SceneInput { scene, report, camera } = arguments.trace.load_with(&options)?;
    let outputs = [&arguments.json, &arguments.heatmap].into_iter().flatten();
    paths::check_outputs(outputs, &InputFiles::of_scene(&scene, &report))?;
    let scene = scene.at_time(0.0)?;
    if let Some(ray) = &arguments.ray {
        let replay = measure::replay(&scene, ray, Some(&input.scene))?;
        let text: String =
            replay.to_string().lines().map(|line| messages::line(line) + "\n").collect();
        output::report(arguments.json.as_ref(), &text, &replay)?;
        return Ok(ExitCode::SUCCESS);
    }

    // Warn of what the comparison may find for reasons of precision.
    let precision = arguments.trace.precision;
    let warnings = messages::scene_warnings(&report, &scene, precision == Precision::Fast);
    if !input.quiet {
        warnings.iter().for_each(|w| messages::warning(w));
    }

    // Compare, and report the result with the command that traces the worst ray again.
    let validation = measure::validate(&scene, precision, camera, input.threads())?;
    let worst = validation.worst.as_ref();
    let replay = worst.map(|worst| replay_command(&input.scene, &worst.ray));
    let mut text = format!("{validation}\n");
    if let Some((worst, replay)) = worst.zip(replay.as_ref()) {
        text += &format!("{worst}\n  {replay}\n");
    }
    let result = ValidationResult { validation: &validation, replay, warnings: &warnings };
    output::report(arguments.json.as_ref(), &text, &result)?;
    if let Some(path) = &arguments.heatmap {
        output::write_heatmap(path, &validation.heatmap)?;
    }
    Ok(check_status(validation.passed))
}

/// Returns the command that traces a ray again, quoted for a shell.
fn replay_command(scene: &Path, ray: &str) -> String {
    let scene = scene.display().to_string();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:@%".contains(c);
    let scene = if scene.chars().all(is_plain) {
        scene
    } else {
        format!("'{}'", scene.replace('\'', r"'\''"))
    };
    format!("envers validate {scene} --ray {ray}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn command_quotes_a_path_that_a_shell_would_split() {
        let of = |path| replay_command(Path::new(path), "-1,0,0,0,0,1");
        assert_eq!(of("a/b.toml"), "envers validate a/b.toml --ray -1,0,0,0,0,1");
        assert_eq!(of("it's a.glb"), r"envers validate 'it'\''s a.glb' --ray -1,0,0,0,0,1");
    }
}
