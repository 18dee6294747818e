//! Meshes packed by Draco and pictures packed by Basis Universal that lie about what is in them.

use draco_core::GeometryAttributeType as Kind;
use serde_json::{Value, json};

use super::{Case, Error, Expect, Warning};
use envers_testing::compressed::{DRACO, compressed_model, ktx};

const OBJ: &str = "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";

/// A sheet of so many squares on a side, in a file that says something else of it.
fn mesh(name: &str, expect: Expect, side: u32, change: impl FnOnce(&mut Value)) -> Case {
    let row = side + 1;
    let points = (0..row * row).map(|i| [(i % row) as f32, (i / row) as f32, 0.0]);
    let positions: Vec<f32> = points.flatten().collect();
    let corners = (0..row * row).filter(|i| i % row < side && i / row < side);
    let halves = corners.flat_map(|i| [[i, i + 1, i + row], [i + 1, i + row + 1, i + row]]);
    let faces: Vec<[u32; 3]> = halves.collect();
    let mut model = compressed_model(&[("POSITION", Kind::Position, 3, &positions)], &faces);
    change(model.primitive());
    Case::new(format!("draco {name}"), "a.glb", model.glb(), expect)
}

/// The bytes of a file with some of those of its stream others.
fn stream(name: &str, change: impl FnOnce(&mut Vec<u8>)) -> Case {
    let model = compressed_model(
        &[("POSITION", Kind::Position, 3, &[0., 0., 0., 1., 0., 0., 0., 1., 0.])],
        &[[0, 1, 2]],
    );
    let mut bytes = model.glb();
    let start = bytes.windows(5).position(|some| some == b"DRACO").unwrap();
    let mut stream = bytes.split_off(start);
    let length = stream.len();
    change(&mut stream);
    stream.resize(length, 0);
    bytes.extend(stream);
    Case::new(format!("draco {name}"), "a.glb", bytes, Expect::Any)
}

fn extension(change: impl FnOnce(&mut Value)) -> impl FnOnce(&mut Value) {
    |primitive| change(&mut primitive["extensions"][DRACO])
}

/// A picture with a number of its header another.
fn picture(name: &str, at: usize, word: u32, expect: Expect) -> Case {
    let mut bytes = ktx([8, 8], [1, 2, 3, 255]);
    bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
    file(name, bytes, expect)
}

fn file(name: &str, bytes: Vec<u8>, expect: Expect) -> Case {
    Case::new(format!("ktx2 {name}"), "a.obj", OBJ, expect)
        .with("a.mtl", "newmtl a\nmap_Kd hostile.ktx2\n")
        .with("hostile.ktx2", bytes)
}

pub fn cases() -> Vec<Case> {
    let refused = Warning("a magenta checker takes its place");
    let mut cases = vec![
        mesh("sheet", Expect::Loads, 3, |_| {}),
        mesh("extension that is no object", Error("bufferView"), 3, extension(|e| *e = json!(7))),
        mesh(
            "without a view",
            Error("bufferView"),
            3,
            extension(|e| e["bufferView"] = json!(null)),
        ),
        mesh(
            "view that is not there",
            Error("bufferView"),
            3,
            extension(|e| e["bufferView"] = json!(9)),
        ),
        mesh("without attributes", Expect::Any, 3, extension(|e| e["attributes"] = json!({}))),
        mesh(
            "attributes that are a list",
            Expect::Any,
            3,
            extension(|e| e["attributes"] = json!([0])),
        ),
        mesh(
            "attribute that is not there",
            Error("no attribute"),
            3,
            extension(|e| e["attributes"]["POSITION"] = json!(u32::MAX)),
        ),
        mesh(
            "attribute of a negative number",
            Error("no attribute"),
            3,
            extension(|e| e["attributes"]["POSITION"] = json!(-1)),
        ),
        mesh("as points", Expect::Any, 3, |primitive| primitive["mode"] = json!(0)),
        mesh("for an accessor of another type", Expect::Any, 3, |primitive| {
            primitive["attributes"]["NORMAL"] = json!(1);
            primitive["extensions"][DRACO]["attributes"]["NORMAL"] = json!(0);
        }),
        mesh("with 100000 attributes of 40000 vertices", Error("elements"), 200, |primitive| {
            let names = primitive["extensions"][DRACO]["attributes"].as_object_mut().unwrap();
            names.extend((0..100_000).map(|i| (format!("_{i}"), json!(0))));
        }),
    ];
    // The kind of mesh, the method, its flags, and the numbers after them, each at its greatest.
    cases.extend(
        (5..40)
            .map(|at| stream(&format!("byte {at} at its greatest"), |bytes| bytes[at] = u8::MAX)),
    );
    cases.extend(
        [4, 8, 11, 14, 20]
            .map(|length| stream(&format!("of {length} bytes"), |bytes| bytes.truncate(length))),
    );
    let whole = ktx([8, 8], [1, 2, 3, 255]);
    cases.extend(
        [12, 79, 80, 103, 147, 150]
            .map(|length| file(&format!("of {length} bytes"), whole[..length].to_vec(), refused)),
    );
    cases.extend([
        file("as it should be", whole, Expect::Loads),
        picture("of 0 pixels", 20, 0, refused),
        picture("2^32 - 1 pixels wide", 20, u32::MAX, refused),
        picture("2^31 pixels high", 24, 1 << 31, refused),
        picture("4096 pixels wide with the data of 8", 20, 4096, refused),
        picture("of depth", 28, 8, refused),
        picture("of 2^32 - 1 layers", 32, u32::MAX, refused),
        picture("of six faces", 36, 6, refused),
        picture("of no faces", 36, 0, refused),
        picture("of 2^32 - 1 levels", 40, u32::MAX, refused),
        picture("of no levels", 40, 0, refused),
        picture("packed by BasisLZ without its tables", 44, 1, refused),
        picture("packed by Zstandard", 44, 2, refused),
        picture("packed by what there is not", 44, 99, refused),
        picture("of a descriptor beyond its end", 48, u32::MAX, refused),
        picture("of a descriptor of 4 GiB", 52, u32::MAX, refused),
        picture("of words beyond its end", 56, u32::MAX, Expect::Loads),
        picture("of words of 4 GiB", 60, u32::MAX, Expect::Loads),
        picture("of global data beyond its end", 68, u32::MAX, refused),
        picture("of global data of 2^63 bytes", 76, u32::MAX, refused),
        picture("of a level beyond its end", 80, u32::MAX, refused),
        picture("of a level at the end of memory", 84, u32::MAX, refused),
        picture("of a level of 4 GiB", 88, u32::MAX, refused),
        picture("of a level that unpacks to 4 GiB", 96, u32::MAX, refused),
        picture("of another model of colour", 116, 0, refused),
    ]);
    cases
}
