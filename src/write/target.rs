//! The target of an output: the file that its path leads to, and whether it can be written.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// The most symbolic links that are followed one after the other, as on Linux.
const MAX_LINKS: usize = 40;

/// Returns the folder of a file.
pub fn folder_of(target: &Path) -> &Path {
    target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Returns the target of an output, which need not exist: a symbolic link stays, and the file that it
/// leads to is written.
///
/// # Errors
/// When the links lead in a circle.
pub fn resolve(path: &Path) -> Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..=MAX_LINKS {
        match fs::read_link(&target) {
            // A relative link begins in its own folder; an absolute one replaces the path.
            Ok(next) => target.set_file_name(next),
            Err(_) => return Ok(target),
        }
    }
    Err(Error::input(
        "the output is a symbolic link that leads to itself, or through too many others",
    )
    .at(path)
    .help("remove the link, or choose another name"))
}

/// Returns the permissions that a file keeps when it is replaced; none if it is new, or where
/// permissions have no bits.
pub fn kept_permissions(target: &Path) -> Option<fs::Permissions> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Without the bits by which a program runs as its owner: the new file may have another one.
        let mode = fs::metadata(target).ok()?.permissions().mode();
        Some(fs::Permissions::from_mode(mode & 0o777))
    }
    #[cfg(not(unix))]
    {
        let _ = target;
        None
    }
}

/// Checks that what is at an output's path, if anything, is a file that may be replaced. Returns the
/// target.
///
/// # Errors
/// When it is not.
#[cfg(feature = "cli")]
pub fn check_replaceable(path: &Path) -> Result<PathBuf> {
    let is_folder = || Error::input("the output is a folder").at(path).help("name a file in it");
    if path.to_string_lossy().ends_with(std::path::is_separator) {
        return Err(is_folder());
    }
    let target = resolve(path)?;
    match fs::metadata(&target) {
        Ok(m) if m.is_dir() => Err(is_folder()),
        Ok(m) if !m.is_file() => Err(Error::input("the output is a pipe or a device, not a file")
            .at(path)
            .help("name a file: it is written beside its old self, which it then replaces")),
        Ok(m) if m.permissions().readonly() => {
            Err(Error::failed("the output is there already and is read-only")
                .at(path)
                .help("choose another name, or make it writable"))
        }
        Err(e) if e.kind() == io::ErrorKind::InvalidFilename => Err(Error::writing(path, &e)),
        _ => Ok(target),
    }
}

/// Returns the error that no file can be made beside `target`.
pub fn cannot_create(target: &Path, error: &io::Error) -> Error {
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

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn links_are_followed_from_their_own_folders() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path("sub")).unwrap();
        symlink("sub/second", path("first")).unwrap();
        symlink("../third", path("sub/second")).unwrap();
        symlink(path("sub/file"), path("third")).unwrap();
        assert_eq!(resolve(&path("first")).unwrap(), path("sub/file"));
    }

    #[test]
    fn a_circle_of_links_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        symlink("b", path("a")).unwrap();
        symlink("a", path("b")).unwrap();
        let error = resolve(&path("a")).unwrap_err();
        assert!(error.to_string().contains("leads to itself"), "{error}");
    }
}
