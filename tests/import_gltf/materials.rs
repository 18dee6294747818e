//! Materials on a Phong shader.

use super::*;

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
fn extension_used_but_not_required_is_a_warning() {
    let mut model = Model::triangle();
    model.json["extensionsUsed"] = json!(["KHR_materials_clearcoat"]);
    assert_warns(&model.load().unwrap(), "KHR_materials_clearcoat");
}
