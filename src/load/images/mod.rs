//! Images for textures: decoding, KTX 2 containers, placeholders for images that cannot be read,
//! and the cache of textures that all importers share.

pub mod decode;
mod exr_header;
mod ktx2;
pub mod placeholder;
pub mod texture_cache;

/// The longest side of an image, in pixels.
const MAX_SIDE: u32 = 1 << 15;
