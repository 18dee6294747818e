//! The tone curves, which map radiance to the range of a picture.

use glam::{DMat3, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;

/// A tone curve, from linear radiance (after exposure) to \[0, 1\].
///
/// [`None`](Tone::None), [`Reinhard`](Tone::Reinhard) and [`Aces`](Tone::Aces) are applied to red, green and
/// blue separately, never decrease, and are 0 at 0. The others look at the whole colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Tone {
    /// The clamp min(x, 1).
    #[default]
    None,
    /// The curve x / (1 + x), which is always below 1. Reinhard et al., "Photographic Tone Reproduction
    /// for Digital Images" (SIGGRAPH 2002), equation 3, for each channel.
    Reinhard,
    /// The curve min(x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14), 1): Narkowicz, "ACES Filmic Tone
    /// Mapping Curve" (2016), a fit to the curve of the Academy's reference transform, with more contrast
    /// in the middle than [`Tone::Reinhard`]. It is 1 from 7.25 on.
    Aces,
    /// Khronos PBR Neutral, which leaves base colours as they are and desaturates only what is brighter
    /// than white: the specification of the Khronos group (2024).
    KhronosPbrNeutral,
    /// AgX, whose bright colours fade to white as on film: Sobotka (2022), as Blender has it, with the
    /// polynomial that Wrensch ("Minimal AgX Implementation", 2023) fitted to its curve.
    Agx,
}

impl Tone {
    /// The name, as scene files and flags have it.
    pub const fn name(self) -> &'static str {
        match self {
            Tone::None => "none",
            Tone::Reinhard => "reinhard",
            Tone::Aces => "aces",
            Tone::KhronosPbrNeutral => "khronos-pbr-neutral",
            Tone::Agx => "agx",
        }
    }

    /// True if red, green and blue are mapped separately, by [`Tone::apply_to_channel`].
    pub fn is_per_channel(self) -> bool {
        matches!(self, Tone::None | Tone::Reinhard | Tone::Aces)
    }

    /// Maps a colour to \[0, 1\]. Negative numbers and NaN count as 0.
    pub fn apply(self, color: [f64; 3]) -> [f64; 3] {
        let clamped = color.map(clamp_radiance);
        match self {
            Tone::KhronosPbrNeutral => khronos_pbr_neutral(clamped.into()),
            Tone::Agx => agx(clamped.into()),
            _ => return color.map(|x| self.apply_to_channel(x)),
        }
        .clamp(DVec3::ZERO, DVec3::ONE)
        .into()
    }

    /// Maps one channel: in \[0, 1\], and 0 for negative numbers and NaN. Of a curve that is not
    /// [per channel](Tone::is_per_channel), that of a grey.
    pub fn apply_to_channel(self, x: f64) -> f64 {
        let x = clamp_radiance(x);
        match self {
            Tone::None => x,
            Tone::Reinhard => x / (1.0 + x),
            Tone::Aces => x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14),
            Tone::KhronosPbrNeutral | Tone::Agx => self.apply([x; 3])[0],
        }
        .min(1.0)
    }
}

/// Returns a value whose square is finite, and from which on every curve is within 1e-9 of its limit; 0 for
/// negative numbers and NaN.
fn clamp_radiance(x: f64) -> f64 {
    // A NaN fails the comparison.
    if x > 0.0 { x.min(1e9) } else { 0.0 }
}

/// Khronos PBR Neutral, in the names and numbers of its specification.
fn khronos_pbr_neutral(mut color: DVec3) -> DVec3 {
    const F90: f64 = 0.04;
    const START_COMPRESSION: f64 = 0.8 - F90;
    const DESATURATION: f64 = 0.15;
    // The light that a dielectric reflects head on is taken off, so that base colours stay as they are.
    let least = color.min_element();
    let offset = if least < 2.0 * F90 { least - least * least / (4.0 * F90) } else { F90 };
    color -= offset;
    let peak = color.max_element();
    if peak < START_COMPRESSION {
        return color;
    }
    // What is brighter is compressed, and fades to white.
    let rest = 1.0 - START_COMPRESSION;
    let new_peak = 1.0 - rest * rest / (peak + rest - START_COMPRESSION);
    color *= new_peak / peak;
    let white = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    color.lerp(DVec3::splat(new_peak), white)
}

/// Linear Rec. 709 to linear Rec. 2020 (ITU-R BT.2087).
const REC_2020: DMat3 = DMat3::from_cols_array_2d(&[
    [0.6274, 0.0691, 0.0164],
    [0.3293, 0.9195, 0.0880],
    [0.0433, 0.0113, 0.8956],
]);
/// Linear Rec. 2020 to linear Rec. 709 (ITU-R BT.2087).
const FROM_REC_2020: DMat3 = DMat3::from_cols_array_2d(&[
    [1.6605, -0.1246, -0.0182],
    [-0.5876, 1.1329, -0.1006],
    [-0.0728, -0.0083, 1.1187],
]);
/// AgX's inset, which desaturates before the curve; its columns.
const INSET: DMat3 = DMat3::from_cols_array_2d(&[
    [0.856627153315983, 0.137318972929847, 0.11189821299995],
    [0.0951212405381588, 0.761241990602591, 0.0767994186031903],
    [0.0482516061458583, 0.101439036467562, 0.811302368396859],
]);
/// AgX's outset, which saturates after it; its columns.
const OUTSET: DMat3 = DMat3::from_cols_array_2d(&[
    [1.1271005818144368, -0.1413297634984383, -0.14132976349843826],
    [-0.11060664309660323, 1.157823702216272, -0.11060664309660294],
    [-0.016493938717834573, -0.016493938717834257, 1.2519364065950405],
]);
/// The range of the curve, in stops.
const AGX_EV: [f64; 2] = [-12.47393, 4.026069];

/// AgX: inset, logarithm, curve, outset. The result is linear: what follows encodes it.
fn agx(color: DVec3) -> DVec3 {
    let [least, most] = AGX_EV;
    let inset = INSET * (REC_2020 * color);
    let stops = inset.max(DVec3::splat(1e-10)).map(f64::log2);
    let position = ((stops - least) / (most - least)).clamp(DVec3::ZERO, DVec3::ONE);
    let curved = OUTSET * position.map(agx_curve);
    FROM_REC_2020 * curved.max(DVec3::ZERO).map(|x| x.powf(2.2))
}

/// Wrensch's polynomial for the curve of AgX.
fn agx_curve(x: f64) -> f64 {
    let coefficients = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232];
    coefficients.into_iter().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Tone; 5] =
        [Tone::None, Tone::Reinhard, Tone::Aces, Tone::KhronosPbrNeutral, Tone::Agx];

    #[test]
    fn greys_rise_from_0_and_stay_within_1() {
        for tone in ALL {
            assert!(tone.apply_to_channel(0.0).abs() < 1e-12, "{tone:?}");
            let greys = (-200..400).map(|i| tone.apply([2f64.powf(f64::from(i) / 10.0); 3]));
            let values: Vec<f64> = greys.map(|[r, g, b]| r.min(g).min(b)).collect();
            assert!(
                values.is_sorted_by(|a, b| *a <= *b + 1e-12)
                    && values.iter().all(|y| (0.0..=1.0).contains(y)),
                "{tone:?}"
            );
        }
    }

    #[test]
    fn curves_have_the_values_of_their_formulas() {
        let values = |tone: Tone, at: [f64; 3]| at.map(|x| tone.apply_to_channel(x));
        assert_eq!(values(Tone::None, [0.25, 1.0, 4.0]), [0.25, 1.0, 1.0]);
        assert_eq!(values(Tone::Reinhard, [0.25, 1.0, 3.0]), [0.2, 0.5, 0.75]);
        // 2.54 / 3.16.
        assert!((Tone::Aces.apply_to_channel(1.0) - 0.803_797_468_354_430_4).abs() < 1e-15);
    }

    #[test]
    fn aces_is_white_from_where_its_documentation_says() {
        assert!(Tone::Aces.apply_to_channel(7.24) < 1.0);
        assert_eq!(Tone::Aces.apply_to_channel(7.25), 1.0);
    }

    #[test]
    fn what_is_no_light_is_black_and_infinite_light_white() {
        for tone in ALL {
            for x in [-1.0, f64::NAN, f64::NEG_INFINITY] {
                assert!(tone.apply([x; 3]).iter().all(|y| *y < 1e-12), "{tone:?}");
            }
            let white = tone.apply([f64::INFINITY; 3]);
            let tolerance = if tone == Tone::Agx { 0.01 } else { 2e-9 };
            assert!(white.iter().all(|y| 1.0 - y < tolerance && *y <= 1.0), "{tone:?}: {white:?}");
        }
    }

    #[test]
    fn neutral_takes_off_what_a_dielectric_reflects_and_compresses_from_there() {
        let near = |color: [f64; 3], expected: [f64; 3]| {
            let found = Tone::KhronosPbrNeutral.apply(color);
            let is_near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12);
            assert!(is_near, "{color:?}: {found:?}");
        };
        // A base colour seen under white light of 1, with the reflection of 0.04.
        near([0.54, 0.24, 0.14], [0.5, 0.2, 0.1]);
        // Below 0.08 the offset is x - 6.25 x².
        near([0.04, 0.5, 0.5], [0.01, 0.47, 0.47]);
        // White: 1 - 0.24² / 0.44.
        near([1.0; 3], [1.0 - 0.0576 / 0.44; 3]);
        // A colour without white keeps its hue until it is brighter than the start of the compression.
        near([0.7, 0.0, 0.0], [0.7, 0.0, 0.0]);
        let [r, g, b] = Tone::KhronosPbrNeutral.apply([100.0, 0.0, 0.0]);
        assert!(r > 0.99 && g == b && g > 0.9, "bright red fades to white: {r} {g} {b}");
    }

    #[test]
    fn agx_keeps_greys_grey_and_fades_bright_colours_to_white() {
        for x in [0.001, 0.18, 1.0, 10.0] {
            let [r, g, b] = Tone::Agx.apply([x; 3]);
            assert!((r - g).abs() < 1e-3 && (g - b).abs() < 1e-3, "{x}: {r} {g} {b}");
        }
        // Middle grey stays about middle grey: within 20% of 0.18.
        let [grey, ..] = Tone::Agx.apply([0.18; 3]);
        assert!((0.15..0.22).contains(&grey), "{grey}");
        let [_, g, b] = Tone::Agx.apply([1000.0, 0.0, 0.0]);
        let [_, dim, _] = Tone::Agx.apply([0.2, 0.0, 0.0]);
        assert!(g > 0.3 && b > 0.3 && dim < 0.05, "{g} {b} {dim}");
    }
}
