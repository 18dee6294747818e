//! Pictures, samplers and texture coordinates.

use envers::scene::{Filter, Texture, Wrap};

use super::*;

fn diffuse_map(scene: &Scene) -> &Texture {
    &scene.textures[material(scene).diffuse_map.unwrap().0 as usize]
}

/// A triangle with texture coordinates and a base colour texture.
fn textured(image: serde_json::Value) -> Model {
    let mut model = Model::triangle();
    let uvs = model.floats("VEC2", &[0., 0., 1., 0., 0., 1.]);
    model.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    model.json["images"] = json!([image]);
    model.json["textures"] = json!([{"source": 0}]);
    model.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    model
}

const RED: [u8; 4] = [255, 0, 0, 255];

#[test]
fn picture_in_a_data_uri() {
    let scene = textured(json!({"uri": data_uri(&png(&[RED]))})).load().unwrap();
    assert_eq!(diffuse_map(&scene).image.texels, [RED]);
}

#[test]
fn picture_in_a_buffer_view_without_a_mime_type() {
    let mut model = textured(json!({}));
    let view = model.view(&png(&[RED]));
    model.json["images"][0]["bufferView"] = view.into();
    assert_eq!(diffuse_map(&model.load().unwrap()).image.texels, [RED]);
}

#[test]
fn picture_in_a_file_whose_name_is_encoded() {
    for uri in ["a%20b%C3%A9.png", "a bé.png", "sub\\a bé.png"] {
        let folder = Folder::new();
        let name = uri.replace('\\', "/").replace("%20", " ").replace("%C3%A9", "é");
        folder.write(&name, png(&[RED]));
        let scene = textured(json!({"uri": uri})).load_in(&folder).unwrap();
        assert_eq!(diffuse_map(&scene).image.texels, [RED], "{uri}");
    }
}

#[test]
fn picture_in_a_file_with_a_percent_sign_of_its_own() {
    let folder = Folder::new();
    folder.write("50%20.png", png(&[RED]));
    let scene = textured(json!({"uri": "50%20.png"})).load_in(&folder).unwrap();
    assert_eq!(diffuse_map(&scene).image.texels, [RED]);
}

#[test]
fn missing_picture_is_a_warning_and_a_placeholder() {
    let scene = textured(json!({"uri": "none.png"})).load().unwrap();
    assert!(diffuse_map(&scene).image.name.contains("missing"));
    assert_warns(&scene, "none.png");
}

#[test]
fn damaged_picture_is_a_warning_and_a_placeholder() {
    let mut bytes = png(&[RED]);
    bytes.truncate(40);
    let scene = textured(json!({"uri": data_uri(&bytes)})).load().unwrap();
    assert!(diffuse_map(&scene).image.name.contains("missing"));
    assert_warns(&scene, "images[0]");
}

#[test]
fn image_with_nothing_in_it_is_a_warning_and_a_placeholder() {
    let scene = textured(json!({})).load().unwrap();
    assert!(diffuse_map(&scene).image.name.contains("missing"));
    assert_warns(&scene, "neither a URI nor a buffer view");
}

#[test]
fn sampler_gives_wrap_and_filter() {
    let mut model = textured(json!({"uri": data_uri(&png(&[RED]))}));
    model.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    model.json["textures"][0]["sampler"] = 0.into();
    let scene = model.load().unwrap();
    assert_eq!(diffuse_map(&scene).wrap, [Wrap::Clamp, Wrap::Mirror]);
    assert_eq!(diffuse_map(&scene).filter, Filter::Nearest);
}

#[test]
fn material_chooses_its_set_of_texture_coordinates() {
    let mut model = textured(json!({"uri": data_uri(&png(&[RED]))}));
    let second = model.floats("VEC2", &[0.5; 6]);
    model.primitive()["attributes"]["TEXCOORD_1"] = second.into();
    model.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1.into();
    assert_eq!(model.load().unwrap().meshes[0].uvs, [[0.5; 2]; 3]);
}

#[test]
fn texture_transform_moves_the_coordinates() {
    let mut model = textured(json!({"uri": data_uri(&png(&[RED]))}));
    model.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
        json!({"KHR_texture_transform": {"offset": [0.25, 0.5], "scale": [2, -1]}});
    let uvs = &model.load().unwrap().meshes[0].uvs;
    assert_eq!(*uvs, [[0.25, 0.5], [2.25, 0.5], [0.25, -0.5]]);
}

#[test]
fn texture_coordinates_are_kept_for_other_materials() {
    let mut model = textured(json!({"uri": "none.png"}));
    model.primitive().as_object_mut().unwrap().remove("material");
    assert_eq!(model.load().unwrap().meshes[0].uvs.len(), 3);
}
