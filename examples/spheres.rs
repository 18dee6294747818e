//! A scene made by hand: three spheres on a chequered ground, written as PNG and EXR.
//!
//! `cargo run --release --example spheres`

use std::path::Path;

use envers::internals::{Settings, write};
use envers::{
    Camera, Checker, Falloff, Light, LightKind, Material, Plane, Projection, Renderer, Result,
    Scene, Shadow, Sphere,
};
use glam::{DVec3, Vec3};

fn main() -> Result<()> {
    let mut scene = Scene::default();
    scene.film.size = [640, 360];
    scene.film.spp = 9;
    scene.film.background = Vec3::new(0.5, 0.65, 0.8);

    let ground = scene.add_material(Material::default());
    let mut plane = Plane::new(DVec3::ZERO, DVec3::Y, ground);
    plane.checker = Some(Checker { colors: [Vec3::splat(0.7), Vec3::splat(0.25)], size: 1.0 });
    scene.planes.push(plane);

    for (x, color) in [(-2.2, Vec3::X), (0.0, Vec3::Y), (2.2, Vec3::Z)] {
        let material = scene.add_material(Material {
            diffuse: color * 0.7 + 0.1,
            specular: Vec3::splat(0.5),
            ..Material::default()
        });
        scene.spheres.push(Sphere::new(DVec3::new(x, 1.0, 0.0), 1.0, material));
    }
    scene.lights.push(Light {
        name: "lamp".to_owned(),
        kind: LightKind::Point {
            position: DVec3::new(4.0, 6.0, 5.0),
            falloff: Falloff::None,
            range: f64::INFINITY,
        },
        intensity: Vec3::ONE,
        shadow: Shadow::default(),
        samples: 16,
        shape: None,
    });
    scene.lights.push(Light {
        name: "sky".to_owned(),
        kind: LightKind::Ambient,
        intensity: Vec3::new(0.2, 0.22, 0.25),
        shadow: Shadow::None,
        samples: 16,
        shape: None,
    });
    let (eye, target) = (DVec3::new(0.0, 2.5, 9.0), DVec3::new(0.0, 0.8, 0.0));
    scene.cameras.push(Camera::look_at(eye, target, DVec3::Y, Projection::FovY(0.6))?);

    let rendering = Renderer::new(&scene).render()?;
    std::fs::create_dir_all("out").ok();
    for file in ["out/spheres.png", "out/spheres.exr"] {
        write(&rendering.film, Path::new(file), &Settings::from_film(&scene.film))?;
        println!("{file}");
    }
    Ok(())
}
