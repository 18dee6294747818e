//! Images in KTX 2 files that Basis Universal has compressed, as KHR_texture_basisu has them.
//!
//! The `basisu` crate transcodes them. It trusts some numbers of the header, so these are checked
//! here first (the KTX 2.0 specification, section 3).

use std::fmt::Display;

use basisu::{DecodeFlags, SourceFormat, TargetFormat, Transcoder};
use exr::prelude::f16;

use crate::error::{Error, Result};
use crate::scene::Texels;

/// The first bytes of every KTX 2 file.
const IDENTIFIER: &[u8; 12] = b"\xABKTX 20\xBB\r\n\x1A\n";
/// The position, in the header, of the offset and length of the key/value data.
const KEY_VALUE_DATA: std::ops::Range<usize> = 56..64;
/// The position of the offset and length of the supercompression global data.
const GLOBAL_DATA: usize = 64;
/// The position of the offset, length and uncompressed length of the first and largest level.
const LEVEL: usize = 80;
/// Vulkan's formats: undefined, and blocks of 4×4 floats.
const UNDEFINED: u32 = 0;
const FLOATS: u32 = 1_000_066_000;
/// The last of the supercompression schemes that glTF allows.
const ZSTANDARD: u32 = 2;
/// The size of a block of 4×4 pixels without supercompression, in bytes.
const BLOCK: u64 = 16;

/// The properties in a header that matter before the image is decoded.
pub struct Header {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// True if the values are floats.
    pub is_float: bool,
}

/// True if bytes are those of a KTX 2 file.
pub fn is_ktx(bytes: &[u8]) -> bool {
    bytes.starts_with(IDENTIFIER)
}

/// The error that an image cannot be decoded.
pub fn undecodable(reason: impl Display) -> Error {
    Error::input(format!("the image cannot be decoded: {reason}"))
}

/// Reads and checks the header of a KTX 2 file.
///
/// # Errors
/// When it is cut short or points beyond the file, or the image is not a single flat one that Basis
/// Universal has compressed.
pub fn header(bytes: &[u8]) -> Result<Header> {
    // Numbers at a position of the header, if the file reaches so far.
    let u32_at = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
    let u64_at = |at: usize| Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?));

    // What the header refers to is within the file.
    let end = |at: usize| u64_at(at)?.checked_add(u64_at(at + 8)?);
    let is_within = |at: usize| end(at).is_some_and(|end| end <= bytes.len() as u64);
    let uncompressed = u64_at(LEVEL + 16).filter(|_| is_within(GLOBAL_DATA) && is_within(LEVEL));
    let uncompressed = uncompressed.ok_or_else(|| undecodable("the KTX file is cut short"))?;

    // One image, of a size that its data can have.
    let [format, width, height, depth, layers, faces, scheme] =
        [12, 20, 24, 28, 32, 36, 44].map(|at| u32_at(at).unwrap_or(0));
    if !matches!(format, UNDEFINED | FLOATS) || scheme > ZSTANDARD {
        return Err(undecodable("the KTX file has no image that Basis Universal has compressed"));
    }
    if width == 0 || height == 0 || depth > 0 || layers > 1 || faces != 1 {
        return Err(undecodable("the KTX file has more or less than one flat image"));
    }
    let blocks = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4));
    if uncompressed > BLOCK * blocks {
        return Err(undecodable("the KTX file has more data than its size in pixels asks for"));
    }
    Ok(Header { size: [width, height], is_float: format == FLOATS })
}

/// Decodes the image of a file whose header is valid.
///
/// # Errors
/// When it is damaged.
pub fn decode(bytes: &[u8]) -> Result<Texels> {
    let fail = |error: basisu::Error| undecodable(format_args!("{error:?}"));
    // The key/value data do not matter, and the crate trusts their lengths.
    let mut bytes = bytes.to_vec();
    bytes.get_mut(KEY_VALUE_DATA).into_iter().for_each(|range| range.fill(0));
    let transcoder = Transcoder::new(&bytes).map_err(fail)?;
    let transcode = |target| transcoder.transcode(0, target, DecodeFlags::NONE).map_err(fail);
    match transcoder.source_format() {
        SourceFormat::Etc1s | SourceFormat::UastcLdr => {
            Ok(Texels::Bytes(transcode(TargetFormat::Rgba32)?.as_chunks().0.to_vec()))
        }
        SourceFormat::UastcHdr4x4 => {
            let halves = transcode(TargetFormat::RgbaHalf)?;
            let halves = halves.as_chunks().0.iter().map(|half| f16::from_le_bytes(*half).to_f32());
            Ok(Texels::Floats(halves.collect::<Vec<f32>>().as_chunks().0.to_vec()))
        }
        other => Err(Error::input(format!("images of the kind {other:?} are not read"))),
    }
}
