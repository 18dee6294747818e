//! Radiance that is not finite: each cause is counted, and none of it reaches a picture.

use envers::internals::NotFinite;
use envers::{
    Backend, Camera, Falloff, Instance, Light, LightKind, Material, MaterialId, Mesh, Projection,
    RenderOptions, Renderer, Scene, Sphere,
};
use glam::{DAffine3, DVec3, Vec3};

/// A wall at z = 0 in one pixel, seen from z = 5.
fn wall(material: Material) -> Scene {
    let mut scene = Scene::default();
    scene.add_material(material);
    scene.film.size = [1, 1];
    let camera = Camera::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, Projection::FovY(0.01));
    scene.cameras.push(camera.unwrap());
    let mesh = scene.add_mesh(Mesh {
        positions: vec![[-9., -9., 0.], [9., -9., 0.], [0., 9., 0.]].into(),
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    });
    scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, MaterialId(0)));
    scene
}

fn lamp(distance: f64, intensity: f32) -> Light {
    let (position, range) = (DVec3::Z * distance, f64::INFINITY);
    let kind = LightKind::Point { position, falloff: Falloff::InverseSquare, range };
    Light::new(kind).with_intensity(Vec3::splat(intensity))
}

fn matt(diffuse: f32) -> Material {
    Material { diffuse: Vec3::splat(diffuse), ..Material::default() }
}

/// Asserts what is counted, and that the pixel is finite; returns it.
#[track_caller]
fn assert_counted(scene: &Scene, expected: NotFinite) -> f32 {
    let options =
        RenderOptions { backend: Some(Backend::Rust), threads: 1, ..RenderOptions::default() };
    let rendering = Renderer::new(scene).options(options.clone()).render().unwrap();
    assert_eq!(rendering.statistics.counts.not_finite, expected);
    let [r, g, b] = rendering.film.pixel(0, 0);
    assert!(r.is_finite() && g.is_finite() && b.is_finite(), "{r} {g} {b}");
    r
}

const NONE: NotFinite = NotFinite { light: 0, surface: 0, sum: 0 };

#[test]
fn light_on_a_surface_is_counted_as_light() {
    let mut scene = wall(matt(0.5));
    scene.lights.push(lamp(1e-20, 1.0));
    assert_counted(&scene, NotFinite { light: 1, ..NONE });
}

#[test]
fn light_that_is_hidden_spoils_nothing() {
    // 1 / distance² is beyond f32, but a ball around the lamp keeps it in.
    let mut scene = wall(matt(0.5));
    scene.lights.push(lamp(1e-20, 1.0));
    scene.spheres.push(Sphere::new(DVec3::Z * 1e-20, 1e-21, MaterialId(0)));
    assert_eq!(assert_counted(&scene, NONE), 0.0);
}

#[test]
fn vertex_colour_times_diffuse_is_counted_as_surface() {
    let mut scene = wall(matt(1e20));
    std::sync::Arc::make_mut(&mut scene.meshes[0]).colors = vec![[1e20; 3]; 3];
    scene.lights.push(lamp(1.0, 1.0));
    assert_counted(&scene, NotFinite { surface: 1, ..NONE });
}

#[test]
fn finite_light_on_a_finite_surface_is_counted_as_sum() {
    let mut scene = wall(matt(1e20));
    scene.lights.push(lamp(1.0, 1e20));
    assert_counted(&scene, NotFinite { sum: 1, ..NONE });
}

#[test]
fn finite_lights_that_add_up_to_more_are_counted_as_sum() {
    let mut scene = wall(matt(1.0));
    scene.lights.extend([lamp(1.0, 3e38), lamp(1.0, 3e38)]);
    assert_counted(&scene, NotFinite { sum: 1, ..NONE });
}

#[test]
fn ambient_light_counts_as_sum_too() {
    let mut scene = wall(matt(1e20));
    scene.lights.push(Light { kind: LightKind::Ambient, ..lamp(1.0, 1e20) });
    assert_counted(&scene, NotFinite { sum: 1, ..NONE });
}

#[test]
fn samples_that_add_up_to_more_have_their_mean() {
    let mut scene = wall(Material { emission: Vec3::splat(2e38), ..matt(0.0) });
    scene.film.spp = 4;
    assert_eq!(assert_counted(&scene, NONE), 2e38);
}

#[test]
fn samples_beyond_f32_are_left_out_one_by_one() {
    // Each is what the wall emits, and as much that it mirrors.
    let glow = Vec3::splat(2e38);
    let mut scene = wall(Material { emission: glow, reflect: Vec3::ONE, ..matt(0.0) });
    scene.film.background = glow;
    scene.film.spp = 4;
    assert_eq!(assert_counted(&scene, NotFinite { sum: 4, ..NONE }), 0.0);
}

#[test]
fn a_sample_counts_once_whatever_else_spoils_it() {
    let mut scene = wall(matt(1e20));
    scene.lights.extend([lamp(1e-20, 1.0), lamp(1.0, 1e20), lamp(1e-20, 1.0)]);
    assert_counted(&scene, NotFinite { light: 1, ..NONE });
}
