//! Faults of accessors, meshes, references and nodes.

use super::*;

#[test]
fn accessor_past_its_view() {
    for (key, value) in
        [("count", json!(4)), ("byteOffset", json!(4)), ("byteOffset", json!(u64::MAX))]
    {
        let mut model = Model::triangle();
        model.accessor_mut(0)[key] = value;
        assert_eq!(json_place(model.load()).0, "accessors[0]");
    }
}

#[test]
fn accessor_with_a_count_beyond_all_memory() {
    let mut model = Model::triangle();
    model.accessor_mut(0)["count"] = u64::MAX.into();
    assert_eq!(json_place(model.load()).0, "accessors[0].count");
}

#[test]
fn sparse_accessor_without_a_view_and_with_four_billion_elements() {
    let mut model = Model::triangle();
    let zero = model.view(&[0; 12]);
    let sparse = json!({
        "count": 1,
        "indices": {"bufferView": zero, "componentType": 5121},
        "values": {"bufferView": zero},
    });
    *model.accessor_mut(0) = json!({
        "componentType": 5126, "type": "VEC3", "count": 4_000_000_000u64, "sparse": sparse,
    });
    assert_eq!(json_place(model.load()).0, "accessors[0].count");
}

#[test]
fn sparse_index_out_of_range() {
    let mut model = Model::triangle();
    let (three, zero) = (model.view(&[3]), model.view(&[0; 12]));
    model.accessor_mut(0)["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": three, "componentType": 5121},
        "values": {"bufferView": zero},
    });
    assert_eq!(json_place(model.load()).0, "accessors[0].sparse.indices");
}

#[test]
fn stride_beyond_all_memory() {
    let mut model = Model::triangle();
    model.last_view()["byteStride"] = u64::MAX.into();
    assert_eq!(json_place(model.load()).0, "accessors[0]");
}

#[test]
fn positions_of_the_wrong_type() {
    let mut model = Model::triangle();
    model.accessor_mut(0)["type"] = "VEC2".into();
    assert_eq!(json_place(model.load()).0, "accessors[0].type");
}

#[test]
fn component_type_that_does_not_exist() {
    let mut model = Model::triangle();
    model.accessor_mut(0)["componentType"] = 5124.into();
    assert_eq!(json_place(model.load()).0, "accessors[0].componentType");
}

#[test]
fn indices_that_are_floats() {
    let mut model = Model::triangle();
    let indices = model.floats("SCALAR", &[0., 1., 2.]);
    model.primitive()["indices"] = indices.into();
    assert_eq!(json_place(model.load()).0, "accessors[1].componentType");
}

#[test]
fn accessor_that_is_not_there() {
    let mut model = Model::triangle();
    model.primitive()["attributes"]["POSITION"] = 9.into();
    assert_eq!(json_place(model.load()).0, "meshes[0].primitives[0].attributes.POSITION");
}

#[test]
fn index_that_is_two_to_the_32_is_not_0() {
    let mut model = Model::triangle();
    model.primitive()["attributes"]["POSITION"] = (1u64 << 32).into();
    assert_eq!(json_place(model.load()).0, "meshes[0].primitives[0].attributes.POSITION");
}

// Meshes

#[test]
fn vertex_index_out_of_range_drops_its_triangles() {
    let mut model = Model::parabola(4);
    let indices = model.shorts(&[0, 1, 2, 1, 2, 4, 65535, 0, 1]);
    model.primitive()["indices"] = indices.into();
    let loaded = model.load().unwrap();
    let scene = &loaded.scene;
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    assert_warns(&loaded, "2 faces are left out");
}

#[test]
fn indices_that_do_not_fill_a_triangle_are_counted() {
    let loaded = Model::parabola(5).load().unwrap();
    let scene = &loaded.scene;
    assert_eq!(scene.triangle_count(), 1);
    assert_warns(&loaded, "faces are left out: they have fewer than three corners");
}

#[test]
fn vertex_that_is_no_number_drops_its_triangles() {
    let mut model = Model::new();
    let positions = model.floats("VEC3", &[0., 0., f32::NAN, 1., 0., 0., 0., 1., 0.]);
    model.primitive()["attributes"]["POSITION"] = positions.into();
    let loaded = model.load().unwrap();
    let scene = &loaded.scene;
    assert_eq!(scene.triangle_count(), 0);
    assert_warns(&loaded, "faces are left out");
}

#[test]
fn mode_that_does_not_exist() {
    let mut model = Model::triangle();
    model.primitive()["mode"] = 7.into();
    assert_eq!(json_place(model.load()).0, "meshes[0].primitives[0].mode");
}

#[test]
fn thousands_of_primitives_of_one_accessor_stay_within_the_limit() {
    // With bytes behind it, and without.
    for count in [1 << 15, 1 << 20] {
        let mut model = Model::parabola(1 << 15);
        if count > 1 << 15 {
            *model.accessor_mut(0) = json!({"componentType": 5126, "type": "VEC3", "count": count});
        }
        let primitive = model.primitive().clone();
        model.json["meshes"][0]["primitives"] = vec![primitive; 4000].into();
        assert_eq!(json_place(model.load()).0, "accessors[0].count");
    }
}

// References

#[test]
fn references_that_lead_nowhere() {
    let cases = [
        ("/scene", "scene"),
        ("/scenes/0/nodes/0", "scenes[0].nodes[0]"),
        ("/nodes/0/mesh", "nodes[0].mesh"),
    ];
    for (pointer, place) in cases {
        let mut model = Model::triangle();
        *model.json.pointer_mut(pointer).unwrap() = 5.into();
        assert_eq!(json_place(model.load()).0, place);
    }
}

#[test]
fn references_of_nodes_that_lead_nowhere() {
    let light = json!({"KHR_lights_punctual": {"light": 3}});
    let cases = [
        ("camera", json!(3), "nodes[0].camera"),
        ("children", json!([3]), "nodes[0].children[0]"),
        ("extensions", light, "nodes[0].extensions.KHR_lights_punctual.light"),
    ];
    for (key, value, place) in cases {
        let mut model = Model::triangle();
        model.json["nodes"][0][key] = value;
        assert_eq!(json_place(model.load()).0, place);
    }
}

#[test]
fn texture_and_material_references_that_lead_nowhere() {
    let mut model = Model::triangle();
    model.primitive()["material"] = 3.into();
    assert_eq!(json_place(model.load()).0, "meshes[0].primitives[0].material");
    model.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    let place = "materials[0].pbrMetallicRoughness.baseColorTexture.index";
    assert_eq!(json_place(model.load()).0, place);
    model.json["textures"] = json!([{"source": 4}]);
    assert_eq!(json_place(model.load()).0, "textures[0].source");
    model.json["images"] = json!([{"bufferView": 8}]);
    model.json["textures"][0] = json!({"source": 0, "sampler": 2});
    assert_eq!(json_place(model.load()).0, "textures[0].sampler");
    // An image that cannot be loaded is a warning, whatever the reason.
    model.json["textures"][0] = json!({"source": 0});
    assert_warns(&model.load().unwrap(), "a magenta checker");
}

// Nodes

#[test]
fn node_cycles() {
    let cycles = [
        json!([{"children": [0], "mesh": 0}]),
        json!([{"children": [1], "mesh": 0}, {"children": [0]}]),
        json!([{"mesh": 0}, {"children": [2]}, {"children": [1]}]),
    ];
    for nodes in cycles {
        let mut model = Model::triangle();
        model.json["nodes"] = nodes;
        assert!(json_place(model.load()).1.contains("its own ancestor"));
    }
}

#[test]
fn graph_of_two_to_the_thirty_paths() {
    let mut model = Model::triangle();
    let mut nodes: Vec<_> = (1..=30).map(|i| json!({"children": [i, i]})).collect();
    nodes.push(json!({"mesh": 0}));
    model.json["nodes"] = nodes.into();
    let loaded = model.load().unwrap();
    let scene = &loaded.scene;
    assert_eq!(scene.instances.len(), 1);
    assert_warns(&loaded, "30 nodes stand twice");
}

#[test]
fn transform_that_is_too_large() {
    let mut model = Model::triangle();
    model.json["nodes"][0]["translation"] = json!([1e39, 0, 0]);
    assert_eq!(json_place(model.load()).0, "nodes[0].translation");
}

#[test]
fn rotation_of_length_zero_turns_nothing() {
    let mut model = Model::triangle();
    model.json["nodes"][0]["rotation"] = json!([0, 0, 0, 0]);
    assert_warns(&model.load().unwrap(), "rotations have length 0");
}
