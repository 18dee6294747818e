//! Each part of a file that is not valid is a warning that names its place, used or not.

use super::*;
use serde_json::Value;

/// Warnings that a file is not valid, of a triangle to which a part is added.
fn complaints(key: &str, part: Value) -> Vec<String> {
    let mut model = Model::triangle();
    model.json[key] = part;
    let mut warnings = model.load().unwrap().report.warnings;
    warnings.retain(|w| w.contains("not valid glTF"));
    warnings
}

#[track_caller]
fn assert_complains(key: &str, part: Value, about: &str) {
    let found = complaints(key, part);
    assert!(found.len() == 1 && found[0].contains(about), "`{about}` in {found:?}");
}

#[test]
fn a_sound_file_is_not_complained_of() {
    assert!(complaints("cameras", orthographic(1.0)).is_empty());
}

fn orthographic(xmag: f64) -> Value {
    let lens = json!({"xmag": xmag, "ymag": 1, "znear": 0, "zfar": 10});
    json!([{"type": "orthographic", "orthographic": lens}])
}

#[test]
fn reference_of_something_that_nobody_uses() {
    let part = json!([{"source": 7}]);
    assert_complains("textures", part, "references lead nowhere, at textures[0].source");
}

#[test]
fn property_that_is_missing() {
    let part = json!([{"orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 1}}]);
    let mut model = Model::triangle();
    model.json["cameras"] = part;
    let (place, text) = json_place(model.load());
    assert_eq!(place, "cameras[0]");
    assert!(text.contains("has no `type`"), "{text}");
}

#[test]
fn value_of_the_wrong_type() {
    let mut model = Model::triangle();
    model.json["materials"] = json!([{"emissiveFactor": [1, "x", 0]}]);
    let (place, text) = json_place(model.load());
    assert_eq!(place, "materials[0].emissiveFactor[1]");
    assert!(text.contains("a number is needed"), "{text}");
}

#[test]
fn value_out_of_range() {
    let part = json!([{"pbrMetallicRoughness": {"metallicFactor": 1.5}}]);
    let place = "out of range, at materials[0].pbrMetallicRoughness.metallicFactor";
    assert_complains("materials", part, place);
}

#[test]
fn list_with_nothing_in_it() {
    assert_complains("skins", json!([]), "lists are empty or name something twice, at skins");
}

#[test]
fn extension_where_it_does_not_belong() {
    let part = json!([{"extensions": {"KHR_texture_transform": {}}}]);
    let mut model = Model::triangle();
    model.json["extensionsUsed"] = json!(["KHR_texture_transform"]);
    model.json["materials"] = part;
    let place = "extensions stand where they do not belong, or are not declared, at materials[0]";
    assert_warns(&model.load().unwrap(), place);
}

#[test]
fn view_that_ends_beyond_its_buffer() {
    let mut model = Model::triangle();
    model.view(&[0; 8]);
    model.last_view()["byteLength"] = 800.into();
    assert_warns(
        &model.load().unwrap(),
        "ranges of bytes do not fit in what holds them, at bufferViews[1]",
    );
}

#[test]
fn accessor_that_ends_beyond_its_view() {
    let mut model = Model::triangle();
    let unused = model.floats("VEC3", &[0.0; 9]);
    model.accessor_mut(unused)["count"] = 4.into();
    assert_warns(&model.load().unwrap(), "do not fit in what holds them, at accessors[1]");
}

#[test]
fn camera_that_contradicts_itself() {
    let about = "objects contradict themselves or others, at cameras[0] (a magnification of 0)";
    assert_complains("cameras", orthographic(0.0), about);
}

#[test]
fn faults_of_one_kind_are_counted() {
    let part = json!([{"source": 7}, {"sampler": 3}, {"source": 8}]);
    assert_complains("textures", part, "3 references lead nowhere, first at textures[0].source");
}
