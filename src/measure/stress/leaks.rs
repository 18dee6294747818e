//! G4: closed meshes have no holes, at vertices and edges least of all.

use glam::{DAffine3, DVec3};

use super::cell::Cell;
use super::random::Random;
use super::report::Beside;
use super::shapes::{INTERSECTORS, closest, cube, icosphere, intersectors, torus};
use crate::geometry::{Hit, PrimitiveId, Ray};
use crate::intersect::{BruteForce, Precision};
use crate::scene::{Instance, Material, Mesh, Scene};

const OFFSETS: [f64; 4] = [0.0, 1e2, 1e4, 1e6];

/// What rays are aimed at.
#[derive(Clone, Copy)]
enum Target {
    Vertices,
    Edges,
    /// Through two vertices of the mesh.
    Diagonals,
    /// Parallel to an axis, at the points of a grid that holds the cube's own vertices.
    Grid,
}

/// The cells.
pub fn cells() -> Vec<Cell> {
    let meshes: [fn() -> Mesh; 3] = [|| icosphere(2), || cube(4), || torus(16, 8)];
    let targets = [
        (Target::Vertices, "vertices"),
        (Target::Edges, "edges"),
        (Target::Diagonals, "diagonals"),
        (Target::Grid, "pixel grid"),
    ];
    let mut cells = Vec::new();
    for mesh in meshes {
        for (target, what) in targets {
            for offset in OFFSETS {
                let name = format!("{}, {what}, offset {offset:.0e}", mesh().name);
                let method = format!("certified, {INTERSECTORS}");
                cells.push(Cell::new(name, method, move |draw| {
                    let scene = scene(mesh(), target, offset, &mut draw.shared());
                    let brute = BruteForce::new(&scene, Precision::Certified);
                    let fast = BruteForce::new(&scene, Precision::Fast);
                    let trees = intersectors(&scene, Precision::Certified)?;
                    let ray = |_, random: &mut Random| ray(&scene, target, random);
                    Ok(draw.batch(ray, |rays, tally| {
                        let mut truth: Vec<Option<Hit>> = Vec::new();
                        for (ray, inside) in rays {
                            let mut first = None;
                            let mut crossings = 0;
                            for hit in brute.all_hits(ray) {
                                Hit::keep_closest(&mut first, hit);
                                crossings += 1;
                            }
                            // An origin inside is left an odd number of times.
                            tally.wrong_if((crossings % 2 == 1) != *inside);
                            let even = (fast.all_hits(ray).count() % 2 == 1) == *inside;
                            let beside = tally.fast.get_or_insert_with(Beside::default);
                            beside.count(even.then_some(0.0));
                            truth.push(first);
                        }
                        let rays: Vec<Ray> = rays.iter().map(|(ray, _)| *ray).collect();
                        for tree in &trees {
                            let found = closest(&**tree, &rays);
                            for (found, truth) in found.iter().zip(&truth) {
                                let same = found.map(|h| (h.id, h.t)) == truth.map(|h| (h.id, h.t));
                                tally.wrong_if(!same);
                            }
                        }
                    }))
                }));
            }
        }
    }
    cells
}

fn scene(mesh: Mesh, target: Target, offset: f64, random: &mut Random) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let mesh = scene.add_mesh(mesh);
    let transform = if matches!(target, Target::Grid) {
        // Powers of two keep the grid's points where they are.
        let offset = if offset == 0.0 { 0.0 } else { offset.log2().round().exp2() };
        DAffine3::from_translation(DVec3::new(offset, -offset, 0.5 * offset))
    } else {
        let away = DVec3::new(offset, -0.7 * offset, 0.3 * offset);
        DAffine3::from_rotation_translation(random.turn(), away)
    };
    scene.instances.push(Instance::new(mesh, transform, material));
    scene
}

/// A ray, and whether it starts inside the mesh.
fn ray(scene: &Scene, target: Target, random: &mut Random) -> (Ray, bool) {
    let instance = &scene.instances[0];
    let place = |p: DVec3| instance.transform.transform_point3(p);
    let triangles = scene.meshes[0].triangles.len();
    let corners = |random: &mut Random| {
        scene.triangle_vertices(PrimitiveId::triangle(0, random.below(triangles) as u32, 0))
    };
    if matches!(target, Target::Grid) {
        let axis = random.below(3);
        let step = |random: &mut Random| random.below(21) as f64 / 8.0 - 1.25;
        let mut start = [step(random), step(random), step(random)];
        let side = random.pick(&[1.0, -1.0]);
        start[axis] = 3.0 * side;
        let ray = Ray::new(place(DVec3::from(start)), DVec3::AXES[axis] * -side);
        return (ray, false);
    }
    let [a, b, _] = corners(random);
    let inside = random.coin();
    // The middle of the ball and of the cube, or a point within the tube of the torus.
    let within = if scene.meshes[0].name == "torus" { DVec3::X * 0.75 } else { DVec3::ZERO };
    let origin = if inside {
        place(within + random.in_ball() * 0.1)
    } else {
        place(random.direction() * random.range(2.0, 6.0))
    };
    match target {
        Target::Vertices => (Ray::new(origin, a - origin), inside),
        Target::Edges => (Ray::new(origin, a.lerp(b, random.unit()) - origin), inside),
        Target::Diagonals | Target::Grid => {
            let [c, ..] = corners(random);
            let other = if c == a { b } else { c };
            (Ray::new(a + (a - other) * 64.0, other - a), false)
        }
    }
}
