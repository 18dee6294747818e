//! The values of several numbers: points, directions, rotations, scales, absorption.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use glam::{DVec3, Vec3};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::F64Deserializer;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::{Amount, Coordinate, Factor, Number, elements, list, value_schema};

/// A position, or a displacement, in world space.
#[derive(Clone, Copy, Debug)]
pub struct Point(pub DVec3);

impl<'de> Deserialize<'de> for Point {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let xyz: [Coordinate; 3] = list(deserializer, "three numbers")?;
        Ok(Self(DVec3::from_array(xyz.map(|x| x.0))))
    }
}

value_schema!(Point, {
    "type": "array", "minItems": 3, "maxItems": 3,
    "items": { "type": "number", "minimum": -1e15, "maximum": 1e15 },
});

/// A direction of any length but zero; it is kept with length 1.
#[derive(Clone, Copy, Debug)]
pub struct Direction(pub DVec3);

impl<'de> Deserialize<'de> for Direction {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let xyz: [Number; 3] = list(deserializer, "three numbers")?;
        normalize(DVec3::from_array(xyz.map(|x| x.0)))
            .map(Self)
            .ok_or_else(|| D::Error::custom("a direction cannot be [0, 0, 0]"))
    }
}

value_schema!(Direction, {
    "type": "array", "minItems": 3, "maxItems": 3, "items": { "type": "number" },
});

/// Returns the vector of length 1 along `v`, however long or short `v` is; none for zero.
pub fn normalize(v: DVec3) -> Option<DVec3> {
    // Measured by its greatest component first, so that no square over- or underflows.
    (v / v.abs().max_element()).try_normalize()
}

/// A rotation: angles about x, y and z, in degrees.
#[derive(Clone, Copy, Debug)]
pub struct Rotation(pub [f64; 3]);

impl<'de> Deserialize<'de> for Rotation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let angles: [Number; 3] = list(deserializer, "three angles in degrees")?;
        Ok(Self(angles.map(|angle| angle.0)))
    }
}

impl Rotation {
    /// Returns the angles in radians.
    pub fn radians(self) -> DVec3 {
        DVec3::from_array(self.0.map(f64::to_radians))
    }
}

value_schema!(Rotation, {
    "type": "array", "minItems": 3, "maxItems": 3, "items": { "type": "number" },
});

/// Reads one number that stands for three, or three of them.
fn one_or_three<'de, T, D>(deserializer: D, expected: &str) -> Result<[T; 3], D::Error>
where
    T: Deserialize<'de> + Copy + Default,
    D: Deserializer<'de>,
{
    struct OneOrThree<'a, T>(&'a str, PhantomData<T>);

    impl<'de, T: Deserialize<'de> + Copy + Default> Visitor<'de> for OneOrThree<'_, T> {
        type Value = [T; 3];
        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str(self.0)
        }
        fn visit_f64<E: Error>(self, x: f64) -> Result<[T; 3], E> {
            T::deserialize(F64Deserializer::new(x)).map(|x| [x; 3])
        }
        fn visit_i64<E: Error>(self, x: i64) -> Result<[T; 3], E> {
            self.visit_f64(x as f64)
        }
        fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<[T; 3], A::Error> {
            elements(seq, &self)
        }
    }

    deserializer.deserialize_any(OneOrThree(expected, PhantomData))
}

/// A scale: one factor for all axes or one for each.
#[derive(Clone, Copy, Debug)]
pub struct Scale(pub DVec3);

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let factors: [Factor; 3] = one_or_three(deserializer, "one number or three")?;
        Ok(Self(DVec3::from_array(factors.map(|x| x.0))))
    }
}

value_schema!(Scale, {
    "anyOf": [
        { "type": "number", "not": { "const": 0 } },
        {
            "type": "array", "minItems": 3, "maxItems": 3,
            "items": { "type": "number", "not": { "const": 0 } },
        },
    ],
});

/// A number for each of red, green and blue, or one for all.
#[derive(Clone, Copy, Debug)]
pub struct Triple(pub Vec3);

impl<'de> Deserialize<'de> for Triple {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expected = "one number from 0 up, or three of them";
        let amounts: [Amount; 3] = one_or_three(deserializer, expected)?;
        Ok(Self(Vec3::from_array(amounts.map(|x| x.0 as f32))))
    }
}

value_schema!(Triple, {
    "anyOf": [
        { "type": "number", "minimum": 0 },
        {
            "type": "array", "minItems": 3, "maxItems": 3,
            "items": { "type": "number", "minimum": 0 },
        },
    ],
});

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
        struct PointOrNameVisitor;
        impl<'de> Visitor<'de> for PointOrNameVisitor {
            type Value = PointOrName;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("three numbers, or an object's name")
            }
            fn visit_str<E: Error>(self, name: &str) -> Result<PointOrName, E> {
                Ok(PointOrName::Name(name.to_owned()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<PointOrName, A::Error> {
                let xyz: [Coordinate; 3] = elements(seq, &self)?;
                Ok(PointOrName::Point(DVec3::from_array(xyz.map(|x| x.0))))
            }
        }
        deserializer.deserialize_any(PointOrNameVisitor)
    }
}

value_schema!(PointOrName, {
    "anyOf": [
        {
            "type": "array", "minItems": 3, "maxItems": 3,
            "items": { "type": "number", "minimum": -1e15, "maximum": 1e15 },
        },
        { "type": "string" },
    ],
});
