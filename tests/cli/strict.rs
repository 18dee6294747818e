//! `--strict`, and what the command tells of what is lost.

use super::*;
use envers_testing::Model;
use serde_json::json;

/// A folder with a model of two triangles, of which one names a vertex that is not there.
fn lossy() -> Folder {
    let mut model = Model::triangle();
    let indices = model.shorts(&[0, 1, 2, 0, 1, 9]);
    model.primitive()["indices"] = indices.into();
    let folder = Folder::new();
    folder.write("a.glb", model.glb());
    folder
}

fn sound() -> Folder {
    let folder = Folder::new();
    folder.write("a.glb", Model::triangle().glb());
    folder
}

#[test]
fn strict_refuses_a_file_of_which_something_is_dropped() {
    for command in ["info", "validate --size 8x8 --spp 1", "render --size 8x8 --spp 1"] {
        let done = lossy().run(&format!("{command} a.glb --strict"));
        assert_eq!(done.status, Some(2));
        assert!(done.stderr.contains("dropped: 1 index-out-of-range"), "{}", done.stderr);
    }
}

#[test]
fn strict_takes_a_sound_file() {
    for command in ["info", "render --size 8x8 --spp 1"] {
        sound().run(&format!("{command} a.glb --strict")).good();
    }
}

#[cfg(feature = "embree")]
#[test]
fn strict_lets_a_sound_file_be_validated() {
    sound().run("validate --size 8x8 --spp 1 a.glb --strict").good();
}

#[test]
fn strict_refuses_a_file_whose_materials_are_missing() {
    let folder = Folder::new();
    for line in ["mtllib gone.mtl", "usemtl gone"] {
        folder.write("a.obj", format!("{line}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
        let done = folder.run("info a.obj --strict");
        assert_eq!(done.status, Some(2), "{line}");
        assert!(
            done.stderr.contains("placeholder: ") && done.stderr.contains("gone"),
            "{}",
            done.stderr
        );
    }
}

#[test]
fn without_strict_a_loss_is_a_warning() {
    let done = lossy().run("info a.glb");
    assert_eq!(done.status, Some(0));
    assert!(done.stderr.contains("faces are left out"), "{}", done.stderr);
}

#[test]
fn strict_looks_at_the_models_of_a_scene_file() {
    let folder = lossy();
    folder.write("s.toml", "[[model]]\nfile = \"a.glb\"\n");
    assert_eq!(folder.run("info s.toml --strict").status, Some(2));
}

#[test]
fn info_balances_faces_in_words() {
    let done = lossy().run("info a.glb");
    assert_eq!(done.status, Some(0));
    let line = "faces      2 read = 1 handed over + 1 index-out-of-range";
    assert!(done.stdout.contains(line), "{}", done.stdout);
}

#[test]
fn info_and_statistics_have_the_report() {
    let folder = lossy();
    let expected = json!({"read": 2, "handed_over": 1, "dropped": {"index-out-of-range": 1}});
    for command in ["info a.glb --json -", "render a.glb --size 8x8 --spp 1 --stats -"] {
        let report = &folder.run(command).json()["report"];
        assert_eq!(report["faces"], expected);
        assert_eq!(report["unsupported"], json!([]));
        assert_eq!(report["placeholders"], json!([]));
    }
}
