//! A check for numbers that are too large for an index.

use gltf::json::Value;

use super::{JsonPath, error_at};
use crate::error::Result;

/// The keys of an index or a constant, or of a list of them.
#[rustfmt::skip]
const INDEX_KEYS: [&str; 21] = [
    "buffer", "bufferView", "camera", "children", "componentType", "index", "indices", "joints",
    "light", "material", "mesh", "mode", "node", "nodes", "sampler", "scene", "skin", "source",
    "texCoord", "wrapS", "wrapT",
];

/// Checks that no index and no constant needs more than 32 bits.
///
/// The `gltf` crate keeps the low 32 bits of an index alone, so that 2³² would mean 0. No file has
/// so many objects. The depth of the recursion is that of the JSON, which its parser limits.
///
/// # Errors
/// When one does.
pub fn check(value: &Value, path: &JsonPath, in_attributes: bool) -> Result<()> {
    match value {
        Value::Array(items) => items.iter().enumerate().try_for_each(|(i, item)| {
            // The items of a list of indices are indices.
            check(item, &JsonPath::Item(path, i), in_attributes)
        }),
        Value::Object(map) => map.iter().try_for_each(|(key, value)| {
            // All values in the attributes and targets of a primitive are indices.
            let in_attributes = in_attributes || matches!(key.as_str(), "attributes" | "targets");
            check(value, &JsonPath::Key(path, key), in_attributes)
        }),
        // Sizes in bytes and counts are 64 bits wide, and checked where they are used.
        Value::Number(n)
            if n.as_u64().is_some_and(|n| n > u64::from(u32::MAX))
                && (in_attributes || INDEX_KEYS.contains(&path.last_key())) =>
        {
            Err(error_at(path, format!("{n} is too large a number here"))
                .help("indices and constants are below 4294967296"))
        }
        _ => Ok(()),
    }
}
