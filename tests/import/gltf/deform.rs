//! Morph targets, skins, and instances of one node.

use super::*;
use envers::Loaded;
use envers::scene::animation::Animated;
use glam::DVec3;
use serde_json::Value;

/// A triangle that can be morphed: by 1 along z, and by 2 along x.
fn morphing() -> Model {
    let mut model = Model::triangle();
    let up = model.floats("VEC3", &[0., 0., 1., 0., 0., 1., 0., 0., 1.]);
    let aside = model.floats("VEC3", &[2., 0., 0., 2., 0., 0., 2., 0., 0.]);
    model.primitive()["targets"] = json!([{"POSITION": up}, {"POSITION": aside}]);
    model
}

/// The first corner of the only mesh, at a time.
fn corner(scene: &Scene, time: f64) -> [f64; 3] {
    scene.at_time(time).unwrap().meshes[0].positions.at(0).to_array()
}

#[test]
fn a_mesh_is_morphed_by_its_own_weights() {
    let mut model = morphing();
    model.json["meshes"][0]["weights"] = json!([0.5, 1]);
    let Loaded { scene, report, .. } = model.load().unwrap();
    assert_eq!(scene.meshes[0].positions.at(0), DVec3::new(2.0, 0.0, 0.5));
    assert!(report.warnings.is_empty() && report.balances(), "{:?}", report.warnings);
}

#[test]
fn weights_of_a_node_come_before_those_of_its_mesh() {
    let mut model = morphing();
    model.json["meshes"][0]["weights"] = json!([1, 1]);
    model.json["nodes"] = json!([{"mesh": 0, "weights": [0, 0]}, {"mesh": 0}]);
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    let Loaded { scene, report, .. } = model.load().unwrap();
    let first = |mesh: usize| scene.meshes[mesh].positions.at(0).to_array();
    assert_eq!((first(0), first(1)), ([0.0; 3], [2.0, 0.0, 1.0]));
    assert!(report.balances(), "{}", report);
}

#[test]
fn normals_are_morphed_too() {
    let mut model = morphing();
    let normals = model.floats("VEC3", &[0., 0., 1., 0., 0., 1., 0., 0., 1.]);
    let turn = model.floats("VEC3", &[1., 0., 0., 1., 0., 0., 1., 0., 0.]);
    model.primitive()["attributes"]["NORMAL"] = normals.into();
    model.primitive()["targets"] = json!([{"NORMAL": turn}]);
    model.json["meshes"][0]["weights"] = json!([1]);
    assert_eq!(model.load().unwrap().scene.meshes[0].normals[0], [1.0, 0.0, 1.0]);
}

#[test]
fn morph_target_that_is_sparse() {
    let mut model = Model::triangle();
    let (one, up) = (model.view(&[1]), model.view(&[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 128, 63]));
    let sparse = json!({
        "count": 1,
        "indices": {"bufferView": one, "componentType": 5121},
        "values": {"bufferView": up},
    });
    let target = model
        .accessor(json!({"componentType": 5126, "type": "VEC3", "count": 3, "sparse": sparse}));
    model.primitive()["targets"] = json!([{"POSITION": target}]);
    model.json["meshes"][0]["weights"] = json!([1]);
    let positions = &model.load().unwrap().scene.meshes[0].positions;
    assert_eq!(*positions, [[0., 0., 0.], [1., 0., 1.], [0., 1., 0.]]);
}

#[test]
fn morph_target_of_another_length_is_an_error() {
    let mut model = morphing();
    let short = model.floats("VEC3", &[0.0; 6]);
    model.primitive()["targets"][1]["POSITION"] = short.into();
    let place = "meshes[0].primitives[0].targets[1].POSITION";
    assert_eq!(json_place(model.load()).0, place);
}

/// An animation of the node's weights: at times 0 and 1, or splines without slopes.
fn animate_weights(model: &mut Model, values: &[f32], interpolation: &str) {
    let times = model.floats("SCALAR", &[0., 1.]);
    let values = model.floats("SCALAR", values);
    let sampler = json!({"input": times, "output": values, "interpolation": interpolation});
    let target = json!({"node": 0, "path": "weights"});
    model.json["animations"] =
        json!([{"channels": [{"sampler": 0, "target": target}], "samplers": [sampler]}]);
}

#[test]
fn weights_move_in_straight_lines() {
    let mut model = morphing();
    animate_weights(&mut model, &[0., 0., 1., 0.5], "LINEAR");
    let scene = model.load().unwrap().scene;
    assert_eq!(corner(&scene, 0.0), [0.0; 3]);
    assert_eq!(corner(&scene, 0.5), [0.5, 0.0, 0.5]);
}

#[test]
fn weights_move_in_splines() {
    let mut model = morphing();
    let values = [0., 0., 0., 0., 0., 0., 0., 0., 1., 0.5, 0., 0.];
    animate_weights(&mut model, &values, "CUBICSPLINE");
    // With slopes of 0 a spline is at 5/32 a quarter of its way.
    assert_eq!(corner(&model.load().unwrap().scene, 0.25), [0.15625, 0.0, 0.15625]);
}

#[test]
fn weights_begin_again_with_the_animation() {
    let mut model = morphing();
    animate_weights(&mut model, &[0., 0., 1., 0.], "LINEAR");
    let scene = model.load().unwrap().scene;
    assert_eq!(corner(&scene, 3.25), corner(&scene, 0.25));
}

#[test]
fn a_mesh_that_keeps_its_shape_stays_the_same_one() {
    let mut model = morphing();
    animate_weights(&mut model, &[0., 0., 1., 0.], "STEP");
    let scene = model.load().unwrap().scene;
    let mut poses = envers::scene::animation::PosedScene::new(&scene);
    let first = poses.pose(0.25).unwrap().meshes[0].clone();
    let second = poses.pose(0.5).unwrap().meshes[0].clone();
    assert!(std::sync::Arc::ptr_eq(&first, &second));
}

#[test]
fn weights_for_another_number_of_targets_leave_the_channel_out() {
    let mut model = morphing();
    animate_weights(&mut model, &[0., 0., 1.], "LINEAR");
    let loaded = model.load().unwrap();
    let scene = &loaded.scene;
    assert!(scene.animation.is_none());
    assert_warns(&loaded, "animation channels are left out");
}

/// A triangle of which one corner hangs on each of three joints, which stand at `places`.
fn skinned(places: [[f32; 3]; 3]) -> Model {
    let mut model = Model::triangle();
    let joints = model.typed(5121, "VEC4", 1, &[0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    let weights = model.floats("VEC4", &[1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0.]);
    model.primitive()["attributes"]["JOINTS_0"] = joints.into();
    model.primitive()["attributes"]["WEIGHTS_0"] = weights.into();
    let joint = |p: [f32; 3]| json!({"translation": p});
    let mut nodes = vec![json!({"mesh": 0, "skin": 0, "translation": [100, 0, 0]})];
    nodes.extend(places.map(joint));
    model.json["nodes"] = nodes.into();
    model.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    model.json["skins"] = json!([{"joints": [1, 2, 3]}]);
    model
}

/// The corners of the triangle as it stands in the world.
fn deformed_positions(scene: &Scene) -> [[f64; 3]; 3] {
    let instance = &scene.instances[0];
    let mesh = &scene.meshes[instance.mesh.0 as usize];
    std::array::from_fn(|i| instance.to_world(mesh.positions.at(i)).to_array())
}

#[test]
fn a_skin_stands_where_its_joints_are_and_not_its_node() {
    let Loaded { scene, report, .. } =
        skinned([[0., 0., 5.], [0., 0., 6.], [0., 0., 7.]]).load().unwrap();
    assert_eq!(deformed_positions(&scene), [[0., 0., 5.], [1., 0., 6.], [0., 1., 7.]]);
    assert!(report.warnings.is_empty() && report.balances(), "{:?}", report.warnings);
}

#[test]
fn bind_matrices_bring_vertices_to_their_joints() {
    let mut model = skinned([[0., 0., 5.]; 3]);
    let down = glam::Mat4::from_translation(-Vec3::Z).to_cols_array();
    let binds = model.floats("MAT4", &[down; 3].concat());
    model.accessor_mut(binds)["count"] = 3.into();
    model.json["skins"][0]["inverseBindMatrices"] = binds.into();
    assert_eq!(deformed_positions(&model.load().unwrap().scene)[0], [0., 0., 4.]);
}

#[test]
fn joints_that_no_scene_shows_are_posed_even_so() {
    let mut model = skinned([[0., 0., 5.]; 3]);
    model.json["scenes"][0]["nodes"] = json!([0]);
    assert_eq!(deformed_positions(&model.load().unwrap().scene)[0], [0., 0., 5.]);
}

fn animate_joint(model: &mut Model) {
    let times = model.floats("SCALAR", &[0., 1.]);
    let values = model.floats("VEC3", &[0., 0., 0., 0., 0., 8.]);
    let target = json!({"node": 2, "path": "translation"});
    model.json["animations"] = json!([{
        "channels": [{"sampler": 0, "target": target}],
        "samplers": [{"input": times, "output": values}],
    }]);
}

#[test]
fn a_skin_moves_with_its_joints() {
    let mut model = skinned([[0.; 3]; 3]);
    animate_joint(&mut model);
    let scene = model.load().unwrap().scene;
    let moved = deformed_positions(&scene.at_time(0.5).unwrap());
    assert_eq!(moved, [[0., 0., 0.], [1., 0., 4.], [0., 1., 0.]]);
}

#[test]
fn a_skin_moves_where_a_scene_places_it() {
    let folder = Folder::new();
    let mut model = skinned([[0.; 3]; 3]);
    animate_joint(&mut model);
    folder.write("m.glb", model.glb());
    let scene = r#"
        [animation]
        frames = 24
        fps = 24
        [[model]]
        file = "m.glb"
        translate = [10, 0, 0]
        scale = 2
        [[model]]
        file = "m.glb"
        translate = [0, 0, 3]
    "#;
    let scene = folder.load("s.toml", scene).unwrap().scene;
    let movers = scene.animation.as_ref().unwrap().objects.iter();
    assert_eq!(movers.filter(|m| matches!(m, Animated::Mesh { .. })).count(), 1);
    let posed = scene.at_time(0.5).unwrap();
    assert_eq!(deformed_positions(&posed)[1], [12., 0., 8.]);
    let second = &posed.instances[1];
    let corner = posed.meshes[second.mesh.0 as usize].positions.at(1);
    assert_eq!(second.to_world(corner).to_array(), [1., 0., 7.]);
}

#[test]
fn a_skin_in_a_scene_without_animation_stands_as_its_file_places_it() {
    let folder = Folder::new();
    let mut model = skinned([[0., 0., 5.]; 3]);
    animate_joint(&mut model);
    folder.write("m.glb", model.glb());
    let scene = folder.load("s.toml", "[[model]]\nfile = \"m.glb\"\n").unwrap().scene;
    assert_eq!(deformed_positions(&scene)[0], [0., 0., 5.]);
}

#[test]
fn joint_that_is_not_there() {
    let mut model = skinned([[0.; 3]; 3]);
    model.json["skins"][0]["joints"] = json!([1, 2, 9]);
    assert_eq!(json_place(model.load()).0, "skins[0].joints[2]");
}

#[test]
fn skin_that_is_not_there() {
    let mut model = skinned([[0.; 3]; 3]);
    model.json["nodes"][0]["skin"] = 4.into();
    assert_eq!(json_place(model.load()).0, "nodes[0].skin");
}

#[test]
fn fewer_bind_matrices_than_joints() {
    let mut model = skinned([[0.; 3]; 3]);
    let binds = model.floats("MAT4", &[0.0; 32]);
    model.accessor_mut(binds)["count"] = 2.into();
    model.json["skins"][0]["inverseBindMatrices"] = binds.into();
    assert_eq!(json_place(model.load()).0, "skins[0].inverseBindMatrices");
}

#[test]
fn vertices_without_weights_are_counted() {
    let mut model = skinned([[0., 0., 5.]; 3]);
    let weights = model.floats("VEC4", &[0.0; 12]);
    model.primitive()["attributes"]["WEIGHTS_0"] = weights.into();
    assert_warns(&model.load().unwrap(), "3 vertices have no weight at any joint");
}

/// A triangle that stands as often as its node's extension says.
fn instanced(attributes: Value) -> Model {
    let mut model = Model::triangle();
    model.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
    model
}

#[test]
fn one_node_has_many_instances() {
    let mut model = instanced(json!({}));
    let places = model.floats("VEC3", &[1., 0., 0., 0., 2., 0.]);
    let scales = model.floats("VEC3", &[1., 1., 1., 3., 3., 3.]);
    let attributes = json!({"TRANSLATION": places, "SCALE": scales});
    model.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
    model.json["nodes"][0]["translation"] = json!([0, 0, 1]);
    let scene = model.load().unwrap().scene;
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2));
    let corner = |i: usize| scene.instances[i].to_world([1.0, 0.0, 0.0]).to_array();
    assert_eq!((corner(0), corner(1)), ([2., 0., 1.], [3., 2., 1.]));
}

#[test]
fn instances_have_their_own_colours() {
    let places: Vec<f32> = (0..4).flat_map(|i| [i as f32, 0.0, 0.0]).collect();
    let colored = |name: &str, width: &str, colors: &[f32], material: serde_json::Value| {
        let mut model = instanced(json!({}));
        model.material(material);
        let (places, colors) = (model.floats("VEC3", &places), model.floats(width, colors));
        let attributes = json!({"TRANSLATION": places, name: colors});
        model.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
        let loaded = model.load().unwrap();
        assert_eq!(loaded.report.warnings, [""; 0]);
        loaded.scene
    };
    let base =
        json!({"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 1, 1], "metallicFactor": 0}});
    let three = [1., 1., 1., 1., 0., 0., 0., 1., 0., 1., 0., 0.];
    for name in ["_COLOR_0", "COLOR_0"] {
        let scene = colored(name, "VEC3", &three, base.clone());
        let color =
            |i: usize| scene.materials[scene.instances[i].material.0 as usize].diffuse.to_array();
        assert_eq!([0, 1, 2].map(color), [[1., 0.5, 1.], [1., 0., 0.], [0., 0.5, 0.]]);
        assert_eq!(
            (color(3), scene.materials.len()),
            (color(1), 3),
            "equal colours share a material"
        );
    }
    // An unlit one, a metal, and an alpha.
    let mut unlit = base.clone();
    unlit["extensions"] = json!({"KHR_materials_unlit": {}});
    let scene = colored("_COLOR_0", "VEC3", &three, unlit);
    assert_eq!(scene.materials[1].emission.to_array(), [1., 0., 0.]);
    let metal = json!({"pbrMetallicRoughness": {"roughnessFactor": 0.5}, "alphaMode": "BLEND"});
    let four = [0.5, 0., 0., 0.25].repeat(4);
    let scene = colored("_COLOR_0", "VEC4", &four, metal);
    let material = &scene.materials[1];
    assert_eq!(material.metallic.as_ref().unwrap().factors.base_color.to_array(), [0.5, 0., 0.]);
    assert_eq!(material.coverage.unwrap().alpha, 0.25);
}

#[test]
fn instances_of_unequal_number_are_an_error() {
    let mut model = instanced(json!({}));
    let places = model.floats("VEC3", &[0.0; 6]);
    let scales = model.floats("VEC3", &[1.0; 9]);
    let attributes = json!({"TRANSLATION": places, "SCALE": scales});
    model.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
    let (place, _) = json_place(model.load());
    assert!(place.starts_with("nodes[0].extensions.EXT_mesh_gpu_instancing"), "{place}");
}
