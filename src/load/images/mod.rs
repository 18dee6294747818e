//! Images for textures: decoding, KTX 2 containers, and placeholders for images that cannot be read.

pub mod decode;
pub mod ktx2;
pub mod placeholder;
