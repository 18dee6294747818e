//! The subcommand `envers stress`.

use std::process::ExitCode;

use crate::cli::paths::{self, InputFiles};
use crate::cli::{args::Stress, check_status, messages, output};
use crate::error::Result;
use crate::measure::stress::{self, StressOptions, Table, plot};
use crate::write;

/// The number of rays for each point of the plot.
const PLOT_RAYS: u64 = 20_000;

pub fn run(arguments: &Stress) -> Result<ExitCode> {
    // Check the outputs.
    output::check_json(arguments.json.as_ref())?;
    output::check_extension(arguments.plot.as_ref(), "svg", "a plot must be an SVG")?;
    let message = "finished test cases are recorded as JSON lines";
    output::check_extension(arguments.resume.as_ref(), "jsonl", message)?;
    let outputs = [&arguments.json, &arguments.plot, &arguments.resume];
    paths::check_outputs(outputs.into_iter().flatten(), &InputFiles::named(&[]))?;
    // Run the sweeps of the goals that are asked for, or of all.
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

    // Report the results.
    output::report(arguments.json.as_ref(), &Table(&rows).to_string(), &rows)?;
    if let Some(path) = &arguments.plot {
        let rays = if arguments.quick { options.rays } else { PLOT_RAYS };
        let svg = plot(arguments.seed, rays)?;
        write::write_atomically(path, |out| out.write_all(svg.as_bytes()))?;
    }
    Ok(check_status(rows.iter().all(|row| row.passed)))
}
