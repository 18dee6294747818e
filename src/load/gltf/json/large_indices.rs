//! A check for numbers that are too large for an index.

use gltf::json::Value;

use super::{JsonPath, Segment, error_at};
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
pub fn check<'v>(value: &'v Value, path: &mut JsonPath<'v>, in_attributes: bool) -> Result<()> {
    match value {
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                path.push(Segment::Index(i));
                check(item, path, in_attributes)?;
                path.pop();
            }
        }
        Value::Object(map) => {
            for (key, value) in map {
                // All values in the attributes and targets of a primitive are indices.
                let in_attributes =
                    in_attributes || matches!(key.as_str(), "attributes" | "targets");
                path.push(Segment::Key(key));
                check(value, path, in_attributes)?;
                path.pop();
            }
        }
        // Sizes in bytes and counts are 64 bits wide, and checked where they are used.
        Value::Number(n)
            if n.as_u64().is_some_and(|n| n > u64::from(u32::MAX))
                && (in_attributes || INDEX_KEYS.contains(&path.last_key())) =>
        {
            return Err(error_at(path, format!("{n} is too large a number here"))
                .help("indices and constants are below 4294967296"));
        }
        _ => {}
    }
    Ok(())
}
