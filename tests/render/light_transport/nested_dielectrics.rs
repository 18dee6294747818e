//! Bodies within and across others.

use envers::{Material, Plane, Renderer};
use glam::{DVec3, Vec3};

use super::one_pixel::*;

const WATER: f64 = 1.33;

/// The share that goes through a surface between two media, head-on.
fn through(a: f64, b: f64) -> f64 {
    1.0 - ((a - b) / (a + b)).powi(2)
}

/// Water below y = 0, with a white bed 5 deep, seen from straight above.
fn pond() -> envers::Scene {
    let mut scene = seen_from(DVec3::Y * 5.0, DVec3::ZERO);
    // No way to and fro adds to the one straight down.
    scene.film.max_depth = 3;
    let water = scene.add_material(glass(WATER));
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, water));
    let bed = scene.add_material(glow(1.0));
    scene.planes.push(Plane::new(DVec3::NEG_Y * 5.0, DVec3::Y, bed));
    scene
}

fn straight_down(scene: &envers::Scene) -> f64 {
    f64::from(radiance(scene)[0])
}

#[test]
fn glass_in_water_reflects_by_the_ratio_of_the_two() {
    let mut scene = pond();
    let without = straight_down(&scene);
    sphere(&mut scene, DVec3::NEG_Y * 2.0, 1.0, glass(1.5));
    let expected = without * through(WATER, 1.5).powi(2);
    // What comes back from the glass's upper side to the water's surface does not come down again.
    assert!((straight_down(&scene) - expected).abs() < 1e-6, "{expected}");
}

#[test]
fn a_bubble_across_the_waters_surface_has_no_surface_within_it() {
    let mut scene = pond();
    sphere(&mut scene, DVec3::ZERO, 1.0, glass(1.0));
    // Air into the bubble is no surface; the only one is at its lower side.
    assert!((straight_down(&scene) - through(1.0, WATER)).abs() < 1e-6);
}

#[test]
fn a_ball_across_the_waters_surface_is_glass_above_and_below() {
    let mut scene = pond();
    sphere(&mut scene, DVec3::ZERO, 1.0, glass(1.5));
    let expected = through(1.0, 1.5) * through(1.5, WATER);
    assert!((straight_down(&scene) - expected).abs() < 1e-6);
}

#[test]
fn with_a_greater_priority_the_water_is_in_the_ball() {
    let mut scene = pond();
    scene.materials[0].priority = 1;
    sphere(&mut scene, DVec3::ZERO, 1.0, glass(1.5));
    let expected = through(1.0, 1.5) * through(1.5, WATER);
    // The same two shares, but the second surface is the water's own, at y = 0: a white bead just
    // below it shows it.
    sphere(&mut scene, DVec3::NEG_Y * 0.5, 0.1, glow(2.0));
    assert!((straight_down(&scene) - 2.0 * expected).abs() < 1e-6);
    scene.materials[0].priority = 0;
    assert!((straight_down(&scene) - 2.0 * through(1.0, 1.5)).abs() < 1e-6);
}

#[test]
fn absorption_is_that_of_the_body_that_fills_the_place() {
    let mut scene = pond();
    scene.materials[0].absorption = Vec3::splat(0.2);
    let absorption = Vec3::splat(0.5);
    sphere(&mut scene, DVec3::NEG_Y * 2.0, 1.0, Material { absorption, ..glass(WATER) });
    // 2 units of the ball, and 3 of the water.
    let expected = through(1.0, WATER) * (-0.5f64 * 2.0 - 0.2 * 3.0).exp();
    assert!((straight_down(&scene) - expected).abs() < 1e-6);
}

#[test]
fn an_eye_in_the_water_begins_in_the_water() {
    let mut scene = seen_from(DVec3::NEG_Y * 2.0, DVec3::Y);
    scene.film.background = Vec3::ONE;
    scene.film.max_depth = 1;
    let absorption = Vec3::splat(0.3);
    let water = scene.add_material(Material { absorption, ..glass(WATER) });
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, water));
    assert_near(radiance(&scene), through(1.0, WATER) * (-0.6f64).exp());
}

#[test]
fn an_eye_in_a_medium_without_end_sees_nothing_through_it() {
    let mut scene = seen_from(DVec3::NEG_Y * 2.0, DVec3::NEG_Y * 9.0);
    scene.film.background = Vec3::ONE;
    let absorption = Vec3::new(0.1, 0.0, 0.1);
    let water = scene.add_material(Material { absorption, ..glass(WATER) });
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, water));
    assert_eq!(radiance(&scene), [0.0, 1.0, 0.0]);
}

#[test]
fn parallel_rays_that_begin_on_both_sides_of_a_surface_each_begin_in_their_own_medium() {
    use envers::Camera;
    use envers::Projection;
    let mut scene = seen_from(DVec3::ZERO, DVec3::NEG_Z);
    scene.cameras[0] =
        Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, Projection::OrthoHeight(2.0)).unwrap();
    scene.film.size = [1, 2];
    scene.film.background = Vec3::ONE;
    let absorption = Vec3::splat(1.0);
    let water = scene.add_material(Material { absorption, ..glass(WATER) });
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, water));
    let film = Renderer::new(&scene).render().unwrap().film;
    assert_eq!([film.pixel(0, 0)[0], film.pixel(0, 1)[0]], [1.0, 0.0]);
}
