//! The elements of accessors within a buffer view, and the components (numbers) of these elements.

use gltf::json::accessor::ComponentType;
use rayon::prelude::*;

use crate::load::gltf::buffers::byte_range;
use crate::scene::GRAIN;

/// The encoding of a component.
#[derive(Clone, Copy)]
pub struct Encoding {
    /// The type of the number.
    pub component_type: ComponentType,
    /// True if an integer stands for a share of its range.
    pub normalized: bool,
}

impl Encoding {
    /// Returns a component as a float. Normalised integers map as the standard's part 3.6.2.2 says.
    pub fn float(self, bytes: &[u8]) -> f32 {
        let scale = |value: f32, greatest: f32| {
            if self.normalized { (value / greatest).max(-1.0) } else { value }
        };
        // The number of bytes tells integers apart by size, and the type by sign.
        match *bytes {
            [a] if self.component_type == ComponentType::I8 => scale(f32::from(a as i8), 127.0),
            [a] => scale(f32::from(a), 255.0),
            [a, b] if self.component_type == ComponentType::I16 => {
                scale(f32::from(i16::from_le_bytes([a, b])), 32767.0)
            }
            [a, b] => scale(f32::from(u16::from_le_bytes([a, b])), 65535.0),
            [a, b, c, d] if self.component_type == ComponentType::F32 => {
                f32::from_le_bytes([a, b, c, d])
            }
            [a, b, c, d] => scale(u32::from_le_bytes([a, b, c, d]) as f32, u32::MAX as f32),
            _ => 0.0,
        }
    }

    /// Returns a component as an unsigned integer.
    pub fn integer(self, bytes: &[u8]) -> u32 {
        match *bytes {
            [a] => u32::from(a),
            [a, b] => u32::from(u16::from_le_bytes([a, b])),
            [a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
            _ => 0,
        }
    }
}

/// Returns the bytes from the first to the last of `count` elements of `size` bytes, `stride` bytes
/// apart, from a byte `offset` of a view; `None` if the view has not that many.
pub fn element_range(
    bytes: &[u8],
    offset: u64,
    stride: usize,
    size: usize,
    count: usize,
) -> Option<&[u8]> {
    if count == 0 {
        return Some(&[]);
    }
    let length = (count as u64 - 1).checked_mul(stride as u64)?.checked_add(size as u64)?;
    byte_range(bytes, offset, length)
}

/// Decodes contiguous elements of `N` components of `SIZE` bytes each, in parallel where they are
/// many; bytes that do not fill an element are ignored.
pub fn decode_contiguous<T: Copy + Default + Send, const N: usize, const SIZE: usize>(
    bytes: &[u8],
    decode: impl Fn([u8; SIZE]) -> T + Sync,
) -> Vec<[T; N]> {
    let (components, _) = bytes.as_chunks::<SIZE>();
    let (elements, _) = components.as_chunks::<N>();
    let element = |bytes: &[[u8; SIZE]; N]| bytes.map(&decode);
    elements.par_iter().with_min_len(GRAIN).map(element).collect()
}
