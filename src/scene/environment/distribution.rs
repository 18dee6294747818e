//! The distribution by which directions to an environment are sampled: in proportion to its luminance.

use std::f32::consts::PI;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{direction_at, equirectangular};
use crate::scene::{Image, Transfer};

/// The greatest number of cells from left to right; maps of more pixels have several in a cell.
const MAX_COLUMNS: usize = 2048;

/// A density of directions that is constant within each of the cells of a map, in the axes of the map.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentDistribution {
    size: [usize; 2],
    /// For each row the sums of the shares of its cells, from 0 to 1.
    columns: Vec<f32>,
    /// The sums of the shares of the rows, from 0 to 1.
    rows: Vec<f32>,
    /// The mean luminance over all directions.
    mean: f64,
}

impl EnvironmentDistribution {
    /// The distribution of a map; of a black one all directions are as likely.
    pub(super) fn new(map: &Image, transfer: Transfer) -> Self {
        let (width, height) = (map.width as usize, map.height as usize);
        let block = width.div_ceil(MAX_COLUMNS);
        let (columns, rows) = (width.div_ceil(block), height.div_ceil(block));
        let luminance = |x: usize, y: usize| {
            let texel = map.texels.linear(y * width + x, transfer).truncate();
            texel.dot(Vec3::new(0.2126, 0.7152, 0.0722)).max(0.0)
        };
        // The mean luminance of each cell.
        let cell = |column: usize, row: usize| {
            let (x, y) = (column * block, row * block);
            let (right, below) = ((x + block).min(width), (y + block).min(height));
            let sum: f32 = (y..below).flat_map(|y| (x..right).map(move |x| luminance(x, y))).sum();
            sum / ((right - x) * (below - y)) as f32
        };
        let of_row = |row: usize| cumulative((0..columns).map(|column| cell(column, row)));
        let parts: Vec<(Vec<f32>, f32)> = (0..rows).into_par_iter().map(of_row).collect();
        // Rows count by their luminance times their solid angle.
        let weight = |(row, (_, sum)): (usize, &(Vec<f32>, f32))| {
            sum * ((row as f32 + 0.5) / rows as f32 * PI).sin()
        };
        let (sums, mean) = cumulative(parts.iter().enumerate().map(weight));
        let columns_of_rows = parts.into_iter().flat_map(|(sums, _)| sums).collect();
        // The mean of the sine over the rows is 2/π.
        let mean = f64::from(mean) * std::f64::consts::FRAC_PI_2;
        Self { size: [columns, rows], columns: columns_of_rows, rows: sums, mean }
    }

    /// Returns the mean luminance over all directions.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    fn row(&self, row: usize) -> &[f32] {
        let count = self.size[0] + 1;
        &self.columns[row * count..][..count]
    }

    /// Samples a direction by a point of the unit square, and returns it with its density per steradian.
    pub fn sample(&self, [u, v]: [f64; 2]) -> (DVec3, f64) {
        let (row, y) = invert(&self.rows, v as f32);
        let (column, x) = invert(self.row(row), u as f32);
        let place =
            [(column as f32 + x) / self.size[0] as f32, (row as f32 + y) / self.size[1] as f32];
        let direction = direction_at(place[0], place[1]).as_dvec3();
        (direction, self.density(column, row, direction))
    }

    /// Returns the density of a direction of length 1 among those that are sampled, per steradian.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        let [u, v] = equirectangular(direction.as_vec3());
        let index = |x: f32, count: usize| ((x * count as f32) as usize).min(count - 1);
        self.density(index(u, self.size[0]), index(v, self.size[1]), direction)
    }

    fn density(&self, column: usize, row: usize, direction: DVec3) -> f64 {
        let share = |sums: &[f32], i: usize| f64::from(sums[i + 1] - sums[i]);
        let share = share(&self.rows, row) * share(self.row(row), column);
        // A cell is 2π/columns by π/rows, and narrower toward the poles.
        let across = direction.x.hypot(direction.z).max(1e-9);
        let cells = (self.size[0] * self.size[1]) as f64;
        share * cells / (2.0 * std::f64::consts::PI.powi(2) * across)
    }
}

/// Returns the sums of weights up to each, divided by the whole, from 0 to 1; and the whole divided by their number.
/// Weights that are all 0 count as equal.
fn cumulative(weights: impl ExactSizeIterator<Item = f32>) -> (Vec<f32>, f32) {
    let count = weights.len();
    let mut sums = vec![0.0f64];
    for weight in weights {
        sums.push(sums[sums.len() - 1] + f64::from(weight));
    }
    let whole = sums[count];
    let share = |i: usize| if whole > 0.0 { sums[i] / whole } else { i as f64 / count as f64 };
    ((0..=count).map(|i| share(i) as f32).collect(), (whole / count as f64) as f32)
}

/// Returns the cell in which sums reach a share, in \[0, 1), and the place in it, from 0 to 1.
fn invert(sums: &[f32], share: f32) -> (usize, f32) {
    let cell = sums.partition_point(|&sum| sum <= share).clamp(1, sums.len() - 1) - 1;
    let width = sums[cell + 1] - sums[cell];
    let place = if width > 0.0 { (share - sums[cell]) / width } else { 0.5 };
    (cell, place.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Texels;

    fn map(size: [usize; 2], radiance: impl Fn(Vec3) -> f32) -> Image {
        let texel = |i: usize| {
            let [u, v] = [(i % size[0], size[0]), (i / size[0], size[1])]
                .map(|(x, n)| (x as f32 + 0.5) / n as f32);
            [radiance(direction_at(u, v)); 4]
        };
        let texels = (0..size[0] * size[1]).map(texel).collect();
        Image::new("", size.map(|x| x as u32), Texels::Floats(texels))
    }

    /// Returns the integral over all directions of a function of direction.
    fn integral(value: impl Fn(DVec3) -> f64) -> f64 {
        let (columns, rows) = (4096, 2048);
        let mut sum = 0.0;
        for row in 0..rows {
            let v = (row as f64 + 0.5) / rows as f64;
            let cell = (v * std::f64::consts::PI).sin() * 2.0 * std::f64::consts::PI.powi(2);
            for column in 0..columns {
                let u = (column as f32 + 0.5) / columns as f32;
                sum += value(direction_at(u, v as f32).as_dvec3()) * cell;
            }
        }
        sum / f64::from(columns * rows)
    }

    #[test]
    fn the_density_adds_up_to_one_and_is_that_of_the_samples() {
        for (size, image) in [
            ([64, 32], map([64, 32], |d| 1.0 + d.x + 20.0 * f32::from(d.y > 0.9))),
            ([4096, 128], map([4096, 128], |d| d.z.max(0.0))),
            ([1, 1], map([1, 1], |_| 0.3)),
            ([8, 8], map([8, 8], |_| 0.0)),
        ] {
            let distribution = EnvironmentDistribution::new(&image, Transfer::None);
            let whole = integral(|direction| distribution.pdf(direction));
            assert!((whole - 1.0).abs() < 1e-3, "{size:?}: {whole}");
            let (mut others, n) = (0, 128);
            for i in 0..n * n {
                let u = [(i % n) as f64 + 0.5, (i / n) as f64 + 0.5].map(|x| x / n as f64);
                let (direction, pdf) = distribution.sample(u);
                assert!(pdf > 0.0 && pdf.is_finite(), "{size:?} {direction} {pdf}");
                others += usize::from((distribution.pdf(direction) / pdf - 1.0).abs() > 1e-6);
            }
            // Only at the edges of cells the two may find neighbours.
            assert!(others < n * n / 100, "{size:?}: {others}");
        }
    }

    #[test]
    fn the_light_of_a_map_is_found_by_few_samples() {
        let image = map([64, 32], |d| if d.x > 0.99 { 50.0 } else { 0.1 });
        let distribution = EnvironmentDistribution::new(&image, Transfer::None);
        // The value of the pixel that a direction is in: each sample then tells nearly the whole integral.
        let value = |direction: DVec3| {
            let [u, v] = equirectangular(direction.as_vec3());
            let [x, y] = [(u * 64.0) as usize, (v * 32.0) as usize];
            f64::from(image.texels.linear(y.min(31) * 64 + x.min(63), Transfer::None).x)
        };
        let mut sum = 0.0;
        for i in 0..16 * 16 {
            let u = [(i % 16) as f64 + 0.5, (i / 16) as f64 + 0.5].map(|x| x / 16.0);
            let (direction, pdf) = distribution.sample(u);
            sum += value(direction) / pdf / 256.0;
        }
        let expected = integral(value);
        assert!((sum / expected - 1.0).abs() < 0.02, "{sum} {expected}");
    }
}
