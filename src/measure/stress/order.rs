//! G8: surfaces a few ulp apart are hit in the order of their exact distances, from any distance.

use glam::{DAffine3, DVec3};

use super::backends::{BothPrecisions, on_each_backend};
use super::case::{Case, RaySampler};
use super::{CaseStats, random::Random};
use crate::error::Result;
use crate::geometry::{Hit, Ray};
use crate::intersect::{Backend, Coherence::Incoherent};
use crate::measure::oracle::Oracle;
use crate::measure::trace::{closest, crossings};
use crate::scene::{Instance, Material, Mesh, Plane, Scene, Sphere};

/// The distances of the rays' origins from the surfaces.
const DISTANCES: [f64; 4] = [1.0, 1e5, 1e10, 1e15];
/// The number of pairs.
const PAIRS: u32 = 8;

/// The kind of the surfaces of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Spheres,
    Planes,
    Triangles,
    /// Two pairs of each kind in one place.
    All,
}

/// Returns the cases.
pub fn cases() -> Vec<Case> {
    let kinds = [
        (Kind::Spheres, "a sphere in a sphere"),
        (Kind::Planes, "parallel planes"),
        (Kind::Triangles, "parallel triangles"),
        (Kind::All, "spheres, planes, triangles"),
    ];
    let placed = kinds.into_iter().flat_map(|kind| DISTANCES.map(|distance| (kind, distance)));
    placed
        .flat_map(|((kind, name), distance)| {
            let name = format!("{name}, from {distance:.0e}");
            on_each_backend(&name, move |sampler, backend| {
                check_order(kind, distance, backend, sampler)
            })
        })
        .collect()
}

/// Checks all hits on the way of each ray; in `fast`, which surface is the nearest.
fn check_order(
    kind: Kind,
    distance: f64,
    backend: Backend,
    sampler: &RaySampler,
) -> Result<CaseStats> {
    let (scene, centers) = pairs(kind, &mut sampler.shared_random());
    let intersectors = BothPrecisions::build(&scene, backend)?;
    let oracle = Oracle::new(&scene);
    let place = |hits: &[Hit]| hits.iter().map(|hit| (hit.id, hit.t)).collect::<Vec<_>>();
    let ray = |random: &mut Random| sample_ray(random.pick(&centers), distance, random);
    Ok(sampler.for_each_batch(ray, |rays, stats| {
        let expected = crossings(&scene, &oracle, rays);
        let found = crossings(&scene, &*intersectors.certified, rays);
        let nearest = closest(&*intersectors.fast, rays, Incoherent);
        for ((expected, found), nearest) in expected.iter().zip(&found).zip(nearest) {
            stats.count_wrong(place(found) != place(expected));
            let is_nearest = nearest.map(|hit| hit.id) == expected.first().map(|hit| hit.id);
            stats.count_fast(is_nearest.then_some(0.0));
        }
    }))
}

/// Returns a scene of pairs of surfaces that are seen along x, 1 before each of these centres. Their gaps
/// are from 0 to 2¹⁷ ulp, and either may be the first in the scene.
fn pairs(kind: Kind, random: &mut Random) -> (Scene, Vec<DVec3>) {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let triangle = scene.add_mesh(Mesh {
        positions: vec![[0.0, -2.0, -2.0], [0.0, 4.0, -2.0], [0.0, -2.0, 4.0]].into(),
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    });
    // Planes have no end: all pairs of them are in one place.
    let is_finite = matches!(kind, Kind::Spheres | Kind::Triangles);
    let apart = if is_finite { 8.0 } else { 0.0 };
    let count = if kind == Kind::All { 2 } else { PAIRS };
    let centers: Vec<DVec3> = (0..count).map(|i| DVec3::Y * (apart * f64::from(i))).collect();
    for &center in &centers {
        let ulps = |random: &mut Random| random.below(4) as f64 * 8f64.powi(random.below(6) as i32);
        for _ in 0..2 {
            let mut out = || 1.0 + f64::EPSILON * ulps(random);
            if matches!(kind, Kind::Spheres | Kind::All) {
                scene.spheres.push(Sphere::new(center, out(), material));
            }
            if matches!(kind, Kind::Planes | Kind::All) {
                scene.planes.push(Plane::new(center - DVec3::X * out(), DVec3::NEG_X, material));
            }
            if matches!(kind, Kind::Triangles | Kind::All) {
                let at = DAffine3::from_translation(center - DVec3::X * out());
                scene.instances.push(Instance::new(triangle, at, material));
            }
        }
    }
    (scene, centers)
}

/// Returns a ray at a pair: along x, or from anywhere before it.
fn sample_ray(center: DVec3, distance: f64, random: &mut Random) -> Ray {
    let aside =
        |random: &mut Random| DVec3::new(0.0, random.range(-0.5, 0.5), random.range(-0.5, 0.5));
    let target = center + aside(random);
    let direction =
        if random.coin() { DVec3::X } else { (DVec3::X + random.in_ball() * 0.8).normalize() };
    // The least distance is that of the surface, 1 before the centre.
    let origin = target - DVec3::X - direction * distance;
    let direction = if direction == DVec3::X { DVec3::X } else { target - origin };
    Ray::new(origin, direction * random.power_of_ten(-3.0, 3.0))
}
