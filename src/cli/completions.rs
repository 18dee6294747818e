//! The subcommand `envers completions`.

use std::process::ExitCode;

use clap::CommandFactory;

use crate::cli::args::{Arguments, Completions};
use crate::cli::output;
use crate::error::Result;

pub fn run(arguments: &Completions) -> Result<ExitCode> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "envers", &mut script);
    output::print(&String::from_utf8_lossy(&script))?;
    Ok(ExitCode::SUCCESS)
}
