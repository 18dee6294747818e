//! The subcommand `envers man`.

use std::process::ExitCode;

use clap::CommandFactory;

use crate::cli::args::{Arguments, Man};
use crate::error::{Error, Result};
use crate::write;

pub fn run(arguments: &Man) -> Result<ExitCode> {
    let folder = &arguments.folder;
    std::fs::create_dir_all(folder).map_err(|e| Error::writing(folder, &e))?;
    // A page for the command, and one for each subcommand, such as envers-render(1).
    let mut command = Arguments::command().disable_help_subcommand(true);
    command.build();
    let subcommands = command.get_subcommands().cloned();
    for command in subcommands.chain([command.clone()]) {
        let name = command.get_display_name().unwrap_or("envers").to_owned();
        let page = clap_mangen::Man::new(command);
        write::write_atomically(&folder.join(format!("{name}.1")), |out| {
            page.render(&mut { out })
        })?;
    }
    Ok(ExitCode::SUCCESS)
}
