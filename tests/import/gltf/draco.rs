//! KHR_draco_mesh_compression.

use draco_core::{DataType, GeometryAttributeType as Kind};
use envers::{DropReason, Limit, Limits, LoadOptions, Loaded};

use super::*;
use envers_testing::compressed::{DRACO, bytes, compressed_model, draco};

const SQUARE: [f32; 12] = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.];
const HALVES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

fn square() -> Model {
    compressed_model(&[("POSITION", Kind::Position, 3, &SQUARE)], &HALVES)
}

/// The corners of a scene's triangles, in the order of their coordinates.
fn corners(scene: &Scene) -> Vec<[[i32; 3]; 3]> {
    let mesh = &scene.meshes[0];
    let corner = |i: u32| mesh.positions.at(i as usize).to_array().map(|x| (x * 1000.0) as i32);
    let mut all: Vec<_> = mesh
        .triangles
        .iter()
        .map(|triangle| {
            let mut corners = triangle.map(corner);
            // Draco may begin a triangle at any of its corners.
            let first = (0..3).min_by_key(|&i| corners[i]).unwrap();
            corners.rotate_left(first);
            corners
        })
        .collect();
    all.sort_unstable();
    all
}

#[test]
fn triangles_are_those_that_were_packed() {
    let (a, b, c, d) = ([0, 0, 0], [1000, 0, 0], [1000, 1000, 0], [0, 1000, 0]);
    assert_eq!(corners(&square().load().unwrap().scene), [[a, b, c], [a, c, d]]);
}

#[test]
fn triangles_of_a_strip_are_packed_as_triangles() {
    let mut model = square();
    model.primitive()["mode"] = 5.into();
    assert_eq!(corners(&model.load().unwrap().scene), corners(&square().load().unwrap().scene));
}

#[test]
fn attributes_stay_with_their_vertices() {
    let normals = [1., 0., 0., 0., 1., 0., 0., 0., 1., 0., -1., 0.];
    let uvs = [0., 0., 1., 0., 1., 1., 0., 1.];
    let model = compressed_model(
        &[
            ("POSITION", Kind::Position, 3, &SQUARE),
            ("NORMAL", Kind::Normal, 3, &normals),
            ("TEXCOORD_0", Kind::TexCoord, 2, &uvs),
        ],
        &HALVES,
    );
    let scene = model.load().unwrap().scene;
    let mesh = &scene.meshes[0];
    for (i, at) in mesh.positions.iter().map(|p| p.as_vec3()).enumerate() {
        let was = SQUARE.chunks(3).position(|p| p[0] == at.x && p[1] == at.y).unwrap();
        assert_eq!(mesh.normals[i], normals[3 * was..][..3], "normal of vertex {was}");
        assert_eq!(mesh.uvs[i], uvs[2 * was..][..2], "texture coordinates of vertex {was}");
    }
}

#[test]
fn bytes_are_normalised_as_their_accessor_says() {
    let mut model = Model::new();
    let (positions, colors) = (bytes(&SQUARE), [255, 0, 0, 255].repeat(4));
    let all = [
        (Kind::Position, DataType::Float32, 3, &positions[..]),
        (Kind::Color, DataType::Uint8, 4, &colors[..]),
    ];
    let view = model.view(&draco(&all, &HALVES));
    for (name, json) in [
        ("POSITION", json!({"componentType": 5126, "type": "VEC3", "count": 4})),
        ("COLOR_0", json!({"componentType": 5121, "normalized": true, "type": "VEC4", "count": 4})),
    ] {
        model.primitive()["attributes"][name] = model.accessor(json).into();
    }
    let ids = json!({"POSITION": 0, "COLOR_0": 1});
    model.primitive()["extensions"] = json!({ DRACO: {"bufferView": view, "attributes": ids} });
    assert_eq!(model.load().unwrap().scene.meshes[0].colors, [[1.0, 0.0, 0.0]; 4]);
}

#[test]
fn faces_are_counted_as_those_of_other_meshes() {
    let mut positions = SQUARE;
    positions[9..].copy_from_slice(&SQUARE[..3]);
    let model = compressed_model(&[("POSITION", Kind::Position, 3, &positions)], &HALVES);
    let Loaded { report, .. } = model.load().unwrap();
    assert_eq!((report.read, report.handed_over), (2, 1));
    assert_eq!(report.dropped, [(DropReason::Degenerate, 1)].into());
}

/// Returns the same model with other data.
fn damaged() -> Model {
    let mut model = square();
    model.primitive()["extensions"][DRACO]["bufferView"] = 1.into();
    model.view(b"DRACO, but not really");
    model
}

#[test]
fn damaged_data_are_an_error_at_their_place() {
    let (place, text) = json_place(damaged().load());
    assert_eq!(place, format!("meshes[0].primitives[0].extensions.{DRACO}"));
    assert!(text.contains("cannot be decompressed"), "{text}");
}

#[test]
fn where_data_are_damaged_those_that_are_not_packed_are_read() {
    let mut model = damaged();
    model.json["extensionsRequired"] = json!([]);
    let positions = model.floats("VEC3", &SQUARE[..9]);
    model.primitive()["attributes"]["POSITION"] = positions.into();
    model.primitive().as_object_mut().unwrap().remove("indices");
    let loaded = model.load().unwrap();
    let scene = &loaded.scene;
    assert_warns(&loaded, "what is not compressed is read instead");
    assert_eq!(scene.triangle_count(), 1);
}

#[test]
fn an_attribute_that_is_not_there_is_an_error_that_names_it() {
    let mut model = square();
    model.primitive()["extensions"][DRACO]["attributes"]["POSITION"] = 7.into();
    let (_, text) = json_place(model.load());
    assert!(text.contains("no attribute with the number that POSITION gives"), "{text}");
}

#[test]
fn more_triangles_than_the_limit_are_an_error_that_names_it() {
    let folder = Folder::new();
    let path = folder.write("model.glb", square().glb());
    let limits = Limits::default().with_limit(Limit::Triangles, 1);
    let options = LoadOptions::default().limits(limits);
    let error = options.load(&path).unwrap_err().to_string();
    assert!(error.contains("larger than the limits allow"), "{error}");
}

#[test]
fn each_attribute_that_is_unpacked_counts_towards_the_elements() {
    let mut model = square();
    let named = model.primitive()["extensions"][DRACO]["attributes"].as_object_mut().unwrap();
    named.extend((0..200).map(|i| (format!("_{i}"), 0.into())));
    let folder = Folder::new();
    let path = folder.write("model.glb", model.glb());
    let limits = Limits::default().with_limit(Limit::Elements, 100);
    let options = LoadOptions::default().limits(limits);
    let error = options.load(&path).unwrap_err().to_string();
    assert!(error.contains("elements"), "{error}");
}
