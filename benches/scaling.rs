//! The growth of time with triangles, spheres, lights, pixels and threads: ours beside bare Embree's,
//! in turn in one run.
//!
//! `cargo bench --bench scaling` measures everything, up to 4,000,000 triangles;
//! `-- [--large] [--rounds N] [triangles] [spheres] [lights] [pixels] [threads]` a part of it,
//! with `--large` also 10,000,000 triangles (3 GB of memory).

mod growth {
    pub mod frames;
    pub mod rays;
    pub mod table;
}
#[allow(dead_code, reason = "each bench uses its own part")]
mod support {
    pub mod arguments;
    pub mod bare;
    pub mod batches;
    pub mod clock;
    pub mod scenes;
}

use growth::{frames, rays};
use support::arguments::Arguments;
use support::bare::Bare;
use support::scenes;
use xtask::reference::knot::resolution;

/// The sizes that are measured, and the number of rounds.
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
    let usage =
        "scaling -- [--large] [--rounds N] [triangles] [spheres] [lights] [pixels] [threads]";
    let mut names = Vec::new();
    let plan = match Arguments::of_bench(usage) {
        None => Plan::trial(),
        Some(mut arguments) => {
            let large = arguments.flag("--large");
            let rounds = arguments.value("--rounds").unwrap_or(21);
            names = arguments.rest(0);
            Plan::whole(large, rounds)
        }
    };
    let asked = |name: &str| names.is_empty() || names.iter().any(|n| n == name);
    println!("medians of {} rounds in turn", plan.rounds);
    match [16, 8, 4].into_iter().find(|&w| has_width(w)) {
        Some(16) => measure::<16>(&plan, asked),
        Some(8) => measure::<8>(&plan, asked),
        Some(4) => measure::<4>(&plan, asked),
        _ => measure::<1>(&plan, asked),
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
