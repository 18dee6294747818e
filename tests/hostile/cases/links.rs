//! glTF files whose buffers and pictures are elsewhere, endless, or the same ones over and over.

use std::path::Path;

use serde_json::{Value, json};

use super::encode::flat_png;
use super::gltf::{case, text};
use super::{Case, Error, Expect, Loads, Warning};
use envers_testing::{Model, data_uri, png};

/// A triangle with a texture by a picture.
fn textured(image: Value) -> Model {
    let mut model = Model::triangle();
    let uvs = model.floats("VEC2", &[0.0; 6]);
    model.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    model.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    model.json["textures"] = json!([{"source": 0}]);
    model.json["images"] = json!([image]);
    model
}

pub fn cases() -> Vec<Case> {
    let buffer = |name: &str, uri: &str, expect, prepare: fn(&Path)| {
        let json = Model::triangle().to_json(Some(uri)).to_string();
        case(name, json, expect).after(prepare)
    };
    let picture = |name: &str, uri: &str, expect, prepare: fn(&Path)| {
        case(name, text(&textured(json!({"uri": uri}))), expect).after(prepare)
    };
    let fifo: fn(&Path) = |folder| {
        let made = std::process::Command::new("mkfifo").arg(folder.join("pipe")).status();
        assert!(made.unwrap().success());
    };
    let zero: fn(&Path) = |f| std::os::unix::fs::symlink("/dev/zero", f.join("link")).unwrap();
    let itself: fn(&Path) = |f| std::os::unix::fs::symlink("link", f.join("link")).unwrap();
    let nowhere: fn(&Path) = |f| std::os::unix::fs::symlink("gone", f.join("link")).unwrap();
    let memory: fn(&Path) =
        |f| std::os::unix::fs::symlink("/proc/self/mem", f.join("link")).unwrap();
    let folder: fn(&Path) = |f| std::fs::create_dir(f.join("link")).unwrap();
    let sparse: fn(&Path) = |f| {
        std::fs::File::create(f.join("link")).unwrap().set_len(1 << 40).unwrap();
    };
    vec![
        buffer("buffer that is a pipe", "pipe", Error("a pipe or a device"), fifo),
        buffer("buffer that is an endless device", "/dev/zero", Error("not in the folder"), |_| {}),
        buffer("buffer that links to an endless device", "link", Error("not in the folder"), zero),
        buffer("buffer that links to itself", "link", Error("buffers[0].uri"), itself),
        buffer("buffer that links to nothing", "link", Error("buffers[0].uri"), nowhere),
        buffer(
            "buffer that links to the memory of the process",
            "link",
            Error("not in the folder"),
            memory,
        ),
        buffer("buffer that is a folder", "link", Error("a folder"), folder),
        buffer("buffer of a tebibyte of nothing", "link", Error("`--limit bytes="), sparse),
        buffer(
            "buffer at an address",
            "http://127.0.0.1:1/x",
            Error("addresses are not read"),
            |_| {},
        ),
        picture("picture that is a pipe", "pipe", Warning("a pipe or a device"), fifo),
        picture(
            "picture that links to an endless device",
            "link",
            Warning("not in the folder"),
            zero,
        ),
        picture("picture that links to itself", "link", Warning("images[0]"), itself),
        picture(
            "picture of a tebibyte of nothing",
            "link",
            Warning("raise the limit `bytes` to "),
            sparse,
        ),
        picture("picture that is the file itself", "hostile.gltf", Warning("images[0]"), |_| {}),
        case(
            "20000 pictures of one large bomb",
            {
                let mut model = textured(json!({"uri": "x"}));
                let images: Vec<_> = (0..20_000)
                    .map(|i| json!({"uri": format!("{}bomb.png", "./".repeat(i % 50 + 1))}))
                    .collect();
                let materials: Vec<_> = (0..20_000)
                    .map(|i| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}}))
                    .collect();
                let primitive = model.primitive().clone();
                let primitives: Vec<_> = (0..20_000)
                    .map(|i| {
                        let mut p = primitive.clone();
                        p["material"] = i.into();
                        p
                    })
                    .collect();
                model.json["images"] = images.into();
                model.json["textures"] = (0..20_000).map(|i| json!({"source": i})).collect();
                model.json["materials"] = materials.into();
                model.json["meshes"][0]["primitives"] = primitives.into();
                text(&model)
            },
            Expect::Any,
        )
        .with("bomb.png", flat_png(4096, 4096)),
        case(
            "100 buffer views that are the same bomb",
            {
                let mut model = textured(json!({"uri": "x"}));
                let view = model.view(&flat_png(4096, 4096));
                let materials: Vec<_> = (0..100)
                    .map(|i| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}}))
                    .collect();
                let primitive = model.primitive().clone();
                let primitives: Vec<_> = (0..100)
                    .map(|i| {
                        let mut p = primitive.clone();
                        p["material"] = i.into();
                        p
                    })
                    .collect();
                model.json["images"] =
                    vec![json!({"bufferView": view, "mimeType": "image/png"}); 100].into();
                model.json["textures"] = (0..100).map(|i| json!({"source": i})).collect();
                model.json["materials"] = materials.into();
                model.json["meshes"][0]["primitives"] = primitives.into();
                text(&model)
            },
            // It is decoded once. The triangles stand at one place.
            Warning("instances of meshes are left out"),
        ),
        case(
            "picture of one pixel",
            text(&textured(json!({"uri": data_uri(&png(&[[1; 4]]))}))),
            Loads,
        ),
    ]
}
