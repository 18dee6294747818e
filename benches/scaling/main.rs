//! How time grows with triangles, spheres, lights, pixels and threads: ours beside bare Embree's,
//! in turn in one run.
//!
//! `cargo bench --bench scaling` measures everything, up to 4,000,000 triangles;
//! `-- [--large] [--rounds N] [triangles] [spheres] [lights] [pixels] [threads]` a part of it,
//! with `--large` also 10,000,000 triangles (3 GB of memory).

#[allow(dead_code)] // It serves the bench `intersect`, too.
#[path = "../intersect/bare.rs"]
mod bare;
#[path = "../intersect/batches.rs"]
mod batches;
#[path = "../frame/clock.rs"]
mod clock;
mod frames;
mod growth;
mod rays;
#[path = "../../examples/reference/mod.rs"]
mod reference;
#[allow(dead_code)]
#[path = "../intersect/scenes.rs"]
mod scenes;

use bare::Bare;
use reference::knot::resolution;

/// What is measured, and how often.
struct Plan {
    rounds: usize,
    /// Width and height of the pictures; both divisible by 4.
    size: [u32; 2],
    triangles: Vec<usize>,
    spheres: Vec<usize>,
    lights: Vec<usize>,
    /// Each as wide as so many times `size`.
    pixels: Vec<u32>,
}

impl Plan {
    fn whole(large: bool, rounds: usize) -> Self {
        let mut triangles = vec![1_000, 10_000, 100_000, 1_000_000, 4_000_000];
        triangles.extend(large.then_some(10_000_000));
        Self {
            rounds,
            size: scenes::SIZE,
            triangles,
            spheres: (0..=6).map(|power| 10usize.pow(power)).collect(),
            lights: vec![1, 2, 4, 8, 16],
            pixels: vec![1, 2, 4],
        }
    }

    /// Runs through everything, and measures nothing: for `cargo test --benches`.
    fn trial() -> Self {
        Self {
            rounds: 1,
            size: [64, 32],
            triangles: vec![100, 1_000],
            spheres: vec![1, 10],
            lights: vec![1, 2],
            pixels: vec![1, 2],
        }
    }
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let has = |flag: &str| args.iter().any(|a| a == flag);
    let rounds = args.iter().skip_while(|a| *a != "--rounds").nth(1);
    let rounds = rounds.map_or(21, |n| n.parse().expect("--rounds wants a whole number from 1"));
    // Only `cargo bench` passes this; `cargo test --benches` must not take long.
    let is_bench = has("--bench");
    let plan = if is_bench { Plan::whole(has("--large"), rounds) } else { Plan::trial() };
    let names = ["triangles", "spheres", "lights", "pixels", "threads"];
    let all = !names.iter().any(|name| has(name));
    println!("medians of {} rounds in turn", plan.rounds);
    match [16, 8, 4].into_iter().find(|&w| has_width(w)) {
        Some(16) => measure::<16>(&plan, |name| all || has(name)),
        Some(8) => measure::<8>(&plan, |name| all || has(name)),
        Some(4) => measure::<4>(&plan, |name| all || has(name)),
        _ => measure::<1>(&plan, |name| all || has(name)),
    }
}

fn has_width(width: usize) -> bool {
    Bare::build(&scenes::spheres(), width).has(width)
}

/// Measures what is asked for, the bare library in packets of `W`, its widest native ones.
fn measure<const W: usize>(plan: &Plan, asked: impl Fn(&str) -> bool) {
    if asked("triangles") {
        let knots = plan.triangles.iter().map(|&n| scenes::knot(resolution(n)));
        rays::growth::<W>("triangles", knots, plan);
    }
    if asked("spheres") {
        let clouds = plan.spheres.iter().map(|&n| rays::cloud(n));
        rays::growth::<W>("spheres", clouds, plan);
    }
    if asked("lights") {
        frames::lights(plan);
    }
    if asked("pixels") {
        frames::pixels(plan);
    }
    if asked("threads") {
        frames::threads::<W>(plan);
    }
}
