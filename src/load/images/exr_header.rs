//! The memory that an OpenEXR file asks for, by its header alone.
//!
//! A file has two sizes: that of its display window, which is the image, and that of its data window, by
//! which the `exr` crate allocates blocks of lines and tiles. Either may be far greater than the other.

use std::io::Cursor;

use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};

use super::MAX_SIDE;
use super::ktx2::undecodable;
use crate::error::{Error, Result};

/// The first bytes of every OpenEXR file.
const IDENTIFIER: [u8; 4] = [0x76, 0x2F, 0x31, 0x01];
/// The bytes of a pixel of four 8-bit channels.
const BYTES_PER_PIXEL: u64 = 4;

/// True if bytes are those of an OpenEXR file.
pub fn is_exr(bytes: &[u8]) -> bool {
    bytes.starts_with(&IDENTIFIER)
}

/// Returns the number of pixels of 8-bit numbers that take as much memory as the greatest layer of a
/// file, with the channels that are decoded: four at most, or `all_channels`.
///
/// # Errors
/// When the header is damaged, or a window or a tile is too large.
pub fn pixels(bytes: &[u8], all_channels: bool) -> Result<u64> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(undecodable)?;
    let mut layers = meta.headers.iter().map(|header| layer_pixels(header, all_channels));
    layers.try_fold(0, |most, pixels| Ok(most.max(pixels?)))
}

/// The same of one layer.
fn layer_pixels(header: &Header, all_channels: bool) -> Result<u64> {
    // The sides of the windows and of the tiles.
    let display = header.shared_attributes.display_window.size;
    let data = header.layer_size;
    let tile = match header.blocks {
        BlockDescription::Tiles(tiles) => tiles.tile_size,
        BlockDescription::ScanLines => exr::math::Vec2(0, 0),
    };
    let sides = [display, data, tile].map(|size| [size.0 as u64, size.1 as u64]);
    if sides.as_flattened().iter().any(|&side| side > u64::from(MAX_SIDE)) {
        return Err(Error::input(format!(
            "the image, its data window or a tile is larger than {MAX_SIDE} on a side"
        )));
    }
    let data_width = sides[1][0];
    // A block is decoded with all of its channels, and written to the image with those that count.
    let [display, data, tile] = sides.map(|[width, height]| width * height);
    let lines = match header.blocks {
        BlockDescription::ScanLines => header.compression.scan_lines_per_block() as u64,
        BlockDescription::Tiles(_) => 0,
    };
    let block = tile.max(lines * data_width);
    let block = block.saturating_mul(header.channels.bytes_per_pixel as u64) / BYTES_PER_PIXEL;
    let count = header.channels.list.len() as u64;
    let channels = if all_channels { count.max(4) } else { 4 };
    Ok(display.max(data).saturating_mul(channels).max(block))
}
