//! Images for textures: decoding, KTX 2 containers, placeholders for images that cannot be read,
//! and the cache of textures that all importers share.

pub mod decode;
mod ktx2;
pub mod placeholder;
pub mod texture_cache;
