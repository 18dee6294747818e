//! Mirrors.

use envers::{Material, Plane};
use glam::{DVec3, Vec3};

use super::one_pixel::*;

#[test]
fn a_mirror_shows_its_share_of_the_background() {
    let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
    scene.film.background = Vec3::splat(0.8);
    sphere(&mut scene, DVec3::ZERO, 1.0, mirror(0.5));
    assert_near(radiance(&scene), 0.4);
}

#[test]
fn a_coloured_mirror_tints_what_it_shows() {
    let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
    scene.film.background = Vec3::ONE;
    let gold = Vec3::new(1.0, 0.75, 0.25);
    sphere(&mut scene, DVec3::ZERO, 1.0, Material { reflect: gold, ..black() });
    assert_eq!(radiance(&scene), gold.to_array());
}

#[test]
fn what_a_mirror_leaves_is_diffuse() {
    use envers::Light;
    use envers::LightKind;
    let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
    scene.film.background = Vec3::splat(0.5);
    let half = Material { diffuse: Vec3::ONE, ..mirror(0.25) };
    sphere(&mut scene, DVec3::ZERO, 1.0, half);
    scene.lights.push(
        Light::new(LightKind::Directional { direction: DVec3::NEG_Z, angle: 0.0 })
            .with_intensity(Vec3::splat(0.4)),
    );
    assert_near(radiance(&scene), 0.75 * 0.4 + 0.25 * 0.5);
}

#[test]
fn a_point_before_a_mirror_sphere_has_its_image_where_the_mirror_equation_puts_it() {
    // 1/s + 1/s' = −2/R for the sphere's outside: R = 1 and s = 3 give s' = −3/7, and an image of a
    // seventh of the height.
    let (distance, height, eye) = (3.0, 0.01, 5.0);
    let image = 1.0 / (2.0 + 1.0 / distance);
    let target = DVec3::new(0.0, height * image / distance, 1.0 - image);
    let seen = |height: f64| {
        let mut scene = seen_from(DVec3::Z * (1.0 + eye), target);
        sphere(&mut scene, DVec3::ZERO, 1.0, mirror(1.0));
        sphere(&mut scene, DVec3::new(0.0, height, 1.0 + distance), 1e-4, glow(1.0));
        radiance(&scene)[0]
    };
    assert_eq!(seen(height), 1.0);
    // A ball of 1% of the height stands elsewhere if it is 2% higher or lower.
    assert_eq!([seen(height * 1.02), seen(height * 0.98)], [0.0; 2]);
}

#[test]
fn between_two_mirrors_what_they_emit_adds_up_as_a_geometric_series() {
    let (share, depth) = (0.5, 12);
    let mut scene = seen_from(DVec3::Z, DVec3::ZERO);
    scene.film.max_depth = depth;
    let both = scene.add_material(Material { emission: Vec3::ONE, ..mirror(share) });
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Z, both));
    scene.planes.push(Plane::new(DVec3::Z * 3.0, DVec3::NEG_Z, both));
    let (pixel, counts) = rendered(&scene);
    let series: f64 = (0..=depth).map(|k| f64::from(share).powi(k as i32)).sum();
    assert_near(pixel, series);
    assert_eq!(counts.rays.reflection, u64::from(depth));
}

#[test]
fn a_mirror_that_is_seen_in_a_mirror_shows_what_stands_behind_the_eye() {
    // A corner of two mirrors sends every ray back where it came from.
    let mut scene = seen_from(DVec3::new(3.0, 2.0, 0.0), DVec3::new(0.0, 1.0, 0.0));
    let id = scene.add_material(mirror(1.0));
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::X, id));
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, id));
    // The way in is along (−3, −1); the way out along (3, 1), from (0, 1) by (−3, 0): on the line
    // y = (x + 3) / 3 − 2 turned up, which passes (9, 2).
    sphere(&mut scene, DVec3::new(9.0, 2.0, 0.0), 0.01, glow(0.5));
    assert_near(radiance(&scene), 0.5);
}
