//! EXT_meshopt_compression: compressed buffer views. Written after the extension's own text
//! (appendices A and B), since no crate decodes it without C++ or unsafe code; a damaged stream is
//! an error, or other numbers, never more.

mod attributes;
mod filters;
mod triangles;

use gltf::json::Value;

use crate::error::{Error, Result};

/// The extension's name.
pub const NAME: &str = "EXT_meshopt_compression";

/// The extension's object in a buffer view.
pub struct CompressedView {
    /// The index of the buffer with the compressed bytes.
    pub buffer: usize,
    /// The offset of the compressed bytes.
    pub offset: u64,
    /// The number of compressed bytes.
    pub length: u64,
    stride: usize,
    count: usize,
    mode: Mode,
    filter: Filter,
}

enum Mode {
    Attributes,
    Triangles,
    Indices,
}

enum Filter {
    None,
    Octahedral,
    Quaternion,
    Exponential,
}

impl CompressedView {
    /// Reads the extension's object.
    ///
    /// # Errors
    /// When something is missing in it or out of range.
    pub fn from_json(object: &Value) -> Result<Self> {
        let integer = |name: &str| object.get(name).and_then(Value::as_u64);
        let required = |name: &str| {
            integer(name).ok_or_else(|| Error::input(format!("`{name}` must be a whole number")))
        };
        let text = |name: &str| object.get(name).and_then(Value::as_str);
        // The way in which the bytes are compressed, and the filter that was applied before.
        let mode = match text("mode") {
            Some("ATTRIBUTES") => Mode::Attributes,
            Some("TRIANGLES") => Mode::Triangles,
            Some("INDICES") => Mode::Indices,
            _ => return Err(Error::input("the mode is not known")),
        };
        let filter = match text("filter") {
            None | Some("NONE") => Filter::None,
            Some("OCTAHEDRAL") => Filter::Octahedral,
            Some("QUATERNION") => Filter::Quaternion,
            Some("EXPONENTIAL") => Filter::Exponential,
            Some(_) => return Err(Error::input("the filter is not known")),
        };

        // Each mode and filter has its own strides.
        let (stride, count) = (required("byteStride")?, required("count")?);
        let is_valid = match (&mode, &filter) {
            (Mode::Attributes, Filter::None | Filter::Exponential) => {
                stride > 0 && stride % 4 == 0 && stride <= 256
            }
            (Mode::Attributes, Filter::Octahedral) => stride == 4 || stride == 8,
            (Mode::Attributes, Filter::Quaternion) => stride == 8,
            (Mode::Triangles, Filter::None) => (stride == 2 || stride == 4) && count % 3 == 0,
            (Mode::Indices, Filter::None) => stride == 2 || stride == 4,
            _ => false,
        };
        if !is_valid {
            return Err(Error::input(format!("a stride of {stride} does not fit the mode")));
        }

        // All numbers are checked again against the buffer, when the view is loaded.
        let to_usize = |x: u64| usize::try_from(x).map_err(|_| Error::input("too many elements"));
        Ok(Self {
            buffer: to_usize(required("buffer")?)?,
            offset: integer("byteOffset").unwrap_or(0),
            length: required("byteLength")?,
            stride: to_usize(stride)?,
            count: to_usize(count)?,
            mode,
            filter,
        })
    }

    /// The number of bytes after decompression.
    pub fn decompressed_size(&self) -> u64 {
        (self.count as u64).saturating_mul(self.stride as u64)
    }

    /// Returns the decompressed bytes of the view.
    ///
    /// # Errors
    /// When the stream is damaged, or claims to hold more elements than it can.
    pub fn decompress(&self, bytes: &[u8]) -> Result<Vec<u8>> {
        let Self { stride, count, .. } = *self;
        // A stream has at least two header bits for 16 deltas, a byte for a triangle, or a byte for
        // an index.
        let (total, most) = match self.mode {
            Mode::Attributes => (count.checked_mul(stride), bytes.len().saturating_mul(64)),
            Mode::Triangles => (Some(count), bytes.len().saturating_mul(3)),
            Mode::Indices => (Some(count), bytes.len()),
        };
        // A damaged count must not make us reserve more memory than the stream can fill.
        if total.is_none_or(|total| total > most) {
            let found = bytes.len();
            return Err(Error::input(format!("{found} bytes cannot hold {count} elements")));
        }
        // Attributes are decoded and filtered; indices are written with the view's stride.
        let indices = match self.mode {
            Mode::Attributes => {
                let mut bytes = attributes::decode(bytes, count, stride).ok_or_else(damaged)?;
                match self.filter {
                    Filter::None => {}
                    Filter::Octahedral => filters::octahedral(&mut bytes, stride),
                    Filter::Quaternion => filters::quaternion(&mut bytes),
                    Filter::Exponential => filters::exponential(&mut bytes),
                }
                return Ok(bytes);
            }
            Mode::Triangles => triangles::decode(bytes, count),
            Mode::Indices => triangles::decode_indices(bytes, count),
        };
        let indices = indices.ok_or_else(damaged)?;
        Ok(if stride == 2 {
            indices.iter().flat_map(|i| (*i as u16).to_le_bytes()).collect()
        } else {
            indices.iter().flat_map(|i| i.to_le_bytes()).collect()
        })
    }
}

fn damaged() -> Error {
    Error::input("the compressed data are damaged")
        .help("`npx @gltf-transform/cli copy IN.glb OUT.glb` says whether others can read it")
}
