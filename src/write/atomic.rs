//! The atomic replacement of files: at any moment a file is the complete old or the complete new one.

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use crate::error::{Error, Result};

/// Creates the temporary file, which is later renamed to `target`: in the same folder, so that the
/// rename cannot cross file systems.
fn temporary(target: &Path) -> Result<NamedTempFile> {
    let folder = folder_of(target);
    let mut builder = Builder::new();
    builder.prefix(".envers-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The permissions of any new file, by the user's umask, instead of those of temporary files.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder).map_err(|e| not_created(target, &e))
}

/// The error that no file can be made beside `target`.
fn not_created(target: &Path, error: &io::Error) -> Error {
    let folder = folder_of(target);
    let shown = folder.display();
    match fs::metadata(folder) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            Error::input(format!("the output's folder {shown} does not exist"))
                .help(format!("make it first: mkdir -p {shown}"))
        }
        Ok(m) if !m.is_dir() => Error::input(format!("the output's folder {shown} is a file"))
            .help("name another folder"),
        _ => Error::writing(target, error).help(format!("can files be made in {shown}?")),
    }
    .at(target)
}

/// The folder of a file.
pub fn folder_of(target: &Path) -> &Path {
    target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Resolves symbolic links: a link stays, and the file that it names is replaced.
fn resolve(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// Checks that [`write_atomically`] could write to `path`.
///
/// # Errors
/// When it could not.
#[cfg(feature = "cli")]
pub fn check(path: &Path) -> Result<()> {
    let target = resolve(path);
    match fs::metadata(&target) {
        Ok(m) if m.is_dir() => {
            Err(Error::input("the output is a folder").at(path).help("name a file in it"))
        }
        Ok(m) if !m.is_file() => Err(Error::input("the output is a pipe or a device, not a file")
            .at(path)
            .help("name a file: it is written beside its old self, which it then replaces")),
        Ok(m) if m.permissions().readonly() => {
            Err(Error::failed("the output is there already and is read-only")
                .at(path)
                .help("choose another name, or make it writable"))
        }
        Err(e) if e.kind() == io::ErrorKind::InvalidFilename => Err(Error::writing(path, &e)),
        _ => temporary(&target).map(drop),
    }
}

/// A file that is being written: a temporary file in the same folder, which is renamed when it is
/// complete.
pub struct PendingFile {
    path: PathBuf,
    target: PathBuf,
    file: NamedTempFile,
}

impl PendingFile {
    /// Begins a file that is to replace `path`, which is untouched until [`PendingFile::commit`].
    pub fn new(path: &Path) -> Result<Self> {
        let target = resolve(path);
        let file = temporary(&target)?;
        Ok(Self { path: path.to_owned(), target, file })
    }

    /// The path that it is to have.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A handle for writing.
    pub fn handle(&self) -> io::Result<File> {
        self.file.as_file().try_clone()
    }

    /// Flushes the file to disk and renames it.
    pub fn commit(self) -> Result<()> {
        let failed = |e: io::Error| Error::writing(&self.path, &e);
        self.file.as_file().sync_all().map_err(failed)?;
        self.file.persist(&self.target).map_err(|e| failed(e.error))?;
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
    let mut buffered = BufWriter::new(pending.file.as_file_mut());
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
        let error = check(&folder.path().join("no/a.png")).unwrap_err();
        assert!(error.to_string().contains("does not exist"), "{error}");
    }
}
