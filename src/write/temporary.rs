//! The temporary files of the process: each becomes an output or is removed, also when a signal ends
//! the process.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, TempPath};

/// The paths of all temporary files. The lock is held while one is created, renamed or removed, so that
/// the list has exactly those that exist whenever nobody holds it.
static PATHS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn paths() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    PATHS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A temporary file, which is removed when it is dropped.
pub struct TemporaryFile {
    file: File,
    /// The path; none once it is renamed.
    path: Option<TempPath>,
}

impl TemporaryFile {
    /// Creates a file in a folder, from whose permissions the system takes those of the user's umask.
    pub fn create(folder: &Path, permissions: Option<fs::Permissions>) -> io::Result<Self> {
        let mut builder = Builder::new();
        builder.prefix(".envers-").suffix(".part");
        if let Some(permissions) = permissions {
            builder.permissions(permissions);
        }
        let mut paths = paths();
        let (file, path) = builder.tempfile_in(folder)?.into_parts();
        paths.insert(path.to_path_buf());
        Ok(Self { file, path: Some(path) })
    }

    /// The open file.
    pub fn file(&mut self) -> &mut File {
        &mut self.file
    }

    /// Renames the file, which replaces another one at `target`.
    pub fn rename(mut self, target: &Path) -> io::Result<()> {
        let mut paths = paths();
        match self.path.take() {
            Some(path) => {
                paths.remove(&*path);
                path.persist(target).map_err(|e| e.error)
            }
            None => Ok(()),
        }
    }
}

impl Drop for TemporaryFile {
    fn drop(&mut self) {
        if let Some(path) = self.path.take() {
            let mut paths = paths();
            paths.remove(&*path);
            // Removed while the lock is held.
            drop(path);
        }
    }
}

/// Removes all temporary files of the process, which is about to end: whoever creates, renames or
/// removes one from now on waits forever.
#[cfg(all(feature = "cli", unix))]
pub fn remove_all() {
    let paths = paths();
    for path in paths.iter() {
        let _ = fs::remove_file(path);
    }
    std::mem::forget(paths);
}
