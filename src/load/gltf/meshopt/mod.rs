//! EXT_meshopt_compression: buffer views that are packed. Written after the extension's own text
//! (appendices A and B), since no crate reads it without C++ or unsafe code; a damaged stream is an
//! error, or other numbers, never more.

mod attributes;
mod filters;
mod triangles;

use gltf::json::Value;

use crate::error::{Error, Result};

/// What the extension says of a view.
pub struct Packed {
    /// The buffer that has the packed bytes.
    pub buffer: usize,
    /// Where they begin there.
    pub offset: u64,
    /// How many they are.
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

impl Packed {
    /// Reads the extension's object.
    ///
    /// # Errors
    /// When something is missing in it or out of range.
    pub fn read(object: &Value) -> Result<Self> {
        let whole = |name: &str| object.get(name).and_then(Value::as_u64);
        let needed = |name: &str| {
            whole(name).ok_or_else(|| Error::input(format!("`{name}` must be a whole number")))
        };
        let word = |name: &str| object.get(name).and_then(Value::as_str);
        let mode = match word("mode") {
            Some("ATTRIBUTES") => Mode::Attributes,
            Some("TRIANGLES") => Mode::Triangles,
            Some("INDICES") => Mode::Indices,
            _ => return Err(Error::input("the mode is not known")),
        };
        let filter = match word("filter") {
            None | Some("NONE") => Filter::None,
            Some("OCTAHEDRAL") => Filter::Octahedral,
            Some("QUATERNION") => Filter::Quaternion,
            Some("EXPONENTIAL") => Filter::Exponential,
            Some(_) => return Err(Error::input("the filter is not known")),
        };
        let (stride, count) = (needed("byteStride")?, needed("count")?);
        let fits = match (&mode, &filter) {
            (Mode::Attributes, Filter::None | Filter::Exponential) => {
                stride > 0 && stride % 4 == 0 && stride <= 256
            }
            (Mode::Attributes, Filter::Octahedral) => stride == 4 || stride == 8,
            (Mode::Attributes, Filter::Quaternion) => stride == 8,
            (Mode::Triangles, Filter::None) => (stride == 2 || stride == 4) && count % 3 == 0,
            (Mode::Indices, Filter::None) => stride == 2 || stride == 4,
            _ => false,
        };
        if !fits {
            return Err(Error::input(format!("a stride of {stride} does not fit the mode")));
        }
        let size = |x: u64| usize::try_from(x).map_err(|_| Error::input("too many elements"));
        Ok(Self {
            buffer: size(needed("buffer")?)?,
            offset: whole("byteOffset").unwrap_or(0),
            length: needed("byteLength")?,
            stride: size(stride)?,
            count: size(count)?,
            mode,
            filter,
        })
    }

    /// How many bytes it is unpacked.
    pub fn size(&self) -> u64 {
        (self.count as u64).saturating_mul(self.stride as u64)
    }

    /// The bytes of the view.
    ///
    /// # Errors
    /// When the stream is damaged, or says of itself that it holds more than it can.
    pub fn unpack(&self, bytes: &[u8]) -> Result<Vec<u8>> {
        let Self { stride, count, .. } = *self;
        // A header bit pair, the least that a stream has of 16 deltas; or a byte of a triangle.
        let most = match self.mode {
            Mode::Attributes => bytes.len().saturating_mul(64),
            Mode::Triangles => bytes.len().saturating_mul(3),
            Mode::Indices => bytes.len(),
        };
        let total = match self.mode {
            Mode::Attributes => count.checked_mul(stride),
            _ => Some(count),
        };
        if total.is_none_or(|total| total > most) {
            return Err(Error::input(format!(
                "{} bytes cannot hold {count} elements",
                bytes.len()
            )));
        }
        let indices = match self.mode {
            Mode::Attributes => {
                let mut made = attributes::decode(bytes, count, stride).ok_or_else(damaged)?;
                match self.filter {
                    Filter::None => {}
                    Filter::Octahedral => filters::octahedral(&mut made, stride),
                    Filter::Quaternion => filters::quaternion(&mut made),
                    Filter::Exponential => filters::exponential(&mut made),
                }
                return Ok(made);
            }
            Mode::Triangles => triangles::decode(bytes, count),
            Mode::Indices => triangles::decode_indices(bytes, count),
        };
        let indices = indices.ok_or_else(damaged)?;
        Ok(match stride {
            2 => indices.iter().flat_map(|i| (*i as u16).to_le_bytes()).collect(),
            _ => indices.iter().flat_map(|i| i.to_le_bytes()).collect(),
        })
    }
}

fn damaged() -> Error {
    Error::input("the packed data are damaged")
        .help("`npx @gltf-transform/cli copy IN.glb OUT.glb` says whether others can read it")
}
