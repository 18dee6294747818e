//! From the bytes of a `.gltf` or `.glb` file to its JSON and its binary chunk.
//!
//! The `gltf` crate trusts a GLB's length fields (a header that says 0 makes it subtract below
//! zero), so they are checked here and the crate sees the JSON alone.

use gltf::json;
use gltf::json::Value;

use crate::error::{Error, Place, Result};

const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
const JSON_CHUNK: u32 = u32::from_le_bytes(*b"JSON");
const BIN_CHUNK: u32 = u32::from_le_bytes(*b"BIN\0");

/// Splits a file into its JSON and, in a GLB that has one, its binary chunk.
pub fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>)> {
    if bytes.starts_with(b"glTF") {
        return split_glb(bytes);
    }
    if bytes.is_empty() {
        return Err(Error::input("the file is empty"));
    }
    if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
        return Err(Error::input("the file is in UTF-16").help("glTF is JSON in UTF-8"));
    }
    Ok((bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes), None))
}

fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>)> {
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err(cut_short("the header", HEADER, bytes.len()));
    };
    if version != 2 {
        return Err(wrong_version(&version.to_string()));
    }
    let length = length as usize;
    if length < HEADER + CHUNK_HEADER {
        return Err(Error::input(format!("the GLB header gives the file's length as {length}"))
            .help(format!("the file has {} bytes", bytes.len())));
    }
    // What follows the declared length is no part of the GLB.
    let bytes = bytes.get(..length).ok_or_else(|| cut_short("the file", length, bytes.len()))?;
    let (mut json, mut bin) = (None, None);
    let mut at = HEADER;
    // Up to three bytes may be left: padding that some writers don't count.
    while let (Some(size), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) {
        at += CHUNK_HEADER;
        let rest = bytes.get(at..).unwrap_or_default();
        let size = size as usize;
        let chunk = rest.get(..size).ok_or_else(|| cut_short("a chunk", size, rest.len()))?;
        match kind {
            JSON_CHUNK if json.is_none() => json = Some(chunk),
            BIN_CHUNK if bin.is_none() => bin = Some(chunk),
            // The standard says that unknown chunks are to be skipped.
            _ => {}
        }
        at += size;
    }
    let json = json.ok_or_else(|| Error::input("the GLB has no JSON chunk"))?;
    Ok((json, bin))
}

fn cut_short(what: &str, expected: usize, found: usize) -> Error {
    Error::input(format!("the GLB is cut short: {what} should have {expected} bytes, has {found}"))
        .help("export or download it again")
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(four.try_into().ok()?))
}

fn wrong_version(version: &str) -> Error {
    let message = if version.starts_with("1") {
        "this is glTF 1.0, a format of 2015 that version 2.0 replaced in 2017".to_owned()
    } else {
        format!("this is glTF version `{version}`, which is not known")
    };
    Error::input(message).help("glTF 2.0 is read; `npx gltf-pipeline -i IN -o OUT` updates 1.0")
}

/// Parses the JSON.
pub fn parse(bytes: &[u8]) -> Result<json::Root> {
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
    check_indices(bytes)?;
    Ok(root)
}

/// The second try at a file that the crate's types refuse. They demand more than the standard
/// does, also of what is never used here, and cannot say that a file is glTF 1.0.
fn reparse(bytes: &[u8], error: &json::Error) -> Result<json::Root> {
    let refused = || syntax(bytes, error);
    let mut value: Value = json::deserialize::from_slice(bytes).map_err(|_| refused())?;
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
    // That there are animations is all that is asked of them.
    for one in value.get_mut("animations").and_then(Value::as_array_mut).into_iter().flatten() {
        for list in ["channels", "samplers"] {
            if let Some(Value::Array(list)) = one.get_mut(list) {
                list.clear();
            }
        }
    }
    soften(&mut value);
    json::deserialize::from_value(value).map_err(|_| refused())
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
fn check_indices(bytes: &[u8]) -> Result<()> {
    // Parsing twice costs time; only a file with a number of ten digits can be concerned.
    let mut digits = 0;
    let long = bytes.iter().any(|b| {
        digits = if b.is_ascii_digit() { digits + 1 } else { 0 };
        digits == 10
    });
    if !long {
        return Ok(());
    }
    let Ok(value) = json::deserialize::from_slice::<Value>(bytes) else { return Ok(()) };
    let mut open = vec![(String::new(), &value)];
    while let Some((path, value)) = open.pop() {
        match value {
            Value::Array(items) => {
                open.extend(items.iter().enumerate().map(|(i, v)| (format!("{path}[{i}]"), v)));
            }
            Value::Object(map) => open.extend(map.iter().map(|(key, v)| {
                (if path.is_empty() { key.clone() } else { format!("{path}.{key}") }, v)
            })),
            Value::Number(n) if n.as_u64().is_some_and(|n| n > u64::from(u32::MAX)) => {
                // Sizes in bytes and counts are 64 bits wide, and checked where they are used.
                let list = path.rsplit_once('[').filter(|_| path.ends_with(']'));
                let list = list.map_or(path.as_str(), |(list, _)| list);
                let last = list.rsplit('.').next().unwrap_or_default();
                let attribute = list.contains(".attributes.") || list.contains(".targets[");
                if INDEX_KEYS.contains(&last) || attribute {
                    return Err(Error::input(format!("{n} is too large a number here"))
                        .place(Place::Json(path))
                        .help("indices and constants are below 4294967296"));
                }
            }
            _ => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(version: u32, length: u32, rest: &[u8]) -> Vec<u8> {
        [b"glTF", &version.to_le_bytes()[..], &length.to_le_bytes(), rest].concat()
    }

    #[test]
    fn glb_of_twelve_bytes_is_an_error() {
        for length in [0, 11, 12, 20, u32::MAX] {
            assert!(split(&glb(2, length, b"")).is_err(), "{length}");
        }
    }

    #[test]
    fn unknown_chunks_are_skipped() {
        let rest = [b"\x02\0\0\0JSON{}", b"\x01\0\0\0ABCDx".as_slice(), b"\x02\0\0\0BIN\0yz"];
        let rest = rest.concat();
        let file = glb(2, 12 + rest.len() as u32, &rest);
        assert_eq!(split(&file).unwrap(), (&b"{}"[..], Some(&b"yz"[..])));
    }

    #[test]
    fn byte_order_mark_is_dropped() {
        assert_eq!(split(b"\xEF\xBB\xBF{}").unwrap(), (&b"{}"[..], None));
    }

    #[test]
    fn scene_without_nodes_is_valid() {
        let root = parse(br#"{"asset":{"version":"2.0"},"scenes":[{}]}"#).unwrap();
        assert_eq!(root.scenes.len(), 1);
    }

    #[test]
    fn integer_written_as_float_is_valid() {
        let root = parse(br#"{"asset":{"version":"2.0"},"nodes":[{"mesh":1.0}]}"#).unwrap();
        assert_eq!(root.nodes[0].mesh.unwrap().value(), 1);
    }

    #[test]
    fn extras_and_animations_may_be_anything() {
        let file = br#"{"asset":{"version":"2.0","extras":42},
            "animations":[{"channels":[{"sampler":0,"target":{}}],"samplers":[]}]}"#;
        assert_eq!(parse(file).unwrap().animations.len(), 1);
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
