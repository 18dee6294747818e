//! Triangles, accessors and vertex attributes.

use super::*;
use envers::Loaded;
use proptest::prelude::*;

#[test]
fn triangle_without_indices() {
    let Loaded { scene, report, .. } = Model::triangle().load().unwrap();
    assert_eq!(scene.meshes[0].positions, [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
}

#[test]
fn glb_is_the_same_as_gltf() {
    let model = Model::triangle();
    let scene = Folder::new().load("model.glb", model.glb()).unwrap().scene;
    assert_eq!(scene.meshes, model.load().unwrap().scene.meshes);
}

#[test]
fn indices_of_one_two_and_four_bytes() {
    for (component, size) in [(5121, 1), (5123, 2), (5125, 4)] {
        let mut model = Model::parabola(4);
        let bytes: Vec<u8> =
            [3u32, 1, 0].iter().flat_map(|i| i.to_le_bytes()[..size].to_vec()).collect();
        let indices = model.typed(component, "SCALAR", size, &bytes);
        model.primitive()["indices"] = indices.into();
        assert_eq!(model.load().unwrap().scene.meshes[0].triangles, [[3, 1, 0]], "{size} bytes");
    }
}

#[test]
fn strip_winds_all_its_triangles_alike() {
    let mut model = Model::parabola(5);
    model.primitive()["mode"] = 5.into();
    assert_eq!(model.load().unwrap().scene.meshes[0].triangles, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
}

#[test]
fn fan_with_indices() {
    let mut model = Model::parabola(4);
    let indices = model.shorts(&[3, 0, 1, 2]);
    model.primitive()["indices"] = indices.into();
    model.primitive()["mode"] = 6.into();
    assert_eq!(model.load().unwrap().scene.meshes[0].triangles, [[0, 1, 3], [1, 2, 3]]);
}

#[test]
fn points_and_lines_are_counted_and_not_drawn() {
    for (mode, lost) in [(0, 3), (1, 2), (2, 3), (3, 2)] {
        let mut model = Model::triangle();
        model.primitive()["mode"] = mode.into();
        let loaded = model.load().unwrap();
        let scene = &loaded.scene;
        assert_eq!(scene.triangle_count(), 0);
        assert_warns(&loaded, &format!("{lost} points, lines or curves are left out"));
    }
}

#[test]
fn interleaved_attributes() {
    let mut model = Model::new();
    let vertex = |i: u8| [[f32::from(i); 3], [0.0, 0.0, 1.0]].concat();
    let bytes: Vec<u8> = (0..3).flat_map(vertex).flat_map(f32::to_le_bytes).collect();
    let view = model.view(&bytes);
    model.last_view()["byteStride"] = 24.into();
    let shared = json!({"bufferView": view, "componentType": 5126, "type": "VEC3", "count": 3});
    let positions = model.accessor(shared.clone());
    let normals = model.accessor(shared);
    model.accessor_mut(normals)["byteOffset"] = 12.into();
    model.primitive()["attributes"] = json!({"POSITION": positions, "NORMAL": normals});
    let mesh = &model.load().unwrap().scene.meshes[0];
    assert_eq!(mesh.positions, [[0.; 3], [1.; 3], [2.; 3]]);
    assert_eq!(mesh.normals, [[0., 0., 1.]; 3]);
}

#[test]
fn normalised_bytes_are_texture_coordinates_from_0_to_1() {
    let mut model = Model::triangle();
    let uvs = model.typed(5121, "VEC2", 1, &[0, 255, 51, 0, 0, 0]);
    model.accessor_mut(uvs)["normalized"] = true.into();
    model.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    assert_eq!(model.load().unwrap().scene.meshes[0].uvs, [[0., 1.], [0.2, 0.], [0., 0.]]);
}

#[test]
fn quantised_positions() {
    let mut model = Model::new();
    model.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let bytes: Vec<u8> =
        [0i16, 0, 0, 300, 0, 0, 0, -7, 0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let positions = model.typed(5122, "VEC3", 2, &bytes);
    model.primitive()["attributes"]["POSITION"] = positions.into();
    assert_eq!(model.load().unwrap().scene.meshes[0].positions.at(2).to_array(), [0., -7., 0.]);
}

#[test]
fn sparse_accessor_replaces_elements() {
    let mut model = Model::triangle();
    let indices = model.view(&[2]);
    let values: Vec<u8> = [5f32, 6., 7.].iter().flat_map(|x| x.to_le_bytes()).collect();
    let values = model.view(&values);
    model.accessor_mut(0)["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": indices, "componentType": 5121},
        "values": {"bufferView": values},
    });
    let positions = &model.load().unwrap().scene.meshes[0].positions;
    assert_eq!(*positions, [[0., 0., 0.], [1., 0., 0.], [5., 6., 7.]]);
}

#[test]
fn accessor_without_a_view_is_zero() {
    let mut model = Model::triangle();
    let colors = model.accessor(json!({"componentType": 5126, "type": "VEC3", "count": 3}));
    model.primitive()["attributes"]["COLOR_0"] = colors.into();
    assert_eq!(model.load().unwrap().scene.meshes[0].colors, [[0.; 3]; 3]);
}

#[test]
fn vertex_colours_with_alpha_in_bytes() {
    let mut model = Model::triangle();
    let colors = model.typed(5121, "VEC4", 1, &[255, 0, 51, 9, 0, 0, 0, 9, 255, 255, 255, 9]);
    model.accessor_mut(colors)["normalized"] = true.into();
    model.primitive()["attributes"]["COLOR_0"] = colors.into();
    assert_eq!(model.load().unwrap().scene.meshes[0].colors[0], [1., 0., 0.2]);
}

#[test]
fn without_normals_a_mesh_is_flat() {
    assert!(Model::triangle().load().unwrap().scene.meshes[0].normals.is_empty());
}

#[test]
fn attribute_of_another_length_is_ignored_with_a_warning() {
    let mut model = Model::triangle();
    let normals = model.floats("VEC3", &[0., 0., 1.]);
    model.primitive()["attributes"]["NORMAL"] = normals.into();
    let loaded = model.load().unwrap();
    let scene = &loaded.scene;
    assert!(scene.meshes[0].normals.is_empty());
    assert_warns(&loaded, "meshes[0].primitives[0].attributes.NORMAL (1 for 3 vertices)");
}

#[test]
fn primitives_of_a_mesh_are_meshes_with_their_own_material() {
    let mut model = Model::triangle();
    let mut second = model.primitive().clone();
    model.json["materials"] = json!([{"name": "a"}, {"name": "b"}]);
    model.primitive()["material"] = 1.into();
    second["material"] = 0.into();
    model.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
    let scene = model.load().unwrap().scene;
    let names = scene.instances.iter().map(|i| &*scene.materials[i.material.0 as usize].name);
    assert_eq!(names.collect::<Vec<_>>(), ["b", "a"]);
}

/// The bytes of elements with `gap` other bytes after each.
fn spread(elements: &[Vec<u8>], gap: usize) -> Vec<u8> {
    elements.iter().flat_map(|e| e.iter().copied().chain(std::iter::repeat_n(0xEE, gap))).collect()
}

/// A mesh whose positions and indices stand `gap` bytes apart.
fn spread_out(points: &[[f32; 3]], indices: &[u8], size: usize, gap: usize) -> Model {
    let mut model = Model::new();
    let points: Vec<Vec<u8>> =
        points.iter().map(|p| p.iter().flat_map(|x| x.to_le_bytes()).collect()).collect();
    let indices: Vec<Vec<u8>> =
        indices.iter().map(|&i| u32::from(i).to_le_bytes()[..size].to_vec()).collect();
    let mut accessor = |elements: &[Vec<u8>], component: u32, kind: &str| {
        let view = model.view(&spread(elements, gap));
        if gap > 0 {
            model.last_view()["byteStride"] = (elements[0].len() + gap).into();
        }
        let count = elements.len();
        model.accessor(
            json!({"bufferView": view, "componentType": component, "type": kind, "count": count}),
        )
    };
    let positions = accessor(&points, 5126, "VEC3");
    let component = [5121, 5123, 5125][size / 2];
    let indices = accessor(&indices, component, "SCALAR");
    model.primitive()["attributes"]["POSITION"] = positions.into();
    model.primitive()["indices"] = indices.into();
    model
}

proptest! {
    #[test]
    fn values_side_by_side_are_read_as_those_apart_are(
        points in prop::collection::vec(prop::array::uniform3(-1e14f32..1e14), 1..40),
        indices in prop::collection::vec(any::<u8>(), 3..90),
        size in prop::sample::select(vec![1usize, 2, 4]),
        gap in 1usize..9,
    ) {
        let indices: Vec<u8> = indices.iter().map(|i| i % points.len() as u8).collect();
        let [packed, apart] =
            [0, gap].map(|gap| spread_out(&points, &indices, size, gap).load().unwrap());
        prop_assert_eq!(packed.scene.meshes, apart.scene.meshes);
    }
}

#[test]
fn a_vrm_file_is_a_binary_one() {
    let scene = Folder::new().load("avatar.vrm", Model::triangle().glb()).unwrap().scene;
    assert_eq!(scene.triangle_count(), 1);
}
