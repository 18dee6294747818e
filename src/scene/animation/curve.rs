//! The animation curve: a value at each keyframe, and the interpolation between keyframes.

use std::fmt::Debug;

use glam::{DQuat, DVec3};

use crate::error::Result;
use crate::scene::check::require;

/// A type that a [`Curve`] can interpolate: a number, a point or direction, a rotation.
pub trait Interpolate: Copy + Debug + PartialEq {
    /// The linear interpolation from `a` to `b`, for `s` in \[0, 1\].
    fn lerp(a: Self, b: Self, s: f64) -> Self;

    /// The weighted sum of four values, for splines.
    fn weighted_sum(terms: [(f64, Self); 4]) -> Self;

    /// True if its numbers are finite, and a rotation has length 1.
    fn is_valid(self) -> bool;
}

macro_rules! interpolate_componentwise {
    ($($T:ty),*) => {$(
        impl Interpolate for $T {
            fn lerp(a: Self, b: Self, s: f64) -> Self {
                a + (b - a) * s
            }

            fn weighted_sum(terms: [(f64, Self); 4]) -> Self {
                terms.into_iter().map(|(weight, value)| value * weight).sum()
            }

            fn is_valid(self) -> bool {
                self.is_finite()
            }
        }
    )*};
}

interpolate_componentwise!(f64, DVec3);

/// Rotations have length 1 and are interpolated along the shorter arc (slerp). A spline's sum is
/// normalised, as glTF prescribes.
impl Interpolate for DQuat {
    fn lerp(a: Self, b: Self, s: f64) -> Self {
        a.slerp(b, s)
    }

    fn weighted_sum(terms: [(f64, Self); 4]) -> Self {
        let sum =
            terms.into_iter().fold(DQuat::from_array([0.0; 4]), |sum, (w, value)| sum + value * w);
        let length = sum.length();
        // Halfway between opposite rotations the sum is 0.
        if length > 1e-9 { sum / length } else { terms[0].1 }
    }

    fn is_valid(self) -> bool {
        (self.length() - 1.0).abs() < 1e-6
    }
}

/// The interpolation between two keyframes, as of glTF's animation samplers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Interpolation<T> {
    /// The value stays until the next keyframe (`STEP`).
    Step,
    /// The value changes at constant speed, rotations along the shorter arc (`LINEAR`).
    Linear,
    /// The value follows a cubic Hermite spline (`CUBICSPLINE`): for each keyframe its in-tangent and
    /// out-tangent, per second.
    Cubic(Vec<[T; 2]>),
}

/// An animation curve (glTF: a sampler): a value at each keyframe, and between keyframes. Before the
/// first and after the last keyframe the value stays.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve<T> {
    /// The times of the keyframes in seconds; increasing, and at least one.
    pub times: Vec<f64>,
    /// The values of the keyframes.
    pub values: Vec<T>,
    /// The interpolation between keyframes.
    pub interpolation: Interpolation<T>,
}

impl<T: Interpolate> Curve<T> {
    /// The curve of a value that does not change.
    pub fn constant(value: T) -> Self {
        Self { times: vec![0.0], values: vec![value], interpolation: Interpolation::Step }
    }

    /// The value at a time in seconds.
    ///
    /// # Panics
    /// When the curve is empty.
    pub fn sample(&self, time: f64) -> T {
        // The keyframes before and after the time; the value stays beyond either end.
        let after = self.times.partition_point(|&t| t <= time);
        if after == 0 {
            return self.values[0];
        }
        let key = after - 1;
        if after == self.times.len() || time == self.times[key] {
            return self.values[key];
        }
        // Interpolation by the fraction s of the time between the two.
        let (a, b) = (self.values[key], self.values[after]);
        let seconds = self.times[after] - self.times[key];
        let s = (time - self.times[key]) / seconds;
        match &self.interpolation {
            Interpolation::Step => a,
            Interpolation::Linear => T::lerp(a, b, s),
            Interpolation::Cubic(tangents) => {
                // The Hermite basis, as in appendix C of the glTF 2.0 specification.
                let (s2, s3) = (s * s, s * s * s);
                T::weighted_sum([
                    (2.0 * s3 - 3.0 * s2 + 1.0, a),
                    (seconds * (s3 - 2.0 * s2 + s), tangents[key][1]),
                    (-2.0 * s3 + 3.0 * s2, b),
                    (seconds * (s3 - s2), tangents[after][0]),
                ])
            }
        }
    }

    /// Checks that there is a value for each time, all of them finite, and that the times increase.
    ///
    /// # Errors
    /// The first condition that does not hold.
    pub fn check(&self) -> Result<()> {
        let (times, values) = (&self.times, &self.values);
        require(!times.is_empty() && times.len() == values.len(), || {
            let (times, values) = (times.len(), values.len());
            format!("{times} times and {values} values, where there must be one for each")
        })?;
        // Times that are finite and increase, and values that are in range.
        for (i, time) in times.iter().enumerate() {
            require(time.is_finite(), || format!("time {i} is not finite"))?;
        }
        for pair in times.windows(2) {
            require(pair[0] < pair[1], || {
                format!("the times do not increase: {} after {}", pair[1], pair[0])
            })?;
        }
        for (i, value) in values.iter().enumerate() {
            require(value.is_valid(), || format!("value {i} is out of range: {value:?}"))?;
        }
        let Interpolation::Cubic(slopes) = &self.interpolation else { return Ok(()) };
        require(slopes.len() == values.len(), || {
            format!("{} pairs of slopes for {} values", slopes.len(), values.len())
        })
    }
}

impl Curve<f64> {
    /// The smooth curve through the values: it starts and ends at rest, and never leaves the range of
    /// the two neighbouring values.
    ///
    /// Fritsch and Butland, *A method for constructing local monotone piecewise cubic
    /// interpolants* (1984): the slope at a keyframe is the weighted harmonic mean of those before and
    /// after it, and 0 where these have opposite signs.
    pub fn smooth(times: Vec<f64>, values: Vec<f64>) -> Self {
        let slopes = slopes(&times, &values).into_iter().map(|slope| [slope; 2]).collect();
        Self { times, values, interpolation: Interpolation::Cubic(slopes) }
    }
}

impl Curve<DVec3> {
    /// The curve whose coordinates are each [smooth](Curve::<f64>::smooth).
    pub fn smooth(times: Vec<f64>, values: Vec<DVec3>) -> Self {
        let axis =
            |axis: usize| slopes(&times, &values.iter().map(|v| v[axis]).collect::<Vec<_>>());
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        let slopes = (0..values.len()).map(|i| [DVec3::new(x[i], y[i], z[i]); 2]).collect();
        Self { times, values, interpolation: Interpolation::Cubic(slopes) }
    }
}

/// The slope at each keyframe; see [`Curve::<f64>::smooth`].
fn slopes(times: &[f64], values: &[f64]) -> Vec<f64> {
    let mut slopes = vec![0.0; values.len()];
    for i in 1..values.len().saturating_sub(1) {
        let (h0, h1) = (times[i] - times[i - 1], times[i + 1] - times[i]);
        let (d0, d1) = ((values[i] - values[i - 1]) / h0, (values[i + 1] - values[i]) / h1);
        if d0 * d1 > 0.0 {
            let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
            slopes[i] = (w0 + w1) / (w0 / d0 + w1 / d1);
        }
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    fn curve(interpolation: Interpolation<f64>) -> Curve<f64> {
        Curve { times: vec![1.0, 3.0, 4.0], values: vec![10.0, 20.0, 0.0], interpolation }
    }

    #[test]
    fn value_stays_before_the_first_key_and_after_the_last() {
        for curve in [curve(Interpolation::Step), curve(Interpolation::Linear)] {
            assert_eq!([0.0, 1.0, 4.0, 9.0].map(|t| curve.sample(t)), [10.0, 10.0, 0.0, 0.0]);
        }
    }

    #[test]
    fn linear_is_a_straight_line_between_keys() {
        assert_eq!(
            [1.5, 2.0, 3.75].map(|t| curve(Interpolation::Linear).sample(t)),
            [12.5, 15.0, 5.0]
        );
    }

    #[test]
    fn step_jumps_at_the_key() {
        assert_eq!([2.999, 3.0].map(|t| curve(Interpolation::Step).sample(t)), [10.0, 20.0]);
    }

    #[test]
    fn cubic_with_the_slopes_of_a_parabola_is_that_parabola() {
        let square = |t: f64| t * t;
        let times = vec![0.0, 1.0, 3.0];
        let slopes = times.iter().map(|t| [2.0 * t; 2]).collect();
        let values = times.iter().map(|&t| square(t)).collect();
        let curve = Curve { times, values, interpolation: Interpolation::Cubic(slopes) };
        for t in [0.25, 0.5, 1.0, 2.0, 2.9] {
            assert!((curve.sample(t) - square(t)).abs() < 1e-12, "{t}");
        }
    }

    #[test]
    fn rotations_turn_at_constant_speed() {
        let values = vec![DQuat::IDENTITY, DQuat::from_rotation_z(FRAC_PI_2)];
        let curve = Curve { times: vec![0.0, 1.0], values, interpolation: Interpolation::Linear };
        let third = curve.sample(1.0 / 3.0) * DVec3::X;
        let (sin, cos) = (FRAC_PI_2 / 3.0).sin_cos();
        assert!((third - DVec3::new(cos, sin, 0.0)).length() < 1e-12, "{third}");
    }

    #[test]
    fn rotations_take_the_shorter_way() {
        let turned = DQuat::from_rotation_z(0.2);
        let values = vec![DQuat::IDENTITY, -turned];
        let curve = Curve { times: vec![0.0, 1.0], values, interpolation: Interpolation::Linear };
        assert!(curve.sample(0.5).angle_between(DQuat::from_rotation_z(0.1)) < 1e-7);
    }

    #[test]
    fn smooth_starts_and_ends_at_rest() {
        let curve = Curve::<f64>::smooth(vec![0.0, 1.0, 2.0], vec![0.0, 1.0, 3.0]);
        let Interpolation::Cubic(slopes) = &curve.interpolation else { panic!("a spline") };
        assert_eq!((slopes[0], slopes[2]), ([0.0; 2], [0.0; 2]));
        assert!(slopes[1][0] > 0.0);
    }

    proptest! {
        #[test]
        fn smooth_never_leaves_the_values_beside_it(
            values in prop::collection::vec(-10.0..10.0f64, 2..8),
            gaps in prop::collection::vec(0.01..5.0f64, 8),
            share in 0.0..1.0f64,
        ) {
            let times: Vec<f64> = gaps.iter().scan(0.0, |t, gap| { *t += gap; Some(*t) })
                .take(values.len()).collect();
            let curve = Curve::<f64>::smooth(times.clone(), values.clone());
            for i in 1..values.len() {
                let found = curve.sample(times[i - 1] + share * (times[i] - times[i - 1]));
                let (low, high) = (values[i - 1].min(values[i]), values[i - 1].max(values[i]));
                prop_assert!(found >= low - 1e-9 && found <= high + 1e-9, "{found} of {low}..{high}");
            }
        }
    }

    #[test]
    fn times_that_do_not_increase_are_an_error() {
        for times in [vec![1.0, 1.0], vec![2.0, 1.0], vec![0.0, f64::NAN], vec![0.0]] {
            let curve = Curve { times, values: vec![0.0; 2], interpolation: Interpolation::Linear };
            assert!(curve.check().is_err(), "{:?}", curve.times);
        }
    }
}
