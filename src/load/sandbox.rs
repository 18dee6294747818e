//! What keeps a load within bounds: the one folder that it may read in, and the limits.
//!
//! Whatever a load opens is opened here. A file that somebody names on the command line may be
//! anywhere; a file that another file names must be beside or below the one from the command line,
//! since that other file may come from a stranger. Only regular files are opened: a pipe could keep
//! the program waiting, a device could do anything.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::limits::{Limit, Limits};
use crate::error::{Error, Remedy, Result};

/// The bounds of one load, and what it has taken of its limits.
pub struct Sandbox {
    /// The canonical path of the folder that files must be in, unless they may be anywhere.
    folder: Option<PathBuf>,
    limits: Limits,
    taken: [AtomicU64; Limit::ALL.len()],
}

/// A regular file, open for reading.
pub struct OpenedFile {
    /// The path by which it is known to the user.
    pub path: PathBuf,
    /// Its canonical path: the same for all names of one file.
    pub identity: PathBuf,
    file: File,
    length: u64,
}

/// Why a file is not opened.
enum Refusal {
    /// It cannot be found or opened.
    Io(io::Error),
    /// It is none: a folder, a pipe, a device.
    Kind(&'static str),
    /// It is elsewhere.
    Outside,
}

impl From<io::Error> for Refusal {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl Sandbox {
    /// For a load of the file at `path`; other files may be anywhere if `allow_outside` says so.
    ///
    /// # Errors
    /// When the folder of the file is not there.
    pub fn new(path: &Path, allow_outside: bool, limits: Limits) -> Result<Self> {
        let folder = match allow_outside {
            true => None,
            false => {
                Some(parent(path).canonicalize().map_err(|error| Error::io("read", path, &error))?)
            }
        };
        Ok(Self { folder, limits, taken: Default::default() })
    }

    /// Opens the file that the user named.
    ///
    /// # Errors
    /// When it cannot be opened, or is no regular file.
    pub fn open_named(&self, path: &Path) -> Result<OpenedFile> {
        open(path, None).map_err(|refusal| self.refused(path, &refusal).at(path))
    }

    /// Opens the file that a file in `folder` refers to by the first of `names` that there is.
    ///
    /// # Errors
    /// When there is none, it is outside, cannot be opened, or is no regular file; the error
    /// has no path, so that it can be reported at the place of the reference.
    pub fn open(&self, folder: &Path, names: &[impl AsRef<str>]) -> Result<OpenedFile> {
        let mut refused: Option<(&str, Refusal)> = None;
        for name in names.iter().map(AsRef::as_ref) {
            match open(&folder.join(name), self.folder.as_deref()) {
                Ok(opened) => return Ok(opened),
                // The first refusal counts, but one of a file that is there more than others.
                Err(new) => match &refused {
                    Some((_, Refusal::Io(_))) if !matches!(new, Refusal::Io(_)) => {
                        refused = Some((name, new));
                    }
                    Some(_) => {}
                    None => refused = Some((name, new)),
                },
            }
        }
        Err(match refused {
            Some((name, refusal)) => self.refused(&folder.join(name), &refusal),
            None => Error::input("no file is named"),
        })
    }

    fn refused(&self, path: &Path, refusal: &Refusal) -> Error {
        match refusal {
            Refusal::Io(error) => Error::input(Error::io("read", path, error).message()),
            Refusal::Kind(what) => Error::input(format!("this is {what}, not a file")),
            Refusal::Outside => {
                let folder = self.folder.as_deref().unwrap_or(Path::new("/"));
                Error::input(format!("it is not in the folder {}", folder.display()))
                    .help(
                        "files are read beside and below the one that was named; allow others if \
                         you trust the file",
                    )
                    .remedied_by(Remedy::AllowOutside)
            }
        }
    }

    /// The most that there may be of something.
    pub fn most(&self, limit: Limit) -> u64 {
        self.limits.get(limit)
    }

    /// Checks that there is no more of something than its limit.
    ///
    /// # Errors
    /// When there is.
    pub fn check(&self, limit: Limit, found: u64) -> Result<()> {
        self.limits.check(limit, found)
    }

    /// Takes some more of what is limited.
    ///
    /// # Errors
    /// When that is more than the limit, together with what was taken before.
    pub fn take(&self, limit: Limit, more: u64) -> Result<()> {
        let add = |taken: u64| Some(taken.saturating_add(more));
        let (set, get) = (Ordering::Relaxed, Ordering::Relaxed);
        let before = self.taken[limit as usize].fetch_update(set, get, add);
        let before = before.unwrap_or_else(|unchanged| unchanged);
        self.limits.check(limit, before.saturating_add(more))
    }
}

impl OpenedFile {
    /// Reads the whole file.
    ///
    /// # Errors
    /// When it cannot be read, or there is more of it than may be.
    pub fn read(self, guard: &Sandbox) -> Result<Vec<u8>> {
        let path = self.path;
        guard.take(Limit::Bytes, self.length).map_err(|e| e.at(&path))?;
        let mut bytes = Vec::new();
        let fail = |error: io::Error| Error::io("read", &path, &error);
        bytes.try_reserve_exact(self.length as usize).map_err(|e| fail(e.into()))?;
        // What is written to it from now on is left out.
        self.file.take(self.length).read_to_end(&mut bytes).map_err(fail)?;
        Ok(bytes)
    }
}

/// The folder of a file.
fn parent(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Opens a regular file, which must be in a `folder`, given by its canonical path, or anywhere.
fn open(path: &Path, folder: Option<&Path>) -> Result<OpenedFile, Refusal> {
    let is_outside = |path: &Path| folder.is_some_and(|folder| !path.starts_with(folder));
    let identity = match path.canonicalize() {
        Ok(identity) if is_outside(&identity) => return Err(Refusal::Outside),
        Ok(identity) => identity,
        Err(error) => {
            // What is not there is said to be outside where it would be.
            let there = path.ancestors().find_map(|above| above.canonicalize().ok());
            let is_outside = there.is_some_and(|there| is_outside(&there));
            return Err(if is_outside { Refusal::Outside } else { error.into() });
        }
    };
    let file = open_within(folder.unwrap_or(parent(&identity)), &identity)?;
    let length = file.metadata()?.len();
    Ok(OpenedFile { path: path.to_owned(), identity, file, length })
}

/// Opens the regular file at a path below a folder, both without symbolic links. From the folder
/// on each step is taken from what the one before has opened, and follows no link: should somebody
/// put one there meanwhile, it is an error, and nothing outside is opened.
#[cfg(unix)]
fn open_within(folder: &Path, path: &Path) -> Result<File, Refusal> {
    use rustix::fs::{AtFlags, CWD, FileType, Mode, OFlags, openat, statat};

    // A folder may be one that can be passed, but not read.
    #[cfg(any(target_os = "linux", target_os = "android"))]
    let access = OFlags::PATH;
    #[cfg(not(any(target_os = "linux", target_os = "android")))]
    let access = OFlags::RDONLY;
    let step = OFlags::DIRECTORY | OFlags::NOFOLLOW | OFlags::CLOEXEC | access;
    let mut at = openat(CWD, folder, step, Mode::empty()).map_err(io::Error::from)?;
    let mut parts = path.strip_prefix(folder).map_err(|_| Refusal::Outside)?.iter();
    let name = parts.next_back().ok_or(Refusal::Kind("a folder"))?;
    for part in parts {
        at = openat(at, part, step, Mode::empty()).map_err(io::Error::from)?;
    }
    // To open a device can do something already.
    let stat = statat(&at, name, AtFlags::SYMLINK_NOFOLLOW).map_err(io::Error::from)?;
    match FileType::from_raw_mode(stat.st_mode) {
        FileType::RegularFile => {}
        FileType::Directory => return Err(Refusal::Kind("a folder")),
        _ => return Err(Refusal::Kind("a pipe or a device")),
    }
    // Should it be a pipe by now, nobody waits for its other end.
    let flags = OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::NOFOLLOW | OFlags::CLOEXEC;
    let file = File::from(openat(&at, name, flags, Mode::empty()).map_err(io::Error::from)?);
    match file.metadata()?.is_file() {
        true => Ok(file),
        false => Err(Refusal::Kind("a pipe or a device")),
    }
}

/// Opens the regular file at a path below a folder, both without symbolic links.
#[cfg(not(unix))]
fn open_within(_: &Path, path: &Path) -> Result<File, Refusal> {
    let metadata = std::fs::symlink_metadata(path)?;
    if metadata.is_dir() {
        return Err(Refusal::Kind("a folder"));
    }
    if !metadata.is_file() {
        return Err(Refusal::Kind("a pipe or a device"));
    }
    Ok(File::open(path)?)
}
