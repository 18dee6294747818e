//! From the bytes of a `.gltf` or `.glb` file to its JSON and its binary chunk.
//!
//! The `gltf` crate trusts a GLB's length fields (a header that says 0 makes it subtract below
//! zero), so they are checked here and the crate sees the JSON alone.

use crate::error::{Error, Result};

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

    // The header declares the length of the whole file.
    let length = length as usize;
    if length < HEADER + CHUNK_HEADER {
        return Err(Error::input(format!("the GLB header gives the file's length as {length}"))
            .help(format!("the file has {} bytes", bytes.len())));
    }
    // What follows the declared length is no part of the GLB.
    let bytes = bytes.get(..length).ok_or_else(|| cut_short("the file", length, bytes.len()))?;

    // The chunks: of each kind the first counts.
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

/// The error that a file is of another version than is read.
pub fn wrong_version(version: &str) -> Error {
    let message = if version.starts_with("1") {
        "this is glTF 1.0, a format of 2015 that version 2.0 replaced in 2017".to_owned()
    } else {
        format!("this is glTF version `{version}`, which is not known")
    };
    Error::input(message).help("glTF 2.0 is read; `npx gltf-pipeline -i IN -o OUT` updates 1.0")
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
}
