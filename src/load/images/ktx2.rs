//! Pictures in KTX 2 files, packed by Basis Universal: those of KHR_texture_basisu.
//!
//! The `basisu` crate unpacks them. It trusts some numbers of the header, so that these are checked
//! here first (the KTX 2.0 specification, section 3).

use basisu::{DecodeFlags, SourceFormat, TargetFormat, Transcoder};
use exr::prelude::f16;

use crate::error::{Error, Result};
use crate::scene::Texels;

/// What every KTX 2 file begins with.
const IDENTIFIER: &[u8; 12] = b"\xABKTX 20\xBB\r\n\x1A\n";
/// Where the header gives the place and the length of what is written beside the picture.
const KEYS_AND_VALUES: std::ops::Range<usize> = 56..64;
/// Where it gives those of what all levels share.
const GLOBAL_DATA: usize = 64;
/// Where it gives those of the first and largest level, and how long that is once unpacked.
const LEVEL: usize = 80;
/// Vulkan's formats: undefined, and blocks of 4×4 floats.
const UNDEFINED: u32 = 0;
const FLOATS: u32 = 1_000_066_000;
/// The last of the ways in which levels are packed that glTF allows.
const ZSTANDARD: u32 = 2;
/// What a block of 4×4 pixels takes before it is packed any further, in bytes.
const BLOCK: u64 = 16;

/// What a picture's header says, as far as it matters before the picture is unpacked.
pub struct Header {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Whether its values are floats.
    pub is_float: bool,
}

/// Whether bytes are those of a KTX 2 file.
pub fn is_ktx(bytes: &[u8]) -> bool {
    bytes.starts_with(IDENTIFIER)
}

/// Reads and checks the header of a KTX 2 file.
///
/// # Errors
/// When it is cut short or points beyond the file, or the picture is not one flat one that Basis
/// Universal has packed.
pub fn header(bytes: &[u8]) -> Result<Header> {
    let fail = |message: &str| Error::input(format!("the picture cannot be decoded: {message}"));
    let word = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
    let long = |at: usize| Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
    let end = |at: usize| long(at)?.checked_add(long(at + 8)?);
    let is_there = |at: usize| end(at).is_some_and(|end| end <= bytes.len() as u64);
    let unpacked = match long(LEVEL + 16) {
        Some(unpacked) if is_there(GLOBAL_DATA) && is_there(LEVEL) => unpacked,
        _ => return Err(fail("the KTX file is cut short")),
    };
    let of = |at: usize| word(at).unwrap_or(0);
    let (format, packing) = (of(12), of(44));
    if !matches!(format, UNDEFINED | FLOATS) || packing > ZSTANDARD {
        return Err(fail("the KTX file has no picture that Basis Universal has packed"));
    }
    let (width, height, depth, layers, faces) = (of(20), of(24), of(28), of(32), of(36));
    if width == 0 || height == 0 || depth > 0 || layers > 1 || faces != 1 {
        return Err(fail("the KTX file has more or less than one flat picture"));
    }
    let blocks = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4));
    if unpacked > BLOCK * blocks {
        return Err(fail("the KTX file has more data than its size in pixels asks for"));
    }
    Ok(Header { size: [width, height], is_float: format == FLOATS })
}

/// Unpacks the picture of a file whose header is sound.
///
/// # Errors
/// When it is damaged.
pub fn decode(bytes: &[u8]) -> Result<Texels> {
    let fail =
        |error: basisu::Error| Error::input(format!("the picture cannot be decoded: {error:?}"));
    // Nothing there matters, and the crate takes their lengths for granted.
    let mut bytes = bytes.to_vec();
    bytes.get_mut(KEYS_AND_VALUES).into_iter().for_each(|some| some.fill(0));
    let picture = Transcoder::new(&bytes).map_err(fail)?;
    let transcode = |target| picture.transcode(0, target, DecodeFlags::NONE).map_err(fail);
    match picture.source_format() {
        SourceFormat::Etc1s | SourceFormat::UastcLdr => {
            Ok(Texels::Bytes(transcode(TargetFormat::Rgba32)?.as_chunks().0.to_vec()))
        }
        SourceFormat::UastcHdr4x4 => {
            let halves = transcode(TargetFormat::RgbaHalf)?;
            let halves = halves.as_chunks().0.iter().map(|half| f16::from_le_bytes(*half).to_f32());
            Ok(Texels::Floats(halves.collect::<Vec<f32>>().as_chunks().0.to_vec()))
        }
        other => Err(Error::input(format!("pictures of the kind {other:?} are not read"))),
    }
}
