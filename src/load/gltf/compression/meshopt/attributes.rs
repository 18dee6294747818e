//! Mode 0: the bytes of elements as deltas, byte by byte of each, in groups of 16.

/// Decodes `count` elements of `stride` bytes; `None` if the stream is damaged.
pub fn decode(bytes: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let rest = bytes.strip_prefix(&[0xa0])?;
    // The tail, of 32 bytes or more, ends with the element that the first delta refers to.
    let (mut data, tail) = rest.split_at_checked(rest.len().checked_sub(stride.max(32))?)?;
    let mut last = tail.get(tail.len() - stride..)?.to_vec();
    let block_size = ((8192 / stride) & !15).min(256);
    let mut decoded = vec![0; count * stride];
    let mut deltas = [0; 256];
    // Each block has the deltas of one byte of all its elements, then those of the next byte.
    for block in decoded.chunks_mut(block_size * stride) {
        let elements = block.len() / stride;
        let groups = elements.div_ceil(16);
        for (k, last) in last.iter_mut().enumerate() {
            let headers = data.split_off(..groups.div_ceil(4))?;
            for (i, group) in deltas.chunks_mut(16).take(groups).enumerate() {
                let mode = headers.get(i / 4)? >> (i % 4 * 2) & 3;
                decode_group(&mut data, mode, group)?;
            }
            for (element, delta) in block.chunks_mut(stride).zip(&deltas) {
                *last = last.wrapping_add(unzigzag(*delta));
                *element.get_mut(k)? = *last;
            }
        }
    }
    data.is_empty().then_some(decoded)
}

/// Decodes 16 deltas: all 0, of 2 bits, of 4 bits, or bytes. A delta of 2
/// or 4 bits that are all set stands for a whole byte, which is stored after the group's bits.
fn decode_group(data: &mut &[u8], mode: u8, group: &mut [u8]) -> Option<()> {
    // The number of bits of a delta. Two modes need no bits: all zero, and whole bytes.
    let bits = match mode {
        0 => {
            group.fill(0);
            return Some(());
        }
        1 => 2,
        2 => 4,
        _ => {
            group.copy_from_slice(data.split_off(..16)?);
            return Some(());
        }
    };

    // The first delta of a byte is in its highest bits.
    let per_byte = 8 / bits;
    let short = data.split_off(..16 / per_byte)?;
    let sentinel = (1u8 << bits) - 1;
    for (i, delta) in group.iter_mut().enumerate() {
        let shift = 8 - bits * (i % per_byte + 1);
        *delta = short.get(i / per_byte)? >> shift & sentinel;
        if *delta == sentinel {
            *delta = *data.split_off_first()?;
        }
    }
    Some(())
}

fn unzigzag(x: u8) -> u8 {
    if x & 1 != 0 { !(x >> 1) } else { x >> 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deltas_of_four_bits_are_those_of_the_extensions_example() {
        let mut data = &[0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5][..];
        let mut group = [0; 16];
        decode_group(&mut data, 2, &mut group).unwrap();
        let found = group.map(|x| unzigzag(x) as i8);
        assert_eq!(found, [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]);
        assert!(data.is_empty());
    }

    #[test]
    fn elements_follow_from_the_one_in_the_tail() {
        // One group of four bytes each: deltas 2, 0, 0, 0 of the first element alone.
        let mut stream = vec![0xa0];
        stream.extend([3, 4]);
        stream.extend([0; 15]);
        stream.extend([0, 0, 0]);
        stream.extend([0; 28]);
        stream.extend([10, 20, 30, 40]);
        let made = decode(&stream, 2, 4).unwrap();
        assert_eq!(made, [12, 20, 30, 40, 12, 20, 30, 40]);
    }

    #[test]
    fn a_stream_cut_short_anywhere_is_none() {
        let mut stream = vec![0xa0, 0, 0, 0, 0];
        stream.extend([0; 32]);
        assert!(decode(&stream, 3, 4).is_some());
        for length in 0..stream.len() {
            assert_eq!(decode(&stream[..length], 3, 4), None, "{length}");
        }
    }
}
