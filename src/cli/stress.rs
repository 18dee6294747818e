//! `envers stress`.

use std::io::IsTerminal;
use std::path::PathBuf;

use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::args::Stress;
use crate::cli::{Outcome, Verdict, output};
use crate::error::{Error, Result};
use crate::measure::stress::{Options, Table, plot, stress};
use crate::write;

/// Rays of a point of the plot.
const PLOT_RAYS: u64 = 20_000;

pub fn run(arguments: &Stress) -> Outcome {
    output::check_json(arguments.json.as_ref())?;
    check_svg(arguments.plot.as_ref())?;
    output::check_json(arguments.resume.as_ref())?;
    let mut options = Options {
        rays: if arguments.quick { Options::QUICK } else { Options::FULL },
        seed: arguments.seed,
        resume: arguments.resume.clone(),
        ..Options::default()
    };
    if !arguments.goal.is_empty() {
        options.goals = arguments.goal.clone();
    }
    let bar = progress_bar(arguments.quiet);
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
        write::atomically(path, |out| out.write_all(svg.as_bytes()))?;
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

fn progress_bar(quiet: bool) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(1000);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {eta} left") {
        bar.set_style(style);
    }
    bar
}
