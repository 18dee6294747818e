//! The light of an environment's map, added up by the directions from which it comes.

use std::f32::consts::{PI, TAU};

use glam::Vec3;
use rayon::prelude::*;

use super::cube_map::{self, CubeMap};
use super::lookup;
use crate::scene::{Image, Transfer};

/// The number of cells of directions along a face of a cube.
pub const CELLS: usize = 16;

/// The greatest number of texels along a face of the finest map.
const MAX_SIZE: usize = 128;

/// The least numbers of rows and columns that are visited: pixels of smaller maps are visited several times.
const MIN_ROWS: usize = 64;
const MIN_COLUMNS: usize = 128;

/// The number of parts into which a map is divided: not that of the threads, so that sums have one order.
const PARTS: usize = 8;

/// The light of a map, by directions.
pub struct MapLight {
    /// The cells of directions, `CELLS` along a face.
    pub cells: Vec<Cell>,
    /// The mean radiance in each texel of a cube map, and its solid angle.
    pub texels: Vec<(Vec3, f32)>,
    /// The number of these texels along a face.
    pub size: usize,
}

/// The light from a cell of directions.
#[derive(Clone, Copy, Default)]
pub struct Cell {
    /// Its solid angle.
    pub solid_angle: f32,
    /// The integral of radiance over the cell.
    pub sum: Vec3,
    /// The same of radiance times direction, for red, green and blue: the irradiance of a surface that sees
    /// the whole cell is the product with its normal.
    pub vectors: [Vec3; 3],
}

impl MapLight {
    /// Adds up the pixels of a map by where they are seen.
    pub fn collect(map: &Image, transfer: Transfer) -> Self {
        let (width, height) = (map.width as usize, map.height as usize);
        // Small maps are visited at several places of each pixel.
        let columns = width * MIN_COLUMNS.div_ceil(width);
        let rows = height * MIN_ROWS.div_ceil(height);
        // Each texel has the centre of some pixel, or nearly each.
        let size = (1 << (rows / 4).ilog2()).min(MAX_SIZE);
        let azimuths: Vec<(f32, f32)> = (0..columns)
            .map(|x| (((x as f32 + 0.5) / columns as f32 - 0.5) * TAU).sin_cos())
            .collect();
        let part = |part: usize| {
            let mut cells = vec![Cell::default(); 6 * CELLS * CELLS];
            let mut texels = vec![(Vec3::ZERO, 0.0f32); 6 * size * size];
            for y in part * rows / PARTS..(part + 1) * rows / PARTS {
                let elevation = (0.5 - (y as f32 + 0.5) / rows as f32) * PI;
                let (sin_elevation, cos_elevation) = elevation.sin_cos();
                // The solid angle of a pixel: exact for the band that the row is.
                let band = 2.0 * cos_elevation * (PI / (2.0 * rows as f32)).sin();
                let solid_angle = band * TAU / columns as f32;
                let row = y * height / rows * width;
                for (x, (sin_azimuth, cos_azimuth)) in azimuths.iter().enumerate() {
                    let radiance =
                        map.texels.linear(row + x * width / columns, transfer).truncate();
                    let direction = Vec3::new(
                        cos_elevation * cos_azimuth,
                        sin_elevation,
                        cos_elevation * sin_azimuth,
                    );
                    let light = radiance * solid_angle;
                    let cell = &mut cells[cube_map::texel_of(direction, CELLS)];
                    cell.sum += light;
                    cell.solid_angle += solid_angle;
                    for channel in 0..3 {
                        cell.vectors[channel] += direction * light[channel];
                    }
                    let texel = &mut texels[cube_map::texel_of(direction, size)];
                    texel.0 += light;
                    texel.1 += solid_angle;
                }
            }
            (cells, texels)
        };
        let parts: Vec<_> = (0..PARTS).into_par_iter().map(part).collect();

        // The sums of the parts, in their order.
        let mut parts = parts.into_iter();
        let (mut cells, mut texels) = parts.next().expect("there are several parts");
        for (more_cells, more_texels) in parts {
            for (cell, more) in cells.iter_mut().zip(more_cells) {
                cell.sum += more.sum;
                cell.solid_angle += more.solid_angle;
                (0..3).for_each(|channel| cell.vectors[channel] += more.vectors[channel]);
            }
            for (texel, more) in texels.iter_mut().zip(more_texels) {
                texel.0 += more.0;
                texel.1 += more.1;
            }
        }
        // A texel that no pixel's centre is in has the radiance at its own.
        let even = 4.0 * PI / (6 * size * size) as f32;
        for (index, texel) in texels.iter_mut().enumerate() {
            *texel = if texel.1 > 0.0 {
                (texel.0 / texel.1, texel.1)
            } else {
                (lookup(map, transfer, cube_map::center_of(index, size)), even)
            };
        }
        Self { cells, texels, size }
    }
}

/// Returns ever coarser maps of the radiance, the finest first.
pub fn pyramid(mut texels: Vec<(Vec3, f32)>, mut size: usize) -> Vec<CubeMap> {
    let mut levels = Vec::new();
    loop {
        levels.push(CubeMap::from_fn(size, |d| texels[cube_map::texel_of(d, size)].0));
        if size == 1 {
            return levels;
        }
        let half = size / 2;
        let merged = |index: usize| {
            let (face, y, x) = (index / (half * half), index / half % half, index % half);
            let first = (face * size + 2 * y) * size + 2 * x;
            let four = [first, first + 1, first + size, first + size + 1];
            let sum: f32 = four.iter().map(|&i| texels[i].1).sum();
            let light: Vec3 = four.iter().map(|&i| texels[i].0 * texels[i].1).sum();
            (light / sum, sum)
        };
        texels = (0..6 * half * half).map(merged).collect();
        size = half;
    }
}
