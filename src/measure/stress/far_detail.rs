//! G13: meshes with details of a millimetre are hit exactly, as far from the origin of coordinates as
//! map projections and the Earth's centre are.

use glam::{DAffine3, DVec3};

use super::backends::{BothPrecisions, on_each_backend};
use super::case::{Case, RaySampler};
use super::meshes::{cube, icosphere, torus};
use super::{CaseStats, random::Random};
use crate::error::Result;
use crate::geometry::{PrimitiveId, Ray};
use crate::intersect::{Backend, Coherence::Incoherent};
use crate::measure::{oracle::Oracle, trace::closest};
use crate::scene::{Instance, Material, MaterialId, Mesh, Scene};

/// The centres of the meshes, in metres: in a zone of UTM, and in earth-centred coordinates (ECEF).
const PLACES: [(&str, DVec3); 2] = [
    ("UTM", DVec3::new(500_000.123, 5_000_000.456, 120.789)),
    ("ECEF", DVec3::new(4_201_000.123, 168_000.456, 4_780_000.789)),
];
/// The distances of the rays' origins, in metres.
const DISTANCES: [f64; 3] = [0.1, 10.0, 1e3];
/// The size of the meshes in metres: their triangles are then of about a millimetre.
const SIZE: f64 = 0.005;

/// Returns the cases.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for ((place, at), distance) in PLACES.into_iter().flat_map(|p| DISTANCES.map(|d| (p, d))) {
        let name = format!("{place}, millimetres, from {distance:.0e} m");
        cases.extend(on_each_backend(&name, move |sampler, backend| {
            check_detail(at, distance, backend, sampler)
        }));
    }
    cases
}

/// Checks closest hits by the oracle.
fn check_detail(
    at: DVec3,
    distance: f64,
    backend: Backend,
    sampler: &RaySampler,
) -> Result<CaseStats> {
    let scene = scene(at, &mut sampler.shared_random());
    let (intersectors, oracle) = (BothPrecisions::build(&scene, backend)?, Oracle::new(&scene));
    let ray = |random: &mut Random| sample_ray(&scene, distance, random);
    Ok(sampler.for_each_batch(ray, |rays, stats| {
        intersectors.count_hits(rays, &closest(&oracle, rays, Incoherent), stats);
    }))
}

/// Returns a scene of small meshes close to one another about a point.
fn scene(at: DVec3, random: &mut Random) -> Scene {
    let mut scene = Scene::default();
    scene.add_material(Material::default());
    for mesh in [torus(24, 12), icosphere(2), cube(6)] {
        let offset = random.in_ball() * (2.0 * SIZE);
        let turned = DAffine3::from_quat(random.rotation());
        // In f64, as a surveyed file has them.
        let positions = mesh.positions.map(|_, p| turned.transform_point3(p * SIZE) + offset + at);
        let mesh = scene.add_mesh(Mesh { positions, ..mesh });
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, MaterialId(0)));
    }
    scene
}

/// Returns a ray at a vertex, an edge or any point of a triangle.
fn sample_ray(scene: &Scene, distance: f64, random: &mut Random) -> Ray {
    let instance = random.below(scene.instances.len()) as u32;
    let mesh = scene.instances[instance as usize].mesh.0;
    let triangle = random.below(scene.meshes[mesh as usize].triangles.len()) as u32;
    let [a, b, c] = scene.triangle_vertices(PrimitiveId::triangle(mesh, triangle, instance));
    let target = match random.below(3) {
        0 => a,
        1 => a.lerp(b, random.unit()),
        _ => a.lerp(b, random.unit()).lerp(c, random.unit()),
    };
    let origin = target + random.direction() * distance;
    Ray::new(origin, target - origin)
}
