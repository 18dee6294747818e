//! The decoded images of textures.

use std::sync::OnceLock;

use super::mipmap::{self, MipLevel};
use super::texels::{Texel, Texels};
use crate::scene::Transfer;

/// A decoded image, or a reference to one that was not read because no material in use shows it.
#[derive(Clone, Debug)]
pub struct Image {
    /// The name of its source, for messages.
    pub name: String,
    /// The width in pixels, at least 1; 0 for one that was not read.
    pub width: u32,
    /// The height in pixels, at least 1; 0 for one that was not read.
    pub height: u32,
    /// The `width · height` pixels.
    pub texels: Texels,
    /// The mipmaps by the encoding of colours, in the order of [`Transfer`]; built when first asked for.
    mipmaps: [OnceLock<Vec<MipLevel>>; 2],
}

impl Image {
    /// An image of `width` times `height` pixels.
    pub fn new(name: impl Into<String>, [width, height]: [u32; 2], texels: Texels) -> Self {
        Self {
            name: name.into(),
            width,
            height,
            texels,
            mipmaps: [OnceLock::new(), OnceLock::new()],
        }
    }

    /// An image of 8 bits per channel.
    pub fn from_bytes(name: impl Into<String>, size: [u32; 2], texels: Vec<Texel>) -> Self {
        Self::new(name, size, Texels::Bytes(texels))
    }

    /// An image that was not read. A scene in which a material in use shows it is not valid.
    pub fn unread(name: impl Into<String>) -> Self {
        Self::from_bytes(name, [0; 2], Vec::new())
    }

    /// True if it was read.
    pub fn is_read(&self) -> bool {
        self.width > 0 && self.height > 0
    }

    /// True if a channel (0 to 3) has its greatest value everywhere.
    ///
    /// # Panics
    /// When there is no such channel.
    pub fn is_channel_full(&self, channel: usize) -> bool {
        match &self.texels {
            Texels::Bytes(texels) => texels.iter().all(|t| t[channel] == u8::MAX),
            Texels::Words(texels) => texels.iter().all(|t| t[channel] == u16::MAX),
            Texels::Floats(texels) => texels.iter().all(|t| t[channel] >= 1.0),
        }
    }

    /// The mipmap of the image, its colours encoded by `transfer`: the levels after the image itself,
    /// largest first.
    pub(crate) fn mipmap(&self, transfer: Transfer) -> &[MipLevel] {
        let size = [self.width, self.height];
        self.mipmaps[transfer as usize].get_or_init(|| mipmap::levels(&self.texels, size, transfer))
    }
}

impl PartialEq for Image {
    fn eq(&self, other: &Self) -> bool {
        let size = |image: &Self| (image.width, image.height);
        self.name == other.name && size(self) == size(other) && self.texels == other.texels
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_is_full_where_no_pixel_has_less() {
        let image = Image::from_bytes("", [2, 1], vec![[255, 0, 0, 255], [255, 0, 0, 254]]);
        assert_eq!([0, 3].map(|channel| image.is_channel_full(channel)), [true, false]);
    }
}
