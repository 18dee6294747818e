//! G10: no light passes a closed mesh, in or out, not even at its edges and vertices, nor where it
//! stands on a plane.

use glam::{DAffine3, DVec3};

use super::backends::{BothPrecisions, on_each_backend};
use super::case::{Case, RaySampler};
use super::meshes::{cube, prism, torus};
use super::self_shadow::incident_light;
use super::{CaseStats, random::Random};
use crate::error::Result;
use crate::geometry::Ray;
use crate::intersect::{Backend, Coherence::Incoherent};
use crate::measure::trace::closest;
use crate::scene::{Instance, Material, Mesh, Plane, Scene};
use crate::surface::Surface;

/// The number of the torus's sections, and of the corners of each.
const TORUS: [u32; 2] = [16, 8];
/// The number of the prism's sides.
const SIDES: u32 = 7;

/// The points of a mesh at which rays are aimed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    Vertices,
    Edges,
    Faces,
    /// The edges on which the mesh stands.
    Feet,
}

/// The place of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Placement {
    /// The mesh as it is: its coordinates have few bits.
    Straight,
    /// Turned about the vertical, and moved this far.
    Turned(f64),
}

/// A closed mesh: its name, how it is made, and how a point within it is found.
#[derive(Clone, Copy)]
struct Enclosure {
    name: &'static str,
    mesh: fn() -> Mesh,
    inside: fn(&mut Random) -> DVec3,
}

const ENCLOSURES: [Enclosure; 3] = [
    Enclosure { name: "cube", mesh: || cube(4), inside: in_cube },
    Enclosure { name: "prism", mesh: || prism(SIDES), inside: in_prism },
    Enclosure { name: "torus", mesh: || torus(TORUS[0], TORUS[1]), inside: in_torus },
];

fn in_cube(random: &mut Random) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| random.range(-0.999, 0.999)))
}

fn in_prism(random: &mut Random) -> DVec3 {
    // Within the circle that its base contains.
    let radius = 0.999 * (std::f64::consts::PI / f64::from(SIDES)).cos();
    let [p, height] = [random.in_ball() * radius, random.direction() * 0.999];
    DVec3::new(p.x, height.y, p.z)
}

fn in_torus(random: &mut Random) -> DVec3 {
    // Between two points of neighbouring sections, well within the circle that a section contains.
    let [p, i] = [random.in_ball() * 0.2, DVec3::splat(random.below(TORUS[0] as usize) as f64)];
    let section = |i: f64| {
        let (sin, cos) = (i / f64::from(TORUS[0]) * std::f64::consts::TAU).sin_cos();
        DVec3::new((0.75 + p.x) * cos, p.y, (0.75 + p.x) * sin)
    };
    section(i.x).lerp(section(i.x + 1.0), random.unit())
}

/// Returns the cases.
pub fn cases() -> Vec<Case> {
    let targets = [
        (Target::Vertices, "vertices"),
        (Target::Edges, "edges"),
        (Target::Faces, "faces"),
        (Target::Feet, "feet"),
    ];
    let placements = [
        (Placement::Straight, "straight"),
        (Placement::Turned(0.0), "turned"),
        (Placement::Turned(1e4), "turned, offset 1e4"),
    ];
    let mut cases = Vec::new();
    for enclosure in ENCLOSURES {
        for ((target, target_name), (placement, placement_name)) in
            targets.into_iter().flat_map(|target| placements.map(|placement| (target, placement)))
        {
            let name = format!("{}, {target_name}, {placement_name}", enclosure.name);
            cases.extend(on_each_backend(&name, move |sampler, backend| {
                check_enclosure(enclosure, target, placement, backend, sampler)
            }));
        }
    }
    cases
}

/// Checks that no point that is seen from outside is lit from inside, and the other way round.
fn check_enclosure(
    enclosure: Enclosure,
    target: Target,
    placement: Placement,
    backend: Backend,
    sampler: &RaySampler,
) -> Result<CaseStats> {
    let scene = scene((enclosure.mesh)(), placement, &mut sampler.shared_random());
    let targets = Targets::new(&scene.meshes[0], target);
    let intersectors = BothPrecisions::build(&scene, backend)?;
    let to_world = scene.instances[0].transform;
    // From outside, above the ground, toward a target, and a lamp inside; or the reverse.
    let ray = |random: &mut Random| {
        let out = random.direction();
        let outside = DVec3::new(out.x, out.y.abs(), out.z) * random.range(3.0, 6.0);
        let inside = (enclosure.inside)(random);
        let ends = random.pick(&[[outside, inside], [inside, outside]]);
        let [origin, lamp] = ends.map(|p| to_world.transform_point3(p));
        (Ray::new(origin, to_world.transform_point3(targets.point(random)) - origin), lamp)
    };
    Ok(sampler.for_each_batch(ray, |rays, stats| {
        let (rays, lamps): (Vec<Ray>, Vec<DVec3>) = rays.iter().copied().unzip();
        let hits = closest(&*intersectors.certified, &rays, Incoherent);
        let seen = rays.iter().zip(lamps).zip(hits).filter_map(|((ray, lamp), hit)| {
            // A ray at a silhouette may pass the mesh; then it sees the ground, if anything.
            let surface = Surface::new(&scene, ray, &hit?);
            let toward = lamp - surface.position;
            // A surface that faces away from the lamp is dark without a shadow ray.
            let faces_lamp = surface.facing_normal().dot(toward) > 0.0;
            faces_lamp.then(|| surface.shadow_ray(ray.direction, &incident_light(toward)))
        });
        let shadow: Vec<Ray> = seen.collect();
        intersectors.count_occluded(&shadow, &vec![true; shadow.len()], stats);
    }))
}

/// Returns a scene with the mesh on the ground, a plane.
fn scene(mesh: Mesh, placement: Placement, random: &mut Random) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let ground = lowest(&mesh);
    scene.planes.push(Plane::new(DVec3::Y * ground, DVec3::Y, material));
    let mesh = scene.add_mesh(mesh);
    let transform = match placement {
        Placement::Straight => DAffine3::IDENTITY,
        // About the vertical, heights do not change.
        Placement::Turned(offset) => {
            let away = DVec3::new(offset, 0.0, -0.7 * offset);
            DAffine3::from_translation(away) * DAffine3::from_rotation_y(random.range(0.1, 1.4))
        }
    };
    scene.instances.push(Instance::new(mesh, transform, material));
    scene
}

/// Returns the least height of a mesh.
fn lowest(mesh: &Mesh) -> f64 {
    mesh.positions.iter().map(|p| p.y).fold(f64::INFINITY, f64::min)
}

/// The triangles at which rays are aimed; of those for feet, the first edge is one.
struct Targets {
    target: Target,
    triangles: Vec<[DVec3; 3]>,
}

impl Targets {
    fn new(mesh: &Mesh, target: Target) -> Self {
        let ground = lowest(mesh);
        let all = (0..mesh.triangles.len() as u32).map(|t| mesh.triangle_vertices(t));
        let triangles = match target {
            // Those that stand on an edge.
            Target::Feet => all
                .flat_map(|[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]])
                .filter(|[a, b, c]| a.y == ground && b.y == ground && c.y > ground)
                .collect(),
            _ => all.collect(),
        };
        Self { target, triangles }
    }

    /// Returns a target, in the mesh's space.
    fn point(&self, random: &mut Random) -> DVec3 {
        let [a, b, c] = random.pick(&self.triangles);
        match self.target {
            Target::Vertices => a,
            Target::Edges => a.lerp(b, random.unit()),
            Target::Faces => a.lerp(b, random.unit()).lerp(c, random.unit()),
            // Half of them have few bits.
            Target::Feet if random.coin() => a.lerp(b, random.below(17) as f64 / 16.0),
            Target::Feet => a.lerp(b, random.unit()),
        }
    }
}
