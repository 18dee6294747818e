//! Where the files are that an OBJ or MTL file names.

use std::ffi::OsString;
use std::path::Path;

use crate::error::Result;
use crate::load::sandbox::{OpenedFile, Sandbox};

/// A file named in a model: as it stands, or as written on Windows, or beside the model when the
/// folder it was in is on another machine; and where none is there, in any case.
///
/// # Errors
/// As [`Sandbox::open`], of the name as it stands.
pub fn find(guard: &Sandbox, folder: &Path, name: &str) -> Result<OpenedFile> {
    let slashes = name.replace('\\', "/");
    let last = slashes.rsplit('/').next().unwrap_or_default();
    guard.open(folder, &[name, &slashes, last]).or_else(|error| {
        let found = [&slashes, last].into_iter().find_map(|name| in_any_case(folder, name));
        found.and_then(|found| guard.open(folder, &[found]).ok()).ok_or(error)
    })
}

/// A file's name without the quotes around it.
pub fn unquoted(name: &str) -> &str {
    name.strip_prefix('"').and_then(|name| name.strip_suffix('"')).unwrap_or(name)
}

/// The path, from a folder, of what is below it and has a name in another case. Only what is
/// really below is looked at: nothing is followed out of it.
fn in_any_case(folder: &Path, name: &str) -> Option<String> {
    let here = folder.as_os_str().is_empty();
    let mut at = if here { Path::new(".") } else { folder }.to_owned();
    let mut found = Vec::new();
    for step in name.split('/') {
        if !found.is_empty() && !at.symlink_metadata().ok()?.is_dir() {
            return None;
        }
        let same = |entry: &OsString| -> bool {
            entry.to_str().is_some_and(|entry| entry.to_lowercase() == step.to_lowercase())
        };
        let entries = std::fs::read_dir(&at).ok()?.flatten().map(|entry| entry.file_name());
        // Of several the same one, in whatever order the system lists them.
        let next = entries.filter(same).min()?.into_string().ok()?;
        at.push(&next);
        found.push(next);
    }
    Some(found.join("/"))
}
