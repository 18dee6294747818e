//! The two scenes of the benches, made by formula, and the rays of their pictures.

use envers::{
    Camera, Falloff, Instance, Light, LightKind, Material, Mesh, Projection, Ray, Scene, Shadow,
    Sphere,
};
use glam::{DAffine3, DVec3, Vec3};
use xtask::reference::knot;

/// Width and height of the pictures that are traced.
pub const SIZE: [u32; 2] = [1000, 500];

/// A torus knot from near by, of `rings · sides · 2` triangles: M's, without what stands about it.
pub fn knot(resolution: [u32; 2]) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let knot::Mesh { positions, triangles } = knot::mesh(resolution);
    let mesh =
        Mesh { name: "knot".into(), positions: positions.into(), triangles, ..Mesh::default() };
    let mesh = scene.add_mesh(mesh);
    scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
    with_camera_and_light(scene, DVec3::new(0.25, 0.15, 2.1))
}

/// S: 501 spheres, one large and 500 on a spiral around it.
pub fn spheres() -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    scene.spheres.push(Sphere::new(DVec3::ZERO, 0.7, material));
    for i in 0..500 {
        // The points of a spiral from pole to pole, evenly spread by the golden angle.
        let y = 1.0 - 2.0 * (f64::from(i) + 0.5) / 500.0;
        let (r, a) = ((1.0 - y * y).sqrt(), f64::from(i) * 2.399_963_229_728_653);
        let center = DVec3::new(r * a.cos(), y, r * a.sin()) * (1.0 + 0.2 * f64::from(i % 3));
        scene.spheres.push(Sphere::new(center, 0.03 + 0.005 * f64::from(i % 7), material));
    }
    with_camera_and_light(scene, DVec3::new(0.0, 0.6, 3.6))
}

/// A scene with a camera, which looks at the origin, and the light.
pub fn with_camera_and_light(mut scene: Scene, eye: DVec3) -> Scene {
    scene.film.size = SIZE;
    let camera = Camera::look_at(eye, DVec3::ZERO, DVec3::Y, Projection::FovY(0.9));
    scene.cameras.push(camera.expect("the eye is not at the origin"));
    scene.lights.push(Light {
        name: String::new(),
        kind: LightKind::Point { position: LIGHT, falloff: Falloff::None, range: f64::INFINITY },
        intensity: Vec3::ONE,
        shadow: Shadow::default(),
        samples: 16,
        shape: None,
    });
    scene.check().expect("the benches' scenes are valid");
    scene
}

/// The position of the light, to which shadow rays go.
pub const LIGHT: DVec3 = DVec3::new(3.0, 5.0, 4.0);

/// The primary rays of a picture in squares of four by four, as the renderer sends them.
pub fn primary(scene: &Scene) -> Vec<Ray> {
    let [width, height] = scene.film.size;
    let maker = scene.cameras[0].ray_generator(scene.film.size);
    let mut rays = Vec::with_capacity((width * height) as usize);
    for y in (0..height).step_by(4) {
        for x in (0..width).step_by(4) {
            for (j, i) in (0..4).flat_map(|j| (0..4).map(move |i| (j, i))) {
                rays.push(maker.ray(f64::from(x + i) + 0.5, f64::from(y + j) + 0.5));
            }
        }
    }
    rays
}
