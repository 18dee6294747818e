//! The values that are whole numbers, and the kinds of shadow.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use super::{Forms, value_schema};
use crate::scene::animation::MAX_FRAMES;
use crate::scene::check::{MAX_DEPTH, MAX_OCCLUSION_RAYS, MAX_SPP};
use crate::scene::{MAX_LIGHT_SAMPLES, Shadow};

/// Defines a type of whole number: its name in messages, the numbers that it holds, and its schema.
macro_rules! whole {
    ($(#[$doc:meta])* $name:ident($of:ty), $expected:literal, $range:expr, $schema:tt) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default)]
        pub struct $name(pub $of);

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let convert = |x| <$of>::try_from(x).ok().filter(|x| ($range).contains(x));
                deserializer.deserialize_i64(WholeVisitor { expected: $expected, convert }).map(Self)
            }
        }

        value_schema!($name, $schema);
    };
}

whole!(
    /// A number of pixels along a side of the image; the number in all is checked elsewhere.
    Whole(u32), "a whole number from 1 to 4294967295", 0..=u32::MAX,
    { "type": "integer", "minimum": 1, "maximum": 4_294_967_295_u32 });
whole!(
    /// A number of samples per pixel.
    Samples(u32), "a whole number from 1 to 65536", 1..=MAX_SPP,
    { "type": "integer", "minimum": 1, "maximum": 65536 });
whole!(
    /// A number of samples of a light.
    LightSamples(u32), "a whole number from 1 to 1024", 1..=MAX_LIGHT_SAMPLES,
    { "type": "integer", "minimum": 1, "maximum": 1024 });
whole!(
    /// A number of rays of ambient occlusion.
    OcclusionRays(u32), "a whole number from 0 to 1024", 0..=MAX_OCCLUSION_RAYS,
    { "type": "integer", "minimum": 0, "maximum": 1024 });
whole!(
    /// A number of frames.
    FrameCount(u32), "a whole number from 1 to 1000000", 1..=MAX_FRAMES,
    { "type": "integer", "minimum": 1, "maximum": 1_000_000 });
whole!(
    /// A number of times that light is followed from a surface.
    Depth(u32), "a whole number from 0 to 65536", 0..=MAX_DEPTH,
    { "type": "integer", "minimum": 0, "maximum": 65536 });
whole!(
    /// A priority among transparent bodies: the greatest one counts.
    Priority(i32), "a whole number from -2147483648 to 2147483647", i32::MIN..=i32::MAX,
    { "type": "integer", "minimum": -2_147_483_648_i32, "maximum": 2_147_483_647 });

struct WholeVisitor<T> {
    expected: &'static str,
    /// Returns the number, if it is one of the kind.
    convert: fn(i64) -> Option<T>,
}

impl<T> Visitor<'_> for WholeVisitor<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_i64<E: Error>(self, x: i64) -> Result<T, E> {
        (self.convert)(x).ok_or_else(|| E::invalid_value(Unexpected::Signed(x), &self))
    }
}

/// A size of an image: width and height in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Size(pub [u32; 2]);

impl<'de> Deserialize<'de> for Size {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let sides: [Whole; 2] =
            deserializer.deserialize_any(Forms::list("two whole numbers, width and height"))?;
        Ok(Self(sides.map(|side| side.0)))
    }
}

value_schema!(Size, {
    "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": "integer", "minimum": 1 },
});

/// A range of samples per pixel: the fewest and the most.
#[derive(Clone, Copy, Debug, JsonSchema)]
#[schemars(with = "[Samples; 2]", description = "")]
pub struct SampleRange(pub [u32; 2]);

impl<'de> Deserialize<'de> for SampleRange {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expected = "the fewest and the most samples per pixel";
        let ends: [Samples; 2] = deserializer.deserialize_any(Forms::list(expected))?;
        Ok(Self(ends.map(|end| end.0)))
    }
}

/// A kind of shadow that a light casts.
#[derive(Clone, Copy, Debug)]
pub struct ShadowKind(pub Shadow);

impl<'de> Deserialize<'de> for ShadowKind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ShadowVisitor;
        impl Visitor<'_> for ShadowVisitor {
            type Value = Shadow;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("true, false, \"tinted\" or \"opaque\"")
            }
            fn visit_bool<E: Error>(self, shadow: bool) -> Result<Shadow, E> {
                Ok(if shadow { Shadow::Tinted } else { Shadow::None })
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Shadow, E> {
                match text {
                    "tinted" => Ok(Shadow::Tinted),
                    "opaque" => Ok(Shadow::Opaque),
                    _ => Err(E::invalid_value(Unexpected::Str(text), &self)),
                }
            }
        }
        deserializer.deserialize_any(ShadowVisitor).map(Self)
    }
}

value_schema!(ShadowKind, { "enum": [true, false, "tinted", "opaque"] });
