//! G7: a picture does not change with the scale of the scene (by a power of two), the number of
//! threads, or the tiling.

use std::ops::RangeInclusive;

use glam::{DAffine3, DVec3, Vec3};

use super::CaseStats;
use super::backends::report_name;
use super::case::{Case, RaySampler};
use super::meshes::{icosphere, torus};
use super::scale::scale_geometry;
use crate::error::Result;
use crate::integrator::Tiling;
use crate::intersect::{Backend, Precision};
use crate::render::{RenderOptions, Renderer};
use crate::scene::{
    Camera, Checker, Falloff, Instance, Light, LightKind, Material, Plane, Projection, Scene,
    Sphere,
};
use crate::write::png_bytes;

/// The exponents of the powers of two by which the scene is scaled.
const SCALE_EXPONENTS: [RangeInclusive<i32>; 4] = [-20..=-11, -10..=-1, 1..=10, 11..=20];
/// The number of pictures of a case: a perspective and a parallel one for each exponent.
const PICTURES: u64 = 20;
/// The numbers of threads.
const THREADS: [usize; 3] = [1, 2, 5];
/// The tilings: single rays, odd shapes, and the whole picture at once.
const TILINGS: [Tiling; 4] = [
    Tiling { rows: 1, columns: 1, block: 1 },
    Tiling { rows: 5, columns: 7, block: 3 },
    Tiling { rows: 3, columns: 1 << 20, block: 2 },
    Tiling { rows: 1 << 20, columns: 1 << 20, block: 16 },
];

/// Returns the cases.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for &backend in Backend::available() {
        let name = report_name(backend);
        let method = format!("certified, {name}");
        // Variants of the scene's scale, of the number of threads and of the tiling.
        for exponents in SCALE_EXPONENTS {
            let name = format!("scaled by 2^{} … 2^{}", exponents.start(), exponents.end());
            cases.push(Case::new(name, &*method, move |sampler| {
                compare_variants(sampler, backend, |scene, options| {
                    exponents.clone().map(|k| (scaled(scene, k), options.clone())).collect()
                })
            }));
        }
        cases.push(Case::new("on 1, 2 and 5 threads", &*method, move |sampler| {
            compare_variants(sampler, backend, |scene, options| {
                let on = |threads| RenderOptions { threads, ..options.clone() };
                THREADS.map(|threads| (scene.clone(), on(threads))).into()
            })
        }));
        cases.push(Case::new("in any tiles", &*method, move |sampler| {
            compare_variants(sampler, backend, |scene, options| {
                let tiled = |tiling| RenderOptions { tiling, ..options.clone() };
                TILINGS.map(|tiling| (scene.clone(), tiled(tiling))).into()
            })
        }));
    }
    cases
}

/// Compares the picture of each camera with those of variants of the scene and options, which should
/// be the same.
fn compare_variants(
    sampler: &RaySampler,
    backend: Backend,
    variants: impl Fn(&Scene, &RenderOptions) -> Vec<(Scene, RenderOptions)>,
) -> Result<CaseStats> {
    // Square pictures, of as many pixels together as the case has rays.
    let side = (sampler.rays as f64 / PICTURES as f64).sqrt().ceil().max(8.0) as u32;
    let scene = scene(side);
    let options = RenderOptions {
        backend: Some(backend),
        precision: Precision::Certified,
        ..RenderOptions::default()
    };
    let variants = variants(&scene, &options);
    let mut stats = CaseStats::default();
    for camera in 0..scene.cameras.len() {
        let (expected, _) = picture(&scene, &options, camera)?;
        for (scene, options) in &variants {
            let (found, rays) = picture(scene, options, camera)?;
            stats.rays += rays;
            stats.count_different(expected.as_chunks::<3>().0, found.as_chunks::<3>().0);
            stats.count_wrong(expected.len() != found.len());
        }
    }
    Ok(stats)
}

/// Renders a picture; returns the bytes of its PNG, and the number of rays.
fn picture(scene: &Scene, options: &RenderOptions, camera: usize) -> Result<(Vec<u8>, u64)> {
    let rendering = Renderer::new(scene).options(options.clone()).camera(camera).render()?;
    Ok((png_bytes(&rendering.film, &rendering.settings), rendering.statistics.counts.rays.total()))
}

/// Returns a scene of glossy, glass and mirror spheres, a checkered plane, meshes, and lights of every
/// kind.
fn scene(side: u32) -> Scene {
    let mut scene = Scene::default();
    scene.film.size = [side, side];
    // One material of each kind.
    let (diffuse, absorption) = (Vec3::new(0.3, 0.5, 0.8), Vec3::new(1.0, 0.25, 0.0));
    let glossy = Material { diffuse, specular: Vec3::ONE, ..<_>::default() };
    let mirror = Material { reflect: Vec3::new(0.9, 0.8, 0.6), ..<_>::default() };
    let glass = Material { transmit: Vec3::ONE, absorption, ..<_>::default() };
    let [glossy, matt, mirror, glass] =
        [glossy, Material::default(), mirror, glass].map(|material| scene.add_material(material));
    // Spheres and a plane.
    for i in 0..12 {
        let angle = f64::from(i) * 0.7;
        let center = DVec3::new(2.0 * angle.cos(), 0.3 + 0.1 * f64::from(i), 2.0 * angle.sin());
        let material = [glossy, glass, mirror][i as usize % 3];
        scene.spheres.push(Sphere::new(center, 0.2 + 0.03 * f64::from(i), material));
    }
    let mut ground = Plane::new(DVec3::Y * -0.2, DVec3::new(0.05, 1.0, 0.02), matt);
    ground.checker = Some(Checker { colors: [Vec3::splat(0.2), Vec3::ONE], size: 0.7 });
    scene.planes.push(ground);
    // Meshes.
    let (sphere, ring) = (scene.add_mesh(icosphere(1)), scene.add_mesh(torus(24, 12)));
    for (mesh, at) in
        [(sphere, DVec3::new(0.3, 1.1, -0.2)), (ring, DVec3::Y), (ring, DVec3::Z * 2.0)]
    {
        let turned = DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), at.z + 0.4);
        let transform = DAffine3::from_translation(at) * turned;
        scene.instances.push(Instance::new(mesh, transform, matt));
    }
    // Lights.
    let falloff = Falloff::InverseSquare;
    let position = DVec3::new(3.0, 5.0, 4.0);
    let aside = DVec3::new(-4.0, 6.0, 1.0);
    for (kind, intensity) in [
        (LightKind::Ambient, 0.05),
        (LightKind::Directional { direction: DVec3::new(0.48, -0.6, -0.64), angle: 0.0 }, 0.3),
        (LightKind::Point { position, falloff, range: 40.0 }, 20.0),
        (LightKind::Point { position: aside, falloff: Falloff::None, range: 30.0 }, 0.2),
        (
            LightKind::Spot {
                position: aside,
                direction: -aside.normalize(),
                falloff,
                range: f64::INFINITY,
                inner_angle: 0.2,
                outer_angle: 0.4,
            },
            15.0,
        ),
    ] {
        scene.lights.push(Light::new(kind).with_intensity(Vec3::splat(intensity)));
    }
    // A perspective and a parallel camera.
    let position = DVec3::new(1.0, 2.5, 6.0);
    let forward = -position.normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    for projection in [Projection::FovY(0.8), Projection::OrthoHeight(6.0)] {
        let name = String::new();
        scene.cameras.push(Camera { name, position, forward, right, up, projection, lens: None });
    }
    scene
}

/// Returns the scene with every length multiplied by 2ᵏ, and the intensities of the lights increased
/// to compensate for the distance.
fn scaled(scene: &Scene, k: i32) -> Scene {
    let by = f64::powi(2.0, k);
    let mut scene = scene.clone();
    // Geometry, with the checkerboards of planes.
    scale_geometry(&mut scene, by);
    for checker in scene.planes.iter_mut().filter_map(|plane| plane.checker.as_mut()) {
        checker.size *= by;
    }
    // Absorption is per unit of length, and light falls off with the square of the distance.
    for material in &mut scene.materials {
        material.absorption /= by as f32;
    }
    for light in &mut scene.lights {
        if let LightKind::Point { position, falloff, range }
        | LightKind::Spot { position, falloff, range, .. } = &mut light.kind
        {
            *position *= by;
            *range *= by;
            if *falloff == Falloff::InverseSquare {
                light.intensity *= (by * by) as f32;
            }
        }
    }
    for camera in &mut scene.cameras {
        camera.position *= by;
        if let Projection::OrthoHeight(height) = &mut camera.projection {
            *height *= by;
        }
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_of_the_sweep_are_valid() {
        for k in [-20, 0, 20] {
            scaled(&scene(8), k).check().unwrap();
        }
    }

    #[test]
    fn pictures_of_the_sweep_show_something() {
        let (bytes, _) = picture(&scene(16), &RenderOptions::default(), 0).unwrap();
        let bright = bytes.iter().filter(|b| **b > 40).count();
        assert!(bright > bytes.len() / 4 && bright < bytes.len(), "{bright} of {}", bytes.len());
    }
}
