//! Numbers that stand side by side, decoded all at once: one loop that knows what they are, on
//! several threads where they are many.

use rayon::prelude::*;

use crate::scene::GRAIN;

/// Elements of `N` numbers of `S` bytes each; bytes that do not fill an element are left out.
pub fn decode<T: Copy + Default + Send, const N: usize, const S: usize>(
    bytes: &[u8],
    number: impl Fn([u8; S]) -> T + Sync,
) -> Vec<[T; N]> {
    let (numbers, _) = bytes.as_chunks::<S>();
    let (elements, _) = numbers.as_chunks::<N>();
    let element = |bytes: &[[u8; S]; N]| bytes.map(&number);
    elements.par_iter().with_min_len(GRAIN).map(element).collect()
}
