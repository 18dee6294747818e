//! KHR_implicit_shapes: a node shows the shape that it names.

use super::*;
use envers::Loaded;
use glam::DVec3;
use serde_json::Value;

/// A file of one node that shows one shape.
fn shown(shape: Value) -> Model {
    let mut model = Model::new();
    model.json.as_object_mut().unwrap().remove("meshes");
    model.json["extensions"]["KHR_implicit_shapes"]["shapes"] = json!([shape]);
    model.json["nodes"] = json!([{"extensions": {"KHR_implicit_shapes": {"shape": 0}}}]);
    model
}

fn sphere() -> Model {
    shown(json!({"type": "sphere", "sphere": {"radius": 2}}))
}

#[test]
fn a_sphere_is_a_real_one() {
    let mut model = sphere();
    model.json["nodes"][0]["translation"] = json!([1, 2, 3]);
    model.json["nodes"][0]["scale"] = json!([3, 3, 3]);
    let Loaded { scene, report, .. } = model.load().unwrap();
    let [sphere] = &scene.spheres[..] else { panic!("{:?}", scene.spheres) };
    assert_eq!((sphere.center, sphere.radius), (DVec3::new(1., 2., 3.), 6.0));
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
}

#[test]
fn a_sphere_has_the_material_beside_it() {
    let mut model = sphere();
    model.json["materials"] = json!([{}, {"name": "gold"}]);
    model.json["nodes"][0]["extensions"]["KHR_implicit_shapes"]["material"] = 1.into();
    let scene = model.load().unwrap().scene;
    assert_eq!(scene.materials[scene.spheres[0].material.0 as usize].name, "gold");
}

#[test]
fn a_sphere_that_is_scaled_unevenly_is_a_mesh() {
    let mut model = sphere();
    model.json["nodes"][0]["scale"] = json!([1, 2, 1]);
    let Loaded { scene, report, .. } = model.load().unwrap();
    assert_eq!((scene.spheres.len(), scene.instances.len()), (0, 1));
    let bounds = scene.bounds();
    assert!((bounds.upper - DVec3::new(2., 4., 2.)).length() < 1e-6, "{bounds:?}");
    assert!(report.balances(), "{}", report);
}

#[test]
fn a_plane_is_infinite_and_faces_the_nodes_y() {
    let mut model = shown(json!({"type": "plane", "plane": {}}));
    let half = std::f64::consts::FRAC_1_SQRT_2;
    model.json["nodes"][0]["rotation"] = json!([0, 0, half, half]);
    model.json["nodes"][0]["translation"] = json!([5, 0, 0]);
    let scene = model.load().unwrap().scene;
    let plane = &scene.planes[0];
    assert!((plane.normal + DVec3::X).length() < 1e-6, "{}", plane.normal);
    assert_eq!(plane.point, DVec3::X * 5.0);
}

#[test]
fn boxes_cylinders_and_capsules_are_meshes() {
    let shapes = [
        json!({"type": "box", "box": {"size": [2, 4, 2]}}),
        json!({"type": "cylinder", "cylinder": {"height": 4, "radiusTop": 1, "radiusBottom": 1}}),
        json!({"type": "capsule", "capsule": {"height": 2, "radiusTop": 1, "radiusBottom": 1}}),
    ];
    for shape in shapes {
        let bounds = shown(shape).load().unwrap().scene.bounds();
        assert!((bounds.upper - DVec3::new(1., 2., 1.)).length() < 1e-6, "{bounds:?}");
    }
}

#[test]
fn shapes_stand_where_a_scene_places_them() {
    let folder = Folder::new();
    folder.write("m.gltf", sphere().to_json(None).to_string());
    let placed = "[[model]]\nfile = \"m.gltf\"\ntranslate = [1, 0, 0]\nscale = 2\n";
    let scene = folder.load("s.toml", placed).unwrap().scene;
    assert_eq!((scene.spheres[0].center, scene.spheres[0].radius), (DVec3::X, 4.0));
}

#[test]
fn shape_that_is_not_there() {
    let mut model = sphere();
    model.json["nodes"][0]["extensions"]["KHR_implicit_shapes"]["shape"] = 3.into();
    let place = "nodes[0].extensions.KHR_implicit_shapes.shape";
    assert_eq!(json_place(model.load()).0, place);
}

#[test]
fn shape_of_no_known_type() {
    let (place, text) = json_place(shown(json!({"type": "teapot"})).load());
    assert_eq!(place, "extensions.KHR_implicit_shapes.shapes[0]");
    assert!(text.contains("teapot"), "{text}");
}
