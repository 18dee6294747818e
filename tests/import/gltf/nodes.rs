//! The tree of nodes.

use envers::{Limit, Limits, LoadOptions, Loaded};
use glam::DVec3;

use super::*;

#[test]
fn child_transform_stands_within_its_parents() {
    let mut model = Model::triangle();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    model.json["nodes"] = json!([
        {"children": [1], "translation": [10, 0, 0], "rotation": [0, 0, half, half]},
        {"mesh": 0, "translation": [1, 0, 0], "scale": [2, 3, 4]},
    ]);
    let scene = model.load().unwrap().scene;
    // The second corner: scaled to (2, 0, 0), moved to (3, 0, 0), turned to (0, 3, 0), moved.
    let corner = scene.instances[0].to_world([1., 0., 0.]);
    assert!((corner - DVec3::new(10., 3., 0.)).length() < 1e-7, "{corner}");
}

#[test]
fn matrix_is_read_by_columns() {
    let mut model = Model::triangle();
    model.json["nodes"][0]["matrix"] = json!([0, 2, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1]);
    let corner = model.load().unwrap().scene.instances[0].to_world([1., 0., 0.]);
    assert_eq!(corner, DVec3::new(7., 10., 9.));
}

#[test]
fn mesh_of_two_nodes_is_stored_once() {
    let mut model = Model::triangle();
    model.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [0, 0, 5]}]);
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = model.load().unwrap().scene;
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2));
}

#[test]
fn default_scene_is_shown_alone() {
    let mut model = Model::triangle();
    model.json["nodes"] = json!([{}, {"mesh": 0}, {"mesh": 0}]);
    model.json["scenes"] = json!([{"nodes": [1, 2]}, {"nodes": [2]}]);
    for (scene, instances) in [(json!(0), 2), (json!(1), 1), (json!(null), 2)] {
        model.json["scene"] = scene;
        assert_eq!(model.load().unwrap().scene.instances.len(), instances);
    }
}

#[test]
fn without_scenes_all_nodes_are_shown() {
    let mut model = Model::triangle();
    model.json["nodes"] = json!([{"children": [1]}, {"mesh": 0}, {"mesh": 0}]);
    model.json.as_object_mut().unwrap().retain(|key, _| !key.starts_with("scene"));
    assert_eq!(model.load().unwrap().scene.instances.len(), 2);
}

#[test]
fn chain_of_a_hundred_thousand_nodes() {
    let mut model = Model::triangle();
    let mut nodes: Vec<_> = (1..100_000).map(|i| json!({"children": [i]})).collect();
    nodes.push(json!({"mesh": 0}));
    model.json["nodes"] = nodes.into();
    let folder = Folder::new();
    model.load_in(&folder).unwrap_err();
    let limits = Limits::default().with_limit(Limit::Depth, 100_000);
    let options = LoadOptions::default().limits(limits);
    assert_eq!(options.load(folder.path("model.gltf")).unwrap().scene.triangle_count(), 1);
}

#[test]
fn scale_of_zero_is_not_drawn_with_a_warning() {
    let mut model = Model::triangle();
    model.json["nodes"][0]["scale"] = json!([1, 0, 1]);
    let loaded = model.load().unwrap();
    let scene = &loaded.scene;
    assert!(scene.instances.is_empty());
    assert_warns(&loaded, "their scale is 0 along some direction, at nodes[0].mesh");
}

#[test]
fn child_that_stands_among_the_roots_is_placed_by_its_parent() {
    let mut model = Model::triangle();
    model.json["nodes"] = json!([{"mesh": 0}, {"children": [0], "translation": [5, 0, 0]}]);
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    let loaded = model.load().unwrap();
    let scene = &loaded.scene;
    assert_eq!(scene.instances.len(), 1);
    assert_eq!(scene.instances[0].transform.translation.x, 5.0);
    assert_warns(&loaded, "stand twice");
}

#[test]
fn a_node_that_is_not_visible_hides_all_that_hangs_on_it() {
    let mut model = Model::triangle();
    let visible = |visible| json!({"KHR_node_visibility": {"visible": visible}});
    model.json["extensionsUsed"] = json!(["KHR_node_visibility"]);
    model.json["nodes"] = json!([
        {"mesh": 0, "children": [1], "extensions": visible(false)},
        {"mesh": 0, "extensions": visible(true)},
        {"mesh": 0, "translation": [5, 0, 0], "extensions": visible(true)},
    ]);
    model.json["scenes"] = json!([{"nodes": [0, 2]}]);
    let Loaded { scene, report, .. } = model.load().unwrap();
    assert_eq!(report.warnings, [""; 0]);
    assert_eq!(scene.instances.len(), 1);
    assert_eq!(scene.instances[0].transform.translation, DVec3::new(5.0, 0.0, 0.0));
}

#[test]
fn extensions_of_what_is_not_seen_are_passed_over_also_where_they_are_required() {
    let mut model = Model::triangle();
    let names = json!(["OMI_physics_body", "EXT_structural_metadata", "KHR_audio_emitter"]);
    model.json["extensionsUsed"] = names.clone();
    model.json["extensionsRequired"] = names;
    let Loaded { report, .. } = model.load().unwrap();
    assert_eq!(report.warnings, [""; 0]);
}

#[test]
fn transforms_keep_the_digits_of_f64() {
    let mut model = Model::triangle();
    model.json["nodes"] = json!([
        {"children": [1], "translation": [388096.123, 5412345.75, 12.5]},
        {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.001, 0.1, 1e-9, 1]},
    ]);
    let place = model.load().unwrap().scene.instances[0].transform.translation;
    assert_eq!(place, DVec3::new(388096.123 + 0.001, 5412345.75 + 0.1, 12.5 + 1e-9));
}
