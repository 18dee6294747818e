//! What the picture is to be: size, samples, background, transfer.

use glam::Vec3;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::Tone;

/// How linear radiance becomes the bytes of a PNG.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Transfer {
    /// The sRGB curve (IEC 61966-2-1).
    #[default]
    Srgb,
    /// None: a byte is 255 times the value, as in the tutorial.
    None,
}

impl Transfer {
    /// The encoded value, in \[0, 1\], of a linear one; what lies outside is clamped.
    pub fn encode(self, linear: f64) -> f64 {
        // A NaN fails the comparison and becomes 0.
        let x = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
        match self {
            Transfer::None => x,
            Transfer::Srgb if x <= 0.003_130_8 => 12.92 * x,
            Transfer::Srgb => 1.055 * x.powf(1.0 / 2.4) - 0.055,
        }
    }

    /// The linear value of an encoded one in \[0, 1\]: the inverse of [`Transfer::encode`].
    pub fn decode(self, encoded: f32) -> f32 {
        match self {
            Transfer::None => encoded,
            Transfer::Srgb if encoded <= 0.040_45 => encoded / 12.92,
            Transfer::Srgb => ((encoded + 0.055) / 1.055).powf(2.4),
        }
    }
}

/// Where in its square a pixel's samples are centred.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SamplePosition {
    /// At the middle of the pixel, (x + ½, y + ½).
    #[default]
    Center,
    /// At its upper left corner, (x, y), as in the tutorial.
    Corner,
}

impl SamplePosition {
    /// The offset from (x, y), in pixels, on both axes.
    pub fn offset(self) -> f64 {
        match self {
            SamplePosition::Center => 0.5,
            SamplePosition::Corner => 0.0,
        }
    }
}

/// More samples where neighbouring ones disagree: in what they hit, in its normal, or in colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveSampling {
    /// The most samples of a pixel, no fewer than every pixel has.
    pub max: u32,
    /// From which difference on two colours disagree, in [0, 1]: in any channel, of the square
    /// roots of their radiance, which is about what a PNG shows. At 0 all do.
    pub threshold: f32,
}

impl AdaptiveSampling {
    /// The threshold where none is asked for.
    pub const THRESHOLD: f32 = 0.1;
}

/// What the picture is to be.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmSettings {
    /// Width and height in pixels, each at least 1.
    pub size: [u32; 2],
    /// Samples per pixel, at least 1.
    pub spp: u32,
    /// Where a pixel gets more than these, if any does.
    pub adaptive: Option<AdaptiveSampling>,
    /// How the PNG encodes what the tone curve leaves.
    pub transfer: Transfer,
    /// The PNG's radiance is multiplied with 2 to the power of this.
    pub exposure: f64,
    /// How the PNG shows what is bright.
    pub tone: Tone,
    /// Radiance where a ray meets nothing, linear Rec. 709.
    pub background: Vec3,
    /// Where in the pixel the samples are centred.
    pub sample_position: SamplePosition,
    /// How often light is followed off mirrors and through surfaces; 0 shows neither.
    pub max_depth: u32,
    /// Rays with no greater share of their pixel than this are not followed; in \[0, 1\]. At 0
    /// only those are left out that can add nothing.
    pub cutoff: f64,
}

impl Default for FilmSettings {
    fn default() -> Self {
        Self {
            size: [1280, 720],
            spp: 1,
            adaptive: None,
            transfer: Transfer::Srgb,
            exposure: 0.0,
            tone: Tone::None,
            background: Vec3::ZERO,
            sample_position: SamplePosition::Center,
            max_depth: 8,
            cutoff: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_decodes_every_byte_it_encodes() {
        for byte in 0..=255u8 {
            let value = byte as f32 / 255.0;
            let back = Transfer::Srgb.encode(Transfer::Srgb.decode(value).into());
            assert_eq!((back * 255.0).round() as u8, byte);
        }
    }

    #[test]
    fn srgb_of_middle_grey() {
        assert!((Transfer::Srgb.encode(0.214_041_14) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn encoding_clamps_and_turns_nan_black() {
        assert_eq!([-1.0, 7.0, f64::NAN].map(|x| Transfer::None.encode(x)), [0.0, 1.0, 0.0]);
    }
}
