//! From JSON to the crate's types, checked for what they let pass and spared what they refuse for
//! no reason.

use gltf::json;
use gltf::json::Value;

use super::container::wrong_version;
use super::indices;
use super::validation;
use crate::error::{Error, Place, Result};

/// About how many bytes the values of a JSON text take once it is parsed: many times its length, if
/// they are lists in lists. See [`crate::load::Limit::Json`].
pub fn memory(bytes: &[u8]) -> u64 {
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

/// JSON that takes more memory than this is not held against the standard: that takes as much again.
const MOST_CHECKED: u64 = 1 << 28;

/// Parses the JSON: as what the crate makes of it, and as it stands in the file; nothing of the
/// latter where it is too large.
pub fn parse(bytes: &[u8]) -> Result<(json::Root, Value)> {
    let root = match json::deserialize::from_slice::<json::Root>(bytes) {
        Ok(root) => root,
        Err(error) => reparse(bytes, &error)?,
    };
    // Anything of the form 2.x may be read by who reads 2.0, says the standard.
    if root.asset.version.split('.').next() != Some("2") {
        return Err(
            wrong_version(&root.asset.version).place(Place::Json("asset.version".to_owned()))
        );
    }
    if memory(bytes) > MOST_CHECKED {
        return Ok((root, Value::Null));
    }
    let value = json::deserialize::from_slice(bytes).map_err(|e| syntax(bytes, &e))?;
    // The paths of all values take time; only a file with a number of ten digits can be concerned.
    let mut digits = 0;
    let is_long = |b: &u8| {
        digits = if b.is_ascii_digit() { digits + 1 } else { 0 };
        digits == 10
    };
    if bytes.iter().any(is_long) {
        indices::check(&value)?;
    }
    Ok((root, value))
}

/// The second try at a file that the crate's types refuse. They demand more than the standard
/// does, also of what is never used here, and cannot say that a file is glTF 1.0.
fn reparse(bytes: &[u8], error: &json::Error) -> Result<json::Root> {
    let mut value: Value =
        json::deserialize::from_slice(bytes).map_err(|_| syntax(bytes, error))?;
    match value.get("asset").and_then(|a| a.get("version")) {
        Some(Value::String(version)) if version.starts_with('2') => {}
        Some(Value::String(version)) => {
            return Err(wrong_version(version).place(Place::Json("asset.version".to_owned())));
        }
        // Some files of glTF 1.0 have a number.
        Some(other) => {
            return Err(
                wrong_version(&other.to_string()).place(Place::Json("asset.version".to_owned()))
            );
        }
        // The first glTF 1.0 files had no `asset`, but objects where 2.0 has arrays.
        None if ["meshes", "techniques"]
            .iter()
            .any(|k| value.get(k).is_some_and(Value::is_object)) =>
        {
            return Err(wrong_version("1.0"));
        }
        None => {
            return Err(Error::input("there is no `asset.version`: this may not be glTF")
                .help("a glTF file has `\"asset\": {\"version\": \"2.0\"}`"));
        }
    }
    for scene in value.get_mut("scenes").and_then(Value::as_array_mut).into_iter().flatten() {
        if let Some(scene) = scene.as_object_mut() {
            scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
        }
    }
    for one in value.get_mut("animations").and_then(Value::as_array_mut).into_iter().flatten() {
        spare_animation(one);
    }
    soften(&mut value);
    let blame = validation::blame(&value);
    json::deserialize::from_value(value).map_err(|_| match blame {
        Some((path, what)) => {
            Error::input(format!("not what glTF has here: {what}")).place(Place::Json(path))
        }
        None => syntax(bytes, error),
    })
}

/// Leaves of an animation the channels that move nodes: some of an extension's move something
/// else, and do without what the crate demands.
fn spare_animation(animation: &mut Value) {
    let Some(animation) = animation.as_object_mut() else { return };
    let is_number = |value: Option<&Value>| value.is_some_and(Value::is_number);
    let is_sampler = |s: &Value| is_number(s.get("input")) && is_number(s.get("output"));
    for list in ["channels", "samplers"] {
        animation.entry(list).or_insert_with(|| Value::Array(Vec::new()));
    }
    let samplers = animation.get("samplers").and_then(Value::as_array);
    let all_whole = samplers.is_some_and(|samplers| samplers.iter().all(is_sampler));
    if !all_whole {
        animation.insert("samplers".to_owned(), Value::Array(Vec::new()));
    }
    if let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) {
        channels.retain(|channel| {
            let target = channel.get("target");
            let of_target = |key: &str| target.and_then(|target| target.get(key));
            is_number(channel.get("sampler"))
                && is_number(of_target("node"))
                && of_target("path").is_some_and(Value::is_string)
        });
    }
}

/// Drops `extras`, which may be anything, and writes 1.0 as 1, which may stand where an integer
/// belongs.
fn soften(value: &mut Value) {
    let mut open = vec![value];
    while let Some(value) = open.pop() {
        match value {
            Value::Object(map) => {
                map.remove("extras");
                open.extend(map.values_mut());
            }
            Value::Array(items) => open.extend(items),
            Value::Number(n) => {
                let whole = n.as_f64().filter(|x| n.is_f64() && *x >= 0.0 && x.fract() == 0.0);
                if let Some(whole) = whole.filter(|&x| x < 2f64.powi(53)) {
                    *n = (whole as u64).into();
                }
            }
            _ => {}
        }
    }
}

fn syntax(bytes: &[u8], error: &json::Error) -> Error {
    let text = error.to_string();
    let message = text.split(" at line ").next().unwrap_or(&text);
    let error_here = Error::input(if error.is_data() {
        format!("not what glTF has here: {message} (column {})", error.column())
    } else {
        format!("the JSON is broken: {message} (column {})", error.column())
    });
    if bytes.iter().all(|b| b.is_ascii_whitespace()) {
        return Error::input("the file has no JSON in it");
    }
    if error.line() == 0 { error_here } else { error_here.place(Place::Line(error.line())) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_that_of_values_and_not_of_strings() {
        assert_eq!(memory(br#"{"a":[1,2,3],"[{,":"\\\"[[[{{{,,,"}"#), 640 + 128 + 3 * 32);
    }

    #[test]
    fn scene_without_nodes_is_valid() {
        let (root, _) = parse(br#"{"asset":{"version":"2.0"},"scenes":[{}]}"#).unwrap();
        assert_eq!(root.scenes.len(), 1);
    }

    #[test]
    fn integer_written_as_float_is_valid() {
        let (root, _) = parse(br#"{"asset":{"version":"2.0"},"nodes":[{"mesh":1.0}]}"#).unwrap();
        assert_eq!(root.nodes[0].mesh.unwrap().value(), 1);
    }

    #[test]
    fn extras_and_animations_may_be_anything() {
        let file = br#"{"asset":{"version":"2.0","extras":42},
            "animations":[{"channels":[{"sampler":0,"target":{}}],"samplers":[]}]}"#;
        assert_eq!(parse(file).unwrap().0.animations.len(), 1);
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
