//! The bytes that a glTF file refers to, fetched when they are first asked for.

use std::cell::{Cell, OnceCell, RefCell};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf::json;
use percent_encoding::percent_decode_str;

use super::meshopt::Packed;
use crate::error::{Error, Place, Result};

/// Base64 with or without its padding, as files have both.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// The buffers of a file.
pub struct Buffers<'a> {
    root: &'a json::Root,
    folder: PathBuf,
    bin: Option<&'a [u8]>,
    loaded: Vec<OnceCell<Arc<Vec<u8>>>>,
    /// The bytes of views that are packed.
    unpacked: Vec<OnceCell<Vec<u8>>>,
    loaded_bytes: Cell<u64>,
    /// Buffers that name the same file share its bytes.
    files: RefCell<HashMap<PathBuf, Arc<Vec<u8>>>>,
}

/// Where a URI leads.
pub enum Target {
    /// Bytes in the URI itself.
    Data(Vec<u8>),
    /// A file.
    File(PathBuf),
}

impl<'a> Buffers<'a> {
    /// The buffers of the file at `path`, whose binary chunk is `bin`.
    pub fn new(root: &'a json::Root, path: &Path, bin: Option<&'a [u8]>) -> Self {
        Self {
            root,
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
        let bytes = match self.resolve(uri).map_err(|e| e.place(at()))? {
            Target::Data(bytes) => {
                self.count(bytes.len());
                Arc::new(bytes)
            }
            Target::File(path) => self.file(&path).map_err(|e| {
                // The model's own path stays the error's, so that its place makes sense.
                let reason = e.message().to_owned();
                Error::input(format!("the buffer {} cannot be had: {reason}", path.display()))
                    .place(at())
                    .help("keep a .gltf file together with its .bin files")
            })?,
        };
        Ok(cell.get_or_init(|| bytes))
    }

    fn file(&self, path: &Path) -> Result<Arc<Vec<u8>>> {
        if let Some(bytes) = self.files.borrow().get(path) {
            return Ok(bytes.clone());
        }
        let bytes = Arc::new(crate::load::read(path)?);
        self.count(bytes.len());
        self.files.borrow_mut().insert(path.to_owned(), bytes.clone());
        Ok(bytes)
    }

    fn count(&self, bytes: usize) {
        self.loaded_bytes.set(self.loaded_bytes.get() + bytes as u64);
    }

    /// What a URI names: data within it, or a file beside the model.
    pub fn resolve(&self, uri: &str) -> Result<Target> {
        if let Some(rest) = strip_prefix_ignoring_case(uri, "data:") {
            return data(rest).map(Target::Data);
        }
        if let Some(scheme) = scheme(uri) {
            return Err(Error::input(format!("`{scheme}:` addresses are not read"))
                .help("name a file beside the model, or embed the data"));
        }
        let decoded = percent_decode_str(uri).decode_utf8();
        // A name that isn't UTF-8 once decoded, or a file whose own name has a % in it.
        let path = |name: &str| self.folder.join(name);
        let candidates = [
            decoded.as_ref().ok().map(|d| path(d)),
            Some(path(uri)),
            // Written on Windows.
            decoded.as_ref().ok().map(|d| path(&d.replace('\\', "/"))),
        ];
        let mut candidates = candidates.into_iter().flatten();
        let first = candidates.next().unwrap_or_else(|| path(uri));
        if first.exists() {
            return Ok(Target::File(first));
        }
        let other = candidates.find(|p| p.exists());
        Ok(Target::File(other.unwrap_or(first)))
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

/// The bytes of a data URI, without its `data:`.
fn data(uri: &str) -> Result<Vec<u8>> {
    let (head, payload) = uri
        .split_once(',')
        .ok_or_else(|| Error::input("the data URI has no comma").help("`data:TYPE;base64,DATA`"))?;
    if !head.to_ascii_lowercase().ends_with(";base64") {
        return Ok(percent_decode_str(payload).collect());
    }
    // Percent signs and line breaks are not base64, but stand in some files.
    let clean: Vec<u8> = percent_decode_str(payload).filter(|b| !b.is_ascii_whitespace()).collect();
    BASE64.decode(clean).map_err(|e| Error::input(format!("the base64 data is broken: {e}")))
}

fn strip_prefix_ignoring_case<'s>(text: &'s str, prefix: &str) -> Option<&'s str> {
    let head = text.get(..prefix.len())?;
    head.eq_ignore_ascii_case(prefix).then(|| &text[prefix.len()..])
}

/// A URI's scheme. One letter is a Windows drive, not a scheme.
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let fits = |c: char| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.');
    let is_one = scheme.len() > 1
        && scheme.starts_with(|c: char| c.is_ascii_alphabetic())
        && scheme.chars().all(fits);
    is_one.then_some(scheme)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_needs_no_padding() {
        assert_eq!(data("x/y;base64,QUI").unwrap(), b"AB");
        assert_eq!(data("x/y;base64,QUI=").unwrap(), b"AB");
    }

    #[test]
    fn data_without_base64_is_percent_encoded() {
        assert_eq!(data("text/plain,a%20b%FF").unwrap(), b"a b\xFF");
    }

    #[test]
    fn range_does_not_overflow() {
        assert_eq!(range(b"abc", 1, 2), Some(&b"bc"[..]));
        assert_eq!(range(b"abc", u64::MAX, 2), None);
        assert_eq!(range(b"abc", 1, u64::MAX), None);
    }

    #[test]
    fn scheme_is_not_a_drive() {
        assert_eq!(scheme("https://a/b.bin"), Some("https"));
        assert_eq!(scheme("c:/b.bin"), None);
        assert_eq!(scheme("b c.bin"), None);
    }
}
