//! The settings of the picture: size, samples, background, transfer function.

use glam::Vec3;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::Tone;

/// The transfer function by which linear values are encoded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Transfer {
    /// The sRGB curve (IEC 61966-2-1).
    #[default]
    Srgb,
    /// The identity: a byte is 255 times the value, as in the tutorial.
    None,
}

impl Transfer {
    /// Encodes a linear value, clamped to \[0, 1\].
    pub fn encode(self, linear: f64) -> f64 {
        // A NaN fails the comparison and becomes 0.
        let x = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
        match self {
            Transfer::None => x,
            Transfer::Srgb if x <= 0.003_130_8 => 12.92 * x,
            Transfer::Srgb => 1.055 * x.powf(1.0 / 2.4) - 0.055,
        }
    }

    /// Decodes a value in \[0, 1\] to a linear one: the inverse of [`Transfer::encode`].
    pub fn decode(self, encoded: f32) -> f32 {
        match self {
            Transfer::None => encoded,
            Transfer::Srgb if encoded <= 0.040_45 => encoded / 12.92,
            Transfer::Srgb => ((encoded + 0.055) / 1.055).powf(2.4),
        }
    }
}

/// The position in a pixel's square about which its samples are centred.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum SamplePosition {
    /// The middle of the pixel, (x + ½, y + ½).
    #[default]
    Center,
    /// The upper left corner, (x, y), as in the tutorial.
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

/// The settings of adaptive sampling: more samples for pixels whose neighbouring samples differ in the
/// primitive hit, in its normal, or in colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveSampling {
    /// The greatest number of samples per pixel, at least [`FilmSettings::spp`].
    pub max: u32,
    /// The difference from which on two colours differ, in [0, 1], of the square roots of their
    /// radiance (about what a PNG shows) in any channel. At 0 all do.
    pub threshold: f32,
}

impl AdaptiveSampling {
    /// The default threshold.
    pub const THRESHOLD: f32 = 0.1;
}

/// The integrator that computes a picture's radiance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum IntegratorKind {
    /// Whitted's: direct light, mirrors and glass, and the light of the environment, without noise.
    #[default]
    Whitted,
    /// A path tracer: all light, by random paths, with noise that falls with the number of samples.
    Path,
}

/// The settings of the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmSettings {
    /// The width and height in pixels, each at least 1.
    pub size: [u32; 2],
    /// The integrator.
    pub integrator: IntegratorKind,
    /// The number by which the random numbers of [`IntegratorKind::Path`] are chosen.
    pub seed: u32,
    /// The number of samples per pixel, at least 1.
    pub spp: u32,
    /// Adaptive sampling, if pixels may get more samples than these.
    pub adaptive: Option<AdaptiveSampling>,
    /// The transfer function by which a PNG encodes the result of the tone curve.
    pub transfer: Transfer,
    /// The exposure in stops: a PNG shows radiance times 2 to the power of this.
    pub exposure: f64,
    /// The tone curve of a PNG.
    pub tone: Tone,
    /// The radiance of rays that hit nothing, linear Rec. 709.
    pub background: Vec3,
    /// True if the picture has alpha, the share of each pixel that something covers. Rays that come from
    /// the camera, also straight through what alpha leaves uncovered, then see no background; rays that
    /// were reflected or refracted do.
    pub transparent: bool,
    /// The position in a pixel about which its samples are centred.
    pub sample_position: SamplePosition,
    /// The greatest number of reflections and refractions along a light path; 0 shows neither.
    pub max_depth: u32,
    /// The number of rays by which the share of the environment's and of ambient light that arrives at a surface
    /// is found; 0 for none, and then all of it arrives.
    pub ambient_occlusion: u32,
    /// The throughput, in \[0, 1\], at or below which secondary rays are not traced. At 0 only those
    /// are left out that can add nothing.
    pub cutoff: f64,
    /// True if light fades out toward the shadow terminator of smooth meshes, instead of ending at the
    /// edges of their faces.
    pub soft_terminator: bool,
}

impl Default for FilmSettings {
    fn default() -> Self {
        Self {
            size: [1280, 720],
            integrator: IntegratorKind::Whitted,
            seed: 0,
            spp: 1,
            adaptive: None,
            transfer: Transfer::Srgb,
            exposure: 0.0,
            tone: Tone::None,
            background: Vec3::ZERO,
            transparent: false,
            sample_position: SamplePosition::Center,
            max_depth: 8,
            ambient_occlusion: 0,
            cutoff: 0.0,
            soft_terminator: true,
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
