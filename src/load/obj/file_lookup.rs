//! The lookup of files that an OBJ or MTL file names.

use std::ffi::OsString;
use std::path::Path;

use crate::error::Result;
use crate::load::sandbox::{OpenedFile, Sandbox};

/// Opens a file by the name that a model has for it: unchanged, or as written on Windows, or beside
/// the model when the folder it was in is on another machine; and where none is there, in upper or
/// lower case.
///
/// # Errors
/// When no such file can be opened; the error of [`Sandbox::open`] is about the unchanged name.
pub fn open_file(sandbox: &Sandbox, folder: &Path, name: &str) -> Result<OpenedFile> {
    let slashes = name.replace('\\', "/");
    let last = slashes.rsplit('/').next().unwrap_or_default();
    sandbox.open(folder, &[name, &slashes, last]).or_else(|error| {
        let found = [&slashes, last].into_iter().find_map(|name| find_ignoring_case(folder, name));
        found.and_then(|found| sandbox.open(folder, &[found]).ok()).ok_or(error)
    })
}

/// Returns a file's name without the quotes around it.
pub fn unquote(name: &str) -> &str {
    name.strip_prefix('"').and_then(|name| name.strip_suffix('"')).unwrap_or(name)
}

/// Finds a file below a folder by its path from there, ignoring the case. Only what is really below the
/// folder is searched: no symbolic link leads out of it.
fn find_ignoring_case(folder: &Path, name: &str) -> Option<String> {
    let is_current = folder.as_os_str().is_empty();
    let mut path = if is_current { Path::new(".") } else { folder }.to_owned();
    let mut found = Vec::new();
    for step in name.split('/') {
        if !found.is_empty() && !path.symlink_metadata().ok()?.is_dir() {
            return None;
        }
        let is_same = |entry: &OsString| -> bool {
            entry.to_str().is_some_and(|entry| entry.to_lowercase() == step.to_lowercase())
        };
        let entries = std::fs::read_dir(&path).ok()?.flatten().map(|entry| entry.file_name());
        // Of several the same one, in whatever order the system lists them.
        let next = entries.filter(is_same).min()?.into_string().ok()?;
        path.push(&next);
        found.push(next);
    }
    Some(found.join("/"))
}
