//! Metals that mirror, transmission, volumes, alpha.

use super::*;
use envers::internals::{ShadingParams, TextureContext};
use envers::{Loaded, PrimitiveId};
use serde_json::Value;

/// Returns the material of a file that loads without a warning.
#[track_caller]
fn made(source: Value) -> Material {
    let mut model = Model::triangle();
    model.material(source);
    let Loaded { scene, report, .. } = model.load().unwrap();
    let said: Vec<&String> = report.warnings.iter().filter(|w| !w.contains("not closed")).collect();
    assert_eq!(said, [""; 0]);
    material(&scene).clone()
}

/// A material of glTF's extensions on a dielectric of this base colour.
fn glass(base: [f32; 4], extensions: Value) -> Value {
    json!({
        "pbrMetallicRoughness": {
            "baseColorFactor": base, "metallicFactor": 0.0, "roughnessFactor": 0.0,
        },
        "extensions": extensions,
    })
}

fn transmission(share: f32) -> Value {
    json!({"KHR_materials_transmission": {"transmissionFactor": share}})
}

/// A file whose one material has a picture of this pixel as its base colour.
fn pictured(pixel: [u8; 4], mut source: Value) -> Scene {
    let mut model = Model::triangle();
    model.json["images"] = json!([{"uri": data_uri(&png(&[pixel]))}]);
    model.json["textures"] = json!([{"source": 0}]);
    source["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
    let uvs = model.floats("VEC2", &[0.0; 6]);
    model.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    model.material(source);
    model.load().unwrap().scene
}

fn metal(roughness: f32) -> Value {
    json!({"pbrMetallicRoughness": {
        "baseColorFactor": [1.0, 0.75, 0.5, 1.0], "metallicFactor": 1.0,
        "roughnessFactor": roughness,
    }})
}

#[test]
fn a_smooth_metal_mirrors_in_its_colour() {
    let m = made(metal(0.0));
    assert!(close(m.reflect, [1.0, 0.75, 0.5]), "{}", m.reflect);
    assert_eq!((m.diffuse, m.transmit), (Vec3::ZERO, Vec3::ZERO));
}

#[test]
fn a_metal_mirrors_less_the_rougher_it_is() {
    // (1 − α/0.16)² with α = 0.04.
    assert!(close(made(metal(0.2)).reflect, [0.5625, 0.421875, 0.28125]));
    for roughness in [0.4, 0.7, 1.0] {
        assert_eq!(made(metal(roughness)).reflect, Vec3::ZERO, "{roughness}");
    }
}

#[test]
fn what_is_no_metal_mirrors_nothing() {
    assert_eq!(made(glass([1.0; 4], json!({}))).reflect, Vec3::ZERO);
}

#[test]
fn transmission_without_volume_is_a_thin_wall() {
    let m = made(glass([1.0, 0.5, 0.25, 1.0], transmission(1.0)));
    assert!(close(m.transmit, [1.0, 0.5, 0.25]), "{}", m.transmit);
    assert_eq!((m.thin, m.ior, m.diffuse), (true, 1.5, Vec3::ZERO));
}

#[test]
fn what_is_not_transmitted_is_scattered_as_the_file_means() {
    let m = made(glass([1.0, 0.5, 0.25, 1.0], transmission(0.75)));
    let scattered = (Vec3::ONE - m.reflect - m.transmit) * m.diffuse;
    assert!(close(m.transmit, [0.75, 0.375, 0.1875]), "{}", m.transmit);
    assert!(close(scattered, [0.25, 0.125, 0.0625]), "{scattered}");
}

#[test]
fn frosted_glass_is_drawn_clear_by_phong_with_a_warning() {
    let mut source = glass([1.0; 4], transmission(1.0));
    source["pbrMetallicRoughness"]["roughnessFactor"] = 0.6.into();
    let mut model = Model::triangle();
    model.material(source);
    let options = envers::LoadOptions::default().shading(envers::scene::ShadingModel::Phong);
    assert_warns(&model.load_with(&options).unwrap(), "frosted materials are drawn clear");
    assert_eq!(
        model.load().unwrap().report.warnings.iter().filter(|w| w.contains("clear")).count(),
        0
    );
}

#[test]
fn metal_transmits_nothing() {
    let mut source = metal(0.0);
    source["extensions"] = transmission(1.0);
    let m = made(source);
    assert!(close(m.reflect, [1.0, 0.75, 0.5]) && m.transmit == Vec3::ZERO);
}

#[test]
fn mirrored_and_transmitted_are_at_most_1_together() {
    for metallic in [0.1, 0.3, 0.7, 0.9] {
        let mut source = glass([1.0; 4], transmission(1.0));
        source["pbrMetallicRoughness"]["metallicFactor"] = metallic.into();
        let m = made(source);
        assert!((m.reflect + m.transmit).max_element() <= 1.0 + 1e-6);
        assert!(close(m.transmit, [1.0 - metallic as f32; 3]));
    }
}

#[test]
fn index_of_refraction() {
    let mut extensions = transmission(1.0);
    extensions["KHR_materials_ior"] = json!({"ior": 2.0});
    let m = made(glass([1.0; 4], extensions));
    assert_eq!(m.ior, 2.0);
    // ((2 − 1) / (2 + 1))².
    assert!(close(m.specular, [1.0 / 9.0; 3]));
}

#[test]
fn an_index_of_0_reflects_everything() {
    let mut extensions = transmission(1.0);
    extensions["KHR_materials_ior"] = json!({"ior": 0.0});
    let m = made(glass([1.0; 4], extensions));
    assert_eq!((m.reflect, m.transmit), (Vec3::ONE, Vec3::ZERO));
}

#[test]
fn an_index_that_is_none_is_a_warning() {
    let mut model = Model::triangle();
    model.material(glass([1.0; 4], json!({"KHR_materials_ior": {"ior": 0.5}})));
    assert_warns(&model.load().unwrap(), "indices of refraction");
}

#[test]
fn a_volume_is_a_body_that_absorbs() {
    let mut extensions = transmission(1.0);
    extensions["KHR_materials_volume"] = json!({
        "thicknessFactor": 1.0, "attenuationDistance": 2.0, "attenuationColor": [1.0, 0.5, 0.0],
    });
    let m = made(glass([1.0; 4], extensions));
    assert!(!m.thin);
    // What is left after the distance is the colour; of black, a millionth.
    let left = (-m.absorption * 2.0).exp();
    assert!(close(left, [1.0, 0.5, 0.0]), "{left}");
}

#[test]
fn a_volume_without_thickness_is_a_thin_wall() {
    let mut extensions = transmission(1.0);
    extensions["KHR_materials_volume"] =
        json!({"attenuationDistance": 2.0, "attenuationColor": [0.5, 0.5, 0.5]});
    let m = made(glass([1.0; 4], extensions));
    assert_eq!((m.thin, m.absorption), (true, Vec3::ZERO));
}

#[test]
fn a_volume_at_no_distance_absorbs_nothing() {
    for distance in [json!(0.0), json!(-1.0)] {
        let mut extensions = transmission(1.0);
        extensions["KHR_materials_volume"] = json!({
            "thicknessFactor": 1.0, "attenuationDistance": distance,
            "attenuationColor": [0.5, 0.5, 0.5],
        });
        // The standard wants it above 0, which is a warning.
        let mut model = Model::triangle();
        model.material(glass([1.0; 4], extensions));
        let scene = model.load().unwrap().scene;
        assert_eq!(material(&scene).absorption, Vec3::ZERO);
    }
}

#[test]
fn a_body_that_is_not_closed_is_a_warning() {
    let mut extensions = transmission(1.0);
    extensions["KHR_materials_volume"] = json!({"thicknessFactor": 1.0});
    let mut model = Model::triangle();
    model.material(glass([1.0; 4], extensions));
    assert_warns(&model.load().unwrap(), "not closed at 3 edges");
}

#[test]
fn alpha_counts_for_nothing_unless_the_mode_says_so() {
    assert_eq!(made(glass([1.0, 1.0, 1.0, 0.25], json!({}))).transmit, Vec3::ZERO);
}

#[test]
fn blended_alpha_of_1_is_opaque_and_no_matter() {
    let mut source = glass([1.0; 4], json!({}));
    source["alphaMode"] = "BLEND".into();
    assert_eq!(made(source).transmit, Vec3::ZERO);
}

#[test]
fn alpha_beside_transmission_is_left_out_with_a_warning() {
    let mut source = glass([1.0, 1.0, 1.0, 0.5], transmission(1.0));
    source["alphaMode"] = "BLEND".into();
    let mut model = Model::triangle();
    model.material(source);
    let loaded = model.load().unwrap();
    let scene = &loaded.scene;
    assert_eq!((material(scene).transmit, material(scene).ior), (Vec3::ONE, 1.5));
    assert_warns(&loaded, "the alpha is left out");
}

#[test]
fn unlit_transmits_and_mirrors_nothing() {
    let mut source = metal(0.0);
    source["extensions"] = json!({"KHR_materials_unlit": {}});
    assert_eq!(made(source).reflect, Vec3::ZERO);
}

#[test]
fn transmission_and_volume_can_be_required() {
    let mut model = Model::triangle();
    model.json["extensionsRequired"] =
        json!(["KHR_materials_transmission", "KHR_materials_volume", "KHR_materials_ior"]);
    model.json["extensionsUsed"] = model.json["extensionsRequired"].clone();
    assert_eq!(model.load().unwrap().report.warnings, [""; 0]);
}

/// Returns the shading parameters of the material.
fn shading(scene: &Scene) -> ShadingParams {
    envers::internals::shading_params(scene, material(scene), &TextureContext::default())
}

#[test]
fn a_transmission_texture_counts_point_by_point() {
    let mut model = Model::triangle();
    model.json["images"] = json!([{"uri": data_uri(&png(&[[51, 255, 255, 255]]))}]);
    model.json["textures"] = json!([{"source": 0}]);
    let extension = json!({"KHR_materials_transmission": {
        "transmissionFactor": 0.5, "transmissionTexture": {"index": 0},
    }});
    model.material(glass([1.0; 4], extension));
    assert!(close(shading(&model.load().unwrap().scene).transmit, [0.1; 3]));
}

#[test]
fn blended_alpha_is_seen_straight_through() {
    let mut source = glass([1.0, 0.5, 0.25, 0.25], json!({}));
    source["alphaMode"] = "BLEND".into();
    source["emissiveFactor"] = json!([1.0, 1.0, 1.0]);
    let mut model = Model::triangle();
    model.material(source);
    let scene = model.load().unwrap().scene;
    let (m, f) = (material(&scene), shading(&scene));
    assert_eq!((f.transmit, m.thin, m.ior), (Vec3::splat(0.75), true, 1.0));
    assert!(close(f.diffuse, [1.0, 0.5, 0.25]) && close(f.emission, [0.25; 3]));
}

#[test]
fn the_alpha_of_a_picture_is_blended() {
    let scene = pictured([255, 255, 255, 51], json!({"alphaMode": "BLEND"}));
    assert!(close(shading(&scene).transmit, [0.8; 3]));
}

#[test]
fn the_alpha_of_vertices_is_blended() {
    let mut model = Model::triangle();
    let colors = model.floats("VEC4", &[1., 1., 1., 0.5, 1., 1., 1., 0.5, 1., 1., 1., 0.5]);
    model.primitive()["attributes"]["COLOR_0"] = colors.into();
    model.material(json!({"alphaMode": "BLEND"}));
    let scene = model.load().unwrap().scene;
    assert_eq!(scene.meshes[0].alphas, [0.5; 3]);
    assert!(material(&scene).coverage.is_some());
}

#[test]
fn a_picture_without_alpha_asks_for_no_alpha() {
    for mode in ["BLEND", "MASK"] {
        let scene = pictured([255; 4], json!({"alphaMode": mode}));
        assert_eq!(material(&scene).coverage, None, "{mode}");
    }
}

#[test]
fn masked_alpha_is_all_or_nothing() {
    let id = PrimitiveId::triangle(0, 0, 0);
    for (alpha, cutoff, is_cut) in [(102, None, true), (153, None, false), (153, Some(0.7), true)] {
        let mut source = json!({"alphaMode": "MASK"});
        if let Some(cutoff) = cutoff {
            source["alphaCutoff"] = cutoff.into();
        }
        let scene = pictured([255, 255, 255, alpha], source);
        assert_eq!(scene.is_cut_out(id, 0.1, 0.1), is_cut, "{alpha} at {cutoff:?}");
    }
}
