//! `envers stress`.

use std::path::PathBuf;

use crate::cli::args::Stress;
use crate::cli::{Outcome, Verdict, files, output, report};
use crate::error::{Error, Result};
use crate::measure::stress::{Options, Table, plot, stress};
use crate::write;

/// Rays of a point of the plot.
const PLOT_RAYS: u64 = 20_000;

pub fn run(arguments: &Stress) -> Outcome {
    output::check_json(arguments.json.as_ref())?;
    check_svg(arguments.plot.as_ref())?;
    check_resume(arguments)?;
    let mut options = Options {
        rays: if arguments.quick { Options::QUICK } else { Options::FULL },
        seed: arguments.seed,
        resume: arguments.resume.clone(),
        ..Options::default()
    };
    if !arguments.goal.is_empty() {
        options.goals.retain(|goal| arguments.goal.contains(goal));
    }
    let bar = report::progress_bar(arguments.quiet);
    let rows = stress(&options, &|share| bar.set_position((share * 1000.0) as u64))?;
    bar.finish_and_clear();
    if output::stdout_is_free(arguments.json.as_ref()) {
        output::print(&Table(&rows).to_string())?;
    }
    if let Some(path) = &arguments.json {
        output::write_json(path, &rows)?;
    }
    if let Some(path) = &arguments.plot {
        let rays = if arguments.quick { options.rays } else { PLOT_RAYS };
        let svg = plot(arguments.seed, rays)?;
        write::write_atomically(path, |out| out.write_all(svg.as_bytes()))?;
    }
    Ok(if rows.iter().all(|row| row.passed) { Verdict::Good } else { Verdict::Bad })
}

fn check_svg(path: Option<&PathBuf>) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg")) {
        return Err(Error::input("a plot is written as SVG").at(path).help("name it .svg"));
    }
    write::check_file(path)
}

/// Checks that finished cells can be kept where they are asked for, and are not overwritten.
fn check_resume(arguments: &Stress) -> Result<()> {
    let Some(path) = &arguments.resume else { return Ok(()) };
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("jsonl")) {
        return Err(Error::input("finished cells are kept as JSON lines")
            .at(path)
            .help("name it .jsonl"));
    }
    let same = |json: &&PathBuf| files::same(json, path);
    if arguments.json.as_ref().filter(same).is_some() {
        return Err(Error::input("--json would overwrite what --resume keeps")
            .at(path)
            .help("name two files"));
    }
    write::check_file(path)
}
