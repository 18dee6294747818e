//! The `envers` command: a module for each subcommand, and what they share.

mod args;
mod bench;
mod completions;
mod diff;
mod flag_values;
mod frame_range;
mod info;
mod load_report;
mod man;
mod messages;
mod output;
mod paths;
mod render;
mod render_checks;
mod render_plan;
mod render_stats;
mod scene_args;
#[cfg(unix)]
mod signals;
mod stress;
mod usage_errors;
mod validate;

use std::io::Write;
use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use crate::error::{ErrorKind, Result};
use args::{Arguments, Command};

/// Runs the command on this process's arguments.
///
/// Exit status 0: success; 1: a check or the work failed; 2: the command line or an input is wrong.
/// SIGINT, SIGTERM and SIGHUP end it as they would by default, after its temporary files are removed.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(message) => return exit_code(help_or_mistake(&usage_errors::correct_tips(message))),
    };
    if arguments.version {
        return exit_code(output::print(&format!("{}\n", version())).map(|()| ExitCode::SUCCESS));
    }
    let Some(command) = arguments.command else {
        messages::to_stderr(&Arguments::command().render_help().to_string());
        return ExitCode::from(2);
    };
    exit_code(run_command(&command))
}

/// Runs a subcommand.
fn run_command(command: &Command) -> Result<ExitCode> {
    #[cfg(unix)]
    signals::handle()?;
    match command {
        Command::Render(arguments) => render::run(arguments),
        Command::Validate(arguments) => validate::run(arguments),
        Command::Stress(arguments) => stress::run(arguments),
        Command::Bench(arguments) => bench::run(arguments),
        Command::Info(arguments) => info::run(arguments),
        Command::Diff(arguments) => diff::run(arguments),
        Command::Completions(arguments) => completions::run(arguments),
        Command::Man(arguments) => man::run(arguments),
    }
}

/// Prints the help that is asked for, or what is wrong with the command line.
///
/// # Errors
/// When the help cannot be printed.
fn help_or_mistake(message: &clap::Error) -> Result<ExitCode> {
    let printed = message.print();
    if message.use_stderr() {
        return Ok(ExitCode::from(2));
    }
    output::check_printed(printed.and_then(|()| std::io::stdout().flush()))?;
    Ok(ExitCode::SUCCESS)
}

/// Prints the error, if there is one, and returns the exit status.
fn exit_code(result: Result<ExitCode>) -> ExitCode {
    result.unwrap_or_else(|error| {
        messages::error(&error);
        match error.kind() {
            ErrorKind::Input => ExitCode::from(2),
            ErrorKind::Failed => ExitCode::FAILURE,
        }
    })
}

/// Returns the exit status of a check: a failure too if two images differ.
fn check_status(passed: bool) -> ExitCode {
    if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Returns the versions of envers and Embree.
fn version() -> String {
    let version = env!("CARGO_PKG_VERSION");
    #[cfg(feature = "embree")]
    match crate::intersect::embree_version() {
        Ok(embree) => format!("envers {version} (Embree {embree})"),
        Err(error) => format!("envers {version} ({})", error.message()),
    }
    #[cfg(not(feature = "embree"))]
    format!("envers {version} (without Embree)")
}
