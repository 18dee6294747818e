//! Scenes of one pixel, and what every backend makes of them.

use envers::internals::Counts;
use envers::scene::{MetallicRoughness, MetallicRoughnessMaps, ShadingModel};
use envers::{
    Backend, Camera, Material, MaterialId, Precision, Projection, RenderOptions, Renderer, Scene,
    Sphere,
};
use glam::{DVec3, Vec3};

/// A scene that is seen through one pixel, whose one ray goes from `eye` to `target`.
pub fn seen_from(eye: DVec3, target: DVec3) -> Scene {
    let mut scene = Scene::default();
    scene.film.size = [1, 1];
    let up = if (target - eye).normalize().y.abs() > 0.9 { DVec3::Z } else { DVec3::Y };
    scene.cameras.push(Camera::look_at(eye, target, up, Projection::FovY(0.01)).unwrap());
    scene
}

pub fn black() -> Material {
    Material { diffuse: Vec3::ZERO, ..Material::default() }
}

pub fn mirror(share: f32) -> Material {
    Material { reflect: Vec3::splat(share), ..black() }
}

pub fn glass(ior: f64) -> Material {
    Material { transmit: Vec3::ONE, ior, ..black() }
}

pub fn glow(radiance: f32) -> Material {
    Material { emission: Vec3::splat(radiance), ..black() }
}

pub fn sphere(scene: &mut Scene, center: DVec3, radius: f64, material: Material) -> MaterialId {
    let id = scene.add_material(material);
    scene.spheres.push(Sphere::new(center, radius, id));
    id
}

/// A physically based material.
pub fn pbr(factors: MetallicRoughness) -> Material {
    let mut material = Material { shading: ShadingModel::Pbr, ..Material::default() };
    material.set_metallic_roughness(MetallicRoughnessMaps::new(factors));
    material
}

pub fn metal(roughness: f32) -> MetallicRoughness {
    MetallicRoughness { roughness, ..MetallicRoughness::default() }
}

pub fn plastic(roughness: f32) -> MetallicRoughness {
    MetallicRoughness { metallic: 0.0, ..metal(roughness) }
}

/// The pixel and the counts; the same from each backend in each precision.
pub fn rendered(scene: &Scene) -> ([f32; 3], Counts) {
    let with = |backend, precision| {
        let options = RenderOptions {
            backend: Some(backend),
            precision,
            threads: 1,
            ..RenderOptions::default()
        };
        let rendering = Renderer::new(scene).options(options.clone()).render().unwrap();
        (rendering.film.pixel(0, 0), rendering.statistics.counts)
    };
    let judge = with(Backend::Rust, Precision::Certified);
    assert_eq!(with(Backend::default(), Precision::Certified), judge, "the backends disagree");
    for backend in [Backend::Rust, Backend::default()] {
        let (pixel, _) = with(backend, Precision::Fast);
        let near = pixel.iter().zip(judge.0).all(|(a, b)| (a - b).abs() <= 1e-5 * b.abs());
        assert!(near, "fast {pixel:?}, certified {:?}", judge.0);
    }
    judge
}

pub fn radiance(scene: &Scene) -> [f32; 3] {
    rendered(scene).0
}

pub fn assert_near(pixel: [f32; 3], expected: f64) {
    let near = |x: &f32| (f64::from(*x) - expected).abs() <= 1e-6 * expected.abs().max(1e-3);
    assert!(pixel.iter().all(near), "{pixel:?} instead of {expected}");
}

/// Fresnel's share head-on, from empty space into a medium or out of it.
pub fn head_on(ior: f64) -> f64 {
    ((ior - 1.0) / (ior + 1.0)).powi(2)
}
