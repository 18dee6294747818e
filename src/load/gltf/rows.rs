//! Elements within a buffer, one after the other.

use super::buffers::range;

/// Elements of `size` bytes, `stride` bytes apart, known to lie within their bytes.
pub struct Rows<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    left: usize,
}

impl<'a> Rows<'a> {
    /// `count` of them from `offset` on, if so many are there.
    pub fn new(
        bytes: &'a [u8],
        offset: u64,
        stride: usize,
        size: usize,
        count: usize,
    ) -> Option<Self> {
        if count == 0 {
            return Some(Self { bytes: &[], stride, size, left: 0 });
        }
        let length = (count as u64 - 1).checked_mul(stride as u64)?.checked_add(size as u64)?;
        Some(Self { bytes: range(bytes, offset, length)?, stride, size, left: count })
    }

    /// The bytes of all elements, where there are no others between them.
    pub fn packed(&self) -> Option<&'a [u8]> {
        (self.stride == self.size).then_some(self.bytes)
    }
}

impl<'a> Iterator for Rows<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        self.left = self.left.checked_sub(1)?;
        let row = self.bytes.get(..self.size)?;
        self.bytes = self.bytes.get(self.stride..).unwrap_or_default();
        Some(row)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}
