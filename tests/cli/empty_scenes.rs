//! Scenes in which there is nothing that a ray can hit.

use super::*;

/// A film and a camera, and nothing to see.
const EMPTY: &str = "\
[film]\nsize = [8, 6]\nbackground = \"#203040\"\n\
[camera]\nposition = [0, 1, 5]\nlook_at = [0, 0, 0]\n";

/// A folder with `a.glb`, whose triangle is scaled from one size to another in a quarter of a second.
fn scaled(from: [f32; 3], to: [f32; 3]) -> Folder {
    let mut model = envers_testing::Model::triangle();
    let input = model.floats("SCALAR", &[0.0, 0.25]);
    let output = model.floats("VEC3", &[from, to].concat());
    model.json["animations"] = serde_json::json!([{
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "scale"}}],
        "samplers": [{"input": input, "output": output}],
    }]);
    let folder = Folder::new();
    folder.write("a.glb", model.glb());
    folder
}

#[track_caller]
fn assert_is_not_rendered(folder: &Folder, command: &str) -> String {
    folder.write("a.png", "old");
    let before = folder.names();
    let message = folder.run(command).failed();
    assert!(message.contains("there is nothing in the scene that a ray can hit"), "{message}");
    assert!(message.contains("`--allow-empty`"), "{message}");
    assert_eq!(folder.names(), before);
    assert_eq!(folder.read("a.png"), b"old");
    message
}

#[test]
fn an_empty_scene_is_not_rendered() {
    assert_is_not_rendered(&Folder::with(EMPTY), "render scene.toml -o a.png");
}

#[test]
fn an_empty_scene_is_rendered_when_that_is_asked_for() {
    let folder = Folder::with(EMPTY);
    let run = folder.run("render scene.toml -o a.png --allow-empty");
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    assert!(
        run.stderr.starts_with("warning: the image is empty: there is nothing"),
        "{}",
        run.stderr
    );
    assert_eq!(pixels(&folder.read("a.png")).1, [0x20, 0x30, 0x40].repeat(48));
}

#[test]
fn a_model_of_points_and_lines_is_empty_and_what_it_lost_is_listed() {
    let folder = Folder::new();
    let mut model = envers_testing::Model::triangle();
    model.json["meshes"][0]["primitives"][0]["mode"] = 0.into();
    folder.write("a.glb", model.glb());
    let message = assert_is_not_rendered(&folder, "render a.glb -o a.png");
    assert!(message.contains("\n  dropped: "), "{message}");
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\np 3\n");
    assert_is_not_rendered(&folder, "render a.obj -o a.png");
}

#[test]
fn an_animation_is_empty_if_all_its_frames_are() {
    let folder = scaled([1.0, 0.0, 1.0], [2.0, 0.0, 1.0]);
    assert_is_not_rendered(&folder, "render a.glb --size 8x6 -o f#.png");
}

#[test]
fn an_animation_with_something_in_one_frame_is_rendered() {
    let folder = scaled([1.0, 0.0, 1.0], [1.0, 1.0, 1.0]);
    folder.run("render a.glb --size 8x6 -o f#.png").good();
    assert!(folder.has("f1.png") && folder.has("f6.png"));
    assert_is_not_rendered(&folder, "render a.glb --frames 1 -o g.png");
}

#[test]
fn nothing_is_missing_when_every_frame_exists() {
    let folder = Folder::with(EMPTY);
    folder.write("a.png", "old");
    let run = folder.run("render scene.toml -o a.png --skip-existing").good();
    assert_eq!(run.stdout, "1 frame existed already\n");
}
