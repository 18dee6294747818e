//! `eclipses.py` reckons with the bodies of the scene that chapter VI.4 renders.

use std::process::Command;

use super::book::{root, tutorial};

#[test]
fn program_and_scene_have_the_same_bodies_and_frames() {
    let scene = envers::load(root().join("assets/scenes/tutorial/6-4-orbit.toml"));
    let scene = scene.expect("the scene loads");
    let [sun, planet, moon] = &scene.scene.spheres[..] else {
        panic!("the scene has three spheres")
    };
    let point = |p: glam::DVec3| format!("({}, {}, {})", p.x, p.y, p.z);
    let animation = scene.scene.animation.as_ref().expect("it is animated");
    let [frames, fps] = [f64::from(animation.frames), animation.fps];
    let of_scene = [sun, planet, moon].map(|sphere| point(sphere.center)).join(" ")
        + &format!(" {} {} {frames} {fps}", planet.radius, moon.radius);

    let print = "from eclipses import *\n\
        points = [f'({p.x:g}, {p.y:g}, {p.z:g})' for p in (soleil, planete, lune)]\n\
        print(*points, R, r, images, par_seconde)";
    let mut command = Command::new("python3");
    command.args(["-B", "-c", print]).current_dir(tutorial().join("programs"));
    let answer = command.output().expect("python3 starts");
    assert_eq!(String::from_utf8_lossy(&answer.stdout).trim(), of_scene);
}
