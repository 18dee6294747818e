//! Modes 1 and 2: indices, of triangles and of anything.

/// Decodes the indices of triangles; `None` if the stream is damaged.
pub fn decode(bytes: &[u8], count: usize) -> Option<Vec<u32>> {
    let rest = bytes.strip_prefix(&[0xe1])?;
    let (codes, rest) = rest.split_at_checked(count / 3)?;
    let (data, table) = rest.split_at_checked(rest.len().checked_sub(16)?)?;
    let mut decoder = Decoder { data, ..Decoder::default() };
    let mut decoded = Vec::with_capacity(count);
    for &code in codes {
        decoded.extend(decoder.triangle(code, table)?);
    }
    decoder.data.is_empty().then_some(decoded)
}

/// Decodes indices that need not be of triangles; `None` if the stream is damaged.
pub fn decode_indices(bytes: &[u8], count: usize) -> Option<Vec<u32>> {
    let rest = bytes.strip_prefix(&[0xd1])?;
    let (mut data, _) = rest.split_at_checked(rest.len().checked_sub(4)?)?;
    let mut last = [0u32; 2];
    let mut decoded = Vec::with_capacity(count);
    for _ in 0..count {
        let code = varint(&mut data)?;
        let baseline = last.get_mut(code as usize & 1)?;
        let delta = if code & 2 != 0 { !(code >> 2) } else { code >> 2 };
        *baseline = baseline.wrapping_add(delta);
        decoded.push(*baseline);
    }
    data.is_empty().then_some(decoded)
}

/// A queue of the last 16 items.
#[derive(Default)]
struct Fifo<T> {
    items: [T; 16],
    at: usize,
}

impl<T: Copy> Fifo<T> {
    fn push(&mut self, item: T) {
        self.items[self.at] = item;
        self.at = (self.at + 1) % 16;
    }

    /// Returns the item that was pushed `back` items before the newest.
    fn get(&self, back: usize) -> T {
        self.items[(self.at + 31 - back) % 16]
    }
}

/// The state of the decoder between triangles.
#[derive(Default)]
struct Decoder<'d> {
    data: &'d [u8],
    /// The next new index.
    next: u32,
    /// The last explicit index.
    last: u32,
    edges: Fifo<[u32; 2]>,
    vertices: Fifo<u32>,
}

impl Decoder<'_> {
    /// Decodes a triangle.
    fn triangle(&mut self, code: u8, table: &[u8]) -> Option<[u32; 3]> {
        let (high, low) = (usize::from(code >> 4), usize::from(code & 15));
        if high < 15 {
            return self.beside_edge(high, low);
        }
        // The codes of the second and the third vertex are in the table, or in the data.
        let is_explicit = low >= 14;
        let codes = if is_explicit { *self.data.split_off_first()? } else { *table.get(low)? };
        // A code of 0 begins the new indices anew.
        if is_explicit && codes == 0 {
            self.next = 0;
        }

        // The three vertices, in order, since each changes what the next refers to.
        let a = if low == 15 { self.explicit_index()? } else { self.new_index() };
        let (b, is_new_b) = self.vertex(codes >> 4, is_explicit)?;
        let (c, is_new_c) = self.vertex(codes & 15, is_explicit)?;

        // Later triangles refer to these edges and vertices.
        self.edges.push([b, a]);
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        self.vertices.push(a);
        if is_new_b {
            self.vertices.push(b);
        }
        if is_new_c {
            self.vertices.push(c);
        }
        Some([a, b, c])
    }

    /// Decodes a triangle that shares a recent edge; `code` tells its third vertex.
    fn beside_edge(&mut self, edge: usize, code: usize) -> Option<[u32; 3]> {
        let [a, b] = self.edges.get(edge);
        let c = match code {
            0 => self.new_index(),
            1..13 => self.vertices.get(code),
            13 | 14 => {
                let step = if code == 13 { u32::MAX } else { 1 };
                self.last = self.last.wrapping_add(step);
                self.last
            }
            _ => self.explicit_index()?,
        };
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        if !(1..13).contains(&code) {
            self.vertices.push(c);
        }
        Some([a, b, c])
    }

    /// Decodes a vertex; the flag is true if it is to be pushed to the recent vertices.
    fn vertex(&mut self, code: u8, is_explicit: bool) -> Option<(u32, bool)> {
        Some(match code {
            0 => (self.new_index(), true),
            15 if is_explicit => (self.explicit_index()?, true),
            n => (self.vertices.get(usize::from(n) - 1), false),
        })
    }

    fn new_index(&mut self) -> u32 {
        let index = self.next;
        self.next = self.next.wrapping_add(1);
        index
    }

    fn explicit_index(&mut self) -> Option<u32> {
        let code = varint(&mut self.data)?;
        let delta = if code & 1 != 0 { !(code >> 1) } else { code >> 1 };
        self.last = self.last.wrapping_add(delta);
        Some(self.last)
    }
}

/// Reads an unsigned LEB128 of at most 32 bits.
fn varint(data: &mut &[u8]) -> Option<u32> {
    let mut value = 0;
    for shift in (0..32).step_by(7) {
        let byte = *data.split_off_first()?;
        value |= u32::from(byte & 127) << shift;
        if byte < 128 {
            return Some(value);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn varints_are_those_of_the_extensions_examples() {
        assert_eq!(varint(&mut &[0x7f][..]), Some(0x7f));
        assert_eq!(varint(&mut &[0x81, 0x04][..]), Some(0x201));
        assert_eq!(varint(&mut &[0x80; 9][..]), None);
    }

    #[test]
    fn two_triangles_share_an_edge() {
        // The first of three new vertices, the second at its last edge (0, 2) with a new one.
        let mut stream = vec![0xe1, 0xf0, 0x00];
        stream.extend([0; 16]);
        assert_eq!(decode(&stream, 6).unwrap(), [0, 1, 2, 0, 2, 3]);
    }

    #[test]
    fn a_stream_with_bytes_missing_or_left_is_none() {
        let mut stream = vec![0xe1, 0xf0, 0x00];
        stream.extend([0; 17]);
        assert_eq!(decode(&stream, 6), None);
        assert_eq!(decode(&stream[..18], 6), None);
    }

    #[test]
    fn indices_differ_from_one_of_two() {
        // +3 to the first, +5 to the second, −1 to the first.
        let stream = [0xd1, 3 << 2, 5 << 2 | 1, 2, 0, 0, 0, 0];
        assert_eq!(decode_indices(&stream, 3).unwrap(), [3, 5, 2]);
    }
}
