//! The camera rays of a tile.

use crate::geometry::{LANES, RayBatch};
use crate::integrator::simd;
use crate::integrator::tiling::Tile;
use crate::scene::RayGenerator;

/// Generates the camera ray through each pixel of a tile, at `position` from the pixel's upper left
/// corner.
pub(super) fn generate(
    arch: pulp::Arch,
    camera: &RayGenerator,
    tile: &Tile,
    position: [f64; 2],
    rays: &mut RayBatch,
) {
    let ([dx, dy], [left, top]) = (position, tile.origin.map(|x| x as f64));
    let blocks = rays.resize_blocks(tile.pixels.len());
    simd::dispatch(
        arch,
        #[inline(always)]
        || {
            for (ray16, pixels) in blocks.iter_mut().zip(&tile.pixels) {
                let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
                for i in 0..LANES {
                    // The first sum is exact, so that the tiling does not matter.
                    x[i] = (pixels.columns[i] + left) + dx;
                    y[i] = (pixels.rows[i] + top) + dy;
                }
                camera.ray16(&x, &y, ray16);
            }
        },
    );
    rays.truncate(tile.count);
}
