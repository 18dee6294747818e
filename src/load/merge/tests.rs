//! Tests of merged models and their instances.

use super::*;
use crate::scene::{
    Camera, Falloff, Image, LightKind, Mesh, MeshId, Projection, Shadow, Texture, TextureId,
};
use glam::{DMat3, DVec3, Vec3};
use std::sync::Arc;

/// One triangle with a textured material, a spot light and a camera.
fn model() -> Scene {
    let mut model = Scene::default();
    let image = Image::from_bytes("", [1, 1], vec![[9; 4]]);
    let texture = model.add_texture(Texture::new(Arc::new(image)));
    let material = Material { diffuse_map: Some(texture), ..Material::default() };
    let material = model.add_material(material);
    let mesh = model.add_mesh(Mesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].into(),
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    });
    model.instances.push(Instance::new(mesh, DAffine3::from_translation(DVec3::X), material));
    model.lights.push(Light {
        name: "lamp".to_owned(),
        kind: LightKind::Spot {
            position: DVec3::X,
            direction: DVec3::X,
            falloff: Falloff::InverseSquare,
            range: 5.0,
            inner_angle: 0.1,
            outer_angle: 0.2,
        },
        intensity: Vec3::ONE,
        shadow: Shadow::default(),
        samples: 16,
        shape: None,
    });
    let camera = Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, Projection::OrthoHeight(2.0));
    model.cameras.push(camera.unwrap());
    model
}

fn instance(transform: DAffine3) -> ModelInstance {
    ModelInstance {
        transform,
        node: None,
        material: None,
        casts_shadow: true,
        has_lights: true,
        provenance: ObjectProvenance::default(),
    }
}

/// A quarter turn about z, twice as large, moved by 10 along x.
fn turned() -> DAffine3 {
    DAffine3 {
        matrix3: DMat3::from_cols(DVec3::Y * 2.0, DVec3::X * -2.0, DVec3::Z * 2.0),
        translation: DVec3::X * 10.0,
    }
}

#[test]
fn indices_are_moved_past_what_the_scene_has() {
    let mut scene = model();
    let merged = MergedModel::merge(&mut scene, model());
    merged.instantiate(&mut scene, &instance(DAffine3::IDENTITY), &mut Vec::new());
    let second = &scene.instances[1];
    assert_eq!((second.mesh, second.material), (MeshId(1), MaterialId(1)));
    assert_eq!(scene.materials[1].diffuse_map, Some(TextureId(1)));
    scene.check().unwrap();
}

#[test]
fn two_instances_share_one_mesh() {
    let mut scene = Scene::default();
    let merged = MergedModel::merge(&mut scene, model());
    merged.instantiate(&mut scene, &instance(DAffine3::IDENTITY), &mut Vec::new());
    merged.instantiate(&mut scene, &instance(turned()), &mut Vec::new());
    assert_eq!((scene.meshes.len(), scene.materials.len(), scene.textures.len()), (1, 1, 1));
    assert_eq!((scene.instances.len(), scene.lights.len(), scene.cameras.len()), (2, 2, 2));
    scene.check().unwrap();
}

#[test]
fn a_model_without_an_instance_is_not_seen() {
    let mut scene = Scene::default();
    MergedModel::merge(&mut scene, model());
    assert!(scene.instances.is_empty() && scene.lights.is_empty() && scene.cameras.is_empty());
}

#[test]
fn the_instances_transform_comes_after_the_models_own() {
    let mut scene = Scene::default();
    MergedModel::merge(&mut scene, model()).instantiate(
        &mut scene,
        &instance(turned()),
        &mut Vec::new(),
    );
    // (1, 0, 0) by the model, then turned to y, doubled and moved.
    assert_eq!(scene.instances[0].to_world(DVec3::ZERO), DVec3::new(10.0, 2.0, 0.0));
}

#[test]
fn a_light_moves_and_turns_and_keeps_its_strength() {
    let mut scene = Scene::default();
    MergedModel::merge(&mut scene, model()).instantiate(
        &mut scene,
        &instance(turned()),
        &mut Vec::new(),
    );
    let light = &scene.lights[0];
    let LightKind::Spot { position, direction, range, .. } = light.kind else {
        panic!("a spot");
    };
    assert_eq!((position, direction), (DVec3::new(10.0, 2.0, 0.0), DVec3::Y));
    assert_eq!((range, light.intensity), (5.0, Vec3::ONE));
}

#[test]
fn lights_can_be_left_out() {
    let mut scene = Scene::default();
    let dark = ModelInstance { has_lights: false, ..instance(DAffine3::IDENTITY) };
    MergedModel::merge(&mut scene, model()).instantiate(&mut scene, &dark, &mut Vec::new());
    assert!(scene.lights.is_empty());
}

#[test]
fn an_instances_material_replaces_the_models_own() {
    let mut scene = Scene::default();
    let gold = scene.add_material(Material::default());
    let golden = ModelInstance { material: Some(gold), ..instance(DAffine3::IDENTITY) };
    MergedModel::merge(&mut scene, model()).instantiate(&mut scene, &golden, &mut Vec::new());
    assert_eq!(scene.instances[0].material, gold);
}

#[test]
fn shadows_are_cast_unless_the_model_or_its_instance_says_no() {
    let casts = |model_casts: bool, casts_shadow: bool| {
        let (mut scene, mut model) = (Scene::default(), model());
        model.instances[0].casts_shadow = model_casts;
        let instance = ModelInstance { casts_shadow, ..instance(DAffine3::IDENTITY) };
        MergedModel::merge(&mut scene, model).instantiate(&mut scene, &instance, &mut Vec::new());
        scene.instances[0].casts_shadow
    };
    let all = [casts(true, true), casts(true, false), casts(false, true)];
    assert_eq!(all, [true, false, false]);
}

#[test]
fn a_camera_goes_with_its_model_and_sees_as_much_of_it() {
    let mut scene = Scene::default();
    MergedModel::merge(&mut scene, model()).instantiate(
        &mut scene,
        &instance(turned()),
        &mut Vec::new(),
    );
    let camera = &scene.cameras[0];
    assert_eq!(camera.position, DVec3::new(10.0, 0.0, 2.0));
    assert_eq!((camera.forward, camera.up), (-DVec3::Z, -DVec3::X));
    assert_eq!(camera.projection, Projection::OrthoHeight(4.0));
}

#[test]
fn a_camera_in_a_mirrored_model_is_no_mirror() {
    let mut scene = Scene::default();
    let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    MergedModel::merge(&mut scene, model()).instantiate(
        &mut scene,
        &instance(mirror),
        &mut Vec::new(),
    );
    let camera = &scene.cameras[0];
    assert_eq!(camera.right.cross(camera.forward), camera.up);
    scene.check().unwrap();
}

#[test]
fn a_camera_that_loses_its_up_is_a_warning() {
    let (mut scene, mut model) = (Scene::default(), model());
    let tilted = Camera::look_at(DVec3::Z, DVec3::Y, DVec3::Y, Projection::FovY(1.0)).unwrap();
    model.cameras = vec![tilted];
    let flat = DAffine3::from_scale(DVec3::new(1.0, 1e-12, 1.0));
    let mut warnings = Vec::new();
    MergedModel::merge(&mut scene, model).instantiate(&mut scene, &instance(flat), &mut warnings);
    assert_eq!((scene.cameras.len(), warnings.len()), (0, 1));
}
