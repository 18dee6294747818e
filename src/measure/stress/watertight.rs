//! G4: closed meshes have no holes, not even at vertices and edges.

use glam::{DAffine3, DVec3};

use super::backends::{intersector_names, intersectors};
use super::meshes::{cube, icosphere, torus};
use super::{CaseStats, case::Case, random::Random};
use crate::geometry::{Hit, PrimitiveId, Ray};
use crate::intersect::{BruteForce, Coherence, Precision};
use crate::measure::trace::closest;
use crate::scene::{Instance, Material, Mesh, Scene};

/// The distances of the mesh from the world's origin.
const OFFSETS: [f64; 4] = [0.0, 1e2, 1e4, 1e6];

/// The points of a mesh at which rays are aimed.
#[derive(Clone, Copy)]
enum Target {
    Vertices,
    Edges,
    /// Lines through two vertices of the mesh.
    Diagonals,
    /// The points of a grid that contains the cube's vertices, by rays parallel to an axis.
    Grid,
}

/// A ray, and whether it starts inside the mesh.
#[derive(Clone, Copy)]
struct Sample {
    ray: Ray,
    starts_inside: bool,
}

/// Returns the cases.
pub fn cases() -> Vec<Case> {
    let meshes: [fn() -> Mesh; 3] = [|| icosphere(2), || cube(4), || torus(16, 8)];
    let targets = [
        (Target::Vertices, "vertices"),
        (Target::Edges, "edges"),
        (Target::Diagonals, "diagonals"),
        (Target::Grid, "pixel grid"),
    ];
    let mut cases = Vec::new();
    let targeted = meshes.into_iter().flat_map(|mesh| targets.map(|target| (mesh, target)));
    for (mesh, (target, target_name)) in targeted {
        for offset in OFFSETS {
            let name = format!("{}, {target_name}, offset {offset:.0e}", mesh().name);
            let method = format!("certified, {}", intersector_names());
            cases.push(Case::new(name, method, move |sampler| {
                let scene = scene(mesh(), target, offset, &mut sampler.shared_random());
                let brute = BruteForce::new(&scene, Precision::Certified);
                let fast = BruteForce::new(&scene, Precision::Fast);
                let intersectors = intersectors(&scene, Precision::Certified)?;
                // Brute force tells what the mesh is like; the trees must agree with it.
                let sample = |random: &mut Random| sample_ray(&scene, target, random);
                Ok(sampler.for_each_batch(sample, |samples, stats| {
                    let expected = count_crossings(samples, &brute, &fast, stats);
                    let rays: Vec<Ray> = samples.iter().map(|sample| sample.ray).collect();
                    for intersector in &intersectors {
                        let found = closest(&**intersector, &rays, Coherence::Incoherent);
                        for (found, expected) in found.iter().zip(&expected) {
                            let [a, b] = [found, expected].map(|hit| hit.map(|h| (h.id, h.t)));
                            stats.count_wrong(a != b);
                        }
                    }
                }))
            }));
        }
    }
    cases
}

/// Counts the rays that do not cross the mesh an odd number of times if they start inside, and an
/// even number otherwise. Returns the certified closest hits.
fn count_crossings(
    samples: &[Sample],
    brute: &BruteForce<'_>,
    fast: &BruteForce<'_>,
    stats: &mut CaseStats,
) -> Vec<Option<Hit>> {
    samples
        .iter()
        .map(|Sample { ray, starts_inside }| {
            let is_closed = |crossings: usize| (crossings % 2 == 1) == *starts_inside;
            // In exact arithmetic; what the formulas of `fast` find is reported only.
            stats.count_wrong(!is_closed(brute.all_hits(ray).count()));
            stats.count_fast(is_closed(fast.all_hits(ray).count()).then_some(0.0));
            brute.closest_hit(ray)
        })
        .collect()
}

/// Returns a scene with an instance of the mesh.
fn scene(mesh: Mesh, target: Target, offset: f64, random: &mut Random) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let mesh = scene.add_mesh(mesh);
    let transform = if matches!(target, Target::Grid) {
        // Powers of two, by which the grid's points are translated exactly.
        let offset = if offset == 0.0 { 0.0 } else { offset.log2().round().exp2() };
        DAffine3::from_translation(DVec3::new(offset, -offset, 0.5 * offset))
    } else {
        let away = DVec3::new(offset, -0.7 * offset, 0.3 * offset);
        DAffine3::from_rotation_translation(random.rotation(), away)
    };
    scene.instances.push(Instance::new(mesh, transform, material));
    scene
}

/// Returns a random ray at a target.
fn sample_ray(scene: &Scene, target: Target, random: &mut Random) -> Sample {
    let instance = &scene.instances[0];
    let to_world = |p: DVec3| instance.transform.transform_point3(p);
    let triangles = scene.meshes[0].triangles.len();
    let corners = |random: &mut Random| {
        scene.triangle_vertices(PrimitiveId::triangle(0, random.below(triangles) as u32, 0))
    };
    // On the grid: an axis-parallel ray through a multiple of 1/8, from outside.
    if matches!(target, Target::Grid) {
        let axis = random.below(3);
        let step = |random: &mut Random| random.below(21) as f64 / 8.0 - 1.25;
        let mut start = [step(random), step(random), step(random)];
        let side = random.pick(&[1.0, -1.0]);
        start[axis] = 3.0 * side;
        let ray = Ray::new(to_world(DVec3::from(start)), DVec3::AXES[axis] * -side);
        return Sample { ray, starts_inside: false };
    }
    // At a vertex or an edge: from anywhere inside or outside.
    let [a, b, _] = corners(random);
    let starts_inside = random.coin();
    // The centre of the sphere and of the cube, or a point within the tube of the torus.
    let inside = if scene.meshes[0].name == "torus" { DVec3::X * 0.75 } else { DVec3::ZERO };
    let origin = if starts_inside {
        to_world(inside + random.in_ball() * 0.1)
    } else {
        to_world(random.direction() * random.range(2.0, 6.0))
    };
    match target {
        Target::Vertices => Sample { ray: Ray::new(origin, a - origin), starts_inside },
        Target::Edges => {
            Sample { ray: Ray::new(origin, a.lerp(b, random.unit()) - origin), starts_inside }
        }
        Target::Diagonals | Target::Grid => {
            // Along the line from another vertex, starting far outside.
            let [c, ..] = corners(random);
            let other = if c == a { b } else { c };
            Sample { ray: Ray::new(a + (a - other) * 64.0, other - a), starts_inside: false }
        }
    }
}
