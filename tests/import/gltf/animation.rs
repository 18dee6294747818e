//! A file's own animation: rigid nodes, and what is said where its data is damaged.

use super::*;
use envers::{LightKind, Loaded};
use glam::DVec3;
use serde_json::Value;

/// A triangle whose node is animated by one channel.
fn animated(path: &str, kind: &str, times: &[f32], values: &[f32], interpolation: &str) -> Model {
    let mut model = Model::triangle();
    channel(&mut model, 0, path, kind, times, values, interpolation);
    model
}

/// Adds a channel to the file's only animation.
fn channel(
    model: &mut Model,
    node: usize,
    path: &str,
    kind: &str,
    times: &[f32],
    values: &[f32],
    interpolation: &str,
) {
    let (input, output) = (model.floats("SCALAR", times), model.floats(kind, values));
    let animations = &mut model.json["animations"];
    if animations.is_null() {
        *animations = json!([{"channels": [], "samplers": []}]);
    }
    let push = |list: &mut Value, value: Value| list.as_array_mut().unwrap().push(value);
    let sampler = animations[0]["samplers"].as_array().unwrap().len();
    push(
        &mut animations[0]["samplers"],
        json!({"input": input, "output": output, "interpolation": interpolation}),
    );
    let target = json!({"node": node, "path": path});
    push(&mut animations[0]["channels"], json!({"sampler": sampler, "target": target}));
}

/// Returns the place, at a time, of a point of the first instance's mesh.
fn at(scene: &Scene, time: f64, point: [f64; 3]) -> DVec3 {
    scene.at_time(time).unwrap().instances[0].to_world(point)
}

fn near(a: DVec3, b: [f64; 3]) -> bool {
    (a - DVec3::from(b)).length() < 1e-6
}

#[test]
fn linear_translation_is_a_straight_line() {
    let model = animated("translation", "VEC3", &[0., 2.], &[0., 0., 0., 4., 0., 2.], "LINEAR");
    assert!(near(at(&model.load().unwrap().scene, 0.5, [0.; 3]), [1., 0., 0.5]));
}

#[test]
fn step_translation_stays_until_the_next_key() {
    let model = animated("translation", "VEC3", &[0., 2.], &[0., 0., 0., 4., 0., 2.], "STEP");
    assert!(near(at(&model.load().unwrap().scene, 1.9, [0.; 3]), [0.; 3]));
}

#[test]
fn spline_has_its_tangents_before_and_after_each_value() {
    // x = t³ − t: values 0 and 6, slopes −1 at 0 and 11 at 2.
    let values = [0., 0., 0., 0., 0., 0., -1., 0., 0., 11., 0., 0., 6., 0., 0., 0., 0., 0.];
    let model = animated("translation", "VEC3", &[0., 2.], &values, "CUBICSPLINE");
    let scene = model.load().unwrap().scene;
    for t in [0.25, 1.0, 1.5] {
        assert!(near(at(&scene, t, [0.; 3]), [t * t * t - t, 0., 0.]), "{t}");
    }
}

#[test]
fn rotation_goes_along_the_sphere() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let quarter = [0., 0., 0., 1., 0., 0., half, half];
    let model = animated("rotation", "VEC4", &[0., 3.], &quarter, "LINEAR");
    let (sin, cos) = (std::f64::consts::FRAC_PI_2 / 3.0).sin_cos();
    assert!(near(at(&model.load().unwrap().scene, 1.0, [1., 0., 0.]), [cos, sin, 0.]));
}

#[test]
fn scale_comes_before_what_the_node_itself_says_of_the_rest() {
    let mut model = animated("scale", "VEC3", &[0., 1.], &[1., 1., 1., 3., 3., 3.], "LINEAR");
    model.json["nodes"][0]["translation"] = json!([10, 0, 0]);
    assert!(near(at(&model.load().unwrap().scene, 0.5, [1., 0., 0.]), [12., 0., 0.]));
}

#[test]
fn a_child_moves_with_its_parent() {
    let mut model = animated("translation", "VEC3", &[0., 1.], &[0., 0., 0., 0., 4., 0.], "LINEAR");
    model.json["nodes"] =
        json!([{"children": [1], "scale": [2, 2, 2]}, {"mesh": 0, "translation": [1, 0, 0]}]);
    assert!(near(at(&model.load().unwrap().scene, 0.5, [0.; 3]), [2., 2., 0.]));
}

#[test]
fn a_light_and_a_camera_move_with_their_node() {
    let mut model = animated("translation", "VEC3", &[0., 1.], &[0., 0., 0., 0., 4., 0.], "LINEAR");
    let lights = json!({"lights": [{"type": "point"}]});
    model.json["extensions"] = json!({"KHR_lights_punctual": lights});
    model.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    model.json["cameras"] =
        json!([{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}]);
    model.json["nodes"][0]["camera"] = 0.into();
    model.json["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    let scene = model.load().unwrap().scene.at_time(0.5).unwrap();
    assert!(near(scene.cameras[0].position, [0., 2., 0.]));
    let LightKind::Point { position, .. } = scene.lights[0].kind else { panic!("a point light") };
    assert!(near(position, [0., 2., 0.]));
}

#[test]
fn a_bare_model_has_the_frames_of_its_animation_at_24_a_second() {
    let model = animated("translation", "VEC3", &[0., 2.5], &[0.; 6], "LINEAR");
    let animation = model.load().unwrap().scene.animation.unwrap();
    assert_eq!((animation.frames, animation.fps), (60, 24.0));
}

#[test]
fn an_animation_of_years_has_as_many_frames_as_can_be() {
    let model = animated("translation", "VEC3", &[0., 1e30], &[0.; 6], "LINEAR");
    assert_eq!(model.load().unwrap().scene.animation.unwrap().frames, 1_000_000);
}

#[test]
fn the_first_animation_is_played() {
    let mut model = animated("translation", "VEC3", &[0., 1.], &[0., 0., 0., 2., 0., 0.], "LINEAR");
    let mut second = model.json["animations"][0].clone();
    second["channels"] = json!([]);
    model.json["animations"].as_array_mut().unwrap().push(second);
    assert!(near(at(&model.load().unwrap().scene, 0.5, [0.; 3]), [1., 0., 0.]));
}

#[test]
fn what_is_flat_at_one_time_is_not_there_then() {
    let scale = [0., 0., 0., 1., 1., 1.];
    let mut model = animated("scale", "VEC3", &[0., 1.], &scale, "LINEAR");
    model.json["nodes"][0]["scale"] = json!([0, 0, 0]);
    let scene = model.load().unwrap().scene;
    let there = |time| scene.at_time(time).unwrap().instances.len();
    assert_eq!([0.0, 0.5].map(there), [0, 1]);
}

#[test]
fn a_channel_of_an_extension_without_a_node_is_passed_over() {
    let mut model = animated("translation", "VEC3", &[0., 1.], &[0., 0., 0., 2., 0., 0.], "LINEAR");
    let pointer = json!({"sampler": 0, "target": {"path": "pointer", "extensions": {}}});
    model.json["animations"][0]["channels"].as_array_mut().unwrap().insert(0, pointer);
    assert!(near(at(&model.load().unwrap().scene, 0.5, [0.; 3]), [1., 0., 0.]));
}

/// The model loads, stands still, and says so once.
#[track_caller]
fn assert_left_out(model: &Model) {
    let loaded = model.load().unwrap();
    let scene = &loaded.scene;
    assert_warns(&loaded, "animation channels are left out");
    assert_eq!((&scene.animation, scene.instances.len()), (&None, 1));
}

#[test]
fn times_that_do_not_increase_are_left_out() {
    for times in [[1., 1.], [2., 1.], [0., f32::NAN], [0., f32::INFINITY]] {
        assert_left_out(&animated("translation", "VEC3", &times, &[0.; 6], "LINEAR"));
    }
}

#[test]
fn more_or_fewer_values_than_times_are_left_out() {
    for count in [3, 9] {
        let values = vec![0.0; count];
        assert_left_out(&animated("translation", "VEC3", &[0., 1.], &values, "LINEAR"));
    }
    assert_left_out(&animated("translation", "VEC3", &[0., 1.], &[0.; 12], "CUBICSPLINE"));
}

#[test]
fn values_that_are_not_finite_or_no_rotations_are_left_out() {
    let nan = [0., 0., f32::NAN, 0., 0., 0.];
    assert_left_out(&animated("translation", "VEC3", &[0., 1.], &nan, "LINEAR"));
    assert_left_out(&animated("rotation", "VEC4", &[0., 1.], &[0.; 8], "LINEAR"));
}

#[test]
fn values_of_another_type_are_left_out() {
    assert_left_out(&animated("rotation", "VEC3", &[0., 1.], &[0.; 6], "LINEAR"));
    assert_left_out(&animated("translation", "VEC3", &[0., 1.], &[0.; 6], "BEZIER"));
}

#[test]
fn references_that_lead_nowhere_are_left_out() {
    type Change = fn(&mut Value);
    let changes: [Change; 4] = [
        |animation| animation["channels"][0]["sampler"] = 9.into(),
        |animation| animation["channels"][0]["target"]["node"] = 9.into(),
        |animation| animation["samplers"][0]["input"] = 9.into(),
        |animation| animation["samplers"][0]["output"] = 9.into(),
    ];
    for change in changes {
        let mut model = animated("translation", "VEC3", &[0., 1.], &[0.; 6], "LINEAR");
        change(&mut model.json["animations"][0]);
        assert_left_out(&model);
    }
}

#[test]
fn a_node_with_a_matrix_stands_still() {
    let mut model = animated("translation", "VEC3", &[0., 1.], &[0.; 6], "LINEAR");
    model.json["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    assert_left_out(&model);
}

#[test]
fn the_same_keys_named_a_million_times_take_no_memory() {
    let times: Vec<f32> = (0..100_000).map(|i| i as f32).collect();
    let mut model = animated("translation", "VEC3", &times, &vec![0.0; 300_000], "LINEAR");
    let nodes: Vec<Value> = (0..100).map(|_| json!({})).collect();
    model.json["nodes"].as_array_mut().unwrap().extend(nodes);
    let channels = model.json["animations"][0]["channels"].as_array_mut().unwrap();
    for node in 1..=100 {
        let target = json!({"node": node, "path": "translation"});
        channels.push(json!({"sampler": 0, "target": target}));
    }
    assert_warns(&model.load().unwrap(), "the limit of 4194304");
}

/// Loads a scene file beside an animated model that rises by 4 in a second.
fn scene_file(text: &str, name: Option<&str>) -> envers::Result<Loaded> {
    let mut model = animated("translation", "VEC3", &[0., 1.], &[0., 0., 0., 0., 4., 0.], "LINEAR");
    let mut still = model.json["animations"][0].clone();
    still["channels"] = json!([]);
    model.json["animations"].as_array_mut().unwrap().insert(0, still);
    model.json["animations"][1]["name"] = json!("rise");
    let folder = Folder::new();
    folder.write("m.glb", model.glb());
    let named = name.map(|name| format!("animation = \"{name}\"\n")).unwrap_or_default();
    let placed = "[[model]]\nname = \"m\"\nfile = \"m.glb\"\ntranslate = [10, 0, 0]\nscale = 2\n";
    folder.load("scene.toml", format!("{placed}{named}{text}"))
}

const FRAMES: &str = "[animation]\nframes = 24\n";

#[test]
fn a_scene_file_plays_the_animation_that_it_names_where_it_places_the_model() {
    let scene = scene_file(FRAMES, Some("rise")).unwrap().scene;
    assert!(near(at(&scene, 0.5, [1., 0., 0.]), [12., 4., 0.]));
}

#[test]
fn a_model_that_moves_by_itself_goes_round_as_well() {
    let orbit = "[[animation.orbit]]\nobject = \"m\"\naround = [0, 0, 0]\nperiod = 2\n";
    let scene = scene_file(&format!("{FRAMES}{orbit}"), Some("rise")).unwrap().scene;
    assert!(near(at(&scene, 0.5, [0.; 3]), [0., 4., -10.]));
}

#[test]
fn a_models_animation_begins_again_in_a_longer_one() {
    let scene = scene_file(FRAMES, Some("rise")).unwrap().scene;
    assert_eq!(at(&scene, 3.25, [0.; 3]), at(&scene, 0.25, [0.; 3]));
}

#[test]
fn a_scene_file_without_animation_plays_none_and_says_so() {
    let loaded = scene_file("", Some("rise")).unwrap();
    let scene = &loaded.scene;
    assert_warns(&loaded, "its animation is not played");
    assert_eq!(scene.animation, None);
}

#[test]
fn an_animation_that_the_model_has_not_is_refused_with_those_that_it_has() {
    let error = scene_file(FRAMES, Some("walk")).map(|_| ()).unwrap_err();
    assert_eq!(error.message(), "there is no animation `walk`");
    assert_eq!(error.advice(), Some("the animations are `rise`"));
}
