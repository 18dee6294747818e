//! Models in scene files.

use envers::{Instance, LightKind, Loaded, Scene};
use glam::DVec3;

use super::{CAMERA, File};

/// Two triangles of two materials, the second of which is not there.
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nusemtl none\nf 1 2 4\n";

/// A camera named "eye" at (0, 0, 2) and a light of 4 at (0, 3, 0).
const GLTF: &str = r#"{
    "asset": { "version": "2.0" },
    "extensionsUsed": ["KHR_lights_punctual"],
    "extensions": { "KHR_lights_punctual": { "lights": [
        { "type": "point", "intensity": 4, "range": 9 }
    ] } },
    "cameras": [{
        "name": "eye", "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 }
    }],
    "nodes": [
        { "name": "eye", "camera": 0, "translation": [0, 0, 2] },
        { "translation": [0, 3, 0], "extensions": { "KHR_lights_punctual": { "light": 0 } } }
    ],
    "scenes": [{ "nodes": [0, 1] }],
    "scene": 0
}"#;

fn file(text: &str) -> File {
    let file = File::new(text);
    std::fs::write(file.beside("two.obj"), OBJ).unwrap();
    std::fs::write(file.beside("eye.gltf"), GLTF).unwrap();
    file
}

fn scene(text: &str) -> Scene {
    file(text).load().unwrap_or_else(|e| panic!("{e}\n{text}")).scene
}

#[test]
fn a_model_alone_is_a_scene_with_a_camera_that_frames_it() {
    let scene = scene("[[model]]\nfile = \"two.obj\"\n");
    assert_eq!((scene.meshes.len(), scene.instances.len()), (2, 2));
    assert_eq!(scene.cameras[0].name, "framing");
}

#[test]
fn a_model_is_placed_by_translate_rotate_scale() {
    let scene = scene(
        "[[model]]\nfile = \"two.obj\"\nscale = 2\nrotate = [0, 0, 90]\ntranslate = [5, 0, 0]\n",
    );
    // x is doubled, turned to y, moved.
    let corner = scene.instances[0].to_world([1.0, 0.0, 0.0]);
    assert_eq!(corner, DVec3::new(5.0, 2.0, 0.0));
}

#[test]
fn a_file_named_twice_is_stored_once_however_it_is_written() {
    let scene = scene("[[model]]\nfile = \"two.obj\"\n[[model]]\nfile = \"./two.obj\"\n");
    assert_eq!((scene.meshes.len(), scene.instances.len()), (2, 4));
}

#[test]
fn warnings_of_a_model_name_it_and_come_once() {
    let text = "[[model]]\nfile = \"two.obj\"\n[[model]]\nfile = \"two.obj\"\n";
    let warnings = file(text).load().unwrap().report.warnings;
    assert!(!warnings.is_empty());
    assert!(warnings.iter().all(|w| w.contains("two.obj: ")), "{warnings:?}");
    let Loaded { report, .. } = envers::load(file("").beside("two.obj")).unwrap();
    assert_eq!(warnings.len(), report.warnings.len());
}

#[test]
fn a_material_takes_the_place_of_all_of_a_models_own() {
    let scene = scene(
        "[[material]]\nname = \"gold\"\n[[model]]\nfile = \"two.obj\"\nmaterial = \"gold\"\n\
         casts_shadow = false\n[[model]]\nfile = \"two.obj\"\n",
    );
    let gold = |i: usize| scene.materials[scene.instances[i].material.0 as usize].name == "gold";
    assert_eq!([0, 1, 2, 3].map(gold), [true, true, false, false]);
    let shadows: Vec<bool> = scene.instances.iter().map(|i| i.casts_shadow).collect();
    assert_eq!(shadows, [false, false, true, true]);
}

#[test]
fn a_models_own_camera_is_used_where_the_file_has_none() {
    let scene = scene(
        "[[model]]\nfile = \"two.obj\"\n[[model]]\nfile = \"eye.gltf\"\ntranslate = [7, 0, 0]\n",
    );
    assert_eq!(scene.cameras.len(), 1);
    assert_eq!(
        (&*scene.cameras[0].name, scene.cameras[0].position),
        ("eye", DVec3::new(7., 0., 2.))
    );
}

#[test]
fn a_models_camera_comes_after_the_files_own() {
    let scene = scene(&format!("{CAMERA}camera.name = \"mine\"\n[[model]]\nfile = \"eye.gltf\"\n"));
    let names: Vec<&str> = scene.cameras.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["mine", "eye"]);
}

#[test]
fn a_models_lights_shine_where_it_is_placed_as_strong_as_they_are() {
    let alone = scene("[[model]]\nfile = \"eye.gltf\"\n");
    let placed = scene("[[model]]\nfile = \"eye.gltf\"\nscale = 2\ntranslate = [0, 1, 0]\n");
    let LightKind::Point { position, range, .. } = placed.lights[0].kind else { panic!("a point") };
    assert_eq!((position, range), (DVec3::new(0.0, 7.0, 0.0), 9.0));
    assert_eq!(placed.lights[0].intensity, alone.lights[0].intensity);
}

#[test]
fn a_models_lights_can_be_left_out() {
    let text = "lights = \"none\"\n[[model]]\nfile = \"eye.gltf\"\nlights = false\n";
    assert!(scene(text).lights.is_empty());
}

#[test]
fn a_models_emission_illuminates_only_where_it_is_asked_to() {
    let file = File::new(format!(
        "{CAMERA}[[model]]\nfile = \"lamp.obj\"\n\
         [[model]]\nfile = \"lamp.obj\"\ntranslate = [5, 0, 0]\nilluminates = true\n"
    ));
    let material = "newmtl lamp\nKe 2 2 2\nnewmtl wall\nKd 1 1 1\n";
    let faces = "usemtl lamp\nf 1 2 3\nusemtl wall\nf 1 3 2\n";
    let model = format!("mtllib lamp.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    std::fs::write(file.beside("lamp.obj"), model).unwrap();
    std::fs::write(file.beside("lamp.mtl"), material).unwrap();
    let Loaded { scene, .. } = file.load().unwrap();
    let of = |instance: &Instance| &scene.materials[instance.material.0 as usize];
    let lamps: Vec<bool> = scene.instances.iter().map(|i| of(i).illuminates).collect();
    assert_eq!(lamps.iter().filter(|&&illuminates| illuminates).count(), 1, "{lamps:?}");
    let lamp = scene.instances.iter().find(|i| of(i).illuminates).unwrap();
    assert_eq!((of(lamp).emission.x, lamp.transform.translation.x), (2.0, 5.0));

    // Where nothing emits, a warning says so.
    std::fs::write(file.beside("lamp.mtl"), material.replace("Ke 2 2 2", "")).unwrap();
    let warnings = file.load().unwrap().report.warnings;
    let said = warnings.iter().any(|w| w.contains("nothing emits light"));
    assert!(said, "{warnings:?}");
}

#[test]
fn an_error_in_a_model_names_the_model() {
    let file = file("[[model]]\nfile = \"eye.gltf\"\n");
    let model = file.beside("eye.gltf");
    std::fs::write(&model, &GLTF[..40]).unwrap();
    let error = file.load().unwrap_err();
    assert_eq!(error.path(), Some(&*model), "{error}");
}

#[test]
fn a_model_placed_too_far_away_is_at_its_name() {
    let far = "[[model]]\nfile = \"two.obj\"\nscale = 1e15\ntranslate = [1e15, 0, 0]\n";
    let error = file(far).load().unwrap_err();
    assert!(error.to_string().contains("scene.toml:2:8: the model reaches beyond"), "{error}");
}

#[test]
fn a_model_of_a_material_that_is_not_there_is_refused() {
    let text = "[[model]]\nfile = \"two.obj\"\nmaterial = \"gold\"\n";
    let error = file(text).load().unwrap_err();
    assert!(error.to_string().contains("scene.toml:3:12: there is no material `gold`"), "{error}");
}

#[test]
fn defaults_of_a_model_are_what_missing_keys_mean() {
    let [bare, full] = super::docs::written_out("[[model]]", "model", "file = \"eye.gltf\"")
        .map(|text| scene(&text))
        .map(|scene| format!("{scene:?}"));
    assert_eq!(bare, full);
}

#[test]
fn defaults_at_the_top_of_the_file_are_what_missing_keys_mean() {
    let [bare, full] = super::docs::written_out("", super::docs::TOP, "")
        .map(|text| scene(&(text + "[[model]]\nfile = \"two.obj\"\n")))
        .map(|scene| format!("{scene:?}"));
    assert_eq!(bare, full);
}

/// The kinds of the lights of a scene with a model that has none.
#[track_caller]
fn lights_with(rest: &str) -> Vec<LightKind> {
    let scene = scene(&format!("{rest}\n[[model]]\nfile = \"two.obj\"\n"));
    scene.lights.into_iter().map(|light| light.kind).collect()
}

#[test]
fn a_model_without_any_light_has_the_lights_of_a_bare_model() {
    let bare = envers::load(file("").beside("two.obj")).unwrap().scene;
    for rest in ["", "lights = \"auto\""] {
        let scene = scene(&format!("{rest}\n[[model]]\nfile = \"two.obj\"\n"));
        assert_eq!((scene.lights.len(), scene.lights), (1, bare.lights.clone()));
        assert!(scene.environment.is_some() && scene.environment == bare.environment);
    }
}

#[test]
fn a_scene_that_says_none_has_no_default_lights() {
    assert_eq!(lights_with("lights = \"none\""), []);
}

#[test]
fn one_light_of_the_scene_or_of_a_model_is_all_its_light() {
    assert_eq!(lights_with("[[light]]\nkind = \"ambient\""), [LightKind::Ambient]);
    assert_eq!(lights_with("[[model]]\nfile = \"eye.gltf\"").len(), 1);
}

#[test]
fn a_scene_without_a_model_has_no_default_lights() {
    let sphere = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n";
    assert_eq!(scene(&format!("{CAMERA}{sphere}")).lights, []);
}
