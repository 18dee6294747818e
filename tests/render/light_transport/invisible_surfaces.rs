//! Surfaces without any effect on light leave no trace.

use envers::{
    Backend, Camera, Checker, Falloff, Instance, Light, LightKind, Material, Mesh, Plane,
    Precision, Projection, RenderOptions, Renderer, Scene, Shadow, Sphere,
};
use glam::{DAffine3, DVec3, Vec3};

use super::one_pixel::*;

/// A mirror, glass and a matt ball on a checker, a roof, and lights of every kind of shadow.
fn scene() -> Scene {
    let mut scene = Scene::default();
    scene.film.size = [64, 48];
    scene.film.background = Vec3::new(0.2, 0.4, 0.8);
    scene.film.max_depth = 6;
    let eye = DVec3::new(0.3, 1.7, 7.0);
    scene
        .cameras
        .push(Camera::look_at(eye, DVec3::Y * 0.7, DVec3::Y, Projection::FovY(0.8)).unwrap());
    let matt = scene.add_material(Material { specular: Vec3::splat(0.5), ..Material::default() });
    let mut ground = Plane::new(DVec3::ZERO, DVec3::Y, matt);
    ground.checker = Some(Checker { colors: [Vec3::splat(0.9), Vec3::splat(0.1)], size: 0.7 });
    scene.planes.push(ground);
    sphere(&mut scene, DVec3::new(-1.5, 1.0, 0.0), 1.0, mirror(0.9));
    let absorption = Vec3::new(0.7, 0.1, 0.4);
    sphere(&mut scene, DVec3::new(0.8, 0.8, 0.7), 0.8, Material { absorption, ..glass(1.5) });
    scene.spheres.push(Sphere::new(DVec3::new(2.2, 0.6, -1.0), 0.6, matt));
    let roof = scene.add_mesh(Mesh {
        positions: vec![[-3., 3., -3.], [3., 3., -3.], [0., 4., 1.]].into(),
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    });
    scene.instances.push(Instance::new(roof, DAffine3::IDENTITY, matt));
    for (x, shadow) in [(-3.0, Shadow::Tinted), (0.0, Shadow::Opaque), (3.0, Shadow::None)] {
        let position = DVec3::new(x, 5.0, 4.0);
        scene.lights.push(Light {
            name: String::new(),
            kind: LightKind::Point { position, falloff: Falloff::None, range: f64::INFINITY },
            intensity: Vec3::splat(0.4),
            shadow,
            samples: 16,
            shape: None,
        });
    }
    scene
}

fn pixels(scene: &Scene, backend: Backend, precision: Precision) -> Vec<[f32; 3]> {
    let options = RenderOptions { backend: Some(backend), precision, ..RenderOptions::default() };
    Renderer::new(scene).options(options.clone()).render().unwrap().film.pixels
}

/// Compares two scenes bit by bit: in `certified` on each backend, and in `fast` on the one whose
/// arithmetic does not depend on what else stands in the scene.
fn assert_same_pictures(a: &Scene, b: &Scene) {
    for (backend, precision) in [
        (Backend::Rust, Precision::Certified),
        (Backend::default(), Precision::Certified),
        (Backend::Rust, Precision::Fast),
    ] {
        let [a, b] = [a, b].map(|scene| pixels(scene, backend, precision));
        let bits = |p: &[f32; 3]| p.map(f32::to_bits);
        let differing = a.iter().zip(&b).filter(|(a, b)| bits(a) != bits(b)).count();
        assert_eq!(differing, 0, "{backend:?} {precision:?}");
    }
}

#[test]
fn a_sphere_of_index_one_is_not_there() {
    let without = scene();
    let mut with = scene();
    let clear = with.add_material(glass(1.0));
    // Across everything, around the eye, around a light, within the glass, and touching the
    // ground.
    for (center, radius) in [
        (DVec3::new(0.0, 1.0, 0.0), 2.5),
        (DVec3::new(0.3, 1.7, 7.0), 0.5),
        (DVec3::new(3.0, 5.0, 4.0), 1.0),
        (DVec3::new(0.8, 0.8, 0.7), 0.4),
        (DVec3::new(0.0, 0.25, 3.0), 0.25),
    ] {
        // Within the glass only a bubble would be seen, so that it must give way to it.
        with.materials[clear.0 as usize].priority = -1;
        with.spheres.push(Sphere::new(center, radius, clear));
    }
    assert_same_pictures(&with, &without);
}

#[test]
fn a_closed_mesh_of_index_one_is_not_there() {
    let without = scene();
    let mut with = scene();
    let clear = with.add_material(Material { priority: -1, ..glass(1.0) });
    let mesh = with.add_mesh(Mesh {
        positions: vec![[-2., 0.1, 3.], [2., 0.1, 3.], [0., 0.1, -3.], [0., 2.5, 0.]].into(),
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        ..Mesh::default()
    });
    with.instances.push(Instance::new(mesh, DAffine3::IDENTITY, clear));
    assert_same_pictures(&with, &without);
}

#[test]
fn a_clear_pane_of_index_one_is_not_there() {
    let without = scene();
    let mut with = scene();
    let clear = with.add_material(Material { thin: true, ..glass(1.0) });
    with.planes.push(Plane::new(DVec3::Z * 3.0, DVec3::new(0.1, 0.0, 1.0), clear));
    assert_same_pictures(&with, &without);
}

#[test]
fn a_ball_of_water_in_water_is_not_there() {
    let pond = || {
        let mut scene = scene();
        let water = scene.add_material(glass(1.33));
        scene.planes.push(Plane::new(DVec3::Y * 0.5, DVec3::Y, water));
        (scene, water)
    };
    let (without, _) = pond();
    let (mut with, water) = pond();
    with.spheres.push(Sphere::new(DVec3::new(0.0, 0.25, 2.0), 0.2, water));
    assert_same_pictures(&with, &without);
}

#[test]
fn a_surface_that_is_clear_but_absorbs_is_there() {
    let mut with = scene();
    let grey = with.add_material(Material { absorption: Vec3::ONE, ..glass(1.0) });
    with.spheres.push(Sphere::new(DVec3::Y, 2.5, grey));
    let pictures = [with, scene()].map(|s| pixels(&s, Backend::default(), Precision::Certified));
    assert_ne!(pictures[0], pictures[1]);
}
