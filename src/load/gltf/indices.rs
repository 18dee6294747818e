//! Numbers too large for the indices that they stand for.

use gltf::json::Value;

use crate::error::{Error, Place, Result};

/// The keys that hold an index or a constant, or a list of them.
const INDEX_KEYS: [&str; 21] = [
    "buffer",
    "bufferView",
    "camera",
    "children",
    "componentType",
    "index",
    "indices",
    "joints",
    "light",
    "material",
    "mesh",
    "mode",
    "node",
    "nodes",
    "sampler",
    "scene",
    "skin",
    "source",
    "texCoord",
    "wrapS",
    "wrapT",
];

/// The crate keeps an index's low 32 bits alone, so that 2³² would mean 0. No file has so many
/// objects: such a number where an index belongs is an error.
pub fn check(value: &Value) -> Result<()> {
    // Each value with the place of the one that it is in: a path for each could fill the memory.
    let mut all = vec![Inner { value, outer: 0, step: Step::Root, of_attributes: false }];
    let mut next = 0;
    while let Some(&Inner { value, of_attributes, .. }) = all.get(next) {
        let outer = next;
        match value {
            Value::Array(items) => all.extend(items.iter().enumerate().map(|(i, value)| Inner {
                value,
                outer,
                step: Step::Index(i),
                of_attributes,
            })),
            Value::Object(map) => all.extend(map.iter().map(|(key, value)| Inner {
                value,
                outer,
                step: Step::Key(key),
                of_attributes: of_attributes || matches!(key.as_str(), "attributes" | "targets"),
            })),
            // Sizes in bytes and counts are 64 bits wide, and checked where they are used.
            Value::Number(n)
                if n.as_u64().is_some_and(|n| n > u64::from(u32::MAX))
                    && (of_attributes || INDEX_KEYS.contains(&last_key(&all, next))) =>
            {
                return Err(Error::input(format!("{n} is too large a number here"))
                    .place(Place::Json(path(&all, next)))
                    .help("indices and constants are below 4294967296"));
            }
            _ => {}
        }
        next += 1;
    }
    Ok(())
}

/// A value within others.
struct Inner<'a> {
    value: &'a Value,
    /// Where the value is that it is in.
    outer: usize,
    /// The way there from that.
    step: Step<'a>,
    /// Whether it is within a primitive's attributes or targets, whose values are indices.
    of_attributes: bool,
}

enum Step<'a> {
    Root,
    Key(&'a str),
    Index(usize),
}

/// The key of a value, or of the list that it is in.
fn last_key<'a>(all: &[Inner<'a>], at: usize) -> &'a str {
    match (&all[at].step, &all[all[at].outer].step) {
        (Step::Key(key), _) | (Step::Index(_), Step::Key(key)) => key,
        _ => "",
    }
}

/// The path of a value, such as `meshes[3].primitives[0]`.
fn path(all: &[Inner], mut at: usize) -> String {
    let mut steps = Vec::new();
    loop {
        match all[at].step {
            Step::Root => break,
            Step::Key(key) => steps.push(format!(".{key}")),
            Step::Index(i) => steps.push(format!("[{i}]")),
        }
        at = all[at].outer;
    }
    steps.reverse();
    steps.concat().trim_start_matches('.').to_owned()
}
