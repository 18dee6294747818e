//! The bytes that a glTF file refers to, loaded when they are first needed.

use std::cell::{Cell, OnceCell, RefCell};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gltf::json;

use super::compression::meshopt::{self, CompressedView};
use super::json::{at_path, error_at, lookup};
use crate::error::{Error, Result};
use crate::load::limits::Limit;
use crate::load::sandbox::{OpenedFile, Sandbox};
use crate::load::uri::Uri;

/// The buffers and buffer views of a file.
pub struct Buffers<'a> {
    /// The JSON of the file.
    pub root: &'a json::Root,
    /// The sandbox of the load.
    pub sandbox: &'a Sandbox,
    folder: PathBuf,
    /// The binary chunk of a GLB.
    bin: Option<&'a [u8]>,
    buffers: Vec<OnceCell<Arc<Vec<u8>>>>,
    /// The bytes of compressed views.
    decompressed_views: Vec<OnceCell<Vec<u8>>>,
    loaded_bytes: Cell<u64>,
    /// The bytes of files, which buffers that name the same file share.
    files: RefCell<HashMap<PathBuf, Arc<Vec<u8>>>>,
}

/// The data that a URI names.
pub enum UriTarget {
    /// Bytes in the URI itself.
    Data(Vec<u8>),
    /// A file.
    File(OpenedFile),
}

impl<'a> Buffers<'a> {
    /// The buffers of the file at `path`, whose binary chunk is `bin`.
    pub fn new(
        root: &'a json::Root,
        sandbox: &'a Sandbox,
        path: &Path,
        bin: Option<&'a [u8]>,
    ) -> Self {
        Self {
            root,
            sandbox,
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            bin,
            decompressed_views: root.buffer_views.iter().map(|_| OnceCell::new()).collect(),
            buffers: root.buffers.iter().map(|_| OnceCell::new()).collect(),
            loaded_bytes: Cell::new(bin.map_or(0, |b| b.len() as u64)),
            files: RefCell::default(),
        }
    }

    /// The number of bytes loaded so far; a file that several buffers name counts once.
    pub fn loaded_bytes(&self) -> u64 {
        self.loaded_bytes.get()
    }

    /// Returns the bytes of a buffer view, to which the JSON path `by` refers.
    ///
    /// # Errors
    /// When there is no such view, its buffer cannot be loaded or is too short, or its compressed
    /// bytes are damaged.
    pub fn view(&self, index: usize, by: &str) -> Result<&[u8]> {
        let path = format!("bufferViews[{index}]");
        let view = lookup(&self.root.buffer_views, index, "bufferView", by)?;
        // A compressed view has its own buffer, which is decompressed when it is first needed.
        let others = view.extensions.as_ref().map(|extensions| &extensions.others);
        if let Some(compressed) = others.and_then(|others| others.get(meshopt::NAME)) {
            let path = format!("{path}.extensions.{}", meshopt::NAME);
            return self.decompressed_view(index, compressed, &path);
        }

        // All other views are ranges of their buffer.
        let buffer = view.buffer.value();
        let bytes = self.buffer(buffer, &format!("{path}.buffer"))?;
        let offset = view.byte_offset.map_or(0, |o| o.0);
        let length = view.byte_length.0;
        byte_range(bytes, offset, length).ok_or_else(|| {
            let found = bytes.len();
            let message = format!(
                "the view takes {length} bytes from byte {offset} of buffers[{buffer}], which has \
                 {found}"
            );
            error_at(path, message)
                .help("the file or its buffer is damaged or cut short; export it again")
        })
    }

    /// Returns the bytes of a view of the file that EXT_meshopt_compression has compressed.
    fn decompressed_view(
        &self,
        index: usize,
        extension: &json::Value,
        path: &str,
    ) -> Result<&[u8]> {
        let cell = &self.decompressed_views[index];
        if let Some(bytes) = cell.get() {
            return Ok(bytes);
        }

        // The compressed bytes, from the buffer that the extension names.
        let view = CompressedView::from_json(extension).map_err(at_path(path))?;
        let CompressedView { buffer, offset, length, .. } = view;
        let bytes = self.buffer(buffer, &format!("{path}.buffer"))?;
        let bytes = byte_range(bytes, offset, length).ok_or_else(|| {
            let found = bytes.len();
            let message = format!(
                "it takes {length} bytes from byte {offset} of buffers[{buffer}], which has {found}"
            );
            error_at(path, message)
        })?;
        // The size is limited before memory is taken.
        self.sandbox.consume(Limit::Bytes, view.decompressed_size()).map_err(at_path(path))?;
        let decompressed = view.decompress(bytes).map_err(at_path(path))?;
        self.add_loaded(decompressed.len());
        Ok(cell.get_or_init(|| decompressed))
    }

    /// Returns the bytes of a buffer.
    fn buffer(&self, index: usize, by: &str) -> Result<&[u8]> {
        let path = format!("buffers[{index}].uri");
        let buffer = lookup(&self.root.buffers, index, "buffer", by)?;
        // Without a URI it is the binary chunk, which is the first buffer and no other.
        let Some(uri) = &buffer.uri else {
            return self.bin.filter(|_| index == 0).ok_or_else(|| {
                let message = "the buffer has no data: neither a URI nor a GLB's chunk";
                error_at(format_args!("buffers[{index}]"), message)
            });
        };

        // The data of a URI are loaded once, and files once for all buffers that name them.
        let cell = &self.buffers[index];
        if let Some(bytes) = cell.get() {
            return Ok(bytes);
        }
        let loaded = self.resolve(uri).and_then(|target| match target {
            UriTarget::Data(bytes) => {
                self.add_loaded(bytes.len());
                Ok(Arc::new(bytes))
            }
            UriTarget::File(file) => self.file(file),
        });
        // A new error names no file, so that its place is that in the model.
        let bytes = loaded.map_err(|e| unreadable("buffer", uri, &e)).map_err(at_path(&path))?;
        Ok(cell.get_or_init(|| bytes))
    }

    fn file(&self, file: OpenedFile) -> Result<Arc<Vec<u8>>> {
        let identity = file.identity.clone();
        if let Some(bytes) = self.files.borrow().get(&identity) {
            return Ok(bytes.clone());
        }
        let bytes = Arc::new(file.read(self.sandbox)?);
        self.add_loaded(bytes.len());
        self.files.borrow_mut().insert(identity, bytes.clone());
        Ok(bytes)
    }

    fn add_loaded(&self, bytes: usize) {
        self.loaded_bytes.set(self.loaded_bytes.get() + bytes as u64);
    }

    /// Decodes the data in a URI, or opens the file that it names.
    ///
    /// # Errors
    /// When the URI or its data are damaged, or the file cannot be opened or is outside.
    pub fn resolve(&self, uri: &str) -> Result<UriTarget> {
        Ok(match Uri::parse(uri)? {
            Uri::Data(bytes) => UriTarget::Data(bytes),
            Uri::File(names) => UriTarget::File(self.sandbox.open(&self.folder, &names)?),
        })
    }
}

/// The error that a buffer or an image cannot be read from its URI.
pub fn unreadable(what: &str, uri: &str, error: &Error) -> Error {
    // A data URI can be long.
    let uri = match uri.char_indices().nth(80) {
        Some((cut, _)) => format!("{}…", &uri[..cut]),
        None => uri.to_owned(),
    };
    // The advice and the remedy of the cause are those that help.
    let advice =
        error.advice().unwrap_or("keep a .gltf file together with the files that it names");
    let message = format!("the {what} `{uri}` cannot be loaded: {}", error.message());
    let unreadable = Error::input(message).help(advice);
    match error.remedy() {
        Some(remedy) => unreadable.remedied_by(remedy),
        None => unreadable,
    }
}

/// Returns `length` bytes from `offset`, if they are there.
pub fn byte_range(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    let end = usize::try_from(offset.checked_add(length)?).ok()?;
    bytes.get(start..end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_range_does_not_overflow() {
        assert_eq!(byte_range(b"abc", 1, 2), Some(&b"bc"[..]));
        assert_eq!(byte_range(b"abc", u64::MAX, 2), None);
        assert_eq!(byte_range(b"abc", 1, u64::MAX), None);
    }
}
