//! The tone curves, which map radiance to the range of a picture.

use schemars::JsonSchema;
use serde::Deserialize;

/// A tone curve, from linear radiance (after exposure) to \[0, 1\].
///
/// It is applied to red, green and blue separately, never decreases, and is 0 at 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
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
}

impl Tone {
    /// Evaluates the curve at `x`: in \[0, 1\], and 0 for negative numbers and NaN.
    pub fn apply(self, x: f64) -> f64 {
        // A value whose square is finite, and from which on every curve is within 1e-9 of its limit.
        const BRIGHT: f64 = 1e9;
        // A NaN fails the comparison.
        let x = if x > 0.0 { x.min(BRIGHT) } else { 0.0 };
        match self {
            Tone::None => x,
            Tone::Reinhard => x / (1.0 + x),
            Tone::Aces => x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14),
        }
        .min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Tone; 3] = [Tone::None, Tone::Reinhard, Tone::Aces];

    #[test]
    fn curves_rise_from_0_and_stay_within_1() {
        for tone in ALL {
            assert_eq!(tone.apply(0.0), 0.0);
            let values: Vec<f64> =
                (-200..400).map(|i| tone.apply(2f64.powf(f64::from(i) / 10.0))).collect();
            assert!(
                values.is_sorted() && values.iter().all(|y| (0.0..=1.0).contains(y)),
                "{tone:?}"
            );
        }
    }

    #[test]
    fn curves_have_the_values_of_their_formulas() {
        assert_eq!([0.25, 1.0, 4.0].map(|x| Tone::None.apply(x)), [0.25, 1.0, 1.0]);
        assert_eq!([0.25, 1.0, 3.0].map(|x| Tone::Reinhard.apply(x)), [0.2, 0.5, 0.75]);
        // 2.54 / 3.16.
        assert!((Tone::Aces.apply(1.0) - 0.803_797_468_354_430_4).abs() < 1e-15);
    }

    #[test]
    fn aces_is_white_from_where_its_documentation_says() {
        assert!(Tone::Aces.apply(7.24) < 1.0 && Tone::Aces.apply(7.25) == 1.0);
    }

    #[test]
    fn what_is_no_light_is_black_and_infinite_light_white() {
        for tone in ALL {
            assert_eq!([-1.0, f64::NAN, f64::NEG_INFINITY].map(|x| tone.apply(x)), [0.0; 3]);
            assert!(1.0 - tone.apply(f64::INFINITY) < 2e-9 && tone.apply(f64::INFINITY) <= 1.0);
        }
    }
}
