//! The colours of a scene file.

use std::borrow::Cow;

use glam::Vec3;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer};

use super::values::{Amount, Forms, value_schema};
use crate::scene::Transfer;

/// A colour as it is written, before the film's transfer curve is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Color {
    /// The value of its pixels in the PNG.
    Pixel([u8; 3]),
    /// The linear colour, in Rec. 709.
    Linear(Vec3),
}

impl Default for Color {
    fn default() -> Self {
        Color::Linear(Vec3::ZERO)
    }
}

impl Color {
    /// Returns the linear colour; `transfer` is the curve by which the PNG encodes light.
    pub fn to_linear(self, transfer: Transfer) -> Vec3 {
        match self {
            Color::Linear(rgb) => rgb,
            Color::Pixel(rgb) => {
                Vec3::from_array(rgb.map(|byte| transfer.decode(f32::from(byte) / 255.0)))
            }
        }
    }
}

impl<'de> Deserialize<'de> for Color {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Forms {
            expected: "a colour: \"#rrggbb\", three numbers, or one for a grey",
            list: |rgb: [Amount; 3]| Self::Linear(Vec3::from_array(rgb.map(|x| x.0 as f32))),
            takes_one: true,
            text: |text| parse_hex(text).map(Self::Pixel),
        })
    }
}

value_schema!(Color, { "anyOf": [
    { "type": "string", "pattern": "^#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})$" },
    { "type": "array", "minItems": 3, "maxItems": 3, "items": { "type": "number", "minimum": 0 } },
    { "type": "number", "minimum": 0 },
] });

/// A pair of colours.
#[derive(Clone, Copy, Debug, JsonSchema)]
#[schemars(with = "[Color; 2]", description = "")]
pub struct Pair(pub [Color; 2]);

impl<'de> Deserialize<'de> for Pair {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Forms::list("two colours")).map(Self)
    }
}

/// Parses the bytes of `#rgb` or `#rrggbb`.
fn parse_hex(text: &str) -> Option<[u8; 3]> {
    let digits: Vec<u8> = text
        .strip_prefix('#')?
        .chars()
        .map(|c| c.to_digit(16).map(|digit| digit as u8))
        .collect::<Option<_>>()?;
    match digits[..] {
        [r, g, b] => Some([r, g, b].map(|digit| digit * 17)),
        [r, rr, g, gg, b, bb] => Some([r * 16 + rr, g * 16 + gg, b * 16 + bb]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_of_three_digits_doubles_each() {
        assert_eq!(parse_hex("#1aF"), Some([0x11, 0xaa, 0xff]));
    }

    #[test]
    fn malformed_hex_colors_are_refused() {
        for text in ["", "#", "123456", "#12", "#1234", "#12345g", "#1234567", "#é12345", "#+1+2+3"]
        {
            assert_eq!(parse_hex(text), None, "{text}");
        }
    }
}
