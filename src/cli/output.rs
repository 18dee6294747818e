//! Outputs of the command: checked before the work begins, written when it is done.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::error::{Error, Result};
use crate::write;

/// What the files of scenes and pictures end in.
const SCENES_AND_PICTURES: [&str; 14] = [
    "toml", "gltf", "glb", "vrm", "bin", "obj", "mtl", "png", "jpg", "jpeg", "webp", "tga", "bmp",
    "exr",
];

/// Checks that JSON could be written to `path`.
///
/// # Errors
/// When it could not.
pub fn check_json(path: Option<&PathBuf>) -> Result<()> {
    let Some(path) = path.filter(|path| !is_stdout(path)) else { return Ok(()) };
    // What scenes and pictures are made of keeps its names to itself: a slip of the hand must not
    // overwrite it.
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if SCENES_AND_PICTURES.contains(&&*extension) {
        return Err(Error::input("JSON is not written to a file of this name")
            .at(path)
            .help("name it .json, or - for standard output"));
    }
    write::check_file(path)
}

/// Checks that a PNG could be written to `path`.
///
/// # Errors
/// When it could not, or the file is not named as a PNG.
pub fn check_png(path: Option<&PathBuf>) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    if write::Format::from_path(path)? != write::Format::Png {
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
        return print(&text);
    }
    write::write_atomically(path, |out| out.write_all(text.as_bytes()))
}

/// Prints to standard output. A reader that has gone, as `head` does, wants no more; that is no
/// error.
///
/// # Errors
/// When it cannot be written for another reason.
pub fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Error::failed(format!("cannot write to standard output: {e}")))
        }
        _ => Ok(()),
    }
}

/// Whether results for a person may go to standard output, which JSON may have taken.
pub fn stdout_is_free(json: Option<&PathBuf>) -> bool {
    !json.is_some_and(|path| is_stdout(path))
}

fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}
