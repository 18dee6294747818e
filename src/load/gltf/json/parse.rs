//! The parser of a file's JSON, more lenient than the types of the `gltf` crate where these refuse
//! a file for no reason, and stricter where they let pass what would mean something else.

use gltf::json::{self, Value};
use serde::Deserialize;

use super::super::container::wrong_version;
use super::super::validate;
use super::node_transforms::NodeTransforms;
use super::{JsonPath, error_at, large_indices, list};
use crate::error::{Error, Location, Result};

/// The estimated memory, in bytes, of the values of a JSON text once it is parsed: many times its
/// length, if they are lists in lists. See [`crate::load::Limit::Json`].
pub fn estimated_memory(bytes: &[u8]) -> u64 {
    let (mut total, mut in_string, mut escaped) = (0u64, false, false);
    for &byte in bytes {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if in_string => escaped = true,
            b'"' => in_string = !in_string,
            _ if in_string => {}
            b'{' => total += 640,
            b'[' => total += 128,
            b',' => total += 32,
            _ => {}
        }
    }
    total
}

/// The largest memory of JSON that is validated: its values are stored beside the crate's types.
const MAX_VALIDATED_MEMORY: u64 = 1 << 28;

/// The JSON of a file.
#[derive(Debug)]
pub struct Document {
    /// The crate's types.
    pub root: json::Root,
    /// The transforms of the nodes, in f64.
    pub transforms: NodeTransforms,
    /// The values as they are in the file, unless they are too large to be validated.
    pub value: Option<Value>,
}

/// Parses the JSON of a file.
///
/// # Errors
/// When it is not JSON, not glTF 2, or lacks what the crate's types need; at a JSON path or a line.
pub fn parse(bytes: &[u8]) -> Result<Document> {
    // Most files are what the crate expects; the others are read once more.
    let root = match json::deserialize::from_slice::<json::Root>(bytes) {
        Ok(root) => root,
        Err(error) => parse_leniently(bytes, &error)?,
    };
    // A reader of 2.0 may read any version 2.x, says the standard.
    if root.asset.version.split('.').next() != Some("2") {
        return Err(unsupported_version(&root.asset.version));
    }
    if estimated_memory(bytes) > MAX_VALIDATED_MEMORY {
        let transforms = serde_json::from_slice(bytes).map_err(|e| syntax_error(bytes, &e))?;
        return Ok(Document { root, transforms, value: None });
    }
    let value: Value = json::deserialize::from_slice(bytes).map_err(|e| syntax_error(bytes, &e))?;
    let transforms = NodeTransforms::deserialize(&value).map_err(|e| syntax_error(bytes, &e))?;
    // A visit to all values takes time, and only a number of ten digits can be too large.
    let mut digits = 0;
    let is_tenth_digit = |b: &u8| {
        digits = if b.is_ascii_digit() { digits + 1 } else { 0 };
        digits == 10
    };
    if bytes.iter().any(is_tenth_digit) {
        large_indices::check(&value, &JsonPath::Root, false)?;
    }
    Ok(Document { root, transforms, value: Some(value) })
}

fn unsupported_version(version: &str) -> Error {
    wrong_version(version).with_location(Location::Json("asset.version".to_owned()))
}

/// Parses a file that the crate's types refuse. They demand more than the standard does, also of
/// what is never used here, and cannot say that a file is glTF 1.0.
fn parse_leniently(bytes: &[u8], error: &json::Error) -> Result<json::Root> {
    let mut value: Value =
        json::deserialize::from_slice(bytes).map_err(|_| syntax_error(bytes, error))?;
    // The version: the crate cannot say that a file is of another one.
    let is_object = |key: &&str| value.get(key).is_some_and(Value::is_object);
    match value.get("asset").and_then(|a| a.get("version")) {
        Some(Value::String(version)) if version.starts_with('2') => {}
        Some(Value::String(version)) => return Err(unsupported_version(version)),
        // Some files of glTF 1.0 have a number.
        Some(other) => return Err(unsupported_version(&other.to_string())),
        // The first glTF 1.0 files had no `asset`, but objects where 2.0 has arrays.
        None if ["meshes", "techniques"].iter().any(is_object) => return Err(wrong_version("1.0")),
        None => {
            return Err(Error::input("there is no `asset.version`: this may not be glTF")
                .help("a glTF file has `\"asset\": {\"version\": \"2.0\"}`"));
        }
    }
    // What the crate demands and the standard does not is filled in or removed.
    for scene in items_mut(&mut value, "scenes") {
        if let Some(scene) = scene.as_object_mut() {
            scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
        }
    }
    items_mut(&mut value, "animations").for_each(simplify_animation);
    normalize(&mut value);

    // What is still refused is named by our own schema, which says where it is.
    let missing_or_mistyped = validate::first_missing_or_mistyped(&value);
    json::deserialize::from_value(value).map_err(|_| match missing_or_mistyped {
        Some((path, what)) => error_at(path, format!("not what glTF has here: {what}")),
        None => syntax_error(bytes, error),
    })
}

/// The items of the list that is a property of an object; none if there is no such list.
fn items_mut<'v>(object: &'v mut Value, key: &str) -> impl Iterator<Item = &'v mut Value> {
    object.get_mut(key).and_then(Value::as_array_mut).into_iter().flatten()
}

/// Removes from an animation all but the channels that move nodes: some channels of an extension
/// move something else, and lack what the crate demands.
fn simplify_animation(animation: &mut Value) {
    let is_number = |value: Option<&Value>| value.is_some_and(Value::is_number);
    let is_sampler = |s: &Value| is_number(s.get("input")) && is_number(s.get("output"));
    let all_samplers_whole = list(animation, "samplers").iter().all(is_sampler);
    let Some(object) = animation.as_object_mut() else { return };
    // The crate demands both lists.
    for key in ["channels", "samplers"] {
        object.entry(key).or_insert_with(|| Value::Array(Vec::new()));
    }
    // A sampler that lacks its input or output costs all of them, since channels count them.
    if !all_samplers_whole || !object["samplers"].is_array() {
        object.insert("samplers".to_owned(), Value::Array(Vec::new()));
    }
    // An unknown interpolation costs its channels alone; one that is no string would cost the file.
    for sampler in items_mut(animation, "samplers").filter_map(Value::as_object_mut) {
        if sampler.get("interpolation").is_some_and(|kind| !kind.is_string()) {
            sampler.insert("interpolation".to_owned(), "?".into());
        }
    }

    // Channels that move no node, or lack what the crate demands, are removed.
    if let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) {
        channels.retain(|channel| {
            let target = channel.get("target");
            let target = |key: &str| target.and_then(|target| target.get(key));
            is_number(channel.get("sampler"))
                && is_number(target("node"))
                && target("path").is_some_and(Value::is_string)
        });
    }
}

/// Removes `extras`, which may be anything, and writes 1.0 as 1, which may stand for an integer.
fn normalize(value: &mut Value) {
    match value {
        Value::Object(map) => {
            map.remove("extras");
            map.values_mut().for_each(normalize);
        }
        Value::Array(items) => items.iter_mut().for_each(normalize),
        Value::Number(n) if n.is_f64() => {
            if let Some(whole) = as_natural(value) {
                *value = whole.into();
            }
        }
        _ => {}
    }
}

/// Returns a number that is whole and not negative as an integer, even if it is written as 1.0.
pub fn as_natural(value: &Value) -> Option<u64> {
    let is_whole = |x: &f64| *x >= 0.0 && x.fract() == 0.0 && *x < 2f64.powi(53);
    value.as_u64().or_else(|| value.as_f64().filter(is_whole).map(|x| x as u64))
}

fn syntax_error(bytes: &[u8], error: &json::Error) -> Error {
    if bytes.iter().all(|b| b.is_ascii_whitespace()) {
        return Error::input("the file has no JSON in it");
    }
    let text = error.to_string();
    let message = text.split(" at line ").next().unwrap_or(&text);
    let problem = if error.is_data() { "not what glTF has here" } else { "the JSON is broken" };
    let found = Error::input(format!("{problem}: {message} (column {})", error.column()));
    if error.line() == 0 { found } else { found.with_location(Location::Line(error.line())) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_that_of_values_and_not_of_strings() {
        assert_eq!(estimated_memory(br#"{"a":[1,2,3],"[{,":"\\\"[[[{{{,,,"}"#), 640 + 128 + 3 * 32);
    }

    #[test]
    fn scene_without_nodes_is_valid() {
        let Document { root, .. } = parse(br#"{"asset":{"version":"2.0"},"scenes":[{}]}"#).unwrap();
        assert_eq!(root.scenes.len(), 1);
    }

    #[test]
    fn integer_written_as_float_is_valid() {
        let Document { root, .. } =
            parse(br#"{"asset":{"version":"2.0"},"nodes":[{"mesh":1.0}]}"#).unwrap();
        assert_eq!(root.nodes[0].mesh.unwrap().value(), 1);
    }

    #[test]
    fn extras_and_animations_may_be_anything() {
        let file = br#"{"asset":{"version":"2.0","extras":42},
            "animations":[{"channels":[{"sampler":0,"target":{}}],"samplers":[]}]}"#;
        assert_eq!(parse(file).unwrap().root.animations.len(), 1);
    }

    #[test]
    fn interpolation_that_is_no_word_is_an_unknown_one() {
        let file = br#"{"asset":{"version":"2.0"},"animations":[{"channels":[],
            "samplers":[{"input":0,"output":1,"interpolation":0}]}]}"#;
        let sampler = &parse(file).unwrap().root.animations[0].samplers[0];
        assert!(matches!(sampler.interpolation, json::validation::Checked::Invalid));
    }

    #[test]
    fn transforms_are_those_of_the_key_that_counts_where_keys_stand_twice() {
        let file = br#"{"asset":{"version":"2.0"},"nodes":[],
            "nodes":[{"translation":[1,0,0],"translation":[0.1,0,0]}]}"#;
        let Document { root, transforms, .. } = parse(file).unwrap();
        assert_eq!((root.nodes.len(), transforms.nodes.len()), (1, 1));
        assert_eq!(transforms.nodes[0].translation, Some([0.1, 0.0, 0.0]));
    }

    #[test]
    fn index_beyond_32_bits_is_named() {
        let error = parse(br#"{"asset":{"version":"2.0"},"nodes":[{"mesh":4294967296}]}"#);
        assert!(error.unwrap_err().to_string().starts_with("nodes[0].mesh:"));
    }

    #[test]
    fn long_numbers_elsewhere_are_fine() {
        let file = br#"{"asset":{"version":"2.0","extras":{"id":12345678901}},
            "nodes":[{"translation":[12345678901,0,0]}]}"#;
        assert!(parse(file).is_ok());
    }
}
