//! The values of several numbers: points, directions, rotations, scales, absorption.

use std::borrow::Cow;

use glam::{DVec3, Vec3};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use super::{Amount, Coordinate, Factor, Forms, Length, Number, value_schema};

/// A position, or a displacement, in world space.
#[derive(Clone, Copy, Debug, JsonSchema)]
#[schemars(with = "[Coordinate; 3]", description = "")]
pub struct Point(pub DVec3);

impl<'de> Deserialize<'de> for Point {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let xyz: [Coordinate; 3] = deserializer.deserialize_any(Forms::list("three numbers"))?;
        Ok(Self(DVec3::from_array(xyz.map(|x| x.0))))
    }
}

/// A direction of any length but zero; it is kept with length 1.
#[derive(Clone, Copy, Debug, JsonSchema)]
#[schemars(with = "[Number; 3]", description = "")]
pub struct Direction(pub DVec3);

impl<'de> Deserialize<'de> for Direction {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let xyz: [Number; 3] = deserializer.deserialize_any(Forms::list("three numbers"))?;
        normalize(DVec3::from_array(xyz.map(|x| x.0)))
            .map(Self)
            .ok_or_else(|| D::Error::custom("a direction cannot be [0, 0, 0]"))
    }
}

/// Returns the vector of length 1 along `v`, however long or short `v` is; none for zero.
pub fn normalize(v: DVec3) -> Option<DVec3> {
    // Measured by its greatest component first, so that no square over- or underflows.
    (v / v.abs().max_element()).try_normalize()
}

/// A rotation: angles about x, y and z, in degrees.
#[derive(Clone, Copy, Debug, JsonSchema)]
#[schemars(with = "[Number; 3]", description = "")]
pub struct Rotation(pub [f64; 3]);

impl<'de> Deserialize<'de> for Rotation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let angles: [Number; 3] =
            deserializer.deserialize_any(Forms::list("three angles in degrees"))?;
        Ok(Self(angles.map(|angle| angle.0)))
    }
}

impl Rotation {
    /// Returns the angles in radians.
    pub fn radians(self) -> DVec3 {
        DVec3::from_array(self.0.map(f64::to_radians))
    }
}

/// A scale: one factor for all axes or one for each.
#[derive(Clone, Copy, Debug)]
pub struct Scale(pub DVec3);

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let forms = Forms { takes_one: true, ..Forms::list("one number or three") };
        let factors: [Factor; 3] = deserializer.deserialize_any(forms)?;
        Ok(Self(DVec3::from_array(factors.map(|x| x.0))))
    }
}

value_schema!(Scale, { "anyOf": [
    { "type": "number", "not": { "const": 0 } },
    {
        "type": "array", "minItems": 3, "maxItems": 3,
        "items": { "type": "number", "not": { "const": 0 } },
    },
] });

/// The lengths of the two sides of a rectangle.
#[derive(Clone, Copy, Debug, JsonSchema)]
#[schemars(with = "[Length; 2]", description = "")]
pub struct Sides(pub [f64; 2]);

impl<'de> Deserialize<'de> for Sides {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let sides: [Length; 2] =
            deserializer.deserialize_any(Forms::list("two lengths, width and height"))?;
        Ok(Self(sides.map(|side| side.0)))
    }
}

/// A number for each of red, green and blue, or one for all.
#[derive(Clone, Copy, Debug)]
pub struct Triple(pub Vec3);

impl<'de> Deserialize<'de> for Triple {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expected = "one number from 0 up, or three of them";
        let forms = Forms { takes_one: true, ..Forms::list(expected) };
        let amounts: [Amount; 3] = deserializer.deserialize_any(forms)?;
        Ok(Self(Vec3::from_array(amounts.map(|x| x.0 as f32))))
    }
}

value_schema!(Triple, { "anyOf": [
    { "type": "number", "minimum": 0 },
    { "type": "array", "minItems": 3, "maxItems": 3, "items": { "type": "number", "minimum": 0 } },
] });

/// A point, or the name of an object that stands for where it is.
#[derive(Clone, Debug)]
pub enum PointOrName {
    /// The point itself.
    Point(DVec3),
    /// An object's name.
    Name(String),
}

impl<'de> Deserialize<'de> for PointOrName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Forms {
            expected: "three numbers, or an object's name",
            list: |xyz: [Coordinate; 3]| Self::Point(DVec3::from_array(xyz.map(|x| x.0))),
            takes_one: false,
            text: |name| Some(Self::Name(name.to_owned())),
        })
    }
}

value_schema!(PointOrName, { "anyOf": [
    {
        "type": "array", "minItems": 3, "maxItems": 3,
        "items": { "type": "number", "minimum": -1e15, "maximum": 1e15 },
    },
    { "type": "string" },
] });
