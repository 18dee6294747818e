//! Pictures, samplers and texture coordinates.

use envers::scene::{Filter, Texels, Wrap};
use envers::{Texture, TextureId};

use super::*;

fn diffuse_map(scene: &Scene) -> &Texture {
    let map = material(scene).metallic.as_ref().unwrap().base_color;
    &scene.textures[map.unwrap().0 as usize]
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
    let scene = textured(json!({"uri": data_uri(&png(&[RED]))})).load().unwrap().scene;
    assert_eq!(diffuse_map(&scene).image.texels, Texels::Bytes(vec![RED]));
}

#[test]
fn picture_in_a_buffer_view_without_a_mime_type() {
    let mut model = textured(json!({}));
    let view = model.view(&png(&[RED]));
    model.json["images"][0]["bufferView"] = view.into();
    assert_eq!(diffuse_map(&model.load().unwrap().scene).image.texels, Texels::Bytes(vec![RED]));
}

#[test]
fn picture_in_a_file_whose_name_is_encoded() {
    for uri in ["a%20b%C3%A9.png", "a bé.png", "sub\\a bé.png"] {
        let folder = Folder::new();
        let name = uri.replace('\\', "/").replace("%20", " ").replace("%C3%A9", "é");
        folder.write(&name, png(&[RED]));
        let scene = textured(json!({"uri": uri})).load_in(&folder).unwrap().scene;
        assert_eq!(diffuse_map(&scene).image.texels, Texels::Bytes(vec![RED]), "{uri}");
    }
}

#[test]
fn picture_in_a_file_with_a_percent_sign_of_its_own() {
    let folder = Folder::new();
    folder.write("50%20.png", png(&[RED]));
    let scene = textured(json!({"uri": "50%20.png"})).load_in(&folder).unwrap().scene;
    assert_eq!(diffuse_map(&scene).image.texels, Texels::Bytes(vec![RED]));
}

#[test]
fn missing_picture_is_a_warning_and_a_placeholder() {
    let loaded = textured(json!({"uri": "none.png"})).load().unwrap();
    let scene = &loaded.scene;
    assert!(diffuse_map(scene).image.name.contains("missing"));
    assert_warns(&loaded, "none.png");
}

#[test]
fn damaged_picture_is_a_warning_and_a_placeholder() {
    let mut bytes = png(&[RED]);
    bytes.truncate(40);
    let loaded = textured(json!({"uri": data_uri(&bytes)})).load().unwrap();
    let scene = &loaded.scene;
    assert!(diffuse_map(scene).image.name.contains("missing"));
    assert_warns(&loaded, "images[0]");
}

#[test]
fn image_with_nothing_in_it_is_a_warning_and_a_placeholder() {
    let loaded = textured(json!({})).load().unwrap();
    let scene = &loaded.scene;
    assert!(diffuse_map(scene).image.name.contains("missing"));
    assert_warns(&loaded, "neither a URI nor a buffer view");
}

#[test]
fn sampler_gives_wrap_and_filter() {
    let mut model = textured(json!({"uri": data_uri(&png(&[RED]))}));
    model.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    model.json["textures"][0]["sampler"] = 0.into();
    let scene = model.load().unwrap().scene;
    assert_eq!(diffuse_map(&scene).wrap, [Wrap::Clamp, Wrap::Mirror]);
    assert_eq!(diffuse_map(&scene).filter, Filter::Nearest);
}

#[test]
fn material_chooses_its_set_of_texture_coordinates() {
    let mut model = textured(json!({"uri": data_uri(&png(&[RED]))}));
    let second = model.floats("VEC2", &[0.5; 6]);
    model.primitive()["attributes"]["TEXCOORD_1"] = second.into();
    model.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1.into();
    assert_eq!(model.load().unwrap().scene.meshes[0].uvs, [[0.5; 2]; 3]);
}

/// Returns the places of the corners of the triangle on the picture of a texture.
fn on_picture(scene: &Scene, texture: &Texture) -> Vec<[f32; 2]> {
    let mesh = &scene.meshes[0];
    let uvs = if texture.set == 0 { &mesh.uvs } else { &mesh.second_uvs };
    uvs.iter().map(|&uv| texture.transform.transform_point2(uv.into()).to_array()).collect()
}

#[test]
fn texture_transform_moves_the_coordinates() {
    let mut model = textured(json!({"uri": data_uri(&png(&[RED]))}));
    model.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
        json!({"KHR_texture_transform": {"offset": [0.25, 0.5], "scale": [2, -1]}});
    let scene = model.load().unwrap().scene;
    let expected = [[0.25, 0.5], [2.25, 0.5], [0.25, -0.5]];
    assert_eq!(on_picture(&scene, diffuse_map(&scene)), expected);
}

#[test]
fn every_slot_has_its_own_transform_and_set() {
    let mut model = textured(json!({"uri": data_uri(&png(&[RED]))}));
    let second = model.floats("VEC2", &[0.5; 6]);
    model.primitive()["attributes"]["TEXCOORD_3"] = second.into();
    let moved = |x: f32, set: u32| {
        let transform = json!({"KHR_texture_transform": {"offset": [x, 0], "texCoord": set}});
        json!({"index": 0, "extensions": transform})
    };
    let material = &mut model.json["materials"][0];
    material["normalTexture"] = moved(1.0, 3);
    material["occlusionTexture"] = moved(2.0, 0);
    material["emissiveTexture"] = moved(3.0, 3);
    material["emissiveFactor"] = json!([1, 1, 1]);
    let scene = model.load().unwrap().scene;
    let m = super::material(&scene);
    let first = |id: TextureId| on_picture(&scene, &scene.textures[id.0 as usize])[0];
    assert_eq!(first(m.normal_map.unwrap().texture), [1.5, 0.5]);
    assert_eq!(first(m.occlusion_map.unwrap().map.texture), [2.0, 0.0]);
    assert_eq!(first(m.emission_map.unwrap()), [3.5, 0.5]);
}

#[test]
fn a_third_set_of_texture_coordinates_is_a_warning() {
    let mut model = textured(json!({"uri": data_uri(&png(&[RED]))}));
    let material = &mut model.json["materials"][0];
    material["occlusionTexture"] = json!({"index": 0, "texCoord": 1});
    material["normalTexture"] = json!({"index": 0, "texCoord": 2});
    assert_warns(&model.load().unwrap(), "more than two sets of texture coordinates");
}

#[test]
fn a_picture_is_decoded_once_however_many_textures_show_it() {
    let uri = data_uri(&png(&[RED]));
    let mut model = textured(json!({"uri": uri}));
    model.json["images"] = json!([{"uri": uri}, {"uri": uri}]);
    model.json["textures"] = json!([{"source": 0}, {"source": 1}]);
    model.json["materials"][0]["emissiveTexture"] = json!({"index": 1});
    model.json["materials"][0]["emissiveFactor"] = json!([1, 1, 1]);
    let scene = model.load().unwrap().scene;
    let m = super::material(&scene);
    let ids = [m.metallic.as_ref().unwrap().base_color.unwrap(), m.emission_map.unwrap()];
    let [a, b] = ids.map(|id| &scene.textures[id.0 as usize].image);
    assert!(std::sync::Arc::ptr_eq(a, b));
}

#[test]
fn mipmaps_are_used_unless_the_sampler_says_otherwise() {
    for (filter, mipmap) in [
        (None, true),
        (Some(9728), false),
        (Some(9729), false),
        (Some(9986), true),
        (Some(9987), true),
    ] {
        let mut model = textured(json!({"uri": data_uri(&png(&[RED]))}));
        model.json["samplers"] = json!([{}]);
        if let Some(filter) = filter {
            model.json["samplers"][0]["minFilter"] = filter.into();
        }
        model.json["textures"][0]["sampler"] = 0.into();
        assert_eq!(diffuse_map(&model.load().unwrap().scene).mipmap, mipmap, "{filter:?}");
    }
}

#[test]
fn texture_coordinates_are_kept_for_other_materials() {
    let mut model = textured(json!({"uri": "none.png"}));
    model.primitive().as_object_mut().unwrap().remove("material");
    assert_eq!(model.load().unwrap().scene.meshes[0].uvs.len(), 3);
}

#[test]
fn missing_pictures_that_are_no_colours_change_nothing() {
    let mut model = textured(json!({"uri": "none.png"}));
    let texture = json!({"index": 0});
    model.material(json!({
        "pbrMetallicRoughness": {"metallicRoughnessTexture": texture},
        "normalTexture": texture,
    }));
    let loaded = model.load().unwrap();
    let scene = &loaded.scene;
    assert_warns(&loaded, "none.png");
    assert_eq!(loaded.report.placeholders.len(), 1);
    let material = material(scene);
    assert_eq!(material.normal_map, None);
    let roughness = material.metallic.as_ref().unwrap().roughness.unwrap().texture;
    let image = &scene.textures[roughness.0 as usize].image;
    assert_eq!(image.texels, Texels::Bytes(vec![[255; 4]]));
}
