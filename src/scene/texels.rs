//! The pixels of images.

use std::sync::LazyLock;

use glam::Vec4;

use crate::scene::Transfer;

/// A stored pixel of 8 bits per channel: red, green, blue, alpha, as the file has them.
pub type Texel = [u8; 4];

/// The pixels of an image, row by row from the upper left: red, green, blue, alpha.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Texels {
    /// Pixels of 8 bits per channel.
    Bytes(Vec<Texel>),
    /// Pixels of 16 bits per channel.
    Words(Vec<[u16; 4]>),
    /// Linear radiance, finite and not negative; no transfer applies to it.
    Floats(Vec<[f32; 4]>),
}

/// The linear values of all sRGB bytes.
static BYTES: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| Transfer::Srgb.decode(i as f32 / 255.0)));
/// The linear values of all 16-bit sRGB values.
static WORDS: LazyLock<Vec<f32>> = LazyLock::new(|| {
    (0..=u16::MAX).map(|i| Transfer::Srgb.decode(f32::from(i) / 65535.0)).collect()
});

impl Texels {
    /// The number of pixels.
    pub fn len(&self) -> usize {
        match self {
            Self::Bytes(texels) => texels.len(),
            Self::Words(texels) => texels.len(),
            Self::Floats(texels) => texels.len(),
        }
    }

    /// True if there are no pixels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The linear colour of a pixel, and its alpha, which no transfer applies to.
    ///
    /// # Panics
    /// When there is no such pixel.
    #[inline]
    pub fn linear(&self, index: usize, transfer: Transfer) -> Vec4 {
        match (self, transfer) {
            (Self::Floats(texels), _) => Vec4::from(texels[index]),
            (Self::Bytes(texels), Transfer::None) => {
                Vec4::from(texels[index].map(f32::from)) / 255.0
            }
            (Self::Words(texels), Transfer::None) => {
                Vec4::from(texels[index].map(f32::from)) / 65535.0
            }
            (Self::Bytes(texels), Transfer::Srgb) => {
                let [r, g, b, a] = texels[index].map(usize::from);
                Vec4::new(BYTES[r], BYTES[g], BYTES[b], a as f32 / 255.0)
            }
            (Self::Words(texels), Transfer::Srgb) => {
                let [r, g, b, a] = texels[index].map(usize::from);
                Vec4::new(WORDS[r], WORDS[g], WORDS[b], a as f32 / 65535.0)
            }
        }
    }

    /// Pixels of the same storage type with these linear colours.
    pub(super) fn encoded_like(&self, colors: &[Vec4], transfer: Transfer) -> Self {
        let encoded = |c: &Vec4| {
            let [r, g, b] = c.truncate().to_array().map(|x| transfer.encode(f64::from(x)) as f32);
            Vec4::new(r, g, b, c.w).clamp(Vec4::ZERO, Vec4::ONE)
        };
        match self {
            Self::Bytes(_) => {
                let to = |c: &Vec4| (encoded(c) * 255.0).to_array().map(|x| x.round() as u8);
                Self::Bytes(colors.iter().map(to).collect())
            }
            Self::Words(_) => {
                let to = |c: &Vec4| (encoded(c) * 65535.0).to_array().map(|x| x.round() as u16);
                Self::Words(colors.iter().map(to).collect())
            }
            Self::Floats(_) => Self::Floats(colors.iter().map(|c| c.to_array()).collect()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_is_linear_whatever_the_colours_are() {
        for texels in [Texels::Bytes(vec![[51; 4]]), Texels::Words(vec![[51 * 257; 4]])] {
            let [srgb, plain] = [Transfer::Srgb, Transfer::None].map(|t| texels.linear(0, t));
            assert!((srgb.w - 0.2).abs() < 1e-6 && (plain - 0.2).abs().max_element() < 1e-6);
            assert!((srgb.x - Transfer::Srgb.decode(0.2)).abs() < 1e-6);
        }
    }

    #[test]
    fn floats_are_linear_already() {
        let texels = Texels::Floats(vec![[0.5, 7.0, 0.0, 1.0]]);
        assert_eq!(texels.linear(0, Transfer::Srgb), Vec4::new(0.5, 7.0, 0.0, 1.0));
    }
}
