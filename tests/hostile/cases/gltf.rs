//! glTF files that are small and ask for much, or go round in circles.

use serde_json::{Value, json};

use super::{Case, Error, Expect, Loads, Warning};
use envers_testing::{Model, data_uri};

pub fn text(model: &Model) -> String {
    model.to_json(Some(&data_uri(model.bin()))).to_string()
}

pub fn case(name: &str, text: impl AsRef<[u8]>, expect: Expect) -> Case {
    Case::new(format!("gltf {name}"), "hostile.gltf", text, expect)
}

/// The triangle with other nodes.
fn nodes(name: &str, nodes: Vec<Value>, expect: Expect) -> Case {
    let mut model = Model::triangle();
    model.json["nodes"] = nodes.into();
    case(name, text(&model), expect)
}

/// The triangle after a change.
pub fn changed(name: &str, expect: Expect, change: impl FnOnce(&mut Model)) -> Case {
    let mut model = Model::triangle();
    change(&mut model);
    case(name, text(&model), expect)
}

pub fn cases() -> Vec<Case> {
    let chain = |n: usize, last: Value| {
        let link = |i: usize| json!({"children": [i + 1]});
        (0..n - 1).map(link).chain([last]).collect::<Vec<_>>()
    };
    let mut cases = vec![
        case("of no bytes", "", Error("empty")),
        case("of spaces", " ".repeat(4096), Error("no JSON")),
        case("of a zero byte", "\0", Error("JSON")),
        case("in UTF-16", b"\xFF\xFE{\0}\0", Error("UTF-16")),
        case("that is a list", "[]", Error("")),
        case("that is a number", "1e999", Error("")),
        case("of a million brackets", "[".repeat(1 << 20), Error("")),
        case("of a million braces", "{\"a\":".repeat(1 << 20), Error("")),
        case("that is not closed", "{\"asset\": {\"version\": \"2.0\"}", Error("JSON")),
        case("with half a surrogate", r#"{"asset": {"version": "\ud800"}}"#, Error("JSON")),
        case(
            "that is not UTF-8",
            b"{\"asset\": {\"version\": \"2.0\", \"a\": \"\xFF\"}}",
            Expect::Any,
        ),
        case(
            "with every key twice",
            r#"{"asset":{"version":"2.0"},"asset":{"version":"2.0"}}"#,
            Expect::Any,
        ),
        case(
            "with a version of a megabyte",
            format!(r#"{{"asset":{{"version":"{}"}}}}"#, "9".repeat(1 << 20)),
            Error(""),
        ),
        nodes("loop of one node", vec![json!({"children": [0]})], Error("its own ancestor")),
        nodes(
            "loop of two nodes",
            vec![json!({"children": [1]}), json!({"children": [0]})],
            Error("its own ancestor"),
        ),
        nodes(
            "loop of 100000 nodes",
            chain(100_000, json!({"children": [0]})),
            Error("its own ancestor"),
        ),
        nodes(
            "loop beside the root",
            vec![json!({"mesh": 0}), json!({"children": [2]}), json!({"children": [1]})],
            Error("its own ancestor"),
        ),
        nodes("chain of 4096 nodes", chain(4096, json!({"mesh": 0})), Loads),
        nodes(
            "chain of 4097 nodes",
            chain(4097, json!({"mesh": 0})),
            Error("`--limit depth=4097`"),
        ),
        nodes(
            "chain of a million nodes",
            chain(1_000_000, json!({"mesh": 0})),
            Error("`--limit json="),
        ),
        nodes(
            "of 2^30 paths",
            (0..30)
                .map(|i| json!({"children": [i + 1, i + 1]}))
                .chain([json!({"mesh": 0})])
                .collect(),
            Warning("stand twice"),
        ),
        nodes(
            "that 50000 nodes have for a child",
            {
                let mut all: Vec<_> = (2..50_001).map(|_| json!({"children": [1]})).collect();
                all.insert(0, json!({"children": (2..50_001).collect::<Vec<_>>()}));
                all.insert(1, json!({"mesh": 0}));
                all
            },
            Warning("stand twice"),
        ),
        nodes("of more than 2^20 nodes", vec![json!({}); (1 << 20) + 1], Error("`--limit json=")),
        nodes(
            "chain of 300000 nodes",
            chain(300_000, json!({"mesh": 0})),
            Error("`--limit depth="),
        ),
        nodes(
            "transforms that overflow together",
            {
                let mut all = chain(20, json!({"mesh": 0}));
                all.iter_mut().for_each(|node| node["scale"] = json!([1e30, 1e30, 1e30]));
                all
            },
            Error("overflow"),
        ),
    ];
    cases.extend(amounts());
    cases
}

fn amounts() -> Vec<Case> {
    let deep = |n: usize| format!("{}{}", "[".repeat(n), "]".repeat(n));
    vec![
        changed("extras nested 100 deep", Loads, |m| m.json["extras"] = serde_json::from_str(&deep(100)).unwrap()),
        case("extras nested 100000 deep", format!(r#"{{"asset":{{"version":"2.0"}},"extras":{}}}"#, deep(100_000)), Error("")),
        case("extension nested 100000 deep", format!(r#"{{"asset":{{"version":"2.0"}},"extensions":{{"A":{}}}}}"#, deep(100_000)), Error("")),
        changed("key of a megabyte over 100000 numbers", Expect::Any, |m| {
            let numbers: Vec<u64> = (0..100_000).map(|_| 1 << 40).collect();
            m.json["extensions"] = json!({"x".repeat(1 << 20): numbers});
        }),
        changed("accessor without a view of 4e9 elements", Error("elements"), |m| {
            *m.accessor_mut(0) = json!({"componentType": 5126, "type": "VEC3", "count": 4_000_000_000u64});
        }),
        changed("accessor without a view at the limit", Expect::Any, |m| {
            *m.accessor_mut(0) = json!({"componentType": 5126, "type": "VEC3", "count": 1 << 25});
        }),
        changed("sparse accessor without a view of 4e9 elements", Error("elements"), |m| {
            let (at, values) = (m.view(&[0, 0]), m.view(&[0; 12]));
            *m.accessor_mut(0) = json!({"componentType": 5126, "type": "VEC3", "count": 4_000_000_000u64,
                "sparse": {"count": 1, "indices": {"bufferView": at, "componentType": 5123}, "values": {"bufferView": values}}});
        }),
        changed("100000 primitives of one accessor", Expect::Any, |m| {
            let primitive = m.primitive().clone();
            m.json["meshes"][0]["primitives"] = vec![primitive; 100_000].into();
        }),
        changed("64 meshes of a million vertices each on the same megabyte", Expect::Any, |m| {
            let view = m.view(&vec![0x3f; 1 << 20]);
            m.last_view()["byteStride"] = 1.into();
            let count = (1 << 20) - 11;
            let all = m.accessor(json!({"bufferView": view, "componentType": 5126, "type": "VEC3", "count": count}));
            let primitive = json!({"attributes": {"POSITION": all, "NORMAL": all}});
            m.json["meshes"][0]["primitives"] = vec![primitive; 64].into();
        }),
        changed("indices that all name the last of many vertices", Expect::Any, |m| {
            let positions = m.accessor(json!({"componentType": 5126, "type": "VEC3", "count": 1 << 23}));
            let indices = m.accessor(json!({"componentType": 5125, "type": "SCALAR", "count": 1 << 23}));
            *m.primitive() = json!({"attributes": {"POSITION": positions}, "indices": indices});
        }),
        changed("strip of many vertices", Expect::Any, |m| {
            let positions = m.accessor(json!({"componentType": 5126, "type": "VEC3", "count": 1 << 23}));
            *m.primitive() = json!({"attributes": {"POSITION": positions}, "mode": 5});
        }),
        changed("vertices that are no numbers", Warning("not a finite number"), |m| {
            let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY].repeat(3);
            let positions = m.floats("VEC3", &bad);
            m.primitive()["attributes"]["POSITION"] = positions.into();
        }),
        changed("vertices at the edge of what floats hold", Error(""), |m| {
            let positions = m.floats("VEC3", &[f32::MAX, f32::MIN, 0., f32::MIN_POSITIVE, 1e-45, 0., 0., f32::MAX, 1.]);
            m.primitive()["attributes"]["POSITION"] = positions.into();
        }),
        changed("triangle whose corners are one point", Expect::Any, |m| {
            let positions = m.floats("VEC3", &[0.5; 9]);
            m.primitive()["attributes"]["POSITION"] = positions.into();
        }),
        changed("100000 textures without an image", Warning("image"), |m| {
            let uvs = m.floats("VEC2", &[0.0; 6]);
            let texture = |i: usize| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}});
            m.json["materials"] = (0..100_000).map(texture).collect();
            m.json["textures"] = vec![json!({}); 100_000].into();
            let mut primitive = m.primitive().clone();
            primitive["attributes"]["TEXCOORD_0"] = uvs.into();
            let with = |i: usize| { let mut p = primitive.clone(); p["material"] = i.into(); p };
            m.json["meshes"][0]["primitives"] = (0..100_000).map(with).collect();
        }),
        changed("100000 extensions with names of their own", Warning("extension"), |m| {
            m.json["extensionsUsed"] = (0..100_000).map(|i| format!("EXT_{i}")).collect();
        }),
        changed("50000 materials with an extension each of 50000 that are used", Expect::Any, |m| {
            let name = |i: usize| format!("EXT_{i}");
            let material = |i: usize| json!({"extensions": {name(i): {}}});
            m.json["extensionsUsed"] = (0..50_000).map(name).collect();
            m.json["materials"] = (0..50_000).map(material).collect();
        }),
        changed("scene that names 100000 times the same node", Warning("stand twice"), |m| {
            m.json["scenes"][0]["nodes"] = vec![0; 100_000].into();
        }),
        changed("300000 required extensions that are the same", Expect::Any, |m| {
            m.json["extensionsRequired"] = vec!["KHR_texture_transform"; 300_000].into();
        }),
        changed("name of a megabyte", Loads, |m| m.json["meshes"][0]["name"] = "x".repeat(1 << 20).into()),
        changed("name that clears the screen", Expect::Any, |m| {
            m.json["materials"] = json!([{"name": "\u{1b}[2J\u{1b}]0;owned\u{7}", "alphaMode": "BLEND",
                "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0]}}]);
            m.primitive()["material"] = 0.into();
        }),
        changed("20000 lights and cameras", Expect::Any, |m| {
            m.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
            m.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
            m.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}]);
            let node = json!({"camera": 0, "mesh": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}});
            m.json["nodes"] = vec![node; 20_000].into();
            m.json["scenes"][0]["nodes"] = (0..20_000).collect();
        }),
        changed("animation of keys without a view", Expect::Any, |m| {
            let times = m.accessor(json!({"componentType": 5126, "type": "SCALAR", "count": 1 << 22}));
            let values = m.accessor(json!({"componentType": 5126, "type": "VEC3", "count": 1 << 22}));
            m.json["animations"] = json!([{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                "samplers": [{"input": times, "output": values}]}]);
        }),
        changed("animation of two counts that overflow together", Expect::Any, |m| {
            let times = m.accessor(json!({"componentType": 5126, "type": "SCALAR", "count": 1u64 << 63}));
            let channel = |path: &str| json!({"sampler": 0, "target": {"node": 0, "path": path}});
            m.json["animations"] = json!([{"channels": [channel("translation"), channel("scale"), channel("rotation")],
                "samplers": [{"input": times, "output": times}]}]);
        }),
        changed("animation of 100000 channels that lead nowhere", Warning("left out"), |m| {
            let channel = json!({"sampler": 7, "target": {"node": 0, "path": "translation"}});
            m.json["animations"] = json!([{"channels": vec![channel; 100_000], "samplers": []}]);
        }),
        changed("animation at times beyond all clocks", Expect::Any, |m| {
            let times = m.floats("SCALAR", &[0.0, f32::MAX]);
            let values = m.floats("VEC3", &[0.0; 6]);
            m.json["animations"] = json!([{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                "samplers": [{"input": times, "output": values}]}]);
        }),
        changed("2000 buffers of one large file", Expect::Any, |_| {}).instead(&{
            let mut json = Model::triangle().to_json(None);
            let uri = |i: usize| json!({"byteLength": 1 << 22, "uri": format!("{}large.bin", "./".repeat(i))});
            json["buffers"] = (0..2000).map(uri).collect();
            let view = |i: usize| json!({"buffer": i, "byteLength": 36});
            json["bufferViews"] = (0..2000).map(view).collect();
            let accessor = |i: usize| json!({"bufferView": i, "componentType": 5126, "type": "VEC3", "count": 3});
            json["accessors"] = (0..2000).map(accessor).collect();
            let primitive = |i: usize| json!({"attributes": {"POSITION": i}});
            json["meshes"][0]["primitives"] = (0..2000).map(primitive).collect();
            json.to_string()
        }).with("large.bin", vec![0; 1 << 22]),
    ]
}
