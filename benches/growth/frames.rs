//! Time of whole frames, shading included, over lights, pixels and threads.

use std::f64::consts::TAU;
use std::hint::black_box;

use envers::internals::Traced;
use envers::{Embree, LightKind, Precision, Renderer, Scene};
use glam::DVec3;
use rayon::ThreadPool;
use rayon::prelude::*;

use super::table::slope;
use crate::Plan;
use crate::support::bare::{Bare, Packet, packets};
use crate::support::clock::{median, time};
use crate::support::scenes;
use xtask::reference::knot::resolution;

/// The scenes whose frames are made, and what they are called.
fn both() -> [(&'static str, Scene); 2] {
    let knot = scenes::knot(resolution(100_000));
    [("a knot of 100,000 triangles", knot), ("501 spheres", scenes::spheres())]
}

fn pool(threads: usize) -> ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start")
}

/// Renders a frame on the current pool; returns how many rays that took.
fn frame(scene: &Scene, intersector: &Embree<'_>) -> u64 {
    let Traced { film, counts, .. } = Renderer::new(scene).render_with(intersector);
    black_box(film);
    counts.rays.total()
}

/// Frames with ever more point lights, on a circle about the scene's own.
pub fn lights(plan: &Plan) {
    for (name, base) in both() {
        let scenes = plan.lights.iter().map(|&count| {
            let mut scene = base.clone();
            let light = base.lights[0].clone();
            scene.film.size = plan.size;
            scene.lights = (0..count)
                .map(|i| {
                    let (sine, cosine) = (TAU * i as f64 / count as f64).sin_cos();
                    let mut light = light.clone();
                    if let LightKind::Point { position, .. } = &mut light.kind {
                        *position += DVec3::new(cosine, sine, 0.0);
                    }
                    light
                })
                .collect();
            (count, scene)
        });
        table(name, "lights", scenes, plan);
    }
}

/// Ever larger pictures.
pub fn pixels(plan: &Plan) {
    for (name, base) in both() {
        let scenes = plan.pixels.iter().map(|&factor| {
            let mut scene = base.clone();
            scene.film.size = plan.size.map(|n| n * factor);
            ((scene.film.size[0] * scene.film.size[1]) as usize, scene)
        });
        table(name, "pixels", scenes, plan);
    }
}

fn table(name: &str, what: &str, scenes: impl Iterator<Item = (usize, Scene)>, plan: &Plan) {
    println!("\nframes of {name}, one thread");
    println!("{what:>10}        rays       ms  ns a ray");
    let one = pool(1);
    let mut points = Vec::new();
    for (count, scene) in scenes {
        let intersector = Embree::build(&scene, Precision::Fast, 1).expect("Embree builds it");
        let rays = one.install(|| frame(&scene, &intersector));
        let rounds =
            (0..plan.rounds).map(|_| one.install(|| time(1, || _ = frame(&scene, &intersector))));
        let seconds = median(rounds);
        let each = seconds * 1e9 / rays as f64;
        println!("{count:>10} {rays:>11} {:8.1} {each:9.1}", seconds * 1e3);
        points.push([rays as f64, seconds]);
    }
    println!("time grows as rays^{:.3}", slope(&points));
}

/// Measures the gain of a second thread for frames, and for the bare library with their primary rays.
pub fn threads<const W: usize>(plan: &Plan) {
    for (name, mut scene) in both() {
        scene.film.size = plan.size;
        let ours = Embree::build(&scene, Precision::Fast, 1).expect("Embree builds it");
        let bare = Bare::build(&scene, W);
        let packets: Vec<Packet<W>> = packets(&scenes::primary(&scene), scene.bounds().center());
        let pools = [pool(1), pool(2)];
        let mut rounds = Vec::new();
        // The first round warms the caches up. One thread, too, is timed by the clock on the wall.
        for _ in 0..=plan.rounds {
            let ours = [0, 1].map(|i| pools[i].install(|| time(2, || _ = frame(&scene, &ours))));
            let bare = [0, 1].map(|i| {
                let trace = |some: &[Packet<W>]| bare.closest(some, true);
                let all = || packets.par_chunks(64).map(trace).sum::<usize>();
                pools[i].install(|| time(2, || _ = black_box(all())))
            });
            rounds.push([ours[0] / ours[1], bare[0] / bare[1]]);
        }
        let of = |value: fn(&[f64; 2]) -> f64| median(rounds[1..].iter().map(value));
        println!(
            "\n{name}, 2 threads beside 1: ours × {:.2}, bare × {:.2}, ratio {:.3}",
            of(|r| r[0]),
            of(|r| r[1]),
            of(|r| r[0] / r[1]),
        );
    }
}
