//! The values that keys take: each type refuses, at its own place in the text, what it cannot be.

mod integers;
mod vectors;

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::F64Deserializer;
use serde::de::{Error, IgnoredAny, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use crate::scene::animation::MAX_FPS;
use crate::scene::check::MAX_COORDINATE;
pub use integers::{
    Depth, FrameCount, LightSamples, OcclusionRays, Priority, SampleRange, Samples, ShadowKind,
    Size,
};
pub use vectors::{Direction, Point, PointOrName, Rotation, Scale, Sides, Triple, normalize};

/// Implements the JSON Schema of a type of value.
macro_rules! value_schema {
    ($name:ident, $schema:tt) => {
        impl JsonSchema for $name {
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }
            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!($schema)
            }
        }
    };
}
pub(super) use value_schema;

/// Defines a type of number: its name in messages, the numbers that it holds, and its schema.
macro_rules! number {
    ($(#[$doc:meta])* $name:ident, $expected:literal, $is_valid:expr, $schema:tt) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default)]
        pub struct $name(pub f64);

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let visitor = NumberVisitor { expected: $expected, is_valid: $is_valid };
                deserializer.deserialize_f64(visitor).map(Self)
            }
        }

        value_schema!($name, $schema);
    };
}

number!(
    /// A finite number.
    Number, "a finite number", |_| true, { "type": "number" });
number!(
    /// A coordinate in world space.
    Coordinate, "a number within 1e15 of 0", |x| x.abs() <= MAX_COORDINATE,
    { "type": "number", "minimum": -1e15, "maximum": 1e15 });
number!(
    /// A length above 0.
    Length, "a number above 0 (and at most 1e15)", |x| x > 0.0 && x <= MAX_COORDINATE,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1e15 });
number!(
    /// A number that f32 holds, 0 or above: a share of light or an amount of it.
    Amount, "a number from 0 up (and at most 1e30)", |x| (0.0..=1e30).contains(&x),
    { "type": "number", "minimum": 0, "maximum": 1e30 });
number!(
    /// A Phong exponent, above 0.
    Shininess, "a number above 0 (and at most 1e6)", |x| (1e-30..=1e6).contains(&x),
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1e6 });
number!(
    /// A field of view in degrees.
    FieldOfView, "an angle in degrees, above 0 and below 180", |x| x > 1e-6 && x < 180.0 - 1e-6,
    { "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 180 });
number!(
    /// A half-angle of a cone, in degrees.
    HalfAngle, "an angle in degrees, from 0 to 90", |x| (0.0..=90.0).contains(&x),
    { "type": "number", "minimum": 0, "maximum": 90 });
number!(
    /// The angular diameter of a sun, in degrees.
    SunAngle, "an angle in degrees, from 0.0001 to 180, or 0",
    |x| x == 0.0 || (1e-4..=180.0).contains(&x),
    { "type": "number", "minimum": 0, "maximum": 180 });
number!(
    /// A factor of a scale.
    Factor, "a number other than 0 (at least 1e-15 and at most 1e15 in size)",
    |x| (1e-15..=1e15).contains(&x.abs()),
    { "type": "number", "not": { "const": 0 } });

number!(
    /// The turbidity of a sky.
    Turbidity, "a turbidity from 1.7 to 10", |x| (1.7..=10.0).contains(&x),
    { "type": "number", "minimum": 1.7, "maximum": 10 });
number!(
    /// An index of refraction.
    Index, "an index of refraction from 0.01 to 100", |x| (0.01..=100.0).contains(&x),
    { "type": "number", "minimum": 0.01, "maximum": 100 });
number!(
    /// A share.
    Share, "a number from 0 to 1", |x| (0.0..=1.0).contains(&x),
    { "type": "number", "minimum": 0, "maximum": 1 });

number!(
    /// A number of frames per second.
    Rate, "a number above 0 (and at most 1000)", |x| (1e-6..=MAX_FPS).contains(&x),
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1000 });
number!(
    /// A span of time, in seconds.
    Seconds, "a number of seconds above 0 (and at most 1e15)", |x| (1e-6..=1e15).contains(&x),
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1e15 });

struct NumberVisitor {
    expected: &'static str,
    is_valid: fn(f64) -> bool,
}

impl Visitor<'_> for NumberVisitor {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_f64<E: Error>(self, x: f64) -> Result<f64, E> {
        if x.is_finite() && (self.is_valid)(x) {
            Ok(x)
        } else {
            Err(E::invalid_value(Unexpected::Float(x), &self))
        }
    }

    fn visit_i64<E: Error>(self, x: i64) -> Result<f64, E> {
        self.visit_f64(x as f64)
    }

    fn visit_u64<E: Error>(self, x: u64) -> Result<f64, E> {
        self.visit_f64(x as f64)
    }
}

/// The forms in which a value may be written: a list of `N` elements, and for some values also one
/// element that stands for all, or a text.
pub(super) struct Forms<T, V, const N: usize> {
    /// The forms, as messages name them.
    pub expected: &'static str,
    /// Returns the value of a list.
    pub list: fn([T; N]) -> V,
    /// True if one number stands for all elements.
    pub takes_one: bool,
    /// Returns the value of a text, if it has any.
    pub text: fn(&str) -> Option<V>,
}

impl<T, const N: usize> Forms<T, [T; N], N> {
    /// Returns the form of a list alone.
    pub fn list(expected: &'static str) -> Self {
        Self { expected, list: |elements| elements, takes_one: false, text: |_| None }
    }
}

impl<'de, T, V, const N: usize> Visitor<'de> for Forms<T, V, N>
where
    T: Deserialize<'de> + Copy + Default,
{
    type Value = V;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_f64<E: Error>(self, x: f64) -> Result<V, E> {
        if !self.takes_one {
            return Err(E::invalid_type(Unexpected::Float(x), &self));
        }
        T::deserialize(F64Deserializer::new(x)).map(|x| (self.list)([x; N]))
    }

    fn visit_i64<E: Error>(self, x: i64) -> Result<V, E> {
        self.visit_f64(x as f64)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<V, E> {
        (self.text)(text).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<V, A::Error> {
        let mut values = [T::default(); N];
        for (i, value) in values.iter_mut().enumerate() {
            *value = seq.next_element()?.ok_or_else(|| A::Error::invalid_length(i, &self))?;
        }
        // A message about a longer list says how long it is.
        let mut length = N;
        while seq.next_element::<IgnoredAny>()?.is_some() {
            length += 1;
        }
        if length == N {
            Ok((self.list)(values))
        } else {
            Err(A::Error::invalid_length(length, &self))
        }
    }
}
