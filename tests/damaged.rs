//! Files that something happened to: whatever it was, they load or they give an error, soon.
//!
//! The same mutations every time; `ENVERS_SEED` tries others, `ENVERS_MUTATIONS` so many of each
//! file.

#[path = "common/mod.rs"]
mod common;
#[path = "import_common/mod.rs"]
mod import_common;

use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use common::Random;
use envers::error::ErrorKind;
use import_common::{Folder, Model, data_uri, png};
use serde_json::json;

/// How long a damaged file of a few kilobytes may take.
const TIME_LIMIT: Duration = Duration::from_secs(10);
/// Mutations of each file, unless `ENVERS_MUTATIONS` says otherwise.
const MUTATIONS: u64 = 500;

const SCENE: &str = r##"
[film]
size = [64, 48]
background = "#203040"
exposure = 0.5
tone = "aces"

[camera]
position = [0, 1, 5]
look_at = [0, 0.5, 0]
fov_y = 40.5

[[material]]
name = "red"
diffuse = "#c03020"
diffuse_map = "picture.png"
shininess = 50
reflect = 0.25
transmit = [0.5, 0.25, 0.5]
ior = 1.33
absorption = 0.5

[[sphere]]
center = [0, 0.5, 0]
radius = 0.5
material = "red"

[[plane]]
point = [0, 0, 0]
normal = [0, 1, 0]
checker = { colors = ["#fff", 0.25], size = 1.5 }
texture_size = 2

[[model]]
file = "model.obj"
translate = [1, 0, 0]
rotate = [0, 40, 0]
scale = [1, -2, 1e-3]

[[light]]
kind = "spot"
position = [3, 5, 4]
direction = [-1, -1, -1]
inner_angle = 10
outer_angle = 20.5
"##;

const OBJ: &str = "\
mtllib model.mtl\no thing\ng part\ns 1\nusemtl red\n\
v -1 0 1.5\nv 1 0 1\nv 0 0 -1\nv 0 1e0 0 0.5 0.5 0.5\nv 2 2 2\n\
vt 0 0\nvt 1 0\nvt 0 1\nvn 0 1 0\nvn 0 0 -1\n\
f 1/1/1 2/2/1 4/3/1\nf 2//2 3//2 4//2\nf -5 -4 -3\nf 1 2 3 4 5\nusemtl blue\nf 1/1 2/2 3/3\nl 1 2\n";

const MTL: &str = "\
newmtl red\nKd 0.8 0.1 0.1\nKs 0.5 0.5 0.5\nNs 50\nillum 7\nd 0.75\nNi 1.5\nTf 1 0.5 1\n\
map_Kd -clamp on -s 1 1 1 picture.png\nnewmtl blue\nKa 0 0 0\nKe 0.1 0 0\nTr 0.5\n";

/// A model that uses most of what is read: indices, normals, texture coordinates, colours, a
/// sparse accessor, a texture in a buffer, a camera, lights and a tree of nodes.
fn model() -> Model {
    let mut model = Model::parabola(5);
    let normals = model.floats("VEC3", &[0.0, 0.6, 0.8].repeat(5));
    let uvs = model.floats("VEC2", &[0., 0., 1., 0., 0., 1., 1., 1., 0.5, 0.5]);
    let colors = model.typed(5121, "VEC4", 1, &[200; 20]);
    model.accessor_mut(colors)["normalized"] = true.into();
    let indices = model.shorts(&[0, 1, 2, 2, 3, 4]);
    let at = model.view(&[1, 0]);
    let values = model.view(&[0; 12]);
    model.accessor_mut(0)["sparse"] = json!({"count": 1,
        "indices": {"bufferView": at, "componentType": 5123}, "values": {"bufferView": values}});
    let picture = model.view(&png(&[[255, 0, 0, 255], [0, 255, 0, 255]]));
    model.json["images"] = json!([{"bufferView": picture, "mimeType": "image/png"},
                                  {"uri": "picture.png"}]);
    model.json["samplers"] = json!([{"wrapS": 33071, "magFilter": 9728}]);
    model.json["textures"] = json!([{"source": 0, "sampler": 0}, {"source": 1}]);
    model.material(json!({
        "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 1, 1], "roughnessFactor": 0.4,
            "baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {
                "offset": [0.5, 0.25], "rotation": 1.5, "scale": [2, 2]}}}},
        "emissiveFactor": [0.1, 0, 0], "emissiveTexture": {"index": 1},
        "alphaMode": "BLEND", "alphaCutoff": 0.5, "extensions": {
            "KHR_materials_transmission": {
                "transmissionFactor": 0.5, "transmissionTexture": {"index": 1}},
            "KHR_materials_ior": {"ior": 1.25},
            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 0.5,
                "attenuationColor": [0.5, 0.25, 1]}}}));
    let primitive = model.primitive();
    primitive["indices"] = indices.into();
    primitive["mode"] = 4.into();
    primitive["attributes"]["NORMAL"] = normals.into();
    primitive["attributes"]["TEXCOORD_0"] = uvs.into();
    primitive["attributes"]["COLOR_0"] = colors.into();
    model.json["cameras"] = json!([{"type": "perspective",
        "perspective": {"yfov": 0.8, "znear": 0.1, "aspectRatio": 1.5}}]);
    model.json["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_texture_transform"]);
    model.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "color": [1, 1, 0.5], "intensity": 30, "range": 20,
         "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}}]}});
    model.json["nodes"] = json!([
        {"mesh": 0, "children": [1, 2], "translation": [1, 2, 3], "rotation": [0, 0, 0, 1]},
        {"mesh": 0, "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 1, 1, 1], "children": [3]},
        {"camera": 0, "translation": [0, 1, 9]},
        {"scale": [1, 1, -1], "extensions": {"KHR_lights_punctual": {"light": 0}}}]);
    model
}

/// A folder with one valid file of each kind, beside each other.
fn valid_files() -> Folder {
    let folder = Folder::new();
    let model = model();
    folder.write("model.glb", model.glb());
    folder.write("model.gltf", model.to_json(Some("model.bin")).to_string());
    let inside = model.to_json(Some(&data_uri(model.bin()))).to_string();
    folder.write("inside.gltf", inside);
    folder.write("model.bin", model.bin());
    folder.write("model.obj", OBJ);
    folder.write("model.mtl", MTL);
    folder.write("scene.toml", SCENE);
    let pixels: Vec<[u8; 4]> = (0..64).map(|i| [i * 4, 255 - i, i ^ 21, 255]).collect();
    folder.write("picture.png", png(&pixels));
    folder
}

/// What is loaded to read a file.
fn entry(file: &str) -> &str {
    match file {
        "model.bin" => "model.gltf",
        "model.mtl" => "model.obj",
        "picture.png" => "scene.toml",
        file => file,
    }
}

/// Bytes to put in the place of a number.
const NUMBERS: &[&str] = &[
    "0",
    "-0",
    "-1",
    "1e30",
    "-1e30",
    "1e39",
    "1e308",
    "1e999",
    "1e-40",
    "1e-320",
    "nan",
    "NaN",
    "inf",
    "-inf",
    "4294967295",
    "4294967296",
    "-2147483648",
    "2147483648",
    "18446744073709551615",
    "18446744073709551616",
    "9007199254740993",
    "65535",
    "0.5",
    "",
    "null",
    "true",
    "\"1\"",
    "[]",
    "{}",
];

/// One to four things that happen to a file.
fn damage(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..1 + random.below(4) * random.below(2) {
        if bytes.is_empty() {
            break;
        }
        let at = random.below(bytes.len());
        match random.below(9) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.bits() as u8,
            2 => bytes.truncate(at),
            3 | 4 => replace_number(&mut bytes, at, random),
            5 => remove_key(&mut bytes, at),
            6 => {
                let end = (at + 1 + random.below(40)).min(bytes.len());
                bytes.drain(at..end);
            }
            7 => {
                let end = (at + 1 + random.below(40)).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, piece);
            }
            _ => {
                // What a binary number of four bytes can be at its worst.
                let worst =
                    [0, 1, u32::MAX, i32::MAX as u32, f32::NAN.to_bits(), f32::MAX.to_bits()];
                let word = worst[random.below(worst.len())].to_le_bytes();
                let at = at & !3;
                let end = (at + 4).min(bytes.len());
                bytes[at..end].copy_from_slice(&word[..end - at]);
            }
        }
    }
    bytes
}

/// Replaces the first number from `at` on.
fn replace_number(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    let of_number = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
    let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit) else { return };
    let start = at + start;
    let length = bytes[start..].iter().take_while(|b| of_number(b)).count();
    let new = NUMBERS[random.below(NUMBERS.len())];
    bytes.splice(start..start + length, new.bytes());
}

/// Removes the key around `at`: in JSON from a quote to the next comma, otherwise the line.
fn remove_key(bytes: &mut Vec<u8>, at: usize) {
    let json = bytes.windows(6).any(|w| w == b"\"asset");
    let (open, close) = if json { (b'"', b',') } else { (b'\n', b'\n') };
    let start = bytes[..at].iter().rposition(|&b| b == open).unwrap_or(0);
    let length = bytes[at..].iter().position(|&b| b == close).map_or(0, |n| n + 1);
    bytes.drain(start..at + length);
}

/// Loads a file; says whether it loads, or what is wrong with how it is refused.
fn loads(path: &Path) -> Result<bool, String> {
    let (sender, receiver) = channel();
    let file = path.to_owned();
    // A thread of its own: one that hangs is left behind.
    std::thread::spawn(move || {
        let _ = sender.send(envers::load::load(&file));
    });
    let error = match receiver.recv_timeout(TIME_LIMIT) {
        Err(RecvTimeoutError::Timeout) => return Err("it takes too long".into()),
        Err(RecvTimeoutError::Disconnected) => return Err("a panic".into()),
        Ok(Ok(_)) => return Ok(true),
        Ok(Err(error)) => error,
    };
    let right = error.kind() == ErrorKind::Input
        && !error.message().is_empty()
        && error.path().is_some_and(Path::exists);
    if right { Ok(false) } else { Err(format!("kind, message or file of the error: {error:?}")) }
}

fn number(variable: &str, otherwise: u64) -> u64 {
    std::env::var(variable).map_or(otherwise, |text| text.parse().expect("a number"))
}

/// Damages one of several files that lie beside each other, again and again.
fn damaged(folder: &Folder, file: &str, count: u64) {
    let path = folder.path(file);
    let whole = std::fs::read(&path).unwrap();
    let entry = folder.path(entry(file));
    let (first, mut refused) = (number("ENVERS_SEED", 0) << 32, 0);
    for seed in first..first + count {
        let bytes = damage(&whole, &mut Random(seed));
        std::fs::write(&path, &bytes).unwrap();
        match loads(&entry) {
            Ok(loaded) => refused += u64::from(!loaded),
            Err(fault) => {
                let kept = std::env::temp_dir().join(format!("envers-damaged-{seed}-{file}"));
                std::fs::write(&kept, &bytes).unwrap();
                panic!("{file}, seed {seed}: {fault}; the file is {}", kept.display());
            }
        }
    }
    std::fs::write(&path, &whole).unwrap();
    println!("{file}: {count} mutations, {refused} refused");
}

macro_rules! damaged {
    ($($test:ident: $file:literal,)*) => {$(
        #[test]
        fn $test() {
            damaged(&valid_files(), $file, number("ENVERS_MUTATIONS", MUTATIONS));
        }
    )*};
}

damaged! {
    damaged_glb: "model.glb",
    damaged_gltf: "model.gltf",
    damaged_gltf_with_its_data_inside: "inside.gltf",
    damaged_buffer: "model.bin",
    damaged_obj: "model.obj",
    damaged_mtl: "model.mtl",
    damaged_scene: "scene.toml",
    damaged_texture: "picture.png",
}

#[test]
fn the_files_are_valid_before() {
    let folder = valid_files();
    for file in ["model.glb", "model.gltf", "inside.gltf", "model.obj", "scene.toml"] {
        let scene = envers::load::load(&folder.path(file)).unwrap_or_else(|e| panic!("{e}"));
        assert!(scene.triangle_count() > 0, "{file}");
    }
}
