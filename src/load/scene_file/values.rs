//! The values that keys take: each type refuses, at its own place in the text, what it cannot be.

use std::fmt;
use std::marker::PhantomData;

use glam::{DVec3, Vec3};
use serde::de::{Error, Expected, IgnoredAny, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use super::numbers::{Amount, Coordinate, Factor, Number, Whole, value_schema};
use crate::scene::Shadow;

/// Reads a list that must hold exactly `N` values.
pub(super) fn list<'de, T, D, const N: usize>(d: D, expected: &str) -> Result<[T; N], D::Error>
where
    T: Deserialize<'de> + Copy + Default,
    D: Deserializer<'de>,
{
    struct ListVisitor<'a, T, const N: usize>(&'a str, PhantomData<T>);

    impl<'de, T, const N: usize> Visitor<'de> for ListVisitor<'_, T, N>
    where
        T: Deserialize<'de> + Copy + Default,
    {
        type Value = [T; N];
        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str(self.0)
        }
        fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<[T; N], A::Error> {
            elements(seq, &self)
        }
    }

    d.deserialize_seq(ListVisitor(expected, PhantomData))
}

/// Reads the elements of a list that must be `N` long.
pub(super) fn elements<'de, T, A, const N: usize>(
    mut seq: A,
    expected: &dyn Expected,
) -> Result<[T; N], A::Error>
where
    T: Deserialize<'de> + Copy + Default,
    A: SeqAccess<'de>,
{
    let mut values = [T::default(); N];
    for (i, value) in values.iter_mut().enumerate() {
        *value = seq.next_element()?.ok_or_else(|| A::Error::invalid_length(i, expected))?;
    }
    let mut length = N;
    while seq.next_element::<IgnoredAny>()?.is_some() {
        length += 1;
    }
    if length == N { Ok(values) } else { Err(A::Error::invalid_length(length, expected)) }
}

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
        unit(DVec3::from_array(xyz.map(|x| x.0)))
            .map(Self)
            .ok_or_else(|| D::Error::custom("a direction cannot be [0, 0, 0]"))
    }
}

value_schema!(Direction, {
    "type": "array", "minItems": 3, "maxItems": 3, "items": { "type": "number" },
});

/// The vector of length 1 along `v`, however long or short `v` is; none for zero.
pub fn unit(v: DVec3) -> Option<DVec3> {
    // Measured by its greatest component first, so that no square over- or underflows.
    (v / v.abs().max_element()).try_normalize()
}

/// Angles about x, y and z, in degrees.
#[derive(Clone, Copy, Debug)]
pub struct Rotation(pub [f64; 3]);

impl<'de> Deserialize<'de> for Rotation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let angles: [Number; 3] = list(deserializer, "three angles in degrees")?;
        Ok(Self(angles.map(|angle| angle.0)))
    }
}

value_schema!(Rotation, {
    "type": "array", "minItems": 3, "maxItems": 3, "items": { "type": "number" },
});

/// A factor for all axes or one for each.
#[derive(Clone, Copy, Debug)]
pub struct Scale(pub DVec3);

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ScaleVisitor;
        impl<'de> Visitor<'de> for ScaleVisitor {
            type Value = DVec3;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("one number or three")
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<DVec3, E> {
                Factor::deserialize(serde::de::value::F64Deserializer::new(x))
                    .map(|factor| DVec3::splat(factor.0))
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<DVec3, E> {
                self.visit_f64(x as f64)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<DVec3, A::Error> {
                elements(seq, &self).map(|v: [Factor; 3]| DVec3::from_array(v.map(|x| x.0)))
            }
        }
        deserializer.deserialize_any(ScaleVisitor).map(Self)
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

/// One number for red, green and blue, or one for each.
#[derive(Clone, Copy, Debug)]
pub struct Triple(pub Vec3);

impl<'de> Deserialize<'de> for Triple {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TripleVisitor;
        impl<'de> Visitor<'de> for TripleVisitor {
            type Value = Vec3;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("one number from 0 up, or three of them")
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<Vec3, E> {
                Amount::deserialize(serde::de::value::F64Deserializer::new(x))
                    .map(|amount| Vec3::splat(amount.0 as f32))
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<Vec3, E> {
                self.visit_f64(x as f64)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Vec3, A::Error> {
                elements(seq, &self).map(|v: [Amount; 3]| Vec3::from_array(v.map(|x| x.0 as f32)))
            }
        }
        deserializer.deserialize_any(TripleVisitor).map(Self)
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
pub enum Spot {
    /// The point itself.
    Point(DVec3),
    /// An object's name.
    Name(String),
}

impl<'de> Deserialize<'de> for Spot {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct SpotVisitor;
        impl<'de> Visitor<'de> for SpotVisitor {
            type Value = Spot;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("three numbers, or an object's name")
            }
            fn visit_str<E: Error>(self, name: &str) -> Result<Spot, E> {
                Ok(Spot::Name(name.to_owned()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Spot, A::Error> {
                let xyz: [Coordinate; 3] = elements(seq, &self)?;
                Ok(Spot::Point(DVec3::from_array(xyz.map(|x| x.0))))
            }
        }
        deserializer.deserialize_any(SpotVisitor)
    }
}

value_schema!(Spot, {
    "anyOf": [
        {
            "type": "array", "minItems": 3, "maxItems": 3,
            "items": { "type": "number", "minimum": -1e15, "maximum": 1e15 },
        },
        { "type": "string" },
    ],
});

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
