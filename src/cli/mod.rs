//! The command, on the public API alone.

mod args;
mod bench;
mod diff;
mod files;
mod frames;
mod info;
mod json;
mod load;
mod load_report;
mod output;
mod range;
mod render;
mod report;
mod stress;
mod validate;
mod values;

use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use crate::error::{ErrorKind, Result};
use args::{Arguments, Command};

/// Runs the command on this process's arguments.
///
/// Exit status 0: done; 1: a check or the work failed; 2: the command line or the input is wrong.
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    if arguments.version {
        return finish(output::print(&format!("{}\n", version())).map(|()| Verdict::Good));
    }
    let Some(command) = arguments.command else {
        // Nothing was asked for: say what there is.
        report::to_stderr(&Arguments::command().render_help().to_string());
        return ExitCode::from(2);
    };
    finish(match command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Validate(arguments) => validate::run(&arguments),
        Command::Stress(arguments) => stress::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
        Command::Diff(arguments) => diff::run(&arguments),
    })
}

/// Reports what went wrong, and says how it came out.
fn finish(outcome: Outcome) -> ExitCode {
    match outcome {
        Ok(Verdict::Good) => ExitCode::SUCCESS,
        Ok(Verdict::Bad) => ExitCode::FAILURE,
        Err(error) => {
            report::error(&error);
            match error.kind() {
                ErrorKind::Input => ExitCode::from(2),
                ErrorKind::Failed => ExitCode::FAILURE,
            }
        }
    }
}

/// How a command that did its work came out.
enum Verdict {
    Good,
    /// A check did not pass, or two pictures differ.
    Bad,
}

type Outcome = Result<Verdict>;

fn version() -> String {
    let version = env!("CARGO_PKG_VERSION");
    #[cfg(feature = "embree")]
    match crate::intersect::embree_version() {
        Ok(embree) => format!("envers {version} (Embree {embree})"),
        Err(error) => format!("envers {version} (Embree: {})", error.message()),
    }
    #[cfg(not(feature = "embree"))]
    format!("envers {version} (without Embree)")
}
