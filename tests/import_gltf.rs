//! What glTF files become: each test one feature.

mod common;

use std::f32::consts::PI;

use common::{Folder, Model, assert_warns, data_uri, png};
use envers::scene::{Filter, Lens, LightKind, Material, Scene, Texture, Wrap};
use glam::{DVec3, Vec3};
use serde_json::json;

fn material(scene: &Scene) -> &Material {
    &scene.materials[scene.instances[0].material.0 as usize]
}

fn diffuse_map(scene: &Scene) -> &Texture {
    &scene.textures[material(scene).diffuse_map.unwrap().0 as usize]
}

fn close(a: Vec3, b: [f32; 3]) -> bool {
    (a - Vec3::from(b)).length() < 1e-5
}

// Geometry

#[test]
fn triangle_without_indices() {
    let scene = Model::triangle().load().unwrap();
    assert_eq!(scene.meshes[0].positions, [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn glb_is_the_same_as_gltf() {
    let model = Model::triangle();
    let scene = Folder::new().load("model.glb", model.glb()).unwrap();
    assert_eq!(scene.meshes, model.load().unwrap().meshes);
}

#[test]
fn indices_of_one_two_and_four_bytes() {
    for (component, size) in [(5121, 1), (5123, 2), (5125, 4)] {
        let mut model = Model::parabola(4);
        let bytes: Vec<u8> =
            [3u32, 1, 0].iter().flat_map(|i| i.to_le_bytes()[..size].to_vec()).collect();
        let indices = model.typed(component, "SCALAR", size, &bytes);
        model.primitive()["indices"] = indices.into();
        assert_eq!(model.load().unwrap().meshes[0].triangles, [[3, 1, 0]], "{size} bytes");
    }
}

#[test]
fn strip_winds_all_its_triangles_alike() {
    let mut model = Model::parabola(5);
    model.primitive()["mode"] = 5.into();
    assert_eq!(model.load().unwrap().meshes[0].triangles, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
}

#[test]
fn fan_with_indices() {
    let mut model = Model::parabola(4);
    let indices = model.shorts(&[3, 0, 1, 2]);
    model.primitive()["indices"] = indices.into();
    model.primitive()["mode"] = 6.into();
    assert_eq!(model.load().unwrap().meshes[0].triangles, [[0, 1, 3], [1, 2, 3]]);
}

#[test]
fn points_and_lines_are_counted_and_not_drawn() {
    for mode in 0..4 {
        let mut model = Model::triangle();
        model.primitive()["mode"] = mode.into();
        let scene = model.load().unwrap();
        assert_eq!(scene.triangle_count(), 0);
        assert_warns(&scene, "1 primitives are points or lines");
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
    let mesh = &model.load().unwrap().meshes[0];
    assert_eq!(mesh.positions, [[0.; 3], [1.; 3], [2.; 3]]);
    assert_eq!(mesh.normals, [[0., 0., 1.]; 3]);
}

#[test]
fn normalised_bytes_are_texture_coordinates_from_0_to_1() {
    let mut model = Model::triangle();
    let uvs = model.typed(5121, "VEC2", 1, &[0, 255, 51, 0, 0, 0]);
    model.accessor_mut(uvs)["normalized"] = true.into();
    model.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    assert_eq!(model.load().unwrap().meshes[0].uvs, [[0., 1.], [0.2, 0.], [0., 0.]]);
}

#[test]
fn quantised_positions() {
    let mut model = Model::new();
    model.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let bytes: Vec<u8> =
        [0i16, 0, 0, 300, 0, 0, 0, -7, 0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let positions = model.typed(5122, "VEC3", 2, &bytes);
    model.primitive()["attributes"]["POSITION"] = positions.into();
    assert_eq!(model.load().unwrap().meshes[0].positions[2], [0., -7., 0.]);
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
    let positions = &model.load().unwrap().meshes[0].positions;
    assert_eq!(*positions, [[0., 0., 0.], [1., 0., 0.], [5., 6., 7.]]);
}

#[test]
fn accessor_without_a_view_is_zero() {
    let mut model = Model::triangle();
    let colors = model.accessor(json!({"componentType": 5126, "type": "VEC3", "count": 3}));
    model.primitive()["attributes"]["COLOR_0"] = colors.into();
    assert_eq!(model.load().unwrap().meshes[0].colors, [[0.; 3]; 3]);
}

#[test]
fn vertex_colours_with_alpha_in_bytes() {
    let mut model = Model::triangle();
    let colors = model.typed(5121, "VEC4", 1, &[255, 0, 51, 9, 0, 0, 0, 9, 255, 255, 255, 9]);
    model.accessor_mut(colors)["normalized"] = true.into();
    model.primitive()["attributes"]["COLOR_0"] = colors.into();
    assert_eq!(model.load().unwrap().meshes[0].colors[0], [1., 0., 0.2]);
}

#[test]
fn without_normals_a_mesh_is_flat() {
    assert!(Model::triangle().load().unwrap().meshes[0].normals.is_empty());
}

#[test]
fn attribute_of_another_length_is_ignored_with_a_warning() {
    let mut model = Model::triangle();
    let normals = model.floats("VEC3", &[0., 0., 1.]);
    model.primitive()["attributes"]["NORMAL"] = normals.into();
    let scene = model.load().unwrap();
    assert!(scene.meshes[0].normals.is_empty());
    assert_warns(&scene, "meshes[0].primitives[0].attributes.NORMAL (1 for 3 vertices)");
}

#[test]
fn primitives_of_a_mesh_are_meshes_with_their_own_material() {
    let mut model = Model::triangle();
    let mut second = model.primitive().clone();
    model.json["materials"] = json!([{"name": "a"}, {"name": "b"}]);
    model.primitive()["material"] = 1.into();
    second["material"] = 0.into();
    model.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
    let scene = model.load().unwrap();
    let names = scene.instances.iter().map(|i| &*scene.materials[i.material.0 as usize].name);
    assert_eq!(names.collect::<Vec<_>>(), ["b", "a"]);
}

// Nodes

#[test]
fn child_transform_stands_within_its_parents() {
    let mut model = Model::triangle();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    model.json["nodes"] = json!([
        {"children": [1], "translation": [10, 0, 0], "rotation": [0, 0, half, half]},
        {"mesh": 0, "translation": [1, 0, 0], "scale": [2, 3, 4]},
    ]);
    let scene = model.load().unwrap();
    // The second corner: scaled to (2, 0, 0), moved to (3, 0, 0), turned to (0, 3, 0), moved.
    let corner = scene.instances[0].bake([1., 0., 0.]);
    assert!((corner - DVec3::new(10., 3., 0.)).length() < 1e-7, "{corner}");
}

#[test]
fn matrix_is_read_by_columns() {
    let mut model = Model::triangle();
    model.json["nodes"][0]["matrix"] = json!([0, 2, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1]);
    let corner = model.load().unwrap().instances[0].bake([1., 0., 0.]);
    assert_eq!(corner, DVec3::new(7., 10., 9.));
}

#[test]
fn mesh_of_two_nodes_is_stored_once() {
    let mut model = Model::triangle();
    model.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [0, 0, 5]}]);
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = model.load().unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2));
}

#[test]
fn default_scene_is_shown_alone() {
    let mut model = Model::triangle();
    model.json["nodes"] = json!([{}, {"mesh": 0}, {"mesh": 0}]);
    model.json["scenes"] = json!([{"nodes": [1, 2]}, {"nodes": [2]}]);
    for (scene, instances) in [(json!(0), 2), (json!(1), 1), (json!(null), 2)] {
        model.json["scene"] = scene;
        assert_eq!(model.load().unwrap().instances.len(), instances);
    }
}

#[test]
fn without_scenes_all_nodes_are_shown() {
    let mut model = Model::triangle();
    model.json["nodes"] = json!([{"children": [1]}, {"mesh": 0}, {"mesh": 0}]);
    model.json.as_object_mut().unwrap().retain(|key, _| !key.starts_with("scene"));
    assert_eq!(model.load().unwrap().instances.len(), 2);
}

#[test]
fn chain_of_a_hundred_thousand_nodes() {
    let mut model = Model::triangle();
    let mut nodes: Vec<_> = (1..100_000).map(|i| json!({"children": [i]})).collect();
    nodes.push(json!({"mesh": 0}));
    model.json["nodes"] = nodes.into();
    assert_eq!(model.load().unwrap().triangle_count(), 1);
}

#[test]
fn scale_of_zero_is_not_drawn_with_a_warning() {
    let mut model = Model::triangle();
    model.json["nodes"][0]["scale"] = json!([1, 0, 1]);
    let scene = model.load().unwrap();
    assert!(scene.instances.is_empty());
    assert_warns(&scene, "their scale is 0 along some direction, at nodes[0].mesh");
}

#[test]
fn child_that_stands_among_the_roots_is_placed_by_its_parent() {
    let mut model = Model::triangle();
    model.json["nodes"] = json!([{"mesh": 0}, {"children": [0], "translation": [5, 0, 0]}]);
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = model.load().unwrap();
    assert_eq!(scene.instances.len(), 1);
    assert_eq!(scene.instances[0].transform.translation.x, 5.0);
    assert_warns(&scene, "stand twice");
}

// Materials

#[test]
fn primitive_without_material_is_a_neutral_grey() {
    let scene = Model::triangle().load().unwrap();
    assert_eq!(*material(&scene), Material::default());
}

#[test]
fn metallic_roughness_on_phong() {
    let mut model = Model::triangle();
    model.material(json!({"pbrMetallicRoughness": {
        "baseColorFactor": [0.5, 0.25, 1.0, 1.0], "metallicFactor": 0.25, "roughnessFactor": 0.5,
    }}));
    let scene = model.load().unwrap();
    let m = material(&scene);
    assert!(close(m.diffuse, [0.375, 0.1875, 0.75]), "{}", m.diffuse);
    assert!(close(m.specular, [0.155, 0.0925, 0.28]), "{}", m.specular);
    // α = 0.25; 2 / 0.0625 − 2.
    assert!((m.shininess - 30.0).abs() < 1e-4, "{}", m.shininess);
}

#[test]
fn metal_and_roughness_textures_count_by_their_mean() {
    let mut model = Model::triangle();
    let uri = data_uri(&png(&[[0, 255, 0, 255], [0, 0, 102, 255]]));
    model.json["images"] = json!([{"uri": uri}]);
    model.json["textures"] = json!([{"source": 0}]);
    model.material(json!({"pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 0}}}));
    let scene = model.load().unwrap();
    // Metalness (0 + 0.4)/2, roughness (1 + 0)/2.
    assert!(close(material(&scene).diffuse, [0.8; 3]), "{}", material(&scene).diffuse);
    assert!((material(&scene).shininess - 30.0).abs() < 1e-4);
    assert_warns(&scene, "their mean holds");
}

#[test]
fn emission_with_its_strength() {
    let mut model = Model::triangle();
    model.material(json!({
        "emissiveFactor": [1.0, 0.5, 0.0],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0}},
    }));
    assert!(close(material(&model.load().unwrap()).emission, [4.0, 2.0, 0.0]));
}

#[test]
fn unlit_is_emission_alone() {
    let mut model = Model::triangle();
    model.material(json!({
        "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 1.0]},
        "extensions": {"KHR_materials_unlit": {}},
    }));
    let scene = model.load().unwrap();
    let m = material(&scene);
    assert!(close(m.emission, [0.1, 0.2, 0.3]));
    assert_eq!((m.diffuse, m.specular), (Vec3::ZERO, Vec3::ZERO));
}

#[test]
fn specular_glossiness() {
    let mut model = Model::triangle();
    model.material(json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.1, 0.2, 0.3, 1.0], "specularFactor": [0.4, 0.5, 0.6],
        "glossinessFactor": 0.5,
    }}}));
    let scene = model.load().unwrap();
    let m = material(&scene);
    assert!(close(m.diffuse, [0.1, 0.2, 0.3]) && close(m.specular, [0.4, 0.5, 0.6]));
    assert!((m.shininess - 30.0).abs() < 1e-4);
}

#[test]
fn alpha_is_drawn_opaque_with_a_warning() {
    for (mode, word) in [("MASK", "drawn whole"), ("BLEND", "drawn opaque")] {
        let mut model = Model::triangle();
        model.material(json!({"alphaMode": mode}));
        assert_warns(&model.load().unwrap(), word);
    }
}

#[test]
fn extension_used_but_not_required_is_a_warning() {
    let mut model = Model::triangle();
    model.json["extensionsUsed"] = json!(["KHR_materials_clearcoat"]);
    assert_warns(&model.load().unwrap(), "KHR_materials_clearcoat");
}

// Textures

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

// Lights and cameras

fn with_light(light: serde_json::Value, node: serde_json::Value) -> Scene {
    let mut model = Model::triangle();
    model.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
    model.json["nodes"] = json!([{"mesh": 0}, node]);
    model.json["nodes"][1]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    model.load().unwrap()
}

#[test]
fn point_light_in_candela_is_divided_by_pi() {
    let light = json!({"type": "point", "color": [1.0, 0.5, 0.0], "intensity": 20.0, "range": 3});
    let scene = with_light(light, json!({"translation": [1, 2, 3]}));
    assert_eq!(scene.lights.len(), 1);
    assert!(close(scene.lights[0].intensity, [20.0 / PI, 10.0 / PI, 0.0]));
    let LightKind::Point { position, range, .. } = scene.lights[0].kind else { panic!() };
    assert_eq!((position, range), (DVec3::new(1., 2., 3.), 3.0));
}

#[test]
fn directional_light_travels_along_its_nodes_minus_z() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let node = json!({"rotation": [-half, 0, 0, half], "scale": [3, 3, 3]});
    let scene = with_light(json!({"type": "directional"}), node);
    let LightKind::Directional { direction } = scene.lights[0].kind else { panic!() };
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
        assert_eq!(scene.lights.len(), 1);
    }
}

fn with_camera(camera: serde_json::Value) -> Scene {
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
    assert_eq!((camera.name.as_str(), camera.lens), ("eye", Lens::FovY(0.5)));
    assert_eq!((camera.position, camera.forward), (DVec3::Z * 9.0, DVec3::NEG_Z));
    assert_eq!((camera.right, camera.up), (DVec3::X, DVec3::Y));
}

#[test]
fn orthographic_camera_sees_twice_its_ymag() {
    let lens = json!({"xmag": 1, "ymag": 1.5, "znear": 0.1, "zfar": 10});
    let scene = with_camera(json!({"type": "orthographic", "orthographic": lens}));
    assert_eq!(scene.cameras[0].lens, Lens::OrthoHeight(3.0));
}

#[test]
fn camera_that_cannot_see_is_left_out_with_a_warning() {
    let scene =
        with_camera(json!({"type": "perspective", "perspective": {"yfov": 7.0, "znear": 1}}));
    assert_eq!(scene.cameras[0].name, "framing");
    assert_warns(&scene, "cameras[0]");
}

#[test]
fn skins_morphs_and_animations_are_warnings() {
    let mut model = Model::triangle();
    model.json["skins"] = json!([{"joints": [0]}]);
    model.json["nodes"][0]["skin"] = 0.into();
    model.primitive()["targets"] = json!([{"POSITION": 0}]);
    model.json["animations"] = json!([{"channels": [], "samplers": []}]);
    let scene = model.load().unwrap();
    for word in ["skinned", "morph", "animations"] {
        assert_warns(&scene, word);
    }
}
