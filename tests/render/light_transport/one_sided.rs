//! One-sided surfaces: what the viewer sees through their back faces, and what light does not.

use envers::scene::{AlphaMode, Coverage};
use envers::{
    Backend, Camera, Instance, Light, LightKind, LoadOptions, Material, Mesh, Plane, Precision,
    Projection, Renderer, Scene, Shadow,
};
use envers_testing::{Folder, Model};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use serde_json::json;

use super::one_pixel::*;

/// The looks of a surface that is seen from its front only.
fn one_sided(material: Material) -> Material {
    Material { cull_back_faces: true, ..material }
}

/// Adds a square of side 4 about the origin, whose front faces along +z, with a transform.
fn square(scene: &mut Scene, transform: DAffine3, material: Material) -> usize {
    let mesh = scene.add_mesh(Mesh {
        positions: vec![[-2., -2., 0.], [2., -2., 0.], [2., 2., 0.], [-2., 2., 0.]].into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    });
    let material = scene.add_material(material);
    scene.instances.push(Instance::new(mesh, transform, material));
    scene.instances.len() - 1
}

fn at_z(z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::Z * z)
}

fn turned_away(z: f64) -> DAffine3 {
    at_z(z) * DAffine3::from_rotation_y(std::f64::consts::PI)
}

/// A view along −z, off the diagonal of the squares, toward a glow of 0.25.
fn view() -> Scene {
    let mut scene = seen_from(DVec3::new(0.3, 0.1, 9.0), DVec3::new(0.3, 0.1, 0.0));
    let glow = scene.add_material(glow(0.25));
    scene.planes.push(Plane::new(DVec3::Z * -50.0, DVec3::Z, glow));
    scene
}

#[test]
fn a_one_sided_surface_is_seen_from_its_front_only() {
    let mut front = view();
    square(&mut front, at_z(0.0), one_sided(glow(1.0)));
    assert_near(radiance(&front), 1.0);
    let mut back = view();
    square(&mut back, turned_away(0.0), one_sided(glow(1.0)));
    assert_near(radiance(&back), 0.25);
    back.materials[1].cull_back_faces = false;
    assert_near(radiance(&back), 1.0);
}

#[test]
fn a_mirrored_instance_keeps_its_front() {
    let flip = |axis| at_z(0.0) * DAffine3::from_mat3(DMat3::from_diagonal(axis));
    for (axis, expected) in [(DVec3::new(-1.0, 1.0, 1.0), 1.0), (DVec3::new(1.0, 1.0, -1.0), 0.25)]
    {
        let mut scene = view();
        square(&mut scene, flip(axis), one_sided(glow(1.0)));
        assert_near(radiance(&scene), expected);
    }
}

#[test]
fn the_front_behind_any_number_of_back_faces_is_seen() {
    let mut scene = view();
    square(&mut scene, at_z(-1.0), one_sided(glow(0.5)));
    for i in 0..300 {
        square(&mut scene, turned_away(f64::from(i) * 0.01), one_sided(glow(1.0)));
    }
    let (pixel, counts) = rendered(&scene);
    assert_near(pixel, 0.5);
    assert_eq!((counts.rays.refraction, counts.work.culling), (300, 301));
}

#[test]
fn of_two_faces_at_one_place_the_front_is_seen() {
    let mut scene = view();
    square(&mut scene, turned_away(0.0), one_sided(glow(1.0)));
    square(&mut scene, at_z(0.0), one_sided(glow(0.5)));
    assert_near(radiance(&scene), 0.5);
    scene.instances.reverse();
    assert_near(radiance(&scene), 0.5);
}

#[test]
fn a_leaf_of_two_faces_shows_the_one_that_is_turned_to_the_viewer_all_over() {
    // Turned so that the distances round, with the back face before or behind the front one in the
    // scene, on each backend in each precision.
    let turned = DAffine3::from_rotation_y(0.7) * DAffine3::from_rotation_x(0.4);
    let reversed = turned * DAffine3::from_rotation_y(std::f64::consts::PI);
    for places in [[turned, reversed], [reversed, turned]] {
        let mut scene = view();
        scene.film.size = [60, 60];
        scene.cameras[0] =
            Camera::look_at(DVec3::Z * 9.0, DVec3::ZERO, DVec3::Y, Projection::FovY(0.2)).unwrap();
        for place in places {
            let radiance = if place == turned { 0.5 } else { 1.0 };
            square(&mut scene, place, one_sided(glow(radiance)));
        }
        for (backend, precision) in [Backend::Rust, Backend::default()]
            .into_iter()
            .flat_map(|backend| [Precision::Fast, Precision::Certified].map(|p| (backend, p)))
        {
            let renderer = Renderer::new(&scene).backend(backend).precision(precision);
            let pixels = renderer.render().unwrap().film.pixels;
            assert!(pixels.iter().all(|p| p[0] == 0.5), "{} {precision:?}", backend.name());
        }
    }
}

#[test]
fn a_mirror_and_glass_show_what_the_viewer_would_see() {
    // In the mirror at z = −2 a square between is seen from its other side.
    let mirrored = |transform| {
        let mut scene = view();
        scene.planes[0].point = DVec3::Z * 20.0;
        square(&mut scene, at_z(-2.0), mirror(1.0));
        square(&mut scene, transform, one_sided(glow(1.0)));
        radiance(&scene)
    };
    assert_near(mirrored(turned_away(-1.0)), 1.0);
    assert_near(mirrored(at_z(-1.0)), 1.0);
    let behind_glass = |transform| {
        let mut scene = view();
        sphere(&mut scene, DVec3::new(0.3, 0.1, 4.0), 1.0, glass(1.0));
        square(&mut scene, transform, one_sided(glow(1.0)));
        radiance(&scene)
    };
    assert_near(behind_glass(at_z(0.0)), 1.0);
    assert_near(behind_glass(turned_away(0.0)), 0.25);
}

#[test]
fn a_blended_ball_covers_once_where_its_back_faces_are_culled() {
    let coverage = Some(Coverage { alpha: 0.5, map: None, mode: AlphaMode::Blend });
    let black = Material { coverage, thin: true, ior: 1.0, ..one_sided(glow(0.0)) };
    let mut scene = view();
    square(&mut scene, at_z(1.0), black.clone());
    square(&mut scene, turned_away(-1.0), black);
    assert_near(radiance(&scene), 0.125);
}

/// White ground under a sun straight above, with a square of this material between.
fn below(transform: DAffine3, material: Material) -> [f32; 3] {
    let mut scene = seen_from(DVec3::new(0.3, 1.0, 9.1), DVec3::new(0.3, 0.0, 0.1));
    let white = scene.add_material(Material::matte(Vec3::ONE));
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, white));
    scene.lights.push(Light {
        name: String::new(),
        kind: LightKind::Directional { direction: DVec3::NEG_Y, angle: 0.0 },
        intensity: Vec3::ONE,
        shadow: Shadow::Tinted,
        samples: 16,
        shape: None,
    });
    square(&mut scene, transform, material);
    radiance(&scene)
}

fn facing(y: f64, up: bool) -> DAffine3 {
    let angle = if up { -0.5 } else { 0.5 } * std::f64::consts::PI;
    DAffine3::from_translation(DVec3::Y * y) * DAffine3::from_rotation_x(angle)
}

#[test]
fn a_one_sided_surface_shades_from_either_side() {
    for up in [false, true] {
        assert_eq!(below(facing(3.0, up), one_sided(Material::matte(Vec3::ONE))), [0.0; 3]);
    }
}

#[test]
fn light_passes_an_unlit_one_sided_surface_from_behind_only() {
    let unlit = Material { unlit: true, ..glow(1.0) };
    assert_near(below(facing(3.0, false), one_sided(unlit.clone())), 1.0);
    assert_eq!(below(facing(3.0, true), one_sided(unlit.clone())), [0.0; 3]);
    assert_eq!(below(facing(3.0, false), unlit), [0.0; 3]);
    // A mirrored square has its front where its vertices run clockwise.
    let mirrored = facing(3.0, false) * DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let unlit = Material { unlit: true, ..glow(1.0) };
    assert_near(below(mirrored, one_sided(unlit)), 1.0);
}

/// The materials of a glTF triangle, by whether they cull back faces.
fn culls(material: serde_json::Value, options: LoadOptions) -> bool {
    let mut model = Model::triangle();
    model.material(material);
    let folder = Folder::new();
    let path = folder.write("model.glb", model.glb());
    let scene = options.load(path).unwrap().scene;
    scene.materials[scene.instances[0].material.0 as usize].cull_back_faces
}

#[test]
fn gltf_materials_are_one_sided_unless_they_say_otherwise_or_are_glass() {
    let glass = json!({
        "pbrMetallicRoughness": {"metallicFactor": 0},
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}},
    });
    for (material, expected) in [
        (json!({}), true),
        (json!({"doubleSided": false}), true),
        (json!({"doubleSided": true}), false),
        (json!({"alphaMode": "BLEND"}), true),
        (json!({"extensions": {"KHR_materials_unlit": {}}}), true),
        (glass, false),
    ] {
        assert_eq!(culls(material.clone(), LoadOptions::default()), expected, "{material}");
        assert!(!culls(material, LoadOptions::default().double_sided(true)));
    }
}
