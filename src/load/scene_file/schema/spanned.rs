//! The wrappers of values that store their span in the text, and check their shape.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use crate::load::scene_file::source::Span;

/// A value and its span in the text; that of a table with a header is the header.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(with = "T", description = "")]
pub struct Spanned<T> {
    /// The span.
    pub span: Span,
    /// The value.
    pub value: T,
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Spanned<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let spanned = toml::Spanned::<T>::deserialize(deserializer)?;
        Ok(Self { span: spanned.span(), value: spanned.into_inner() })
    }
}

/// A table that must be written as one: serde alone would also take a list of its values in order.
#[derive(Clone, Debug, Default, JsonSchema)]
#[schemars(with = "T", description = "")]
pub struct Table<T>(pub T);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Table<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TableVisitor<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for TableVisitor<T> {
            type Value = Table<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table")
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Table<T>, A::Error> {
                T::deserialize(MapAccessDeserializer::new(map)).map(Table)
            }
        }
        deserializer.deserialize_map(TableVisitor(PhantomData))
    }
}

/// A list of tables under headers in double brackets, such as `[[sphere]]`; or also a single table,
/// such as `[camera]`, if it `MAY_BE_ONE`.
#[derive(Debug)]
pub struct Tables<T, const MAY_BE_ONE: bool = false>(pub Vec<Spanned<Table<T>>>);

/// A table, such as `[camera]`, or several under double brackets.
pub type OneOrMore<T> = Tables<T, true>;

impl<T, const MAY_BE_ONE: bool> Default for Tables<T, MAY_BE_ONE> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T, const MAY_BE_ONE: bool> Tables<T, MAY_BE_ONE> {
    /// Returns the tables, without their spans.
    pub fn iter(&self) -> impl Iterator<Item = &T> {
        self.0.iter().map(|table| &table.value.0)
    }
}

impl<'de, T: Deserialize<'de>, const MAY_BE_ONE: bool> Deserialize<'de> for Tables<T, MAY_BE_ONE> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        /// The tables, of which a single one has no span yet.
        struct Unspanned<T, const MAY_BE_ONE: bool>(Vec<Spanned<Table<T>>>);
        impl<'de, T: Deserialize<'de>, const MAY_BE_ONE: bool> Deserialize<'de>
            for Unspanned<T, MAY_BE_ONE>
        {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any(TablesVisitor::<T, MAY_BE_ONE>(PhantomData)).map(Self)
            }
        }
        let Spanned { span, value: Unspanned::<T, MAY_BE_ONE>(mut tables) } =
            Spanned::deserialize(deserializer)?;
        if let [only] = &mut tables[..] {
            // The span of the whole is that of the only table, or of the first of several.
            only.span = span;
        }
        Ok(Self(tables))
    }
}

struct TablesVisitor<T, const MAY_BE_ONE: bool>(PhantomData<T>);

impl<'de, T: Deserialize<'de>, const MAY_BE_ONE: bool> Visitor<'de>
    for TablesVisitor<T, MAY_BE_ONE>
{
    type Value = Vec<Spanned<Table<T>>>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if MAY_BE_ONE { "a table or a list of tables" } else { "a list of tables" })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        if !MAY_BE_ONE {
            return Err(A::Error::invalid_type(Unexpected::Map, &self));
        }
        let table = Table(T::deserialize(MapAccessDeserializer::new(map))?);
        Ok(vec![Spanned { span: 0..0, value: table }])
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Self::Value, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(seq))
    }
}

impl<T: JsonSchema, const MAY_BE_ONE: bool> JsonSchema for Tables<T, MAY_BE_ONE> {
    fn schema_name() -> Cow<'static, str> {
        format!("{}s", T::schema_name()).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let one = generator.subschema_for::<T>();
        let list = json_schema!({ "type": "array", "items": one });
        if MAY_BE_ONE { json_schema!({ "anyOf": [one, list] }) } else { list }
    }
}
