//! The cutting of a picture into strips and tiles.

use std::ops::Range;

use crate::geometry::{LANES, Lanes};

/// The sizes into which a picture is cut for tracing.
///
/// They decide speed and never the picture, in precision `certified`: the stress test tries them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tiling {
    /// The rows of a strip, the unit of work that threads share; at least 1.
    pub rows: usize,
    /// The columns of a tile, whose camera rays are traced together; at least 1.
    pub columns: usize,
    /// The side of the squares in which a tile's rays are ordered; at least 1.
    pub block: usize,
}

impl Default for Tiling {
    /// Returns tiles of 64 × 16 pixels in squares of 4 × 4, so that a packet of 16 is a square.
    fn default() -> Self {
        Self { rows: 16, columns: 64, block: 4 }
    }
}

/// The pixels of a tile, in the order of their camera rays.
#[derive(Debug, Default)]
pub(super) struct Tile {
    /// The column and the row, in the picture, of the tile's origin.
    pub origin: [usize; 2],
    /// The width and the height in pixels.
    size: [usize; 2],
    /// The side of the squares.
    block: usize,
    /// The number of pixels.
    pub count: usize,
    /// The pixels' columns and rows relative to the origin.
    pub pixels: Vec<Pixels16>,
    /// The runs of pixels that are neighbours in a row.
    pub runs: Vec<PixelRun>,
}

/// The columns and rows of sixteen pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pixels16 {
    /// The columns.
    pub columns: Lanes<f64>,
    /// The rows.
    pub rows: Lanes<f64>,
}

/// A run of neighbouring pixels in a row of a tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelRun {
    /// The column of the first one, in the tile.
    pub column: u32,
    /// The row, in the tile.
    pub row: u32,
    /// The number of pixels.
    pub length: u32,
}

impl Tile {
    /// Sets the tile to the one at `origin`, in the picture, of a strip of this width and height.
    pub fn set(&mut self, tiling: &Tiling, origin: [usize; 2], [width, rows]: [usize; 2]) {
        let (columns, block) = (tiling.columns.min(width - origin[0]), tiling.block);
        let size = [columns, rows];
        self.origin = origin;
        // Most tiles have the size of the one before.
        if (self.size, self.block) == (size, block) {
            return;
        }
        (self.size, self.block) = (size, block);
        self.clear();
        for y in (0..rows).step_by(block) {
            for x in (0..columns).step_by(block) {
                let end = (x + block).min(columns);
                for row in y..(y + block).min(rows) {
                    let length = (end - x) as u32;
                    self.runs.push(PixelRun { column: x as u32, row: row as u32, length });
                    (x..end).for_each(|column| self.push(column, row));
                }
            }
        }
    }

    /// Sets the tile to any pixels, by their columns and rows in the picture; it has no runs.
    pub fn set_pixels(&mut self, pixels: impl Iterator<Item = [usize; 2]>) {
        (self.origin, self.size, self.block) = ([0; 2], [0; 2], 0);
        self.clear();
        pixels.for_each(|[column, row]| self.push(column, row));
    }

    /// Returns the indices of a run's pixels in the strip of the tile, of rows of `width` pixels.
    #[inline(always)]
    pub fn run_in_strip(&self, run: &PixelRun, width: usize) -> Range<usize> {
        let first = run.row as usize * width + self.origin[0] + run.column as usize;
        first..first + run.length as usize
    }

    fn clear(&mut self) {
        self.count = 0;
        self.pixels.clear();
        self.runs.clear();
    }

    fn push(&mut self, column: usize, row: usize) {
        let lane = self.count % LANES;
        if lane == 0 {
            self.pixels.push(Pixels16 { columns: [0.0; LANES], rows: [0.0; LANES] });
        }
        if let Some(Pixels16 { columns, rows }) = self.pixels.last_mut() {
            (columns[lane], rows[lane]) = (column as f64, row as f64);
        }
        self.count += 1;
    }
}
