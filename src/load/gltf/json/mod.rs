//! The JSON of a glTF file: parsing it, paths within it, and references from one part to another.

mod large_indices;
mod node_transforms;
mod parse;

use std::fmt;

use gltf::json::Value;

use crate::error::{Error, Location, Result};

pub use node_transforms::NodeTransform;
pub use parse::{Document, as_natural, estimated_memory, parse};

/// The path from the root of the JSON to a value, which displays as `nodes[3].children[0]`.
#[derive(Clone, Copy)]
pub enum JsonPath<'p> {
    /// The root itself.
    Root,
    /// The value of a key in the object at a path.
    Key(&'p JsonPath<'p>, &'p str),
    /// An item of the list at a path.
    Item(&'p JsonPath<'p>, usize),
}

impl JsonPath<'_> {
    /// Returns the key of the value, or of the list that it is an item of; empty if there is none.
    pub fn last_key(&self) -> &str {
        match self {
            Self::Key(_, key) | Self::Item(Self::Key(_, key), _) => key,
            _ => "",
        }
    }
}

impl fmt::Display for JsonPath<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Root => f.write_str("the root"),
            Self::Key(Self::Root, key) => f.write_str(key),
            Self::Key(object, key) => write!(f, "{object}.{key}"),
            Self::Item(list, index) => write!(f, "{list}[{index}]"),
        }
    }
}

/// An error at a JSON path.
pub fn error_at(path: impl fmt::Display, message: impl Into<String>) -> Error {
    at_path(path)(Error::input(message))
}

/// Returns a function that adds a JSON path to an error that has no place yet.
pub fn at_path(path: impl fmt::Display) -> impl FnOnce(Error) -> Error {
    move |error| error.with_location(Location::Json(path.to_string()))
}

/// Returns an element of one of the root's lists, of a `kind` that messages name.
///
/// # Errors
/// When there is none of this index; the error is at the JSON path `by` of the reference.
pub fn lookup<'r, T>(
    list: &'r [T],
    index: usize,
    kind: &str,
    by: impl fmt::Display,
) -> Result<&'r T> {
    list.get(index).ok_or_else(|| {
        let found = match list.len() {
            0 => "the file has none".to_owned(),
            1 => "the file has one, number 0".to_owned(),
            n => format!("the file has {n}, from 0 to {}", n - 1),
        };
        error_at(by, format!("there is no {kind} {index}: {found}"))
    })
}

/// Returns a JSON value as an index into a list, if it can be one.
pub fn as_index(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

/// Returns the items of the list that is a property of an object; none if there is no such list.
pub fn list<'v>(object: &'v Value, key: &str) -> &'v [Value] {
    object.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}
