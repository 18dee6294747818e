//! Time for each ray over the number of triangles and of spheres.

use std::f64::consts::TAU;
use std::hint::black_box;

use envers::{Coherence, Embree, Material, Precision, Ray, Scene, Sphere};
use glam::DVec3;

use super::table::{self, Step};
use crate::Plan;
use crate::support::bare::{Bare, Packet, packets};
use crate::support::batches::Batches;
use crate::support::clock::{median, time};
use crate::support::scenes;
use xtask::reference::spheres::SplitMix;

/// `count` spheres at random in a cube of side 2, the smaller the more there are: they hide about
/// as much of each other's background whatever their number, so that only the number grows.
pub fn cloud(count: usize) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let mut random = SplitMix(count as u64);
    let radius = 1.0 / (count as f64).sqrt();
    for i in 0..count {
        let center = DVec3::from_array(std::array::from_fn(|_| random.within(-1.0, 1.0)));
        let center = if i == 0 { DVec3::ZERO } else { center };
        scene.spheres.push(Sphere::new(center, radius, material));
    }
    scenes::with_camera_and_light(scene, DVec3::new(0.2, 0.3, 2.2))
}

/// `count` rays from anywhere on a sphere about the scene to anywhere on it.
fn random(scene: &Scene, count: usize) -> Vec<Ray> {
    let bounds = scene.bounds();
    let (center, radius) = (bounds.center(), (bounds.upper - bounds.lower).length() / 2.0);
    let mut random = SplitMix(1);
    let mut point = || {
        let (z, turn) = (random.within(-1.0, 1.0), random.within(0.0, TAU));
        let r = (1.0 - z * z).sqrt();
        center + DVec3::new(r * turn.cos(), r * turn.sin(), z) * radius
    };
    (0..count)
        .map(|_| {
            let (from, to) = (point(), point());
            Ray::new(from, (to - from).normalize())
        })
        .collect()
}

const KINDS: [&str; 2] = ["coherent", "random"];

/// Measures scenes of growing size with the rays of a picture, and with random ones.
pub fn growth<const W: usize>(what: &str, scenes: impl Iterator<Item = Scene>, plan: &Plan) {
    let mut steps = Vec::new();
    table::print_head(what, &KINDS);
    for mut scene in scenes {
        scene.film.size = plan.size;
        let primary = scenes::primary(&scene);
        // Each of them takes long: fewer will do.
        let random = random(&scene, primary.len() / 16 / 16 * 16);
        let ours = Embree::build(&scene, Precision::Fast, 1).expect("Embree builds the scene");
        let bare = Bare::build(&scene, W);
        let step = |rays: &[Ray], coherence| step::<W>(&scene, &ours, &bare, rays, coherence, plan);
        steps.push([step(&primary, Coherence::Coherent), step(&random, Coherence::Incoherent)]);
        table::print_row(&steps[steps.len() - 1]);
    }
    for (i, kind) in KINDS.into_iter().enumerate() {
        table::print_growth(what, kind, &steps.iter().map(|s| &s[i]).collect::<Vec<_>>());
    }
}

fn step<const W: usize>(
    scene: &Scene,
    ours: &Embree<'_>,
    bare: &Bare,
    rays: &[Ray],
    coherence: Coherence,
    plan: &Plan,
) -> Step {
    let packets: Vec<Packet<W>> = packets(rays, scene.bounds().center());
    let mut batches = Batches::new(rays);
    let mut hits = 0;
    let mut rounds = Vec::new();
    // The first round warms the caches up.
    for _ in 0..=plan.rounds {
        let ours = time(1, || hits = batches.closest(ours, coherence));
        let bare =
            time(1, || _ = black_box(bare.closest(&packets, coherence == Coherence::Coherent)));
        rounds.push([ours, bare]);
    }
    let of = |value: fn(&[f64; 2]) -> f64| median(rounds[1..].iter().map(value));
    let nanoseconds = 1e9 / rays.len() as f64;
    Step {
        count: scene.spheres.len() + scene.triangle_count() as usize,
        hits: hits as f64 / rays.len() as f64,
        ours: of(|r| r[0]) * nanoseconds,
        bare: of(|r| r[1]) * nanoseconds,
        ratio: of(|r| r[0] / r[1]),
    }
}
