//! `envers validate`.

use std::path::Path;

use serde::Serialize;

use crate::cli::args::Validate;
use crate::cli::load::Input;
use crate::cli::{Outcome, Verdict, files, output, report};
use crate::geometry::Ray;
use crate::intersect::Precision;
use crate::measure::{self, Validation};
use crate::scene::{Scene, Transfer};
use crate::write::{self, Settings};

/// `validate --json`.
#[derive(Serialize)]
struct Outcomes<'a> {
    #[serde(flatten)]
    found: &'a Validation,
    /// The command that traces the worst ray again; null where there is none.
    replay: Option<String>,
    warnings: &'a [String],
}

pub fn run(arguments: &Validate) -> Outcome {
    output::check_json(arguments.json.as_ref())?;
    output::check_png(arguments.heatmap.as_ref())?;
    let Input { scene, report: loaded, camera } = arguments.tracing.load()?;
    if let Some(ray) = &arguments.ray {
        return replay(arguments, &scene, ray);
    }
    files::check_not_a_texture(&scene, &arguments.heatmap)?;
    let precision = Precision::from(arguments.tracing.precision);
    let mut warnings = loaded.warnings.clone();
    warnings.extend(report::precision_warnings(&scene, precision == Precision::Fast));
    if !arguments.tracing.quiet {
        warnings.iter().for_each(|w| report::warning(w));
    }
    let found = measure::validate(&scene, precision, camera, arguments.tracing.threads())?;
    let again = found.worst.as_ref().map(|w| command(&arguments.tracing.scene, &w.ray));
    if output::stdout_is_free(arguments.json.as_ref()) {
        let mut text = format!("{found}\n");
        if let Some((worst, again)) = found.worst.as_ref().zip(again.as_ref()) {
            text += &format!("{worst}\n  {again}\n");
        }
        output::print(&text)?;
    }
    if let Some(path) = &arguments.json {
        output::write_json(path, &Outcomes { found: &found, replay: again, warnings: &warnings })?;
    }
    if let Some(path) = &arguments.heatmap {
        let settings = Settings { transfer: Transfer::None, ..Settings::default() };
        write::write(&found.heatmap, path, &settings)?;
    }
    Ok(if found.passed { Verdict::Good } else { Verdict::Bad })
}

/// `envers validate --ray`: what everyone says of one ray.
fn replay(arguments: &Validate, scene: &Scene, ray: &Ray) -> Outcome {
    let found = measure::replay(scene, ray)?;
    if output::stdout_is_free(arguments.json.as_ref()) {
        output::print(&found.to_string())?;
    }
    if let Some(path) = &arguments.json {
        output::write_json(path, &found)?;
    }
    Ok(Verdict::Good)
}

/// The command that traces a ray again, as a shell takes it.
fn command(scene: &Path, ray: &str) -> String {
    let scene = scene.display().to_string();
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:@%".contains(c);
    let scene = if scene.chars().all(plain) {
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
        let of = |path| command(Path::new(path), "-1,0,0,0,0,1");
        assert_eq!(of("a/b.toml"), "envers validate a/b.toml --ray -1,0,0,0,0,1");
        assert_eq!(of("it's a.glb"), r"envers validate 'it'\''s a.glb' --ray -1,0,0,0,0,1");
    }
}
