//! glTF files with skins, morph targets, instances and shapes that ask for much or make no sense.

use serde_json::{Value, json};

use super::gltf::changed;
use super::{Case, Error, Expect};
use envers_testing::Model;

/// An accessor without a view.
fn zeros(model: &mut Model, kind: &str, component: u32, count: u64) -> usize {
    model.accessor(json!({"componentType": component, "type": kind, "count": count}))
}

/// Adds `count` vertices, in squares.
fn squares(model: &mut Model, count: usize) -> usize {
    let square = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.];
    model.floats("VEC3", &square.repeat(count / 4))
}

/// The first node, so many times.
fn nodes(model: &mut Model, count: usize, node: impl Fn(usize) -> Value) {
    model.json["nodes"] = (0..count).map(node).collect();
    model.json["scenes"][0]["nodes"] = (0..count).collect();
}

const FIRST: [u8; 12] = [0; 12];
const WHOLE: [f32; 12] = [1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0.];

/// The triangle in a skin.
fn skinned(name: &str, joints: [u8; 12], weights: [f32; 12], skin: Value) -> Case {
    changed(name, Expect::Any, move |m| {
        let joints = m.typed(5121, "VEC4", 1, &joints);
        let weights = m.floats("VEC4", &weights);
        m.primitive()["attributes"]["JOINTS_0"] = joints.into();
        m.primitive()["attributes"]["WEIGHTS_0"] = weights.into();
        m.json["nodes"][0]["skin"] = 0.into();
        m.json["skins"] = json!([skin]);
    })
}

fn morphed(name: &str, targets: Value, weights: Value) -> Case {
    changed(name, Expect::Any, move |m| {
        m.primitive()["targets"] = targets;
        m.json["meshes"][0]["weights"] = weights;
    })
}

fn instances(model: &mut Model, attributes: Value) {
    model.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    model.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
}

fn shape(name: &str, shape: Value) -> Case {
    changed(name, Expect::Any, move |m| {
        m.json["extensionsUsed"] = json!(["KHR_implicit_shapes"]);
        m.json["extensions"] = json!({"KHR_implicit_shapes": {"shapes": [shape]}});
        m.json["nodes"][0]["extensions"] = json!({"KHR_implicit_shapes": {"shape": 0}});
    })
}

pub fn cases() -> Vec<Case> {
    let sphere = |radius: Value| json!({"type": "sphere", "sphere": {"radius": radius}});
    let joints = |joints: Value| json!({"joints": joints});
    let same = json!([{"POSITION": 0}]);
    vec![
        skinned("skin without joints", FIRST, WHOLE, joints(json!([]))),
        skinned("skin whose joints are not there", FIRST, WHOLE, joints(json!([7]))),
        skinned("skin of joints it does not have", [255; 12], WHOLE, joints(json!([0]))),
        skinned("skin of weights that are no numbers", FIRST, [f32::NAN; 12], joints(json!([0]))),
        skinned("skin of weights that are 0", FIRST, [0.0; 12], joints(json!([0]))),
        skinned("skin of weights beyond numbers", FIRST, [f32::MAX; 12], joints(json!([0]))),
        skinned(
            "skin of matrices that are not there",
            FIRST,
            WHOLE,
            json!({"joints": [0], "inverseBindMatrices": 99}),
        ),
        changed("2000 nodes that each skin 100000 vertices", Expect::Any, |m| {
            let positions = squares(m, 100_000);
            let joints = zeros(m, "VEC4", 5121, 100_000);
            let weights = zeros(m, "VEC4", 5126, 100_000);
            *m.primitive() = json!({"attributes":
                {"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights}});
            m.json["skins"] = json!([{"joints": [0]}]);
            nodes(m, 2000, |_| json!({"mesh": 0, "skin": 0}));
        }),
        morphed("65536 targets of nothing", vec![json!({}); 1 << 16].into(), json!([1])),
        morphed(
            "100000 targets of itself",
            vec![json!({"POSITION": 0}); 100_000].into(),
            json!([1]),
        ),
        morphed("fewer targets than weights", same.clone(), vec![1.0; 100_000].into()),
        morphed("morph weights beyond all numbers", same.clone(), json!([1e38, -1e38])),
        morphed("morph weights that are text", same, json!(["1"])),
        changed("2000 nodes that each morph 100000 vertices", Expect::Any, |m| {
            let positions = squares(m, 100_000);
            *m.primitive() = json!({"attributes": {"POSITION": positions},
                "targets": [{"POSITION": positions}]});
            nodes(m, 2000, |i| json!({"mesh": 0, "weights": [0.001 * (i + 1) as f64]}));
        }),
        changed("2^20 + 1 instances without a view", Error("instances"), |m| {
            let moves = zeros(m, "VEC3", 5126, (1 << 20) + 1);
            instances(m, json!({"TRANSLATION": moves}));
        }),
        changed("2000 nodes of 2000 instances", Error("`--limit instances="), |m| {
            let moves = zeros(m, "VEC3", 5126, 2000);
            instances(m, json!({"TRANSLATION": moves}));
            let node = m.json["nodes"][0].clone();
            nodes(m, 2000, |_| node.clone());
        }),
        changed("instances turned by nothing", Expect::Any, |m| {
            let turns = zeros(m, "VEC4", 5126, 9);
            instances(m, json!({"ROTATION": turns}));
        }),
        changed("instances at places that are no numbers", Expect::Any, |m| {
            let moves = m.floats("VEC3", &[f32::NAN; 9]);
            instances(m, json!({"TRANSLATION": moves}));
        }),
        changed("instances by a list", Expect::Any, |m| instances(m, json!([]))),
        shape("sphere of no radius", sphere(json!(0))),
        shape("sphere of a negative radius", sphere(json!(-1))),
        shape("sphere larger than the world", sphere(json!(1e300))),
        shape("sphere whose radius is text", sphere(json!("1"))),
        shape("shape without a type", json!({})),
        shape("shape that is a list", json!([])),
    ]
}
