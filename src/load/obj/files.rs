//! Where the files are that an OBJ or MTL file names.

use std::path::{Path, PathBuf};

/// A file named in a model: as it stands, or as written on Windows, or beside the model when the
/// folder it was in is on another machine; and each of these in any case. Where none is there, the
/// name as it stands.
pub fn find(folder: &Path, name: &str) -> PathBuf {
    let first = folder.join(name);
    if first.exists() {
        return first;
    }
    let slashes = name.replace('\\', "/");
    let last = slashes.rsplit('/').next().unwrap_or_default();
    let found = [&slashes, last].into_iter().find_map(|name| in_any_case(folder, name));
    found.unwrap_or(first)
}

/// A regular file below a folder, whose name and folders may be written in another case.
fn in_any_case(folder: &Path, name: &str) -> Option<PathBuf> {
    let exact = folder.join(name);
    if exact.is_file() {
        return Some(exact);
    }
    let step = |folder: PathBuf, name: &str| {
        let next = folder.join(name);
        if next.exists() {
            return Some(next);
        }
        let entries = std::fs::read_dir(&folder).ok()?.flatten().map(|entry| entry.file_name());
        let is_same = |found: &std::ffi::OsString| {
            found.to_str().is_some_and(|found| found.to_lowercase() == name.to_lowercase())
        };
        // Of several the same one, in whatever order the system lists them.
        entries.filter(is_same).min().map(|found| folder.join(found))
    };
    let mut steps = name.split('/').filter(|step| !step.is_empty());
    steps.try_fold(folder.to_owned(), step).filter(|path| path.is_file())
}
