//! What a scene does not need is not done, and the picture is the same as if it were.

use super::*;
use envers::scene::Feature;

/// A mesh that stands once, and a material with a picture that nothing is made of.
const PLAIN: &str = r##"
[film]
size = [60, 40]

[camera]
position = [2, 2, 3]
look_at = [0.3, 0.3, 0.3]

[[material]]
name = "unused"
diffuse_map = "wood.png"

[[model]]
file = "tetrahedron.obj"
rotate = [0, 20, 0]

[[light]]
kind = "directional"
direction = [-1, -2, -1]
"##;

fn plain() -> Folder {
    let folder = Folder::with(PLAIN);
    folder.write("tetrahedron.obj", TETRAHEDRON);
    image::RgbImage::from_pixel(2, 2, image::Rgb([150, 100, 50]))
        .save(folder.path("wood.png"))
        .unwrap();
    folder
}

/// The counts of work of a rendering.
fn work(folder: &Folder, flags: &str) -> Value {
    let run = folder.run(&format!("render scene.toml -o work.png --stats - {flags}")).good();
    run.json()["work"].clone()
}

/// Asserts that the certified picture is the same bytes when a kind of work is not skipped, each in
/// turn, and when none is.
#[track_caller]
fn assert_same(folder: &Folder, scene: &str) {
    let backends = if cfg!(feature = "embree") { &["embree", "rust"][..] } else { &["rust"] };
    for backend in backends {
        let render = format!("render {scene} --precision certified --backend {backend} --spp 1");
        folder.run(&format!("{render} -o skips.exr")).good();
        for name in Feature::ALL.map(Feature::name).into_iter().chain(["all"]) {
            folder.run(&format!("{render} -o all.exr --no-skip {name}")).good();
            assert!(folder.read("skips.exr") == folder.read("all.exr"), "{name} on {backend}");
        }
    }
}

/// As [`assert_same`], of a small picture of a scene that comes with envers.
#[track_caller]
fn assert_same_of_asset(name: &str) {
    let scene = format!("{}/assets/scenes/{name}", env!("CARGO_MANIFEST_DIR"));
    assert_same(&Folder::new(), &format!("{scene} --size 72x48"));
}

#[test]
fn the_picture_of_a_scene_that_needs_nothing_is_the_same_without_each_skip() {
    assert_same(&plain(), "scene.toml");
}

#[test]
fn the_picture_of_a_scene_with_everything_in_it_is_the_same_without_each_skip() {
    assert_same(&Folder::with_everything(), "scene.toml");
}

#[test]
fn the_picture_of_the_room_is_the_same_without_each_skip() {
    assert_same_of_asset("room.toml");
}

#[test]
fn the_picture_of_gems_is_the_same_without_each_skip() {
    assert_same_of_asset("gallery/gems.toml");
}

#[test]
fn the_picture_of_a_lit_sphere_is_the_same_without_each_skip() {
    assert_same_of_asset("tutorial/3-2-lambert.toml");
}

#[test]
#[cfg(feature = "embree")]
fn no_spheres_make_no_user_geometry() {
    let folder = plain();
    assert_eq!(work(&folder, "")["spheres"], 0);
    assert_eq!(work(&folder, "--no-skip spheres")["spheres"], 1);
    assert_eq!(work(&Folder::with(SPHERE), "")["spheres"], 1);
}

#[test]
#[cfg(feature = "embree")]
fn meshes_that_stand_once_make_no_instances() {
    let folder = plain();
    for precision in ["fast", "certified"] {
        let flags = format!("--precision {precision}");
        assert_eq!(work(&folder, &flags)["instances"], 0, "{precision}");
        let flags = format!("--precision {precision} --no-skip instances");
        assert_eq!(work(&folder, &flags)["instances"], 1, "{precision}");
    }
    assert_eq!(work(&Folder::with_everything(), "")["instances"], 2);
}

#[test]
fn pictures_that_nothing_shows_are_not_read() {
    let folder = plain();
    assert_eq!(work(&folder, "")["pictures"], 0);
    assert_eq!(work(&folder, "--no-skip pictures")["pictures"], 1);
    folder.write("scene.toml", PLAIN.replace("rotate =", "material = \"unused\"\nrotate ="));
    assert_eq!(work(&folder, "")["pictures"], 1);
}

#[test]
fn a_picture_that_nothing_shows_may_be_damaged_and_is_not_overwritten() {
    let folder = plain();
    folder.write("wood.png", "no picture");
    folder.run("render scene.toml -o a.png").good();
    let said = folder.run("render scene.toml -o a.png --no-skip pictures").refused();
    assert!(said.contains("wood.png"), "{said}");
    let said = folder.run("render scene.toml -o wood.png").refused();
    assert!(said.contains("the output is a texture of the scene"), "{said}");
}

#[test]
fn lights_and_materials_that_are_not_there_cast_no_rays() {
    let folder = plain();
    folder.write("scene.toml", PLAIN.to_owned() + "shadow = false\n");
    let work = work(&folder, "");
    for none in ["shadows", "reflection", "refraction"] {
        assert_eq!(work[none], 0, "{none}");
    }
}

#[test]
#[cfg(feature = "embree")]
fn statistics_say_why_work_is_skipped() {
    let folder = plain();
    let stats = folder.run("render scene.toml -o a.png --stats -").good().json();
    assert_eq!(stats["skipped"]["spheres"], "there are no spheres");
    assert_eq!(stats["skipped"]["instances"], "0 of 1 meshes stand more than once");
    assert_eq!(stats["skipped"]["pictures"], "0 of 1 pictures are on a material in use");
    assert!(stats["skipped"]["shadows"].is_null());
    let run = "render scene.toml -o a.png --stats - --no-skip spheres --no-skip instances";
    let stats = folder.run(run).good().json();
    assert!(stats["skipped"]["spheres"].is_null() && stats["skipped"]["instances"].is_null());
}

#[test]
fn work_of_an_unknown_name_is_refused_with_the_names_that_there_are() {
    let said = plain().run("render scene.toml -o a.png --no-skip sphere").refused();
    assert!(said.contains("no kind of work is called `sphere`"), "{said}");
    assert!(said.contains("they are spheres, instances, planes, pictures"), "{said}");
}

#[test]
fn the_switches_are_not_in_the_help() {
    assert!(!plain().run("render --help").good().stdout.contains("no-skip"));
}

#[test]
fn info_says_what_is_needed_and_what_is_skipped_and_why() {
    let said = plain().run("info scene.toml").good().stdout;
    assert!(said.contains("\nneeds      shadows: 1 of 1 lights cast shadows\n"), "{said}");
    assert!(said.contains("\nskips      spheres: there are no spheres\n"), "{said}");
    let json = plain().run("info scene.toml --json -").good().json();
    assert_eq!(json["needed"]["shadows"], "1 of 1 lights cast shadows");
    assert_eq!(json["skipped"]["instances"], "0 of 1 meshes stand more than once");
}
