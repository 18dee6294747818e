//! The wrappers of values that store their span in the text, and check their shape.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::load::scene_file::source::Span;

/// A value and its span in the text; that of a table with a header is the header.
#[derive(Clone, Debug)]
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
#[derive(Clone, Debug, Default)]
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

/// Implements what lists of tables have in common.
macro_rules! list_of_tables {
    ($name:ident) => {
        impl<T> Default for $name<T> {
            fn default() -> Self {
                Self(Vec::new())
            }
        }

        impl<T> $name<T> {
            /// Returns the tables, without their spans.
            pub fn iter(&self) -> impl Iterator<Item = &T> {
                self.0.iter().map(|table| &table.value.0)
            }
        }
    };
}

/// A list of tables under headers in double brackets, such as `[[sphere]]`.
#[derive(Debug)]
pub struct Tables<T>(pub Vec<Spanned<Table<T>>>);

list_of_tables!(Tables);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Tables<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(ListVisitor::new("a list of tables")).map(Self)
    }
}

/// A visitor of a list of any length; errors say what was expected.
pub struct ListVisitor<T>(&'static str, PhantomData<T>);

impl<T> ListVisitor<T> {
    /// Returns the visitor of a list that messages call by this name.
    pub fn new(expected: &'static str) -> Self {
        Self(expected, PhantomData)
    }
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for ListVisitor<T> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Vec<T>, A::Error> {
        read_elements(seq)
    }
}

/// A table, such as `[camera]`, or several under double brackets.
#[derive(Debug)]
pub struct OneOrMore<T>(pub Vec<Spanned<Table<T>>>);

list_of_tables!(OneOrMore);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for OneOrMore<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrMoreVisitor<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for OneOrMoreVisitor<T> {
            type Value = Vec<Spanned<Table<T>>>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table or a list of tables")
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
                let table = Table(T::deserialize(MapAccessDeserializer::new(map))?);
                Ok(vec![Spanned { span: 0..0, value: table }])
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Self::Value, A::Error> {
                read_elements(seq)
            }
        }
        struct Tables<T>(Vec<Spanned<Table<T>>>);
        impl<'de, T: Deserialize<'de>> Deserialize<'de> for Tables<T> {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any(OneOrMoreVisitor(PhantomData)).map(Tables)
            }
        }
        let Spanned { span, value: Tables(mut tables) } = Spanned::deserialize(deserializer)?;
        if let [only] = &mut tables[..] {
            // The span of the whole is that of the only table, or of the first of several.
            only.span = span;
        }
        Ok(Self(tables))
    }
}

fn read_elements<'de, T: Deserialize<'de>, A: SeqAccess<'de>>(
    mut seq: A,
) -> Result<Vec<T>, A::Error> {
    let mut tables = Vec::with_capacity(seq.size_hint().unwrap_or(0));
    while let Some(table) = seq.next_element()? {
        tables.push(table);
    }
    Ok(tables)
}

/// Implements the schema of wrappers that change nothing of it.
macro_rules! transparent_schema {
    ($($name:ident)*) => {$(
        impl<T: JsonSchema> JsonSchema for $name<T> {
            fn inline_schema() -> bool {
                T::inline_schema()
            }
            fn schema_name() -> Cow<'static, str> {
                T::schema_name()
            }
            fn schema_id() -> Cow<'static, str> {
                T::schema_id()
            }
            fn json_schema(generator: &mut SchemaGenerator) -> Schema {
                T::json_schema(generator)
            }
        }
    )*};
}

transparent_schema!(Spanned Table);

impl<T: JsonSchema> JsonSchema for Tables<T> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        format!("{}s", T::schema_name()).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "array", "items": generator.subschema_for::<T>() })
    }
}

impl<T: JsonSchema> JsonSchema for OneOrMore<T> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        format!("{}s", T::schema_name()).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let one = generator.subschema_for::<T>();
        json_schema!({ "anyOf": [one, { "type": "array", "items": one }] })
    }
}
