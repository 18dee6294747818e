//! The subcommand `envers stress`.

use crate::cli::args::Stress;
use crate::cli::{Outcome, messages, output, paths};
use crate::error::{Error, Result};
use crate::measure::stress::{self, StressOptions, Table, plot};
use crate::write;

/// The number of rays for each point of the plot.
const PLOT_RAYS: u64 = 20_000;

pub fn run(arguments: &Stress) -> Result<Outcome> {
    output::check_json(arguments.json.as_ref())?;
    output::check_extension(arguments.plot.as_ref(), "svg", "a plot must be an SVG")?;
    let message = "finished test cases are recorded as JSON lines";
    output::check_extension(arguments.resume.as_ref(), "jsonl", message)?;
    if let (Some(json), Some(resume)) = (&arguments.json, &arguments.resume)
        && paths::is_same(json, resume)
    {
        return Err(Error::input("--json would overwrite the file of --resume")
            .at(json)
            .help("name two different files"));
    }
    let mut options = StressOptions {
        rays: if arguments.quick { StressOptions::QUICK } else { StressOptions::FULL },
        seed: arguments.seed,
        resume: arguments.resume.clone(),
        ..StressOptions::default()
    };
    if !arguments.goal.is_empty() {
        options.goals.retain(|goal| arguments.goal.contains(goal));
    }

    let bar = messages::progress_bar(arguments.quiet);
    let rows = stress::run(&options, &|share| messages::set_progress(&bar, share))?;
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
    Ok(Outcome::of_check(rows.iter().all(|row| row.passed)))
}
