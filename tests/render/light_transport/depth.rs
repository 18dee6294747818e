//! The depth to which secondary rays are traced, and its cost.

use envers::internals::{RayCounts, Tiling};
use envers::scene::{AlphaMode, Coverage};
use envers::{Material, Plane, RenderOptions, Renderer, Scene};
use glam::{DVec3, Vec3};

use super::one_pixel::*;

/// Between two whole mirrors that glow a little.
fn hall(depth: u32) -> Scene {
    let mut scene = seen_from(DVec3::Z, DVec3::ZERO);
    scene.film.max_depth = depth;
    let both = scene.add_material(Material { emission: Vec3::splat(0.125), ..mirror(1.0) });
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Z, both));
    scene.planes.push(Plane::new(DVec3::Z * 3.0, DVec3::NEG_Z, both));
    scene
}

#[test]
fn at_depth_nothing_a_mirror_is_black() {
    let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
    scene.film.background = Vec3::ONE;
    scene.film.max_depth = 0;
    sphere(&mut scene, DVec3::ZERO, 1.0, mirror(1.0));
    assert_eq!(radiance(&scene), [0.0; 3]);
}

#[test]
fn ten_thousand_reflections_are_ten_thousand_rays() {
    let (pixel, counts) = rendered(&hall(10_000));
    assert_eq!(counts.rays.reflection, 10_000);
    assert_near(pixel, 0.125 * 10_001.0);
}

#[test]
fn rays_of_no_more_than_the_cutoff_are_not_followed() {
    let mut scene = hall(100);
    scene.materials[0].reflect = Vec3::splat(0.5);
    scene.film.cutoff = 0.1;
    // 1/2, 1/4 and 1/8 of the pixel; 1/16 is less than a tenth.
    assert_eq!(rendered(&scene).1.rays.reflection, 3);
}

#[test]
fn rays_that_can_add_nothing_are_not_followed() {
    let mut scene = hall(65_536);
    scene.materials[0].reflect = Vec3::splat(0.5);
    // The greatest f32 times 2^−280 is less than half of the least.
    assert_eq!(rendered(&scene).1.rays.reflection, 279);
}

#[test]
fn without_mirrors_and_glass_nothing_is_followed() {
    let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
    sphere(&mut scene, DVec3::ZERO, 1.0, Material::default());
    let rays = rendered(&scene).1.rays;
    assert_eq!(rays, RayCounts { primary: 1, ..RayCounts::default() });
}

#[test]
fn mirrors_alone_refract_nothing() {
    assert_eq!(rendered(&hall(5)).1.rays.refraction, 0);
}

#[test]
fn ten_thousand_lights_add_up() {
    use envers::Light;
    use envers::LightKind;
    let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
    sphere(&mut scene, DVec3::ZERO, 1.0, Material { diffuse: Vec3::ONE, ..black() });
    let light = Light::new(LightKind::Directional { direction: DVec3::NEG_Z, angle: 0.0 })
        .with_intensity(Vec3::splat(1.0 / 8192.0));
    scene.lights = vec![light; 10_000];
    let (pixel, counts) = rendered(&scene);
    assert_near(pixel, 10_000.0 / 8192.0);
    assert_eq!(counts.rays.shadow, 10_000);
}

#[test]
fn the_picture_does_not_depend_on_tiles_where_waves_are_cut() {
    // Shells of glass, so that a tile's rays double and double until its waves are cut.
    let mut scene = seen_from(DVec3::Z * 9.0, DVec3::ZERO);
    scene.film.size = [24, 16];
    scene.film.max_depth = 12;
    scene.film.background = Vec3::new(0.1, 0.5, 0.9);
    scene.cameras[0].projection = envers::Projection::FovY(0.4);
    for (i, radius) in [2.0, 1.6, 1.2, 0.8].into_iter().enumerate() {
        let ior = if i % 2 == 0 { 1.5 } else { 1.1 };
        sphere(&mut scene, DVec3::ZERO, radius, glass(ior));
    }
    let picture = |rows, columns| {
        let tiling = Tiling { rows, columns, ..Tiling::default() };
        let precision = envers::Precision::Certified;
        let options = RenderOptions { tiling, precision, ..RenderOptions::default() };
        let rendering = Renderer::new(&scene).options(options.clone()).render().unwrap();
        (rendering.film.pixels, rendering.statistics.counts)
    };
    let (whole, counts) = picture(16, 24);
    assert!(counts.rays.total() > 384 * 200, "{counts:?}");
    assert_eq!(whole, picture(3, 5).0);
    assert_eq!(whole, picture(1, 1).0);
}

/// `count` cards of this alpha, which glow by themselves, before white.
fn cards(count: u32, alpha: f32, own: f32) -> Scene {
    let mut scene = seen_from(DVec3::Z * 1000.0, DVec3::ZERO);
    scene.film.background = Vec3::ONE;
    let coverage = Some(Coverage { alpha, map: None, mode: AlphaMode::Blend });
    let card = scene.add_material(Material { coverage, thin: true, ior: 1.0, ..glow(own) });
    for i in 0..count {
        scene.planes.push(Plane::new(DVec3::Z * f64::from(i), DVec3::Z, card));
    }
    scene
}

#[test]
fn layers_cover_what_lies_behind_up_to_256_of_them_at_any_depth() {
    for (count, alpha) in [(1, 0.3), (9, 0.1), (24, 0.1), (256, 0.01)] {
        let mut scene = cards(count, alpha, 0.5);
        for depth in [0, 8] {
            scene.film.max_depth = depth;
            let (pixel, counts) = rendered(&scene);
            let left = (1.0 - f64::from(alpha)).powi(count as i32);
            let near = (f64::from(pixel[0]) - (left + (1.0 - left) * 0.5)).abs() < 1e-5;
            assert!(near, "{count} cards: {pixel:?}");
            assert_eq!((counts.rays.refraction, counts.beyond_layers), (count.into(), 0));
        }
    }
}

#[test]
fn behind_256_layers_it_is_black_and_counted() {
    let (pixel, counts) = rendered(&cards(257, 0.01, 0.0));
    assert_eq!((pixel, counts.beyond_layers), ([0.0; 3], 1));
}

#[test]
fn layers_that_reflect_count_for_the_depth_so_that_paths_do_not_fork_without_end() {
    let mut scene = cards(40, 0.5, 0.0);
    scene.materials[0].reflect = Vec3::splat(0.5);
    scene.film.max_depth = 6;
    let rays = rendered(&scene).1.rays;
    assert!(rays.total() <= 1 << 7, "{rays:?}");
}
