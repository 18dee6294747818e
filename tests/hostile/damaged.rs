//! Files that something happened to: whatever it was, they load or they give an error, soon.
//!
//! The same mutations every time; `ENVERS_SEED` tries others, `ENVERS_MUTATIONS` so many of each
//! file. Where `ENVERS_CORPUS` names a corpus of model files, the small ones of it are damaged, too.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use draco_core::GeometryAttributeType as Kind;
use envers::ErrorKind;
use envers_testing::compressed::{compressed_model, ktx};
use envers_testing::{Folder, Random, corpus, data_uri, files, whole};
use image::ImageFormat;
use serde_json::Value;

/// The time that a damaged file of a few kilobytes may take.
const TIME_LIMIT: Duration = Duration::from_secs(10);
/// Mutations of each file, unless `ENVERS_MUTATIONS` says otherwise.
const MUTATIONS: u64 = 1000;
/// Mutations of each small file of the corpus.
const OF_CORPUS: u64 = 10;

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

/// A folder with one valid file of each kind, beside each other.
fn valid_files() -> Folder {
    let folder = Folder::new();
    let model = whole::model();
    folder.write("model.glb", model.glb());
    folder.write("model.gltf", model.to_json(Some("model.bin")).to_string());
    let inside = model.to_json(Some(&data_uri(model.bin()))).to_string();
    folder.write("inside.gltf", inside);
    folder.write("model.bin", model.bin());
    folder.write("packed.glb", packed_file());
    folder.write("model.obj", OBJ);
    folder.write("model.mtl", MTL);
    folder.write("scene.toml", SCENE);
    folder.write("picture.png", picture(ImageFormat::Png));
    folder
}

/// A sheet of a few waves, packed by Draco.
fn packed_file() -> Vec<u8> {
    const SIDE: u32 = 8;
    let points = (0..SIDE * SIDE).map(|i| [(i % SIDE) as f32, (i / SIDE) as f32]);
    let positions: Vec<f32> = points.clone().flat_map(|[x, y]| [x, y, (x * y).sin()]).collect();
    let uvs: Vec<f32> = points.flatten().map(|x| x / SIDE as f32).collect();
    let corners = (0..SIDE * SIDE).filter(|i| i % SIDE + 1 < SIDE && i / SIDE + 1 < SIDE);
    let halves = corners.flat_map(|i| [[i, i + 1, i + SIDE], [i + 1, i + SIDE + 1, i + SIDE]]);
    let attributes = [
        ("POSITION", Kind::Position, 3, &positions[..]),
        ("TEXCOORD_0", Kind::TexCoord, 2, &uvs[..]),
    ];
    compressed_model(&attributes, &halves.collect::<Vec<_>>()).glb()
}

/// A folder with a model that shows one picture.
fn picture_of(name: &str, bytes: &[u8]) -> Folder {
    let folder = Folder::new();
    folder.write("model.obj", OBJ);
    folder.write("model.mtl", MTL.replace("picture.png", name));
    folder.write(name, bytes);
    folder
}

/// A small picture of many colours.
fn picture(format: ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let pixel = |x, y| image::Rgb([(x * 31) as u8, (y * 17) as u8, (x ^ y) as u8]);
    image::RgbImage::from_fn(8, 8, pixel).write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// A picture of floats.
fn exr() -> Vec<u8> {
    use exr::prelude::*;
    let pixel = |at: Vec2<usize>| (at.x() as f32, at.y() as f32 * 0.5, 1e3f32);
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = Image::from_channels((8, 8), SpecificChannels::rgb(pixel));
    image.write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// A Radiance picture, its rows as they are.
fn hdr() -> Vec<u8> {
    let pixels = (0..64).flat_map(|i| [i * 3, 99, 200 - i, 120 + i]);
    b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 8\n".iter().copied().chain(pixels).collect()
}

/// Returns the file that is loaded to read another one.
fn entry_file(file: &str) -> &str {
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
    if random.below(2) == 0
        && let Some(damaged) = damage_json(bytes, random)
    {
        return damaged;
    }
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

/// One to four values of a glTF file, or of the JSON in a GLB, that are others. Its grammar and the
/// GLB's lengths stay sound, so that what is behind them is tried.
fn damage_json(bytes: &[u8], random: &mut Random) -> Option<Vec<u8>> {
    let glb = bytes.starts_with(b"glTF");
    let length = |at: usize| {
        let word = bytes.get(at..at + 4)?.try_into().ok()?;
        Some(u32::from_le_bytes(word) as usize)
    };
    let (json, rest) = match glb {
        true => bytes.get(20..)?.split_at_checked(length(12)?)?,
        false => (bytes, &[][..]),
    };
    let mut json: Value = serde_json::from_slice(json).ok().filter(Value::is_object)?;
    for _ in 0..1 + random.below(4) {
        let other = match random.below(3) {
            // A number or what is none, where it can stand in JSON.
            0 => serde_json::from_str(NUMBERS[random.below(NUMBERS.len())]).unwrap_or(Value::Null),
            1 => random.below(9).into(),
            _ => any(&mut json, random).clone(),
        };
        match random.below(4) {
            0 => match any(&mut json, random) {
                Value::Array(items) => items.push(other),
                Value::Object(map) => {
                    let keys: Vec<String> = map.keys().cloned().collect();
                    keys.get(random.below(keys.len().max(1))).and_then(|key| map.remove(key));
                }
                value => *value = other,
            },
            _ => *any(&mut json, random) = other,
        }
    }
    let mut json = json.to_string().into_bytes();
    if !glb {
        return Some(json);
    }
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |n: usize| (n as u32).to_le_bytes();
    let header = [&bytes[..8], &word(20 + json.len() + rest.len()), &word(json.len()), b"JSON"];
    Some([&header.concat()[..], &json, rest].concat())
}

/// Some value within another one, which may be that itself.
fn any<'v>(mut value: &'v mut Value, random: &mut Random) -> &'v mut Value {
    loop {
        let count = match value {
            Value::Array(items) => items.len(),
            Value::Object(map) => map.len(),
            _ => 0,
        };
        if count == 0 || random.below(6) == 0 {
            return value;
        }
        let at = random.below(count);
        value = match value {
            Value::Array(items) => &mut items[at],
            Value::Object(map) => map.values_mut().nth(at).expect("ok: it has so many"),
            _ => unreachable!("it has none"),
        };
    }
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
        let _ = sender.send(envers::load(&file));
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
fn damaged(folder: &Folder, file: &str, entry: &str, count: u64) {
    let path = folder.path(file);
    let whole = std::fs::read(&path).unwrap();
    let entry = folder.path(entry);
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
            let count = number("ENVERS_MUTATIONS", MUTATIONS);
            damaged(&valid_files(), $file, entry_file($file), count);
        }
    )*};
}

damaged! {
    damaged_glb: "model.glb",
    damaged_gltf: "model.gltf",
    damaged_gltf_with_its_data_inside: "inside.gltf",
    damaged_buffer: "model.bin",
    damaged_packed_mesh: "packed.glb",
    damaged_obj: "model.obj",
    damaged_mtl: "model.mtl",
    damaged_scene: "scene.toml",
    damaged_texture: "picture.png",
}

macro_rules! damaged_pictures {
    ($($test:ident: $file:literal is $bytes:expr,)*) => {$(
        #[test]
        fn $test() {
            let folder = picture_of($file, &$bytes);
            damaged(&folder, $file, "model.obj", number("ENVERS_MUTATIONS", MUTATIONS));
        }
    )*};
}

damaged_pictures! {
    damaged_jpeg: "picture.jpg" is picture(ImageFormat::Jpeg),
    damaged_webp: "picture.webp" is picture(ImageFormat::WebP),
    damaged_tga: "picture.tga" is picture(ImageFormat::Tga),
    damaged_bmp: "picture.bmp" is picture(ImageFormat::Bmp),
    damaged_hdr: "picture.hdr" is hdr(),
    damaged_exr: "picture.exr" is exr(),
    damaged_ktx: "picture.ktx2" is ktx([8, 8], [200, 100, 50, 255]),
}

/// The small model files of the corpus, each beside what it names.
#[test]
fn damaged_corpus() {
    const SMALL: u64 = 64 << 10;
    let Some(corpus) = corpus() else { return };
    let is_small = |path: &Path| path.metadata().is_ok_and(|m| m.is_file() && m.len() <= SMALL);
    let mut folders: BTreeMap<PathBuf, Vec<String>> = BTreeMap::new();
    for path in files(&corpus, &["gltf", "glb", "obj"]) {
        if is_small(&path) {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            folders.entry(path.parent().unwrap().to_owned()).or_default().push(name);
        }
    }
    let count = number("ENVERS_MUTATIONS", OF_CORPUS);
    for (from, names) in &folders {
        let folder = Folder::new();
        for path in files(from, &["gltf", "glb", "obj", "mtl", "bin", "png", "jpg"]) {
            let within = path.strip_prefix(from).unwrap().to_string_lossy().into_owned();
            if is_small(&path) {
                folder.write(&within, std::fs::read(&path).unwrap());
            }
        }
        names.iter().for_each(|name| damaged(&folder, name, name, count));
    }
    println!("{} folders", folders.len());
}

#[test]
fn the_files_are_valid_before() {
    let folder = valid_files();
    for file in ["model.glb", "model.gltf", "inside.gltf", "packed.glb", "model.obj", "scene.toml"]
    {
        let scene = envers::load(folder.path(file)).unwrap_or_else(|e| panic!("{e}")).scene;
        assert!(scene.triangle_count() > 0, "{file}");
    }
}
