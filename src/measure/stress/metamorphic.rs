//! G7: what must not change a picture does not: the scale of the scene by a power of two, the
//! number of threads, the tiles.

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::cell::{Cell, Draw};
use super::report::Tally;
use super::shapes::{icosphere, torus};
use crate::error::Result;
use crate::integrator::Tiling;
use crate::intersect::{Backend, Precision};
use crate::render::{RenderOptions, Renderer};
use crate::scene::{
    Camera, Checker, Falloff, Instance, Light, LightKind, Material, Plane, Projection, Scene,
    Shadow, Sphere,
};
use crate::write::png_bytes;

/// Powers of two by which the scene is scaled.
const SCALES: [std::ops::RangeInclusive<i32>; 4] = [-20..=-11, -10..=-1, 1..=10, 11..=20];
/// Pictures of a cell: a perspective and a parallel one for each power.
const PICTURES: u64 = 20;
const THREADS: [usize; 3] = [1, 2, 5];
/// Tilings: rays one by one, odd shapes, the whole picture at once.
const TILINGS: [Tiling; 4] = [
    Tiling { rows: 1, columns: 1, block: 1 },
    Tiling { rows: 5, columns: 7, block: 3 },
    Tiling { rows: 3, columns: 1 << 20, block: 2 },
    Tiling { rows: 1 << 20, columns: 1 << 20, block: 16 },
];

/// The cells.
pub fn cells() -> Vec<Cell> {
    let mut cells = Vec::new();
    for backend in backends() {
        let method = format!("certified, {}", name(backend));
        let like = move |threads, tiling| {
            let precision = Precision::Certified;
            RenderOptions { backend, precision, threads, tiling, ..RenderOptions::default() }
        };
        for scales in SCALES {
            let cell = format!("scaled by 2^{} … 2^{}", scales.start(), scales.end());
            cells.push(Cell::new(cell, &*method, move |draw| {
                let options = like(0, Tiling::default());
                same(draw, &options, |scene| {
                    scales.clone().map(|k| (scaled(scene, k), options.clone())).collect()
                })
            }));
        }
        cells.push(Cell::new("on 1, 2 and 5 threads", &*method, move |draw| {
            same(draw, &like(0, Tiling::default()), |scene| {
                THREADS.map(|n| (scene.clone(), like(n, Tiling::default()))).into()
            })
        }));
        cells.push(Cell::new("in any tiles", &*method, move |draw| {
            same(draw, &like(0, Tiling::default()), |scene| {
                TILINGS.map(|tiling| (scene.clone(), like(0, tiling))).into()
            })
        }));
    }
    cells
}

/// Compares the picture of each camera with what the variants of scene and options make of it.
fn same(
    draw: &Draw,
    options: &RenderOptions,
    variants: impl Fn(&Scene) -> Vec<(Scene, RenderOptions)>,
) -> Result<Tally> {
    let scene = scene(side(draw));
    let variants = variants(&scene);
    let mut tally = Tally::default();
    for camera in 0..scene.cameras.len() {
        let (expected, _) = picture(&scene, options, camera)?;
        for (scene, options) in &variants {
            let (found, rays) = picture(scene, options, camera)?;
            tally.rays += rays;
            let pixels = expected.chunks(3).zip(found.chunks(3));
            tally.misclassified += pixels.filter(|(a, b)| a != b).count() as u64;
            tally.wrong_if(expected.len() != found.len());
        }
    }
    Ok(tally)
}

fn backends() -> Vec<Backend> {
    vec![
        #[cfg(feature = "embree")]
        Backend::Embree,
        Backend::Rust,
    ]
}

fn name(backend: Backend) -> &'static str {
    match backend {
        #[cfg(feature = "embree")]
        Backend::Embree => "embree",
        Backend::Rust => "bvh",
    }
}

/// The side of the square pictures of a cell.
fn side(draw: &Draw) -> u32 {
    (draw.rays as f64 / PICTURES as f64).sqrt().ceil().max(8.0) as u32
}

/// The PNG's bytes of a picture, and how many rays it took.
fn picture(scene: &Scene, options: &RenderOptions, camera: usize) -> Result<(Vec<u8>, u64)> {
    let rendering = Renderer::new(scene).options(options.clone()).camera(camera).render()?;
    Ok((png_bytes(&rendering.film, &rendering.settings), rendering.statistics.counts.rays.total()))
}

/// Spheres of paint, glass and mirrors, a checkered plane, meshes, and a light of every kind.
fn scene(side: u32) -> Scene {
    let mut scene = Scene::default();
    scene.film.size = [side, side];
    let glossy =
        Material { diffuse: Vec3::new(0.3, 0.5, 0.8), specular: Vec3::ONE, ..<_>::default() };
    let glossy = scene.add_material(glossy);
    let matt = scene.add_material(Material::default());
    let mirror = Material { reflect: Vec3::new(0.9, 0.8, 0.6), ..<_>::default() };
    let absorption = Vec3::new(1.0, 0.25, 0.0);
    let glass = Material { transmit: Vec3::ONE, absorption, ..<_>::default() };
    let [mirror, glass] = [mirror, glass].map(|material| scene.add_material(material));
    for i in 0..12 {
        let angle = f64::from(i) * 0.7;
        let center = DVec3::new(2.0 * angle.cos(), 0.3 + 0.1 * f64::from(i), 2.0 * angle.sin());
        let material = [glossy, glass, mirror][i as usize % 3];
        scene.spheres.push(Sphere::new(center, 0.2 + 0.03 * f64::from(i), material));
    }
    let mut ground = Plane::new(DVec3::Y * -0.2, DVec3::new(0.05, 1.0, 0.02), matt);
    ground.checker = Some(Checker { colors: [Vec3::splat(0.2), Vec3::ONE], size: 0.7 });
    scene.planes.push(ground);
    let (ball, ring) = (scene.add_mesh(icosphere(1)), scene.add_mesh(torus(24, 12)));
    for (mesh, at) in [(ball, DVec3::new(0.3, 1.1, -0.2)), (ring, DVec3::Y), (ring, DVec3::Z * 2.0)]
    {
        let turned = DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), at.z + 0.4);
        let transform = DAffine3::from_translation(at) * turned;
        scene.instances.push(Instance::new(mesh, transform, matt));
    }
    let falloff = Falloff::InverseSquare;
    let position = DVec3::new(3.0, 5.0, 4.0);
    let aside = DVec3::new(-4.0, 6.0, 1.0);
    for (kind, intensity) in [
        (LightKind::Ambient, 0.05),
        (LightKind::Directional { direction: DVec3::new(0.48, -0.6, -0.64) }, 0.3),
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
        let intensity = Vec3::splat(intensity);
        scene.lights.push(Light {
            name: String::new(),
            kind,
            intensity,
            shadow: Shadow::default(),
        });
    }
    let position = DVec3::new(1.0, 2.5, 6.0);
    let forward = -position.normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    for lens in [Projection::FovY(0.8), Projection::OrthoHeight(6.0)] {
        scene.cameras.push(Camera {
            name: String::new(),
            position,
            forward,
            right,
            up,
            projection: lens,
        });
    }
    scene
}

/// The scene with every length multiplied by 2ᵏ, and the lights as much stronger as that makes
/// them weaker.
fn scaled(scene: &Scene, k: i32) -> Scene {
    let by = f64::powi(2.0, k);
    let mut scene = scene.clone();
    for sphere in &mut scene.spheres {
        sphere.center *= by;
        sphere.radius *= by;
    }
    for material in &mut scene.materials {
        material.absorption /= by as f32;
    }
    for plane in &mut scene.planes {
        plane.point *= by;
        if let Some(checker) = &mut plane.checker {
            checker.size *= by;
        }
    }
    for instance in &mut scene.instances {
        let DAffine3 { matrix3, translation } = instance.transform;
        let matrix3: DMat3 = matrix3 * by;
        instance.transform = DAffine3 { matrix3, translation: translation * by };
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
