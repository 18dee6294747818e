//! Small files that ask for much of whatever is done with them: loaded, rendered or compared.

use serde_json::{Value, json};

use super::encode::{exr_of, flat_png};
use super::gltf::text;
use super::{Case, Command, Error, Expect, Loads, Warning};
use envers_testing::Model;

const COMPRESSIONS: [&str; 8] = ["none", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A"];

pub fn cases() -> Vec<Case> {
    [
        windows(),
        comparisons(),
        skins(),
        shared_pictures(),
        copies(),
        scene_texts(),
        amounts(),
        names(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn glb(name: &str, model: &Model, expect: Expect) -> Case {
    Case::new(name, "hostile.glb", model.glb(), expect)
}

/// A window of this width and height.
const fn window(width: i32, height: i32) -> [i32; 4] {
    [0, 0, width - 1, height - 1]
}

/// OpenEXR files whose data window is another one than the display window, by which they are counted.
fn windows() -> Vec<Case> {
    let mut cases = Vec::new();
    let textured = |name: String, bytes: Vec<u8>| {
        let obj = "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
        let refused = Warning("a magenta checker takes its place");
        Case::new(name, "a.obj", obj, refused)
            .with("a.mtl", "newmtl a\nmap_Kd a.exr\n")
            .with("a.exr", bytes)
    };
    // A chunk of nothing follows, so that the pixels are asked for.
    let chunk = [vec![0; 8], vec![0; 4], vec![4, 0, 0, 0, 1, 2, 3, 4]].concat();
    let one = window(1, 1);
    for (i, compression) in COMPRESSIONS.iter().enumerate() {
        for (name, data, display) in [
            ("a line of 10^9", window(1_000_000_000, 1), one),
            ("32768 × 32768", window(1 << 15, 1 << 15), one),
            ("a display of 32768 × 32768", one, window(1 << 15, 1 << 15)),
        ] {
            let bytes = exr_of(data, display, i as u8, &["R", "G", "B"], None, &chunk);
            cases.push(textured(format!("window {name} ({compression})"), bytes));
        }
    }
    let tiles = exr_of(one, one, 3, &["R", "G", "B"], Some([1 << 30, 1 << 30]), &chunk);
    cases.push(textured("window of tiles of 2^30".into(), tiles));
    let names: Vec<String> = (0..100_000).map(|i| format!("c{i}")).collect();
    let mut names: Vec<&str> = names.iter().map(String::as_str).collect();
    names.extend(["R", "G", "B"]);
    names.sort_unstable();
    let channels = exr_of(window(1 << 15, 1), window(1 << 15, 1), 3, &names, None, &chunk);
    cases.push(textured("window of 100000 channels".into(), channels));
    cases
}

/// Pictures that `envers diff` is given.
fn comparisons() -> Vec<Case> {
    let compared = |name: String, file: &str, bytes: Vec<u8>, expect| Case {
        command: Command::Diff,
        ..Case::new(name, file, bytes, expect)
    };
    let limit = Error("`--limit pixels=");
    let mut cases = Vec::new();
    for [width, height] in
        [[1 << 15, 1 << 15], [1 << 14, 1 << 14], [1 << 13, 1 << 13], [1 << 15, 1 << 11]]
    {
        let bytes = flat_png(width, height);
        cases.push(compared(format!("diff of flat {width} × {height}"), "a.png", bytes, limit));
    }
    cases.push(compared(
        "diff of 32769 × 1".into(),
        "a.png",
        flat_png(32769, 1),
        Error("larger than 32768"),
    ));
    cases.push(compared("diff of a flat 1920 × 1080".into(), "a.png", flat_png(1920, 1080), Loads));
    let chunk = [vec![0; 8], vec![0; 4], vec![4, 0, 0, 0, 1, 2, 3, 4]].concat();
    for (i, compression) in COMPRESSIONS.iter().enumerate() {
        for (name, size, expect) in [
            ("a line of 10^9", window(1_000_000_000, 1), Error("larger than 32768")),
            ("20000 × 20000", window(20_000, 20_000), limit),
        ] {
            let bytes = exr_of(size, window(1, 1), i as u8, &["B", "G", "R"], None, &chunk);
            cases.push(compared(format!("diff of {name} ({compression})"), "a.exr", bytes, expect));
        }
    }
    let names: Vec<String> = (10_000..20_000).map(|i| format!("c{i}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let bytes = exr_of(window(1 << 10, 1 << 10), window(1, 1), 0, &names, None, &chunk);
    cases.push(compared("diff of 10000 channels".into(), "a.exr", bytes, limit));
    cases
}

/// A triangle in a skin of so many joints, which so many nodes show, with sets of influences.
fn skinned(joints: usize, nodes: usize, sets: usize, moves: bool) -> Model {
    let mut model = Model::triangle();
    let first = model.typed(5123, "VEC4", 2, &[0; 24]);
    let whole = model.floats("VEC4", &[1., 0., 0., 0.].repeat(3));
    for n in 0..sets {
        model.primitive()["attributes"][format!("JOINTS_{n}")] = first.into();
        model.primitive()["attributes"][format!("WEIGHTS_{n}")] = whole.into();
    }
    model.json["skins"] = json!([{"joints": vec![0; joints]}]);
    model.json["nodes"] = vec![json!({"mesh": 0, "skin": 0}); nodes].into();
    model.json["scenes"][0]["nodes"] = (0..nodes).collect();
    if moves {
        let times = model.floats("SCALAR", &[0., 1.]);
        let places = model.floats("VEC3", &[0., 0., 0., 1., 0., 0.]);
        model.json["animations"] = json!([{"samplers": [{"input": times, "output": places}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]);
    }
    model
}

fn skins() -> Vec<Case> {
    let limit = Error("`--limit deformed=");
    let skin = |name: &str, model: Model, expect| glb(&format!("skin {name}"), &model, expect);
    let mut many = skinned(1, 1, 1, false);
    many.json["skins"] = vec![json!({"joints": vec![0; 1000]}); 2000].into();
    many.json["nodes"] = (0..2000).map(|i| json!({"mesh": 0, "skin": i})).collect();
    many.json["scenes"][0]["nodes"] = (0..2000).collect();
    let mut targets = Model::triangle();
    targets.primitive()["targets"] = vec![json!({"POSITION": 0}); 20_000].into();
    targets.json["meshes"][0]["weights"] = vec![0.001; 20_000].into();
    targets.json["nodes"] = vec![json!({"mesh": 0}); 5000].into();
    targets.json["scenes"][0]["nodes"] = (0..5000).collect();
    let packed = {
        let mut model = skinned(1, 1, 0, false);
        let joints =
            model.accessor(json!({"componentType": 5121, "type": "VEC4", "count": 30_000}));
        let weights =
            model.accessor(json!({"componentType": 5126, "type": "VEC4", "count": 30_000}));
        let positions =
            model.accessor(json!({"componentType": 5126, "type": "VEC3", "count": 30_000}));
        model.primitive()["attributes"]["POSITION"] = positions.into();
        for n in 0..500 {
            model.primitive()["attributes"][format!("JOINTS_{n}")] = joints.into();
            model.primitive()["attributes"][format!("WEIGHTS_{n}")] = weights.into();
        }
        model
    };
    vec![
        skin("of 5000 joints at 1000 nodes", skinned(5000, 1000, 1, false), limit),
        skin("of 5000 joints at 1000 nodes that moves", skinned(5000, 1000, 1, true), limit),
        skin("of 50000 joints at 500 nodes that moves", skinned(50_000, 500, 1, true), limit),
        skin("of 1000 joints at 3000 nodes that moves", skinned(1000, 3000, 1, true), Expect::Any),
        skin("of 2000 sets of joints at 3000 nodes", skinned(1, 3000, 2000, false), limit),
        skin("of 500 sets of 30000 vertices", packed, Error("`--limit elements=")),
        skin("2000 of 1000 joints", many, limit),
        skin("20000 morph targets at 5000 nodes", targets, limit),
    ]
}

/// One picture in many views of the same bytes.
fn shared_pictures() -> Vec<Case> {
    let pictures =
        |name: &str, picture: &[u8], count: usize, expect, view: fn(usize, usize) -> [usize; 2]| {
            let mut model = Model::triangle();
            let uvs = model.floats("VEC2", &[0.0; 6]);
            model.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
            // What follows the picture in its bytes makes other bytes of each view.
            let bytes = [picture, &vec![0; count]].concat();
            model.view(&bytes);
            let mut json = model.to_json(None);
            let first = json["bufferViews"].as_array().unwrap().len() - 1;
            let start = json["bufferViews"][first]["byteOffset"].as_u64().unwrap() as usize;
            let views = json["bufferViews"].as_array_mut().unwrap();
            views.extend((0..count).map(|i| {
                let [offset, length] = view(i, picture.len());
                json!({"buffer": 0, "byteOffset": start + offset, "byteLength": length})
            }));
            json["images"] = (0..count)
                .map(|i| json!({"bufferView": first + 1 + i, "mimeType": "image/png"}))
                .collect();
            json["textures"] = (0..count).map(|i| json!({"source": i})).collect();
            let material =
                |i: usize| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}});
            json["materials"] = (0..count).map(material).collect();
            let primitive = json["meshes"][0]["primitives"][0].clone();
            json["meshes"][0]["primitives"] = (0..count)
                .map(|i| {
                    let mut primitive = primitive.clone();
                    primitive["material"] = i.into();
                    primitive
                })
                .collect();
            json["buffers"][0]["uri"] = "a.bin".into();
            Case::new(format!("pictures {name}"), "hostile.gltf", json.to_string(), expect)
                .with("a.bin", model.bin())
        };
    let dense: Vec<[u8; 4]> =
        (0..1u32 << 14).map(|i| i.wrapping_mul(2_654_435_761).to_le_bytes()).collect();
    let dense = envers_testing::png(&dense);
    let limit = Warning("raise the limit `pixels`");
    vec![
        pictures(
            "in 200 views of the same bytes",
            &flat_png(2048, 2048),
            200,
            Expect::Any,
            |_, n| [0, n],
        ),
        pictures("in 200 views, each a byte longer", &flat_png(2048, 2048), 200, limit, |i, n| {
            [0, n + i]
        }),
        pictures("in 500 views, each a byte longer", &flat_png(8192, 256), 500, limit, |i, n| {
            [0, n + i]
        }),
        pictures("of noise in 200 views, each a byte longer", &dense, 200, Expect::Any, |i, n| {
            [0, n + i]
        }),
    ]
}

/// Things that stand at the same place many thousand times, which are rendered.
fn copies() -> Vec<Case> {
    let rendered = |case: Case| Case { command: Command::Render, ..case };
    let said = Warning("others of the same shape stand at the same place");
    let instances = |material: Option<Value>| {
        let mut model = Model::triangle();
        let moves =
            model.accessor(json!({"componentType": 5126, "type": "VEC3", "count": 100_000}));
        model.json["nodes"][0]["extensions"] =
            json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": moves}}});
        material.into_iter().for_each(|material| model.material(material));
        model
    };
    let glass =
        json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}});
    let mut indexed = Model::triangle();
    let indices = indexed.shorts(&[0, 1, 2].repeat(100_000));
    indexed.primitive()["indices"] = indices.into();
    let mut unindexed = Model::triangle();
    let positions = unindexed.floats("VEC3", &[0., 0., 0., 1., 0., 0., 0., 1., 0.].repeat(50_000));
    unindexed.primitive()["attributes"]["POSITION"] = positions.into();
    let mut primitives = Model::triangle();
    let primitive = primitives.primitive().clone();
    primitives.json["meshes"][0]["primitives"] = vec![primitive; 20_000].into();
    let mut nodes = Model::triangle();
    nodes.json["nodes"] = vec![json!({"mesh": 0}); 50_000].into();
    nodes.json["scenes"][0]["nodes"] = (0..50_000).collect();
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let objects: String = (0..20_000).map(|i| format!("o p{i}\nf 1 2 3\n")).collect();
    let camera = "[camera]\nposition = [0, 1, 9]\nlook_at = [0, 0, 0]\nfov_y = 40\n";
    let spheres = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n".repeat(20_000);
    let planes = "[[plane]]\npoint = [0, -1, 0]\nnormal = [0, 1, 0]\n".repeat(20_000);
    vec![
        rendered(glb("copies by 100000 instances", &instances(None), said)),
        rendered(glb("copies by 100000 blended instances", &instances(Some(glass)), said)),
        rendered(glb("copies by 100000 times three indices", &indexed, said)),
        rendered(glb("copies by 50000 triangles", &unindexed, said)),
        rendered(glb("copies by 20000 primitives", &primitives, said)),
        rendered(glb("copies by 50000 nodes", &nodes, said)),
        rendered(Case::new(
            "copies by 100000 faces",
            "a.obj",
            format!("{corners}{}", "f 1 2 3\n".repeat(100_000)),
            said,
        )),
        rendered(Case::new(
            "copies by 20000 objects",
            "a.obj",
            format!("{corners}{objects}"),
            said,
        )),
        rendered(Case::new(
            "copies of 20000 spheres",
            "a.toml",
            format!("{camera}{spheres}"),
            said,
        )),
        rendered(Case::new("copies of 20000 planes", "a.toml", format!("{camera}{planes}"), said)),
    ]
}

/// Scene files whose text takes its parser much memory.
fn scene_texts() -> Vec<Case> {
    let text = |name: &str, bytes: Vec<u8>, expect| {
        Case::new(format!("text {name}"), "hostile.toml", bytes, expect)
    };
    let limit = Error("`--limit json=");
    let control = Error("cannot stand here");
    let mega = |piece: &str, millions: usize| piece.repeat(millions << 20).into_bytes();
    let mut cases = vec![
        text("of 64 MB of zeros", vec![0; 64 << 20], control),
        text("of 8 MB of brackets", mega("[", 8), limit),
        text("of 8 MB of braces", mega("{", 8), limit),
        text("of 8 MB of line ends", mega("\n", 8), limit),
        text("of 8 MB of comments", mega("#\n", 4), limit),
        text("of 8 MB of quotes", mega("\"\"", 4), limit),
        text("of a key of 4 million parts", mega("a.", 4), limit),
        text("of a list of 4 million numbers", [b"x=[".to_vec(), mega("1,", 4)].concat(), limit),
        text("of 16 MB of words", mega("a ", 10), limit),
        text("of 32 MB of no sign", mega("@", 32), Error("hostile.toml:1")),
        text("of 32 MB of letters", mega("é", 16), Error("hostile.toml:1")),
        text(
            "of a line of 32 MB that is wrong",
            [b"x = [".to_vec(), mega("a", 32)].concat(),
            Error("hostile.toml:1"),
        ),
        text(
            "of a million spheres",
            mega("[[sphere]]\ncenter = [0.5, 0, 1]\nradius = 1\n", 1),
            limit,
        ),
    ];
    for code in ['\u{1}', '\u{8}', '\u{b}', '\u{1b}', '\u{7f}'] {
        cases.push(text(
            &format!("with U+{:04X}", code as u32),
            format!("a = \"{code}\"").into_bytes(),
            control,
        ));
    }
    cases
}

/// Files of many objects and materials, and of long lines.
fn amounts() -> Vec<Case> {
    let rendered = |case: Case| Case { command: Command::Render, ..case };
    let place = |i: usize| format!("v {0} {1} 0\nv {0}.9 {1} 0\nv {0} {1}.9 0\n", i % 200, i / 200);
    let face = |i: usize| format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    let object = |i: usize| format!("{}usemtl m{i}\n{}", place(i), face(i));
    let materials: String = (0..30_000).map(|i| format!("newmtl m{i}\nKd 0.5 0.5 0.5\n")).collect();
    let obj = "mtllib a.mtl\n".to_owned() + &(0..30_000).map(object).collect::<String>();
    let objects: String = (0..300_000).map(|i| format!("o p{i}\nf 1 2 3\n")).collect();
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let bumps: String = (0..20_000).map(|i| format!("newmtl m{i}\nnorm {i}.png\n")).collect();
    let long = "x".repeat(8 << 20);
    vec![
        rendered(
            Case::new("amount of 30000 materials", "a.obj", &obj, Loads).with("a.mtl", materials),
        ),
        Case::new(
            "amount of 20000 normal maps that are missing",
            "a.obj",
            &obj,
            Warning("left out"),
        )
        .with("a.mtl", bumps),
        Case::new("amount of 300000 objects", "a.obj", format!("{corners}{objects}"), Expect::Any),
        Case::new(
            "amount of letters in a number",
            "a.obj",
            format!("v {long} 0 0\n"),
            Error("a.obj:1"),
        ),
        Case::new(
            "amount of letters in a keyword",
            "a.obj",
            format!("{corners}f 1 2 3\n{long} 1\n"),
            Warning("first word"),
        ),
        Case::new(
            "amount of letters in a material",
            "a.obj",
            format!("{corners}usemtl {long}\nf 1 2 3\n"),
            Warning("in no MTL file"),
        ),
        Case::new(
            "amount of letters in an MTL line",
            "a.obj",
            format!("mtllib a.mtl\n{corners}usemtl a\nf 1 2 3\n"),
            Warning("wants"),
        )
        .with("a.mtl", format!("newmtl a\nKd {long}\n")),
    ]
}

/// Names that look like messages, hide text or cannot be seen.
fn names() -> Vec<Case> {
    let mut cases = Vec::new();
    for code in ["\n", "\r", "\u{85}", "\u{2028}", "\u{200b}", "\u{feff}", "\u{202e}", "\u{ad}"] {
        let name = format!("a{code}error: forged{code}");
        let shown = code.escape_unicode().to_string();
        let case = |kind: &str, model: Model| {
            Case::new(format!("name {shown} of {kind}"), "hostile.gltf", text(&model), Expect::Any)
        };
        let mut material = Model::triangle();
        material.material(json!({"name": name, "extensions": {"KHR_materials_variants": {}},
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
        material.json["textures"] = json!([{"source": 0}]);
        material.json["images"] = json!([{"uri": format!("{name}.png"), "name": name}]);
        cases.push(case("a picture", material));
        let mut lamp = Model::triangle();
        lamp.json["cameras"] =
            json!([{"name": name, "type": "perspective", "perspective": {"yfov": 1, "znear": 1}}]);
        lamp.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"name": name, "type": "point"}]},
            "KHR_materials_variants": {"variants": [{"name": name}]}});
        lamp.json["nodes"][0]["camera"] = 0.into();
        lamp.json["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
        lamp.json["extensionsUsed"] =
            json!(["KHR_lights_punctual", "KHR_materials_variants", name]);
        cases.push(case("a lamp", lamp));
        let mut required = Model::triangle();
        required.json["extensionsRequired"] = json!([name]);
        cases.push(case("an extension", required));
        let key = name.replace('\n', "\\n").replace('\r', "\\r");
        let toml = format!("[camera]\nposition = [0, 0, 9]\nlook_at = [0, 0, 0]\n\"{key}\" = 1\n");
        cases.push(Case::new(format!("name {shown} of a key"), "hostile.toml", toml, Expect::Any));
    }
    cases
}
