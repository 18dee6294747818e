//! Materials: their parameters, and what Lambert and Phong make of them.

use super::*;
use envers::Loaded;
use envers::internals::{ShadingParams, TextureContext, ambient_occlusion, shading_params};
use envers::scene::Transfer;

#[test]
fn primitive_without_material_is_a_neutral_grey() {
    let scene = Model::triangle().load().unwrap().scene;
    assert_eq!(*material(&scene), Material::default());
}

#[test]
fn metallic_roughness_on_phong() {
    let mut model = Model::triangle();
    model.material(json!({"pbrMetallicRoughness": {
        "baseColorFactor": [0.5, 0.25, 1.0, 1.0], "metallicFactor": 0.25, "roughnessFactor": 0.5,
    }}));
    let scene = model.load().unwrap().scene;
    let m = material(&scene);
    assert!(close(m.diffuse, [0.375, 0.1875, 0.75]), "{}", m.diffuse);
    assert!(close(m.specular, [0.155, 0.0925, 0.28]), "{}", m.specular);
    // α = 0.25; 2 / 0.0625 − 2.
    assert!((m.shininess - 30.0).abs() < 1e-4, "{}", m.shininess);
}

/// A triangle with texture coordinates and these pictures, of one pixel each, as textures.
fn pictured(pixels: &[[u8; 4]], material: serde_json::Value) -> Loaded {
    let mut model = Model::triangle();
    let uvs = model.floats("VEC2", &[0.0; 6]);
    model.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    let images: Vec<_> = pixels.iter().map(|&p| json!({"uri": data_uri(&png(&[p]))})).collect();
    let textures: Vec<_> = (0..pixels.len()).map(|i| json!({"source": i})).collect();
    if !pixels.is_empty() {
        (model.json["images"], model.json["textures"]) = (images.into(), textures.into());
    }
    model.material(material);
    model.load().unwrap()
}

/// Returns the shading parameters of the material at a point of this vertex colour.
fn tinted(loaded: &Loaded, tint: Vec3) -> ShadingParams {
    let Loaded { scene, report, .. } = loaded;
    assert_eq!(report.warnings, [""; 0]);
    shading_params(
        scene,
        material(scene),
        &TextureContext { vertex_color: tint, ..TextureContext::default() },
    )
}

fn untinted(loaded: &Loaded) -> ShadingParams {
    tinted(loaded, Vec3::ONE)
}

#[test]
fn metal_and_roughness_are_green_and_blue_of_their_texture() {
    let loaded = pictured(
        &[[0, 128, 51, 255]],
        json!({"pbrMetallicRoughness": {
            "metallicRoughnessTexture": {"index": 0}, "roughnessFactor": 255.0 / 256.0,
        }}),
    );
    let m = untinted(&loaded);
    assert!(close(m.diffuse, [0.8; 3]), "{}", m.diffuse);
    assert!((m.shininess - 30.0).abs() < 1e-3, "{}", m.shininess);
}

#[test]
fn a_metal_is_coloured_by_its_base_colour_texture() {
    let loaded = pictured(
        &[[255, 0, 0, 255]],
        json!({"pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 1.0, 1.0, 1.0],
            "roughnessFactor": 0.0,
        }}),
    );
    let m = untinted(&loaded);
    assert!(close(m.specular, [0.5, 0.0, 0.0]) && close(m.reflect, [0.5, 0.0, 0.0]));
}

#[test]
fn a_metal_is_coloured_by_its_vertices() {
    let loaded = pictured(&[], json!({}));
    assert!(close(tinted(&loaded, Vec3::Y).specular, [0.0, 1.0, 0.0]));
}

#[test]
fn specular_factor_and_colour_change_what_is_no_metal() {
    let specular = json!({"specularFactor": 0.5, "specularColorFactor": [1.0, 0.5, 0.0]});
    let loaded = pictured(
        &[],
        json!({
            "pbrMetallicRoughness": {"metallicFactor": 0.0},
            "extensions": {"KHR_materials_specular": specular},
        }),
    );
    assert!(close(untinted(&loaded).specular, [0.02, 0.01, 0.0]));
}

#[test]
fn specular_textures_are_alpha_and_colour() {
    let specular = json!({
        "specularTexture": {"index": 0}, "specularColorTexture": {"index": 1},
    });
    let loaded = pictured(
        &[[9, 9, 9, 51], [255, 255, 0, 255]],
        json!({
            "pbrMetallicRoughness": {"metallicFactor": 0.0},
            "extensions": {"KHR_materials_specular": specular},
        }),
    );
    assert!(close(untinted(&loaded).specular, [0.008, 0.008, 0.0]));
}

#[test]
fn occlusion_is_red_by_its_strength() {
    let scene = pictured(
        &[[51, 9, 9, 255]],
        json!({
            "occlusionTexture": {"index": 0, "strength": 0.5},
        }),
    )
    .scene;
    let share = ambient_occlusion(&scene, material(&scene), &TextureContext::default());
    // 1 + 0.5 · (0.2 − 1).
    assert!((share - 0.6).abs() < 1e-6, "{share}");
}

#[test]
fn a_normal_texture_has_its_scale_and_makes_tangents() {
    let mut model = Model::triangle();
    let normals = model.floats("VEC3", &[0., 0., 1., 0., 0., 1., 0., 0., 1.]);
    let uvs = model.floats("VEC2", &[0., 1., 1., 1., 0., 0.]);
    model.primitive()["attributes"]["NORMAL"] = normals.into();
    model.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    model.json["images"] = json!([{"uri": data_uri(&png(&[[128, 128, 255, 255]]))}]);
    model.json["textures"] = json!([{"source": 0}]);
    model.material(json!({"normalTexture": {"index": 0, "scale": 0.5}}));
    let scene = model.load().unwrap().scene;
    assert_eq!(material(&scene).normal_map.unwrap().scale, 0.5);
    assert_eq!(scene.meshes[0].tangents, [[1., 0., 0., 1.]; 3]);
    let texture = material(&scene).normal_map.unwrap().texture;
    assert_eq!(scene.textures[texture.0 as usize].transfer, Transfer::None);
}

#[test]
fn tangents_of_the_file_are_kept() {
    let mut model = Model::triangle();
    let normals = model.floats("VEC3", &[0., 0., 1., 0., 0., 1., 0., 0., 1.]);
    let tangents = model.floats("VEC4", &[0., 1., 0., -1., 0., 1., 0., -1., 0., 1., 0., -1.]);
    model.primitive()["attributes"]["NORMAL"] = normals.into();
    model.primitive()["attributes"]["TANGENT"] = tangents.into();
    model.json["images"] = json!([{"uri": data_uri(&png(&[[128, 128, 255, 255]]))}]);
    model.json["textures"] = json!([{"source": 0}]);
    model.material(json!({"normalTexture": {"index": 0}}));
    assert_eq!(model.load().unwrap().scene.meshes[0].tangents, [[0., 1., 0., -1.]; 3]);
}

#[test]
fn without_a_normal_texture_there_are_no_tangents() {
    let scene = pictured(&[[9; 4]], json!({"occlusionTexture": {"index": 0}})).scene;
    assert!(scene.meshes[0].tangents.is_empty());
}

#[test]
fn emission_with_its_strength() {
    let mut model = Model::triangle();
    model.material(json!({
        "emissiveFactor": [1.0, 0.5, 0.0],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0}},
    }));
    assert!(close(material(&model.load().unwrap().scene).emission, [4.0, 2.0, 0.0]));
}

#[test]
fn emission_illuminates_above_a_strength_of_one() {
    let illuminates = |strength: f32, factor: [f32; 3]| {
        let mut model = Model::triangle();
        model.material(json!({
            "emissiveFactor": factor,
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}},
        }));
        material(&model.load().unwrap().scene).illuminates
    };
    assert!(illuminates(1.5, [1.0, 0.5, 0.0]));
    assert!(!illuminates(1.0, [1.0; 3]) && !illuminates(9.0, [0.0; 3]));
}

#[test]
fn unlit_is_emission_alone() {
    let mut model = Model::triangle();
    model.material(json!({
        "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 1.0]},
        "extensions": {"KHR_materials_unlit": {}},
    }));
    let scene = model.load().unwrap().scene;
    let m = material(&scene);
    assert!(close(m.emission, [0.1, 0.2, 0.3]));
    assert_eq!((m.diffuse, m.specular), (Vec3::ZERO, Vec3::ZERO));
}

#[test]
fn unlit_is_coloured_by_its_vertices() {
    let loaded = pictured(
        &[],
        json!({
            "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1.0]},
            "extensions": {"KHR_materials_unlit": {}},
        }),
    );
    assert!(close(tinted(&loaded, Vec3::Y).emission, [0.0, 0.5, 0.0]));
}

#[test]
fn specular_glossiness_texture_is_colour_and_gloss() {
    let loaded = pictured(
        &[[255, 0, 0, 128]],
        json!({"extensions": {
            "KHR_materials_pbrSpecularGlossiness": {
                "specularGlossinessTexture": {"index": 0}, "glossinessFactor": 255.0 / 256.0,
            },
        }}),
    );
    let m = untinted(&loaded);
    assert!(close(m.specular, [1.0, 0.0, 0.0]) && (m.shininess - 30.0).abs() < 1e-3);
}

#[test]
fn specular_glossiness() {
    let mut model = Model::triangle();
    model.material(json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.1, 0.2, 0.3, 1.0], "specularFactor": [0.4, 0.5, 0.6],
        "glossinessFactor": 0.5,
    }}}));
    let scene = model.load().unwrap().scene;
    let m = material(&scene);
    assert!(close(m.diffuse, [0.1, 0.2, 0.3]) && close(m.specular, [0.4, 0.5, 0.6]));
    assert!((m.shininess - 30.0).abs() < 1e-4);
}

#[test]
fn extension_used_but_not_required_is_a_warning() {
    let mut model = Model::triangle();
    model.json["extensionsUsed"] = json!(["KHR_materials_volume_scatter"]);
    assert_warns(&model.load().unwrap(), "KHR_materials_volume_scatter");
}

#[test]
fn layers_of_extensions_are_read_with_their_textures() {
    let mut model = Model::triangle();
    let texture = |i: u32| json!({"index": i});
    model.json["images"] = json!([{"uri": data_uri(&png(&[[255; 4]]))}]);
    model.json["textures"] = json!([{"source": 0}, {"source": 0}, {"source": 0}]);
    model.material(json!({
        "pbrMetallicRoughness": {"metallicFactor": 0.25, "roughnessFactor": 0.5},
        "extensions": {
            "KHR_materials_clearcoat": {
                "clearcoatFactor": 0.75, "clearcoatRoughnessFactor": 0.125,
                "clearcoatTexture": texture(0), "clearcoatRoughnessTexture": texture(1),
                "clearcoatNormalTexture": {"index": 2, "scale": 0.5},
            },
            "KHR_materials_sheen": {
                "sheenColorFactor": [0.1, 0.2, 0.3], "sheenRoughnessFactor": 0.4,
                "sheenRoughnessTexture": texture(0),
            },
            "KHR_materials_anisotropy": {"anisotropyStrength": 0.6, "anisotropyRotation": 1.5},
            "KHR_materials_iridescence": {
                "iridescenceFactor": 0.5, "iridescenceIor": 1.8,
                "iridescenceThicknessMinimum": 200, "iridescenceThicknessMaximum": 600,
            },
            "KHR_materials_dispersion": {"dispersion": 0.25},
            "KHR_materials_diffuse_transmission": {
                "diffuseTransmissionFactor": 0.3, "diffuseTransmissionColorFactor": [1, 0.5, 0],
            },
        },
    }));
    let Loaded { scene, report, .. } = model.load().unwrap();
    assert!(report.warnings.iter().all(|w| w.contains("TEXCOORD_0")), "{:?}", report.warnings);
    let m = material(&scene);
    assert!(m.is_pbr());
    let maps = m.metallic.as_deref().unwrap();
    let f = &maps.factors;
    assert_eq!((f.metallic, f.roughness), (0.25, 0.5));
    assert_eq!((f.clearcoat, f.clearcoat_roughness), (0.75, 0.125));
    assert_eq!(maps.clearcoat.unwrap().channel, 0);
    assert_eq!(maps.clearcoat_roughness.unwrap().channel, 1);
    assert_eq!(m.clearcoat_normal_map.unwrap().scale, 0.5);
    assert!(close(f.sheen_color, [0.1, 0.2, 0.3]) && f.sheen_roughness == 0.4);
    assert_eq!(maps.sheen_roughness.unwrap().channel, 3);
    assert_eq!((f.anisotropy, f.anisotropy_rotation), (0.6, 1.5));
    assert_eq!((f.iridescence, f.iridescence_ior, f.iridescence_thickness), (0.5, 1.8, 600.0));
    assert_eq!(maps.iridescence_thickness_minimum, 200.0);
    assert_eq!((f.dispersion, f.diffuse_transmission), (0.25, 0.3));
    assert!(close(f.diffuse_transmission_color, [1.0, 0.5, 0.0]));
}

#[test]
fn layers_that_are_no_numbers_count_as_missing() {
    let mut model = Model::triangle();
    model.material(json!({"extensions": {
        "KHR_materials_clearcoat": {"clearcoatFactor": "much", "clearcoatTexture": 7},
        "KHR_materials_sheen": {"sheenColorFactor": [0.5, null]},
        "KHR_materials_anisotropy": {"anisotropyStrength": 1, "anisotropyRotation": {}},
        "KHR_materials_iridescence": [],
    }}));
    let loaded = model.load().unwrap();
    let m = material(&loaded.scene);
    let f = &m.metallic.as_deref().unwrap().factors;
    assert_eq!((f.clearcoat, f.iridescence, f.anisotropy_rotation), (0.0, 0.0, 0.0));
    assert!(close(f.sheen_color, [0.5, 0.0, 0.0]));
}

#[test]
fn a_layers_texture_that_is_not_there_is_an_error_at_its_place() {
    let mut model = Model::triangle();
    model.material(json!({"extensions": {
        "KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1], "sheenColorTexture": {"index": 9}},
    }}));
    let (path, _) = json_place(model.load());
    assert_eq!(path, "materials[0].extensions.KHR_materials_sheen.sheenColorTexture.index");
}
