//! `--variant`.

use super::*;
use envers_testing::Model;
use serde_json::json;

/// A folder with a square that is white, or black as the variant `coal`.
fn folder() -> Folder {
    let mut model = Model::new();
    let corners = model.floats("VEC3", &[0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.]);
    model.primitive()["attributes"]["POSITION"] = corners.into();
    model.primitive()["mode"] = 5.into();
    let unlit = |x| {
        json!({"pbrMetallicRoughness": {"baseColorFactor": [x, x, x, 1]},
            "extensions": {"KHR_materials_unlit": {}}})
    };
    model.json["materials"] = json!([unlit(1), unlit(0)]);
    model.json["extensions"] = json!({"KHR_materials_variants": {"variants": [{"name": "coal"}]}});
    model.primitive()["material"] = 0.into();
    model.primitive()["extensions"] =
        json!({"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [0]}]}});
    let folder = Folder::new();
    folder.write("a.glb", model.glb());
    folder.write("s.toml", "[[model]]\nfile = \"a.glb\"\n");
    folder
}

#[test]
fn render_shows_the_variant() {
    let folder = folder();
    for file in ["a.glb", "s.toml"] {
        for (name, flag) in [("white", ""), ("coal", "--variant coal")] {
            folder.run(&format!("render {file} -o {name}.png --size 9x9 -q {flag}")).good();
        }
        let centre = |name| image::open(folder.path(name)).unwrap().to_rgb8().get_pixel(4, 4).0;
        assert_eq!((centre("white.png"), centre("coal.png")), ([255; 3], [0; 3]), "{file}");
    }
}

#[test]
fn info_lists_the_variants() {
    let folder = folder();
    for file in ["a.glb", "s.toml"] {
        let done = folder.run(&format!("info {file}"));
        assert!(done.stdout.contains("variants   `coal`\n"), "{}", done.stdout);
        let report = &folder.run(&format!("info {file} --json -")).json()["report"];
        assert_eq!(report["variants"], json!(["coal"]));
    }
}

#[test]
fn info_says_nothing_of_variants_where_there_are_none() {
    let folder = Folder::new();
    folder.write("a.glb", Model::triangle().glb());
    assert!(!folder.run("info a.glb").stdout.contains("variants"));
}

#[test]
fn a_variant_that_is_not_there_is_refused_by_every_command() {
    let folder = folder();
    for command in ["info", "render --size 8x8", "validate --size 8x8", "bench --quick --out b"] {
        for file in ["a.glb", "s.toml"] {
            let message = folder.run(&format!("{command} {file} --variant cool")).refused();
            assert!(message.contains(&format!("{file}: there is no variant `cool`")), "{message}");
            assert!(message.contains("did you mean `coal`?"), "{message}");
        }
    }
}
