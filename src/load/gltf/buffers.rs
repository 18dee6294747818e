//! The bytes that a glTF file refers to, fetched when they are first asked for.

use std::cell::{Cell, OnceCell, RefCell};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gltf::json;

use super::meshopt::Packed;
use crate::error::{Error, Place, Result};
use crate::load::limits::Limit;
use crate::load::sandbox::{OpenedFile, Sandbox};
use crate::load::uri::Uri;

/// The buffers of a file.
pub struct Buffers<'a> {
    root: &'a json::Root,
    guard: &'a Sandbox,
    folder: PathBuf,
    bin: Option<&'a [u8]>,
    loaded: Vec<OnceCell<Arc<Vec<u8>>>>,
    /// The bytes of views that are packed.
    unpacked: Vec<OnceCell<Vec<u8>>>,
    loaded_bytes: Cell<u64>,
    /// Buffers that name the same file share its bytes.
    files: RefCell<HashMap<PathBuf, Arc<Vec<u8>>>>,
}

/// What a URI names, found.
pub enum Target {
    /// Bytes in the URI itself.
    Data(Vec<u8>),
    /// A file.
    File(OpenedFile),
}

impl<'a> Buffers<'a> {
    /// The buffers of the file at `path`, whose binary chunk is `bin`.
    pub fn new(
        root: &'a json::Root,
        guard: &'a Sandbox,
        path: &Path,
        bin: Option<&'a [u8]>,
    ) -> Self {
        Self {
            root,
            guard,
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            bin,
            unpacked: root.buffer_views.iter().map(|_| OnceCell::new()).collect(),
            loaded: root.buffers.iter().map(|_| OnceCell::new()).collect(),
            loaded_bytes: Cell::new(bin.map_or(0, |b| b.len() as u64)),
            files: RefCell::default(),
        }
    }

    /// How many bytes have been fetched so far; files that several buffers name count once.
    pub fn loaded_bytes(&self) -> u64 {
        self.loaded_bytes.get()
    }

    /// The bytes of a buffer view. `by` is the place of what refers to it.
    pub fn view(&self, index: usize, by: &str) -> Result<&[u8]> {
        let at = || format!("bufferViews[{index}]");
        let view = get(&self.root.buffer_views, index, "bufferView", by)?;
        let others = view.extensions.as_ref().map(|extensions| &extensions.others);
        if let Some(packed) = others.and_then(|others| others.get("EXT_meshopt_compression")) {
            let at = format!("{}.extensions.EXT_meshopt_compression", at());
            return self.unpacked(index, packed, &at);
        }
        let buffer_index = view.buffer.value();
        let bytes = self.buffer(buffer_index, &format!("{}.buffer", at()))?;
        let offset = view.byte_offset.map_or(0, |o| o.0);
        let length = view.byte_length.0;
        range(bytes, offset, length).ok_or_else(|| {
            Error::input(format!(
                "the view takes {length} bytes from byte {offset} of buffers[{buffer_index}], \
                 which has {}",
                bytes.len()
            ))
            .place(Place::Json(at()))
            .help("the file or its buffer is damaged or cut short; export it again")
        })
    }

    /// The bytes of a view that is packed.
    fn unpacked(&self, index: usize, packed: &json::Value, at: &str) -> Result<&[u8]> {
        let place = |e: Error| e.place(Place::Json(at.to_owned()));
        let missing = || place(Error::input("the view is not there"));
        let cell = self.unpacked.get(index).ok_or_else(missing)?;
        if let Some(bytes) = cell.get() {
            return Ok(bytes);
        }
        let packed = Packed::read(packed).map_err(place)?;
        let bytes = self.buffer(packed.buffer, &format!("{at}.buffer"))?;
        let Packed { offset, length, .. } = packed;
        let bytes = range(bytes, offset, length).ok_or_else(|| {
            let (buffer, found) = (packed.buffer, bytes.len());
            place(Error::input(format!(
                "it takes {length} bytes from byte {offset} of buffers[{buffer}], which has {found}"
            )))
        })?;
        self.guard.take(Limit::Bytes, packed.size()).map_err(place)?;
        let made = packed.unpack(bytes).map_err(place)?;
        self.count(made.len());
        Ok(cell.get_or_init(|| made))
    }

    fn buffer(&self, index: usize, by: &str) -> Result<&[u8]> {
        let at = || Place::Json(format!("buffers[{index}].uri"));
        let buffer = get(&self.root.buffers, index, "buffer", by)?;
        let Some(uri) = &buffer.uri else {
            return match self.bin {
                Some(bin) if index == 0 => Ok(bin),
                _ => Err(Error::input("the buffer has no data: neither a URI nor a GLB's chunk")
                    .place(Place::Json(format!("buffers[{index}]")))),
            };
        };
        let missing = || Error::input("the buffer is not there").place(at());
        let cell = self.loaded.get(index).ok_or_else(missing)?;
        if let Some(bytes) = cell.get() {
            return Ok(bytes);
        }
        let bytes =
            match self.resolve(uri).map_err(|e| cannot_have("buffer", uri, &e).place(at()))? {
                Target::Data(bytes) => {
                    self.count(bytes.len());
                    Arc::new(bytes)
                }
                Target::File(file) => self.file(file).map_err(|e| {
                    // The model's own path stays the error's, so that its place makes sense.
                    cannot_have("buffer", uri, &e).place(at())
                })?,
            };
        Ok(cell.get_or_init(|| bytes))
    }

    fn file(&self, file: OpenedFile) -> Result<Arc<Vec<u8>>> {
        let identity = file.identity.clone();
        if let Some(bytes) = self.files.borrow().get(&identity) {
            return Ok(bytes.clone());
        }
        let bytes = Arc::new(file.read(self.guard)?);
        self.count(bytes.len());
        self.files.borrow_mut().insert(identity, bytes.clone());
        Ok(bytes)
    }

    fn count(&self, bytes: usize) {
        self.loaded_bytes.set(self.loaded_bytes.get() + bytes as u64);
    }

    /// What a URI names: data within it, or a file that may be read.
    pub fn resolve(&self, uri: &str) -> Result<Target> {
        Ok(match Uri::parse(uri)? {
            Uri::Data(bytes) => Target::Data(bytes),
            Uri::File(names) => Target::File(self.guard.open(&self.folder, &names)?),
        })
    }
}

/// The error that what a URI names, a buffer or a picture, is not to be had.
pub fn cannot_have(what: &str, uri: &str, error: &Error) -> Error {
    let uri = shortened(uri);
    let cannot = Error::input(format!("the {what} `{uri}` cannot be had: {}", error.message()));
    match error.advice() {
        Some(advice) => cannot.help(advice),
        None => cannot.help("keep a .gltf file together with the files that it names"),
    }
}

/// A URI as a message can show it.
fn shortened(uri: &str) -> String {
    match uri.char_indices().nth(80) {
        Some((cut, _)) => format!("{}…", &uri[..cut]),
        None => uri.to_owned(),
    }
}

/// An element of one of the root's lists, or the error that `by` names none.
pub fn get<'r, T>(list: &'r [T], index: usize, kind: &str, by: &str) -> Result<&'r T> {
    list.get(index).ok_or_else(|| {
        let found = match list.len() {
            0 => "the file has none".to_owned(),
            1 => "the file has one, number 0".to_owned(),
            n => format!("the file has {n}, from 0 to {}", n - 1),
        };
        Error::input(format!("there is no {kind} {index}: {found}"))
            .place(Place::Json(by.to_owned()))
    })
}

/// `length` bytes from `offset`, if they are there.
pub fn range(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    let end = usize::try_from(offset.checked_add(length)?).ok()?;
    bytes.get(start..end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn range_does_not_overflow() {
        assert_eq!(range(b"abc", 1, 2), Some(&b"bc"[..]));
        assert_eq!(range(b"abc", u64::MAX, 2), None);
        assert_eq!(range(b"abc", 1, u64::MAX), None);
    }
}
