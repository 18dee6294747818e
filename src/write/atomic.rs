//! The atomic replacement of files: at any moment a file is the complete old or the complete new one.

#[cfg(feature = "cli")]
use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
#[cfg(feature = "cli")]
use crate::write::target::check_replaceable;
use crate::write::target::{cannot_create, folder_of, kept_permissions, resolve};
use crate::write::temporary::TemporaryFile;

/// Creates the temporary file, which is later renamed to `target`: in the same folder, so that the
/// rename cannot cross file systems.
fn temporary(target: &Path) -> Result<TemporaryFile> {
    // Nobody may read it who may not read the file that it replaces.
    let permissions = kept_permissions(target).or_else(new_permissions);
    TemporaryFile::create(folder_of(target), permissions).map_err(|e| cannot_create(target, &e))
}

/// Returns the permissions of any new file, from which the system takes those of the user's umask;
/// none where permissions have no bits.
fn new_permissions() -> Option<fs::Permissions> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        Some(fs::Permissions::from_mode(0o666))
    }
    #[cfg(not(unix))]
    None
}

/// Checks that [`write_atomically`] could write to these paths. Each folder is tried once, so that
/// thousands of paths take no time.
///
/// # Errors
/// When it could not.
#[cfg(feature = "cli")]
pub fn check(paths: impl IntoIterator<Item = impl AsRef<Path>>) -> Result<()> {
    let mut tried = HashSet::new();
    for path in paths {
        let target = check_replaceable(path.as_ref())?;
        if tried.insert(folder_of(&target).to_owned()) {
            temporary(&target)?;
        }
    }
    Ok(())
}

/// A file that is being written: a temporary file in the same folder, which is renamed when it is
/// complete.
pub struct PendingFile {
    path: PathBuf,
    target: PathBuf,
    file: TemporaryFile,
}

impl PendingFile {
    /// Begins a file that is to replace `path`, which is untouched until [`PendingFile::commit`].
    pub fn new(path: &Path) -> Result<Self> {
        let target = resolve(path)?;
        let file = temporary(&target)?;
        Ok(Self { path: path.to_owned(), target, file })
    }

    /// The path that it is to have.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A handle for writing.
    pub fn handle(&mut self) -> io::Result<File> {
        self.file.file().try_clone()
    }

    /// Flushes the file to disk and renames it. It gets the permissions of the file that it replaces.
    pub fn commit(mut self) -> Result<()> {
        let failed = |e: io::Error| Error::writing(&self.path, &e);
        if let Some(permissions) = kept_permissions(&self.target) {
            self.file.file().set_permissions(permissions).map_err(failed)?;
        }
        self.file.file().sync_all().map_err(failed)?;
        self.file.rename(&self.target).map_err(failed)?;
        // The rename itself is flushed with the folder; some systems cannot open or flush folders, and
        // there the file is complete all the same.
        if let Ok(folder) = File::open(folder_of(&self.target)) {
            let _ = folder.sync_all();
        }
        Ok(())
    }
}

/// Writes a file through `fill`: to a temporary file in the same folder, which is flushed to disk and
/// then renamed.
///
/// # Errors
/// When anything fails; the temporary file is then removed, and an older file at `path` stays as it
/// was.
pub fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut (dyn WriteSeek + '_)) -> io::Result<()>,
) -> Result<()> {
    let mut pending = PendingFile::new(path)?;
    let failed = |e: io::Error| Error::writing(path, &e);
    let mut buffered = BufWriter::new(pending.file.file());
    fill(&mut buffered).map_err(failed)?;
    buffered.flush().map_err(failed)?;
    drop(buffered);
    pending.commit()
}

/// A destination that encoders can write to and seek in.
pub trait WriteSeek: Write + Seek {}
impl<T: Write + Seek> WriteSeek for T {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failure_leaves_the_old_file_and_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        fs::write(&path, "old").unwrap();
        let result = write_atomically(&path, |out| {
            out.write_all(b"half of the new")?;
            Err(io::Error::other("the disk is full"))
        });
        assert!(result.unwrap_err().to_string().contains("the disk is full"));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn success_replaces_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        fs::write(&path, "old").unwrap();
        write_atomically(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
    }

    #[test]
    #[cfg(unix)]
    fn link_stays_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real.png"), folder.path().join("link.png"));
        fs::write(&real, "old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write_atomically(&link, |out| out.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&real).unwrap(), b"new");
    }

    #[test]
    fn missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = PendingFile::new(&folder.path().join("no/a.png")).err().unwrap();
        assert!(error.to_string().contains("does not exist"), "{error}");
    }
}
