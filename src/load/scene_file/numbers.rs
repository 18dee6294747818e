//! The numbers that keys take, each kind with the range that it has.

use std::fmt;

use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use crate::scene::animation::{MAX_FPS, MAX_FRAMES};
use crate::scene::check::{MAX_COORDINATE, MAX_DEPTH, MAX_SPP};

/// Gives a type of value its part of the JSON Schema.
macro_rules! value_schema {
    ($name:ident, $schema:tt) => {
        impl schemars::JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }
            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                schemars::json_schema!($schema)
            }
        }
    };
}
pub(super) use value_schema;

/// A kind of number: what to call it in a message, which numbers it holds, and its schema.
macro_rules! number {
    ($(#[$doc:meta])* $name:ident, $expected:literal, $holds:expr, $schema:tt) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default)]
        pub struct $name(pub f64);

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let visitor = NumberVisitor { expected: $expected, holds: $holds };
                deserializer.deserialize_f64(visitor).map(Self)
            }
        }

        value_schema!($name, $schema);
    };
}

number!(
    /// Any finite number.
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
    /// Phong's exponent, above 0.
    Shininess, "a number above 0 (and at most 1e6)", |x| (1e-30..=1e6).contains(&x),
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1e6 });
number!(
    /// A field of view in degrees.
    FieldOfView, "an angle in degrees, above 0 and below 180", |x| x > 1e-6 && x < 180.0 - 1e-6,
    { "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 180 });
number!(
    /// Half the opening of a cone, in degrees.
    HalfAngle, "an angle in degrees, from 0 to 90", |x| (0.0..=90.0).contains(&x),
    { "type": "number", "minimum": 0, "maximum": 90 });
number!(
    /// A factor of a scale.
    Factor, "a number other than 0 (at least 1e-15 and at most 1e15 in size)",
    |x| (1e-15..=1e15).contains(&x.abs()),
    { "type": "number", "not": { "const": 0 } });
number!(
    /// An index of refraction.
    Index, "an index of refraction from 0.01 to 100", |x| (0.01..=100.0).contains(&x),
    { "type": "number", "minimum": 0.01, "maximum": 100 });
number!(
    /// A share.
    Share, "a number from 0 to 1", |x| (0.0..=1.0).contains(&x),
    { "type": "number", "minimum": 0, "maximum": 1 });
number!(
    /// Frames in a second.
    Rate, "a number above 0 (and at most 1000)", |x| (1e-6..=MAX_FPS).contains(&x),
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1000 });
number!(
    /// A span of time, in seconds.
    Seconds, "a number of seconds above 0 (and at most 1e15)", |x| (1e-6..=1e15).contains(&x),
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1e15 });

struct NumberVisitor {
    expected: &'static str,
    holds: fn(f64) -> bool,
}

impl Visitor<'_> for NumberVisitor {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_f64<E: Error>(self, x: f64) -> Result<f64, E> {
        if x.is_finite() && (self.holds)(x) {
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

/// A kind of whole number: what to call it in a message, which numbers it holds, and its schema.
macro_rules! whole {
    ($(#[$doc:meta])* $name:ident($of:ty), $expected:literal, $range:expr, $schema:tt) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default)]
        pub struct $name(pub $of);

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let holds = |x| <$of>::try_from(x).ok().filter(|x| ($range).contains(x));
                deserializer.deserialize_i64(WholeVisitor { expected: $expected, holds }).map(Self)
            }
        }

        value_schema!($name, $schema);
    };
}

whole!(
    /// Pixels along a side of the picture; how many a picture can have is checked of both sides.
    Whole(u32), "a whole number from 1 to 4294967295", 0..=u32::MAX,
    { "type": "integer", "minimum": 1, "maximum": 4_294_967_295_u32 });
whole!(
    /// Samples per pixel.
    Samples(u32), "a whole number from 1 to 65536", 1..=MAX_SPP,
    { "type": "integer", "minimum": 1, "maximum": 65536 });
whole!(
    /// How many frames there are.
    FrameCount(u32), "a whole number from 1 to 1000000", 1..=MAX_FRAMES,
    { "type": "integer", "minimum": 1, "maximum": 1_000_000 });
whole!(
    /// How many times light is followed from a surface.
    Depth(u32), "a whole number from 0 to 65536", 0..=MAX_DEPTH,
    { "type": "integer", "minimum": 0, "maximum": 65536 });
whole!(
    /// What goes before what: the greater.
    Priority(i32), "a whole number from -2147483648 to 2147483647", i32::MIN..=i32::MAX,
    { "type": "integer", "minimum": -2_147_483_648_i32, "maximum": 2_147_483_647 });

struct WholeVisitor<T> {
    expected: &'static str,
    /// The number, if it is one of the kind.
    holds: fn(i64) -> Option<T>,
}

impl<T> Visitor<'_> for WholeVisitor<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_i64<E: Error>(self, x: i64) -> Result<T, E> {
        (self.holds)(x).ok_or_else(|| E::invalid_value(Unexpected::Signed(x), &self))
    }
}
