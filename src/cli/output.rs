//! The outputs of the command: checked before the work begins, written when it is done.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::error::{Error, Result};
use crate::film::Film;
use crate::scene::Transfer;
use crate::write::{self, Settings};

/// The extensions of scene, model and image files.
const SCENE_AND_IMAGE_EXTENSIONS: [&str; 14] = [
    "toml", "gltf", "glb", "vrm", "bin", "obj", "mtl", "png", "jpg", "jpeg", "webp", "tga", "bmp",
    "exr",
];

/// Checks that JSON can be written to `path`.
///
/// # Errors
/// When it cannot, or the file is named like a scene or an image.
pub fn check_json(path: Option<&PathBuf>) -> Result<()> {
    let Some(path) = path.filter(|path| !is_stdout(path)) else { return Ok(()) };
    // A typing error must not overwrite a scene or an image.
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if SCENE_AND_IMAGE_EXTENSIONS.contains(&&*extension) {
        return Err(Error::input("this is not the name of a JSON file")
            .at(path)
            .help("name it .json, or - for standard output"));
    }
    write::check_files([path])
}

/// Checks that a file can be written to `path`, and is named with an extension.
///
/// # Errors
/// When it cannot, or, with the message, when the extension is another one.
pub fn check_extension(path: Option<&PathBuf>, extension: &str, message: &str) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension)) {
        return Err(Error::input(message).at(path).help(format!("name it .{extension}")));
    }
    write::check_files([path])
}

/// Prints the text of a result, unless its JSON is printed, and writes its JSON if that is asked for.
///
/// # Errors
/// When one of the two cannot be written.
pub fn report(json: Option<&PathBuf>, text: &str, value: &impl Serialize) -> Result<()> {
    if stdout_is_free(json) {
        print(text)?;
    }
    json.map_or(Ok(()), |path| write_json(path, value))
}

/// Writes `value` as JSON, to standard output if `path` is `-`.
///
/// # Errors
/// When it cannot be written.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<()> {
    let mut text = serde_json::to_string_pretty(value)
        .map_err(|e| Error::failed(format!("cannot create the JSON: {e}")))?;
    text.push('\n');
    if is_stdout(path) {
        return print(&text);
    }
    write::write_atomically(path, |out| out.write_all(text.as_bytes()))
}

/// Prints to standard output. A closed pipe, as `head` leaves it, is no error.
///
/// # Errors
/// When it cannot be written for another reason.
pub fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    check_printed(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Checks that something could be printed to standard output; see [`print`].
///
/// # Errors
/// When it could not, for another reason than a closed pipe.
pub fn check_printed(printed: std::io::Result<()>) -> Result<()> {
    match printed {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Error::failed(format!("cannot write to standard output: {e}")))
        }
        _ => Ok(()),
    }
}

/// True if text can be printed to standard output, because no JSON is.
pub fn stdout_is_free(json: Option<&PathBuf>) -> bool {
    !json.is_some_and(|path| is_stdout(path))
}

fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Writes a heat map, with its values as they are.
///
/// # Errors
/// When it cannot be written.
pub fn write_heatmap(path: &Path, heatmap: &Film) -> Result<()> {
    let settings = Settings { transfer: Transfer::None, ..Settings::default() };
    write::write(heatmap, path, &settings)
}
