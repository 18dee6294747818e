//! Smooth meshes of few faces: the shadow terminator, and glass.

use std::f64::consts::{PI, TAU};

use envers::{
    Backend, Camera, Instance, Light, Material, Mesh, Precision, Projection, Renderer, Scene,
};
use glam::{DAffine3, DVec3, Vec3};

use super::one_pixel::glass;

/// A ball of radius 1 of `around` times `across` faces, two at each pole, with smooth normals.
fn ball(around: u32, across: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let mut positions = Vec::new();
    for j in 0..=across {
        let (out, up) = (f64::from(j) / f64::from(across) * PI).sin_cos();
        for i in 0..around {
            let (sin, cos) = (f64::from(i) / f64::from(around) * TAU).sin_cos();
            let p = DVec3::new(out * cos, up, out * sin).as_vec3();
            positions.push(p.to_array());
            mesh.normals.push(p.normalize().to_array());
        }
    }
    let index = |i: u32, j: u32| j * around + i % around;
    for (i, j) in (0..around).flat_map(|i| (0..across).map(move |j| (i, j))) {
        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
        // At the poles one of the two would be degenerate.
        if j > 0 {
            mesh.triangles.push([a, b, d]);
        }
        if j + 1 < across {
            mesh.triangles.push([b, c, d]);
        }
    }
    mesh.positions = positions.into();
    mesh
}

/// The ball of this material before a background, seen from +z.
fn scene(mesh: Mesh, material: Material, background: f32) -> Scene {
    let mut scene = Scene::default();
    scene.film.size = [96, 96];
    scene.film.background = Vec3::splat(background);
    let material = scene.add_material(material);
    let mesh = scene.add_mesh(mesh);
    scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
    let projection = Projection::OrthoHeight(2.2);
    let camera = Camera::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, projection).unwrap();
    scene.cameras.push(camera);
    scene
}

/// The red of each pixel; the same on each backend.
fn red(scene: &Scene) -> Vec<f32> {
    let with = |backend| {
        let renderer = Renderer::new(scene).backend(backend).precision(Precision::Certified);
        let pixels = renderer.render().unwrap().film.pixels;
        pixels.iter().map(|pixel| pixel[0]).collect::<Vec<f32>>()
    };
    let pixels = with(Backend::Rust);
    assert_eq!(with(Backend::default()), pixels);
    pixels
}

/// The greatest difference of neighbouring pixels well within the ball.
fn greatest_step(pixels: &[f32]) -> f32 {
    let inside = |x: usize, y: usize| {
        let [x, y] = [x, y].map(|x| (x as f64 + 0.5) / 48.0 - 1.0);
        x.hypot(y) * 1.1 < 0.8
    };
    let mut step = 0f32;
    for (x, y) in (0..95).flat_map(|x| (0..95).map(move |y| (x, y))) {
        for (x1, y1) in [(x + 1, y), (x, y + 1)] {
            if inside(x, y) && inside(x1, y1) {
                step = step.max((pixels[y * 96 + x] - pixels[y1 * 96 + x1]).abs());
            }
        }
    }
    step
}

#[test]
fn the_terminator_of_a_ball_of_few_faces_is_no_staircase() {
    for (around, across) in [(12, 8), (24, 16)] {
        let mut scene = scene(ball(around, across), Material::matte(Vec3::ONE), 0.0);
        scene.lights.push(Light::sun(DVec3::new(-1.0, -0.6, -0.1)));
        let soft = red(&scene);
        scene.film.soft_terminator = false;
        let hard = red(&scene);
        let steps = [&soft, &hard].map(|pixels| greatest_step(pixels));
        assert!(steps[0] < 0.4 * steps[1], "{around} x {across}: {steps:?}");
        // Nothing becomes brighter, and what the sun sees well stays as it was.
        assert!(soft.iter().zip(&hard).all(|(soft, hard)| soft <= hard));
        assert!(
            soft.iter().zip(&hard).filter(|(_, hard)| **hard > 0.9).all(|(a, b)| *a > b * 0.94)
        );
    }
}

#[test]
fn a_flat_mesh_is_not_changed_by_the_terminator() {
    let mut mesh = ball(12, 8);
    mesh.normals.clear();
    let mut scene = scene(mesh, Material::matte(Vec3::ONE), 0.0);
    scene.lights.push(Light::sun(DVec3::new(-1.0, -0.6, -0.1)));
    let soft = red(&scene);
    scene.film.soft_terminator = false;
    assert_eq!(soft, red(&scene));
}

#[test]
fn smooth_glass_of_few_faces_loses_no_more_light_than_flat_glass() {
    let light = |is_smooth: bool| {
        let mut mesh = ball(10, 8);
        if !is_smooth {
            mesh.normals.clear();
        }
        let mut scene = scene(mesh, glass(1.5), 1.0);
        scene.film.max_depth = 24;
        scene.film.cutoff = 1e-4;
        let pixels = red(&scene);
        f64::from(pixels.iter().sum::<f32>()) / pixels.len() as f64
    };
    let (smooth, flat) = (light(true), light(false));
    assert!(smooth > flat - 1e-3, "smooth {smooth}, flat {flat}");
}
