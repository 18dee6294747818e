//! Mode 0: the bytes of elements as differences, byte by byte of each, in groups of 16.

/// Elements of `stride` bytes; nothing where the stream is not one.
pub fn decode(bytes: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let (&header, rest) = bytes.split_first()?;
    if header != 0xa0 {
        return None;
    }
    // The tail is a first element to differ from, at the very end of 32 bytes or more.
    let (mut data, tail) = rest.split_at_checked(rest.len().checked_sub(stride.max(32))?)?;
    let mut last = tail.get(tail.len() - stride..)?.to_vec();
    let most = ((8192 / stride) & !15).min(256);
    let mut made = vec![0; count * stride];
    let mut deltas = [0; 256];
    for block in made.chunks_mut(most * stride) {
        let elements = block.len() / stride;
        let groups = elements.div_ceil(16);
        for (k, last) in last.iter_mut().enumerate() {
            let headers = take(&mut data, groups.div_ceil(4))?;
            for (i, group) in deltas.chunks_mut(16).take(groups).enumerate() {
                let mode = headers.get(i / 4)? >> (i % 4 * 2) & 3;
                group_of(&mut data, mode, group)?;
            }
            for (element, delta) in block.chunks_mut(stride).zip(&deltas) {
                *last = last.wrapping_add(unzigzag(*delta));
                *element.get_mut(k)? = *last;
            }
        }
    }
    data.is_empty().then_some(made)
}

/// Reads 16 differences: all 0, of 2 bits, of 4 bits, or bytes. Those with all bits set stand as
/// whole bytes behind the others.
fn group_of(data: &mut &[u8], mode: u8, group: &mut [u8]) -> Option<()> {
    let bits = match mode {
        0 => {
            group.fill(0);
            return Some(());
        }
        1 => 2,
        2 => 4,
        _ => {
            group.copy_from_slice(take(data, 16)?);
            return Some(());
        }
    };
    let per_byte = 8 / bits;
    let short = take(data, 16 / per_byte)?;
    let sentinel = (1u8 << bits) - 1;
    for (i, delta) in group.iter_mut().enumerate() {
        let shift = 8 - bits * (i % per_byte + 1);
        *delta = short.get(i / per_byte)? >> shift & sentinel;
        if *delta == sentinel {
            [*delta] = *take(data, 1)?.first_chunk()?;
        }
    }
    Some(())
}

fn unzigzag(x: u8) -> u8 {
    if x & 1 != 0 { !(x >> 1) } else { x >> 1 }
}

fn take<'d>(data: &mut &'d [u8], count: usize) -> Option<&'d [u8]> {
    let (taken, rest) = data.split_at_checked(count)?;
    *data = rest;
    Some(taken)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_of_four_bits_are_those_of_the_extensions_example() {
        let mut data = &[0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5][..];
        let mut group = [0; 16];
        group_of(&mut data, 2, &mut group).unwrap();
        let found = group.map(|x| unzigzag(x) as i8);
        assert_eq!(found, [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]);
        assert!(data.is_empty());
    }

    #[test]
    fn elements_follow_from_the_one_in_the_tail() {
        // One group of four bytes each: differences 2, 0, 0, 0 of the first element alone.
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
