//! The share of rays that are answered wrongly beside needles: triangles far longer than they are wide.
//!
//! `cargo bench --bench needles` aims rays at needles and beside them, as often, and compares what bare
//! Embree (with its ROBUST flag) and both precisions find with exact arithmetic: a hit or a miss, and
//! which primitive.

#[allow(dead_code, reason = "each bench uses its own part")]
mod support {
    pub mod arguments;
    pub mod bare;
}

use envers::{
    Bvh, Coherence, Embree, Instance, Intersector, Material, Mesh, Precision, Ray, Scene,
};
use glam::{DAffine3, DVec3};
use support::arguments::Arguments;
use support::bare::{Bare, packets};
use xtask::reference::spheres::SplitMix;

const NEEDLES: u32 = 256;
const RAYS: usize = 200_000;

/// Needles of length 1 along x, one above the other in z. Their points are narrow about y = 0, where f32 has
/// numbers as small as it takes.
fn needles(width: f32) -> Scene {
    let mut random = SplitMix(5);
    let mut mesh = Mesh { name: "needles".into(), ..Mesh::default() };
    let mut positions: Vec<[f32; 3]> = Vec::new();
    for index in 0..NEEDLES {
        let x = random.within(-1.0, 0.0) as f32;
        let z = 2.0 * (index as f32 + 0.5) / NEEDLES as f32 - 1.0;
        let half = 0.5 * width;
        positions.extend([[x, -half, z], [x, half, z], [x + 1.0, 0.0, z]]);
        mesh.triangles.push([3 * index, 3 * index + 1, 3 * index + 2]);
    }
    mesh.positions = positions.into();
    let mut scene = Scene::default();
    let (mesh, material) = (scene.add_mesh(mesh), scene.add_material(Material::default()));
    scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
    scene
}

/// Rays from around the needles to points of them, and to points as far beside them.
fn rays(scene: &Scene) -> Vec<Ray> {
    let mut random = SplitMix(6);
    let mesh = &scene.meshes[0];
    let ray = |i: usize| {
        let [a, b, c] = mesh.triangle_vertices(i as u32 % NEEDLES);
        let base = a.lerp(b, random.within(-0.5, 1.5));
        let target = base.lerp(c, random.within(0.0, 1.0));
        let mut side = || random.within(-2.0, 2.0);
        let origin = DVec3::new(side(), side(), 2.5 + side());
        Ray::new(origin, (target - origin).normalize())
    };
    (0..RAYS).map(ray).collect()
}

/// The triangles that an intersector finds.
fn found(intersector: &dyn Intersector, rays: &[Ray]) -> Vec<Option<u32>> {
    let mut hits = vec![None; rays.len()];
    intersector.closest(rays, Coherence::Incoherent, &mut hits);
    hits.into_iter().map(|hit| hit.map(|hit| hit.id.primitive)).collect()
}

fn main() -> envers::Result<()> {
    let Some(arguments) = Arguments::of_bench("needles") else { return Ok(()) };
    arguments.rest(0);
    println!("{RAYS} rays at {NEEDLES} needles; wrong answers");
    println!(
        "{:<24}{:>8}{:>14}{:>8}{:>11}",
        "width / length", "hits", "bare Embree", "fast", "certified"
    );
    for width in [1e-3, 1e-6, 1e-12] {
        let scene = needles(width);
        let rays = rays(&scene);
        let exact = found(&Bvh::build(&scene, Precision::Certified), &rays);
        let bare = Bare::build(&scene, 1).primitives(&packets(&rays, scene.bounds().center()));
        let [fast, certified] = [Precision::Fast, Precision::Certified]
            .map(|precision| Embree::build(&scene, precision, 1).map(|e| found(&e, &rays)));
        let wrong = |answers: &[Option<u32>]| {
            let count = answers.iter().zip(&exact).filter(|(a, b)| a != b).count();
            format!("{:.2} %", 100.0 * count as f64 / RAYS as f64)
        };
        let hits = 100.0 * exact.iter().flatten().count() as f64 / RAYS as f64;
        let (bare, fast, certified) = (wrong(&bare), wrong(&fast?), wrong(&certified?));
        println!("{width:<24e}{hits:>6.1} %{bare:>14}{fast:>8}{certified:>11}");
    }
    Ok(())
}
