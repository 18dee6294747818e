//! `envers info`.

use super::*;
use envers_testing::{Model, png};
use serde_json::json;

#[test]
fn info_says_what_is_in_a_scene() {
    let stdout = Folder::with_everything().run("info scene.toml").good().stdout;
    for line in [
        "spheres    2",
        "planes     1",
        "triangles  9 in 3 instances of 2 meshes (5 stored)",
        "vertices   7 stored",
        "closed     1 of 2 meshes",
        "textures   0\n",
        "lights     point, directional, spot, ambient",
        "cameras    fov_y 45.0000 `front`, fov_x 60.0000 `above`",
    ] {
        assert!(stdout.contains(&format!("\n{line}")), "{line} in {stdout}");
    }
}

#[test]
fn info_says_what_will_be_skipped_only_if_asked() {
    let folder = Folder::with(SPHERE);
    let stdout = folder.run("info scene.toml --verbose").good().stdout;
    assert!(stdout.contains("\nskips      instances: there are no meshes\n"), "{stdout}");
    assert!(!stdout.contains("skips      shadows"), "{stdout}");
    let stdout = folder.run("info scene.toml").good().stdout;
    assert!(!stdout.contains("skips") && !stdout.contains("needs"), "{stdout}");
}

#[test]
fn info_json_says_the_same() {
    let info = Folder::with_everything().run("info scene.toml --json -").good().json();
    let expected = json!({"spheres": 2, "triangles": 9, "planes": 1, "instances": 3});
    assert_eq!(info["geometry"], expected);
    assert_eq!(info["size"], json!([150, 110]));
    assert_eq!((&info["vertices"], &info["closed_meshes"]), (&7.into(), &1.into()));
    assert_eq!(info["lights"].as_array().unwrap().len(), 4);
    assert_eq!(info["cameras"].as_array().unwrap().len(), 2);
    assert!(info["needed"].is_object() && info["skipped"].is_object());
    assert!(info["warnings"].as_array().unwrap().is_empty());
}

#[test]
fn info_json_goes_to_a_file() {
    let folder = Folder::with(SPHERE);
    folder.run("info scene.toml --json i.json").good();
    serde_json::from_slice::<Value>(&folder.read("i.json")).unwrap();
}

#[test]
fn info_says_how_large_the_files_are() {
    let folder = Folder::with_everything();
    let size = |name| folder.read(name).len();
    let all = size("scene.toml") + size("tetrahedron.obj") + size("triangle.glb");
    let info = folder.run("info scene.toml --json -").good().json();
    let expected = json!({"path": "scene.toml", "own_bytes": size("scene.toml"), "count": 3,
        "bytes": all});
    assert_eq!(info["files"], expected);
    let stdout = folder.run("info scene.toml").good().stdout;
    let [own, all] = [size("scene.toml"), all].map(|bytes| bytes as f64 / 1e3);
    let line = format!("file       {own:.1} kB, with those that it names {all:.1} kB in 3 files\n");
    assert!(stdout.starts_with(&line), "{line} in {stdout}");
    let stdout = folder.run("info tetrahedron.obj").good().stdout;
    assert!(stdout.starts_with(&format!("file       {} bytes\n", size("tetrahedron.obj"))));
}

#[test]
fn info_lists_images_with_their_sizes_and_materials_with_their_names() {
    let folder = Folder::new();
    folder.write("small.png", png(&[[9; 4]; 2]));
    folder.write("large.png", png(&[[9; 4]; 5]));
    // Nothing shows the last one, which is not read.
    folder.write("unused.png", "no picture");
    let material =
        |name: &str| format!("[[material]]\nname = \"{name}\"\ndiffuse_map = \"{name}.png\"\n");
    let sphere = |name: &str, x: u32| {
        format!("[[sphere]]\ncenter = [{x}, 0, 0]\nradius = 0.4\nmaterial = \"{name}\"\n")
    };
    let camera = "camera.position = [0, 0, 5]\ncamera.look_at = [0, 0, 0]\n";
    let names = ["small", "large", "unused"];
    let spheres = [sphere("small", 0), sphere("large", 1), sphere("small", 2)].concat();
    folder.write("scene.toml", camera.to_owned() + &names.map(material).concat() + &spheres);

    let info = folder.run("info scene.toml --json -").good().json();
    assert_eq!(info["materials"], json!(names));
    assert_eq!(info["textures"], 3);
    let expected = json!([
        {"name": "small.png", "width": 2, "height": 1},
        {"name": "large.png", "width": 5, "height": 1},
        {"name": "unused.png", "width": null, "height": null},
    ]);
    assert_eq!(info["images"], expected);
    let stdout = folder.run("info scene.toml").good().stdout;
    let lines = "materials  3\ntextures   3 of 3 images, the largest 5x1 `large.png`\n";
    assert!(stdout.contains(lines), "{stdout}");
}

#[test]
fn info_json_has_the_numbers_of_lights_and_cameras() {
    let info = Folder::with_everything().run("info scene.toml --json -").good().json();
    let spot = &info["lights"][2];
    assert_eq!((&spot["kind"], &spot["position"]), (&json!("spot"), &json!([0.0, 4.0, 1.0])));
    assert_eq!(spot["direction"], json!([0.0, -1.0, 0.0]));
    assert_eq!((&spot["falloff"], &spot["range"]), (&json!("none"), &Value::Null));
    let degrees = |key: &str| spot[key].as_f64().unwrap().round();
    assert_eq!([degrees("inner_angle"), degrees("outer_angle")], [10.0, 30.0]);
    let sun = &info["lights"][1];
    assert_eq!((&sun["position"], &sun["falloff"]), (&Value::Null, &Value::Null));
    assert!(sun["direction"].is_array() && sun["intensity"].as_array().unwrap().len() == 3);
    let above = &info["cameras"][1];
    assert_eq!((&above["name"], &above["projection"]), (&json!("above"), &json!("fov_x")));
    assert!((above["value"].as_f64().unwrap() - 60.0).abs() < 1e-9);
    assert_eq!(above["position"], json!([0.0, 7.0, 0.5]));
    assert!(above["direction"].is_array() && above["up"].is_array());
}

#[test]
fn info_says_how_large_the_scene_is() {
    let folder = Folder::new();
    folder.write("a.obj", TETRAHEDRON);
    let stdout = folder.run("info a.obj").good().stdout;
    let lines = "bounds     [-0.5, 0.0, -0.5] to [0.5, 1.0, 0.5]\nextent     1 x 1 x 1\n";
    assert!(stdout.contains(lines), "{stdout}");
    assert_eq!(folder.run("info a.obj --json -").json()["extent"], json!([1.0, 1.0, 1.0]));
}

/// A triangle that two animations move.
fn animated() -> Model {
    let mut model = Model::triangle();
    let values = model.floats("VEC3", &[0., 0., 0., 1., 0., 0.]);
    let mut animation = |name: Option<&str>, last: f32| {
        let times = model.floats("SCALAR", &[0.0, last]);
        model.accessor_mut(times)["min"] = json!([0]);
        model.accessor_mut(times)["max"] = json!([last]);
        let channel = json!({"sampler": 0, "target": {"node": 0, "path": "translation"}});
        let mut animation =
            json!({"channels": [channel], "samplers": [{"input": times, "output": values}]});
        if let Some(name) = name {
            animation["name"] = name.into();
        }
        animation
    };
    let animations = [animation(Some("walk"), 1.5), animation(None, 4.0)];
    model.json["animations"] = json!(animations);
    let asset = json!({"version": "2.0", "generator": "by hand", "copyright": "none\u{7}"});
    model.json["asset"] = asset;
    model
}

#[test]
fn info_lists_all_animations_of_a_file_and_who_made_it() {
    let folder = Folder::new();
    folder.write("a.glb", animated().glb());
    let stdout = folder.run("info a.glb").good().stdout;
    for line in [
        "made by    by hand\ncopyright  none\\u{7}\n",
        "animations `walk` (1.500 s), 1 (4.000 s)\n",
        "animation  36 frames at 24 fps",
    ] {
        assert!(stdout.contains(&format!("\n{line}")), "{line} in {stdout}");
    }
    folder.write("s.toml", "[[model]]\nfile = \"a.glb\"\n[animation]\nframes = 9\n");
    let info = folder.run("info s.toml --json -").json();
    let expected = json!([{"file": "a.glb", "version": "2.0", "generator": "by hand",
        "copyright": "none\u{7}", "animations": [
            {"name": "walk", "seconds": 1.5}, {"name": null, "seconds": 4.0}]}]);
    assert_eq!((&info["gltf"], &info["animation"]["frames"]), (&expected, &9.into()));
}

#[test]
fn faces_without_area_are_counted_and_no_warning() {
    let folder = Folder::new();
    folder.write("a.obj", format!("{TETRAHEDRON}f 1 1 2\nf 1 2 2\n"));
    let stdout = folder.run("info a.obj").good().stdout;
    assert!(stdout.contains("faces      6 read = 4 handed over + 2 degenerate\n"), "{stdout}");
    folder.run("render a.obj --size 8x8 --spp 1 -o a.png").good();
    // They are dropped, all the same.
    let strict = folder.run("info a.obj --strict");
    assert_eq!(strict.status, Some(2));
    assert!(strict.stderr.contains("dropped: 2 degenerate"), "{}", strict.stderr);
}
