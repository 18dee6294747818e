//! The errors of a command line that cannot be parsed.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Error};

use crate::cli::args::Arguments;

/// Flags of other programs, and ours that do the same.
const FLAGS_ELSEWHERE: [(&str, &str); 8] = [
    ("--width", "--size"),
    ("--height", "--size"),
    ("--resolution", "--size"),
    ("--samples", "--spp"),
    ("--out", "--output"),
    ("--format", "--output"),
    ("--bounces", "--max-depth"),
    ("--jobs", "--threads"),
];

/// Corrects the tips of the parser for a flag that does not exist. It advises to pass the flag as a value, as
/// in `-- --width`, which no command here has a use for; and it knows only flags that are spelt alike.
pub fn correct_tips(mut error: Error) -> Error {
    if error.kind() != ErrorKind::UnknownArgument {
        return error;
    }
    error.remove(ContextKind::Suggested);
    if let Some(ContextValue::String(flag)) = error.get(ContextKind::InvalidArg) {
        let same = FLAGS_ELSEWHERE.iter().find(|(other, _)| other == flag);
        if let Some((_, ours)) = same.filter(|(_, ours)| is_flag_here(ours)) {
            let ours = ContextValue::String((*ours).to_owned());
            error.insert(ContextKind::SuggestedArg, ours);
        }
    }
    error
}

/// True if the subcommand of this process's arguments has a flag.
fn is_flag_here(flag: &str) -> bool {
    let command = Arguments::command();
    let subcommand = std::env::args_os().skip(1).find_map(|word| command.find_subcommand(word));
    let mut flags = subcommand.into_iter().flat_map(|command| command.get_arguments());
    flags.any(|argument| argument.get_long() == flag.strip_prefix("--"))
}
