//! How a picture is cut up.

/// How a picture is cut into the batches that go through the intersector together.
///
/// It decides speed and never the picture, in precision `certified`: the stress test tries it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tiling {
    /// Rows of a strip, the unit of work that threads share; at least 1.
    pub rows: usize,
    /// Columns of a tile, the batch; at least 1.
    pub columns: usize,
    /// Side of the squares in which a tile's rays are lined up; at least 1.
    pub block: usize,
}

impl Default for Tiling {
    /// Tiles of 64 × 16 pixels, of squares of 4 × 4, so that a packet of 16 is a square.
    fn default() -> Self {
        Self { rows: 16, columns: 64, block: 4 }
    }
}
