//! The sandbox of a load: the one folder that it may read in, and the limits.
//!
//! All files of a load are opened here. The file that the user names may be anywhere; a file that
//! another file names must be beside or below it, since that other file may come from a stranger. Only
//! regular files are opened: a pipe could keep the program waiting, a device could do anything.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use super::limits::{Limit, Limits};
use crate::error::{Error, Remedy, Result};

/// The sandbox of one load.
pub struct Sandbox {
    /// The canonical path of the folder that files must be in; none if they may be anywhere.
    folder: Option<PathBuf>,
    limits: Limits,
    /// The amount of each limit that is used up.
    used: [AtomicU64; Limit::ALL.len()],
    /// The files that were read, each of which counts once.
    files: Mutex<ReadFiles>,
}

/// The files that were read so far.
#[derive(Default)]
struct ReadFiles {
    /// Their canonical paths.
    identities: BTreeSet<PathBuf>,
    /// The bytes that they have together.
    bytes: u64,
    /// The bytes of these that images have not accounted for.
    bytes_left: u64,
}

/// A regular file, open for reading.
pub struct OpenedFile {
    /// The path by which it is known to the user.
    pub path: PathBuf,
    /// The canonical path: the same for all names of one file.
    pub identity: PathBuf,
    file: File,
    length: u64,
}

/// The pixels for each byte of an image's file that do not count toward the limit.
const FREE_PIXELS_PER_BYTE: u64 = 16;

/// The name of a folder in messages.
const FOLDER: &str = "a folder";
/// The name of all else that is no regular file in messages.
const PIPE_OR_DEVICE: &str = "a pipe or a device";

/// The reason why a file is not opened.
enum OpenError {
    /// The file cannot be found or opened.
    Io(io::Error),
    /// The path leads to a folder, a pipe or a device, as the text says.
    NotRegular(&'static str),
    /// The file is outside the folder of the sandbox.
    Outside,
}

impl From<io::Error> for OpenError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl Sandbox {
    /// Returns the sandbox for a load of the file at `path`; other files may be anywhere if
    /// `allow_outside` is set.
    ///
    /// # Errors
    /// When the folder of the file is not there.
    pub fn new(path: &Path, allow_outside: bool, limits: Limits) -> Result<Self> {
        let folder = (!allow_outside).then(|| parent(path).canonicalize()).transpose();
        let folder = folder.map_err(|error| Error::reading(path, &error))?;
        Ok(Self { folder, limits, used: Default::default(), files: Mutex::default() })
    }

    /// Opens the file that the user named.
    ///
    /// # Errors
    /// When it cannot be opened, or is no regular file.
    pub fn open_named(&self, path: &Path) -> Result<OpenedFile> {
        open(path, None).map_err(|error| self.error(path, &error).at(path))
    }

    /// Opens the file that a file in `folder` refers to, by the first of `names` that exists.
    ///
    /// # Errors
    /// When there is none, it is outside, cannot be opened, or is no regular file; the error
    /// has no path, so that it can be reported at the place of the reference.
    pub fn open(&self, folder: &Path, names: &[impl AsRef<str>]) -> Result<OpenedFile> {
        let mut first: Option<(&str, OpenError)> = None;
        for name in names.iter().map(AsRef::as_ref) {
            match open(&folder.join(name), self.folder.as_deref()) {
                Ok(opened) => return Ok(opened),
                // The first error counts, but that of a file that is there before any other.
                Err(new) => {
                    let is_there = !matches!(new, OpenError::Io(_));
                    if first.is_none() || is_there && matches!(first, Some((_, OpenError::Io(_)))) {
                        first = Some((name, new));
                    }
                }
            }
        }
        Err(match first {
            Some((name, error)) => self.error(&folder.join(name), &error),
            None => Error::input("no file is named"),
        })
    }

    /// Returns the error that the file at a path is not opened.
    fn error(&self, path: &Path, error: &OpenError) -> Error {
        match error {
            OpenError::Io(error) => Error::input(Error::reading(path, error).message()),
            OpenError::NotRegular(what) => Error::input(format!("this is {what}, not a file")),
            OpenError::Outside => {
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

    /// Returns a limit.
    pub fn limit(&self, limit: Limit) -> u64 {
        self.limits.get(limit)
    }

    /// Checks an amount of something against its limit.
    ///
    /// # Errors
    /// When it is more.
    pub fn check(&self, limit: Limit, found: u64) -> Result<()> {
        self.limits.check(limit, found)
    }

    /// Uses up some more of a limit.
    ///
    /// # Errors
    /// When that is more than the limit, together with what was used before.
    pub fn consume(&self, limit: Limit, more: u64) -> Result<()> {
        // The amount is added in one step, since threads share the limit.
        let add = |used: u64| Some(used.saturating_add(more));
        let (set, get) = (Ordering::Relaxed, Ordering::Relaxed);
        let before = self.used[limit as usize].fetch_update(set, get, add);
        let before = before.unwrap_or_else(|unchanged| unchanged);
        self.limits.check(limit, before.saturating_add(more))
    }
}

impl Sandbox {
    /// Uses up the pixels of an image for which the size of its file, of so many bytes, does not
    /// account. The bytes of the files that were read account for pixels once, however many images are
    /// read from the same bytes.
    ///
    /// # Errors
    /// When that is more than the limit, together with those before.
    pub fn consume_pixels(&self, pixels: u64, bytes: u64) -> Result<()> {
        let free = {
            let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
            let bytes = bytes.min(files.bytes_left);
            // What an image does not need is left to others.
            let needed = bytes.min(pixels.div_ceil(FREE_PIXELS_PER_BYTE));
            files.bytes_left -= needed;
            FREE_PIXELS_PER_BYTE * needed
        };
        self.consume(Limit::Pixels, pixels.saturating_sub(free))
    }

    /// Counts a file that is read.
    fn count_file(&self, identity: PathBuf, bytes: u64) {
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        if files.identities.insert(identity) {
            files.bytes_left += bytes;
            files.bytes += bytes;
        }
    }

    /// Returns the canonical paths of the files that were read, and the number of their bytes.
    pub fn read_files(&self) -> (BTreeSet<PathBuf>, u64) {
        let files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        (files.identities.clone(), files.bytes)
    }
}

impl OpenedFile {
    /// Returns its number of bytes.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Reads the whole file.
    ///
    /// # Errors
    /// When it cannot be read, or is larger than the limit allows.
    pub fn read(self, sandbox: &Sandbox) -> Result<Vec<u8>> {
        let path = self.path;
        sandbox.consume(Limit::Bytes, self.length).map_err(|e| e.at(&path))?;
        sandbox.count_file(self.identity, self.length);
        let mut bytes = Vec::new();
        let fail = |error: io::Error| Error::reading(&path, &error);
        bytes.try_reserve_exact(self.length as usize).map_err(|e| fail(e.into()))?;
        // Bytes that are written to it from now on are left out.
        self.file.take(self.length).read_to_end(&mut bytes).map_err(fail)?;
        Ok(bytes)
    }
}

/// Returns the folder of a file.
fn parent(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Opens a regular file, which must be in a `folder`, given by its canonical path, or anywhere.
fn open(path: &Path, folder: Option<&Path>) -> Result<OpenedFile, OpenError> {
    let is_outside = |path: &Path| folder.is_some_and(|folder| !path.starts_with(folder));
    let identity = match path.canonicalize() {
        Ok(identity) if is_outside(&identity) => return Err(OpenError::Outside),
        Ok(identity) => identity,
        Err(error) => {
            // A file that does not exist is outside if it would be.
            let existing = path.ancestors().find_map(|above| above.canonicalize().ok());
            let is_outside = existing.is_some_and(|existing| is_outside(&existing));
            return Err(if is_outside { OpenError::Outside } else { error.into() });
        }
    };
    let file = open_within(folder.unwrap_or(parent(&identity)), &identity)?;
    let length = file.metadata()?.len();
    Ok(OpenedFile { path: path.to_owned(), identity, file, length })
}

/// Opens the regular file at a path below a folder, both without symbolic links. From the folder on
/// each step is taken from the folder that the step before has opened, and follows no link: should
/// somebody put one there meanwhile, it is an error, and nothing outside is opened.
#[cfg(unix)]
fn open_within(folder: &Path, path: &Path) -> Result<File, OpenError> {
    use rustix::fs::{AtFlags, CWD, FileType, Mode, OFlags, openat, statat};

    // A folder may be one that can be passed, but not read.
    #[cfg(any(target_os = "linux", target_os = "android"))]
    let access = OFlags::PATH;
    #[cfg(not(any(target_os = "linux", target_os = "android")))]
    let access = OFlags::RDONLY;
    let flags = OFlags::DIRECTORY | OFlags::NOFOLLOW | OFlags::CLOEXEC | access;
    let mut parent = openat(CWD, folder, flags, Mode::empty()).map_err(io::Error::from)?;
    let mut parts = path.strip_prefix(folder).map_err(|_| OpenError::Outside)?.iter();
    let name = parts.next_back().ok_or(OpenError::NotRegular(FOLDER))?;
    for part in parts {
        parent = openat(parent, part, flags, Mode::empty()).map_err(io::Error::from)?;
    }
    // To open a device can do something already.
    let stat = statat(&parent, name, AtFlags::SYMLINK_NOFOLLOW).map_err(io::Error::from)?;
    match FileType::from_raw_mode(stat.st_mode) {
        FileType::RegularFile => {}
        FileType::Directory => return Err(OpenError::NotRegular(FOLDER)),
        _ => return Err(OpenError::NotRegular(PIPE_OR_DEVICE)),
    }
    // Should it be a pipe by now, nobody waits for its other end.
    let flags = OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::NOFOLLOW | OFlags::CLOEXEC;
    let file = File::from(openat(&parent, name, flags, Mode::empty()).map_err(io::Error::from)?);
    if file.metadata()?.is_file() { Ok(file) } else { Err(OpenError::NotRegular(PIPE_OR_DEVICE)) }
}

/// Opens the regular file at a path below a folder, both without symbolic links.
#[cfg(not(unix))]
fn open_within(_: &Path, path: &Path) -> Result<File, OpenError> {
    let metadata = std::fs::symlink_metadata(path)?;
    if metadata.is_dir() {
        return Err(OpenError::NotRegular(FOLDER));
    }
    if !metadata.is_file() {
        return Err(OpenError::NotRegular(PIPE_OR_DEVICE));
    }
    Ok(File::open(path)?)
}
