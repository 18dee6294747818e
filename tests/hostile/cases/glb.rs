//! GLB files whose lengths lie.

use super::{Case, Error, Loads, Warning};
use envers_testing::{Model, whole};

fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// Returns the same file with a word of four bytes replaced.
fn patched(at: usize, word: u32) -> Vec<u8> {
    let mut glb = Model::triangle().glb();
    glb[at..at + 4].copy_from_slice(&word.to_le_bytes());
    glb
}

pub fn cases() -> Vec<Case> {
    let case = |name: &str, bytes: Vec<u8>, expect| {
        Case::new(format!("glb {name}"), "hostile.glb", bytes, expect)
    };
    let whole_glb = Model::triangle().glb();
    let json_length = u32::from_le_bytes(whole_glb[12..16].try_into().unwrap()) as usize;
    let bin = 20 + json_length;
    let mut cases = vec![
        case("of no bytes", Vec::new(), Error("empty")),
        case("of its first four bytes", b"glTF".to_vec(), Error("cut short")),
        case("of version 1", patched(4, 1), Error("glTF 1")),
        case("of version 0", patched(4, 0), Error("version")),
        case("of version 2^32 - 1", patched(4, u32::MAX), Error("version")),
        case("with a JSON chunk of 0 bytes", patched(12, 0), Error("")),
        case("with a JSON chunk of 2^32 - 1 bytes", patched(12, u32::MAX), Error("cut short")),
        case(
            "with a JSON chunk one byte too short",
            patched(12, json_length as u32 - 1),
            Error(""),
        ),
        case("without a JSON chunk", patched(16, 0x4E49_4243), Error("no JSON")),
        case("whose JSON chunk is called BIN", patched(16, 0x004E_4942), Error("no JSON")),
        case("with a binary chunk of 0 bytes", patched(bin, 0), Error("")),
        case("with a binary chunk of 2^31 bytes", patched(bin, 1 << 31), Error("cut short")),
        case("with a binary chunk of another kind", patched(bin + 4, 7), Error("buffer")),
        case("followed by others", [whole_glb.clone(), whole_glb.clone()].concat(), Loads),
        case("of two headers", [&whole_glb[..12], &whole_glb].concat(), Error("")),
        case("that is text", b"glTF{\"asset\": {\"version\": \"2.0\"}}".to_vec(), Error("")),
        case("of zeros", vec![0; 1 << 16], Error("")),
        case("with a byte order mark", [b"\xEF\xBB\xBF", &whole_glb[..]].concat(), Error("")),
    ];
    for length in [0, 1, 11, 12, 19, 20, 21, 1 << 31, u32::MAX - 3, u32::MAX] {
        cases.push(case(
            &format!("that says it has {length} bytes"),
            patched(8, length),
            Error(""),
        ));
    }
    for length in [5, 11, 13, 19, 21, bin - 1, bin + 3, bin + 8, whole_glb.len() - 1] {
        let name = format!("that ends after {length} bytes");
        cases.push(case(&name, whole_glb[..length].to_vec(), Error("")));
    }
    // A hundred thousand chunks of nothing.
    let mut chunks = whole_glb.clone();
    chunks.extend(words(&[0, 0x5555_5555]).repeat(100_000));
    let length = (chunks.len() as u32).to_le_bytes();
    chunks[8..12].copy_from_slice(&length);
    cases.push(case("with 100000 empty chunks", chunks, Loads));
    let mut twice = whole_glb.clone();
    twice.extend(&whole_glb[12..]);
    let length = (twice.len() as u32).to_le_bytes();
    twice[8..12].copy_from_slice(&length);
    cases.push(case("with two JSON and two binary chunks", twice, Loads));
    let glb = whole::model().glb();
    cases.push(case("without the picture beside it", glb, Warning("picture.png")));
    cases
}
