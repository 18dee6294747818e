//! Values that are whole numbers, and those that are words.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use super::{list, value_schema};
use crate::scene::Shadow;
use crate::scene::check::MAX_DEPTH;

/// A whole number, 0 or above.
#[derive(Clone, Copy, Debug, Default)]
pub struct Whole(pub u32);

impl<'de> Deserialize<'de> for Whole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct WholeVisitor;
        impl Visitor<'_> for WholeVisitor {
            type Value = u32;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number from 1 to 4294967295")
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<u32, E> {
                u32::try_from(x).map_err(|_| E::invalid_value(Unexpected::Signed(x), &self))
            }
        }
        deserializer.deserialize_u32(WholeVisitor).map(Self)
    }
}

value_schema!(Whole, { "type": "integer", "minimum": 1, "maximum": 4_294_967_295_u32 });

/// A width and a height in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Size(pub [u32; 2]);

impl<'de> Deserialize<'de> for Size {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let sides: [Whole; 2] = list(deserializer, "two whole numbers, width and height")?;
        Ok(Self(sides.map(|side| side.0)))
    }
}

value_schema!(Size, {
    "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": "integer", "minimum": 1 },
});

/// How many times light is followed from a surface.
#[derive(Clone, Copy, Debug)]
pub struct Depth(pub u32);

impl<'de> Deserialize<'de> for Depth {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let depth = i64::deserialize(deserializer)?;
        match u32::try_from(depth) {
            Ok(depth) if depth <= MAX_DEPTH => Ok(Self(depth)),
            _ => Err(D::Error::invalid_value(
                Unexpected::Signed(depth),
                &"a whole number from 0 to 65536",
            )),
        }
    }
}

value_schema!(Depth, { "type": "integer", "minimum": 0, "maximum": 65536 });

/// A whole number that says what goes before what.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(transparent)]
pub struct Priority(pub i32);

value_schema!(Priority, { "type": "integer" });

/// What keeps a light from what lies behind it.
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
