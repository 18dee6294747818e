//! Outputs of the command: checked before the work begins, written when it is done.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::error::{Error, Result};
use crate::write;

/// Checks that JSON could be written to `path`.
///
/// # Errors
/// When it could not.
pub fn check_json(path: Option<&PathBuf>) -> Result<()> {
    match path {
        Some(path) if !is_stdout(path) => write::check_file(path),
        _ => Ok(()),
    }
}

/// Checks that a PNG could be written to `path`.
///
/// # Errors
/// When it could not, or the file is not named as a PNG.
pub fn check_png(path: Option<&PathBuf>) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    if write::Format::of(path)? != write::Format::Png {
        return Err(Error::input("a heat map is written as PNG").at(path).help("name it .png"));
    }
    write::check(path)
}

/// Writes `value` as JSON, to standard output when `path` is `-`.
///
/// # Errors
/// When it cannot be written.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<()> {
    let mut text = serde_json::to_string_pretty(value)
        .map_err(|e| Error::failed(format!("the JSON cannot be made: {e}")))?;
    text.push('\n');
    if is_stdout(path) {
        let mut out = std::io::stdout().lock();
        return out
            .write_all(text.as_bytes())
            .and_then(|()| out.flush())
            .map_err(|e| Error::failed(format!("cannot write to standard output: {e}")));
    }
    write::atomically(path, |out| out.write_all(text.as_bytes()))
}

/// Whether results for a person may go to standard output, which JSON may have taken.
pub fn stdout_is_free(json: Option<&PathBuf>) -> bool {
    !json.is_some_and(|path| is_stdout(path))
}

fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}
