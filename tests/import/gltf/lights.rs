//! Lights, cameras, and what stands still.

use envers::{LightKind, Loaded, Projection};
use std::f32::consts::PI;

use glam::DVec3;

use super::*;

fn with_light(light: serde_json::Value, node: serde_json::Value) -> Scene {
    let mut model = Model::triangle();
    model.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
    model.json["nodes"] = json!([{"mesh": 0}, node]);
    model.json["nodes"][1]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    model.load().unwrap().scene
}

/// Counts the lights that are the file's own: a bare model gets a little ambient light besides.
fn own_lights(scene: &Scene) -> usize {
    scene.lights.iter().filter(|light| light.kind != LightKind::Ambient).count()
}

#[test]
fn point_light_in_candela_is_divided_by_pi() {
    let light = json!({"type": "point", "color": [1.0, 0.5, 0.0], "intensity": 20.0, "range": 3});
    let scene = with_light(light, json!({"translation": [1, 2, 3]}));
    assert_eq!(own_lights(&scene), 1);
    assert!(close(scene.lights[0].intensity, [20.0 / PI, 10.0 / PI, 0.0]));
    let LightKind::Point { position, range, .. } = scene.lights[0].kind else { panic!() };
    assert_eq!((position, range), (DVec3::new(1., 2., 3.), 3.0));
}

#[test]
fn directional_light_travels_along_its_nodes_minus_z() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let node = json!({"rotation": [-half, 0, 0, half], "scale": [3, 3, 3]});
    let scene = with_light(json!({"type": "directional"}), node);
    let LightKind::Directional { direction, .. } = scene.lights[0].kind else { panic!() };
    assert!((direction - DVec3::NEG_Y).length() < 1e-7, "{direction}");
}

#[test]
fn spot_has_its_cone() {
    let spot = json!({"innerConeAngle": 0.2, "outerConeAngle": 0.3});
    let scene = with_light(json!({"type": "spot", "spot": spot}), json!({}));
    let LightKind::Spot { inner_angle, outer_angle, .. } = scene.lights[0].kind else { panic!() };
    assert!((inner_angle - 0.2).abs() < 1e-7 && (outer_angle - 0.3).abs() < 1e-7);
}

#[test]
fn spot_of_any_cone_is_valid() {
    let half = std::f64::consts::FRAC_PI_2;
    for (inner, outer) in [(0.0, half), (half, half), (0.5, 0.2), (-1.0, 9.0), (0.0, 0.0)] {
        let spot = json!({"innerConeAngle": inner, "outerConeAngle": outer});
        let scene = with_light(json!({"type": "spot", "spot": spot}), json!({}));
        assert_eq!(own_lights(&scene), 1);
    }
}

fn with_camera(camera: serde_json::Value) -> Scene {
    load_with_camera(camera).scene
}

fn load_with_camera(camera: serde_json::Value) -> Loaded {
    let mut model = Model::triangle();
    model.json["cameras"] = json!([camera]);
    model.json["nodes"] =
        json!([{"mesh": 0}, {"camera": 0, "translation": [0, 0, 9], "scale": [2, 2, 2]}]);
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    model.load().unwrap()
}

#[test]
fn perspective_camera_looks_along_its_nodes_minus_z() {
    let scene = with_camera(
        json!({"type": "perspective", "name": "eye", "perspective": {"yfov": 0.5, "znear": 1}}),
    );
    let camera = &scene.cameras[0];
    assert_eq!((camera.name.as_str(), camera.projection), ("eye", Projection::FovY(0.5)));
    assert_eq!((camera.position, camera.forward), (DVec3::Z * 9.0, DVec3::NEG_Z));
    assert_eq!((camera.right, camera.up), (DVec3::X, DVec3::Y));
}

#[test]
fn orthographic_camera_sees_twice_its_ymag() {
    let lens = json!({"xmag": 1, "ymag": 1.5, "znear": 0.1, "zfar": 10});
    let scene = with_camera(json!({"type": "orthographic", "orthographic": lens}));
    assert_eq!(scene.cameras[0].projection, Projection::OrthoHeight(3.0));
}

#[test]
fn camera_that_cannot_see_is_left_out_with_a_warning() {
    let loaded =
        load_with_camera(json!({"type": "perspective", "perspective": {"yfov": 7.0, "znear": 1}}));
    assert_eq!(loaded.scene.cameras[0].name, "framing");
    assert_warns(&loaded, "cameras[0]");
}
