//! How a picture is cut up.

use crate::geometry::{LANES, Lanes};

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

/// The pixels of a tile, in the order in which their rays are lined up.
#[derive(Debug, Default)]
pub(super) struct Tile {
    /// Width and height, and the side of the squares.
    shape: ([usize; 2], usize),
    /// How many pixels there are.
    pub count: usize,
    /// Column and row of the upper left one in the picture.
    pub place: [f64; 2],
    /// Columns and rows in the tile, sixteen by sixteen.
    pub places: Vec<[Lanes<f64>; 2]>,
    /// Pixels that are neighbours in a row: column, row and number.
    pub runs: Vec<[u32; 3]>,
}

impl Tile {
    /// Makes it the tile of a shape whose upper left pixel is at a place in the picture.
    pub fn set(&mut self, place: [usize; 2], shape: [usize; 2], block: usize) {
        self.place = place.map(|x| x as f64);
        if self.shape == (shape, block) {
            return;
        }
        self.shape = (shape, block);
        self.places.clear();
        self.runs.clear();
        self.count = 0;
        let [columns, rows] = shape;
        for y in (0..rows).step_by(block) {
            for x in (0..columns).step_by(block) {
                for row in y..(y + block).min(rows) {
                    let end = (x + block).min(columns);
                    self.runs.push([x as u32, row as u32, (end - x) as u32]);
                    (x..end).for_each(|column| self.add(column, row));
                }
            }
        }
    }

    fn add(&mut self, column: usize, row: usize) {
        let lane = self.count % LANES;
        if lane == 0 {
            self.places.push([[0.0; LANES]; 2]);
        }
        if let Some([columns, rows]) = self.places.last_mut() {
            (columns[lane], rows[lane]) = (column as f64, row as f64);
        }
        self.count += 1;
    }
}
