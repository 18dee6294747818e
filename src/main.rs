//! The `envers` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    envers::cli::run()
}
