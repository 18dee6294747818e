//! Environments: what camera rays, mirrors, glass and surfaces of either shading model show of them.

use std::sync::Arc;

use envers::scene::{Environment, Image, MetallicRoughness, Texels, Transfer};
use envers::{Light, Material, Plane, Scene};
use glam::{DVec3, Vec3};

use super::one_pixel::*;

/// A ball in an environment, seen from +z at a point with this height.
fn ball(material: Material, environment: Environment, height: f64) -> Scene {
    let mut scene = seen_from(DVec3::new(0.0, height, 5.0), DVec3::new(0.0, height, 0.0));
    scene.environment = Some(environment);
    sphere(&mut scene, DVec3::ZERO, 1.0, material);
    scene
}

/// An environment whose radiance is this function of the direction.
fn environment(radiance: impl Fn(DVec3) -> Vec3) -> Environment {
    let (width, height) = (1024, 512);
    let texel = |i: usize| {
        let u = ((i % width) as f64 + 0.5) / width as f64;
        let v = ((i / width) as f64 + 0.5) / height as f64;
        let (sin, cos) = ((u - 0.5) * std::f64::consts::TAU).sin_cos();
        let (height, across) = ((0.5 - v) * std::f64::consts::PI).sin_cos();
        radiance(DVec3::new(across * cos, height, across * sin)).extend(1.0).to_array()
    };
    let texels = Texels::Floats((0..width * height).map(texel).collect());
    Environment::new(
        Arc::new(Image::new("", [width as u32, height as u32], texels)),
        Transfer::None,
    )
}

/// An environment that tells directions apart: green grows upward, and blue toward +x.
fn directions() -> Environment {
    environment(|d| Vec3::new(1.0, 0.5 + 0.5 * d.y as f32, 0.5 + 0.5 * d.x as f32))
}

#[test]
fn rays_that_hit_nothing_see_the_environment_in_their_direction() {
    let mut scene = seen_from(DVec3::ZERO, DVec3::new(0.6, 0.0, -0.8));
    scene.environment = Some(directions());
    let [r, g, b] = radiance(&scene);
    assert!((r - 1.0).abs() < 1e-5 && (g - 0.5).abs() < 1e-3 && (b - 0.8).abs() < 1e-3);
}

#[test]
fn camera_rays_see_the_background_before_an_environment_that_is_not_visible() {
    let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
    scene.film.background = Vec3::new(0.1, 0.2, 0.3);
    scene.environment = Some(directions().with_visible(false));
    assert_eq!(radiance(&scene), [0.1, 0.2, 0.3]);
    // A mirror sees it all the same: here what stands behind the eye.
    sphere(&mut scene, DVec3::ZERO, 1.0, mirror(1.0));
    let [r, g, b] = radiance(&scene);
    assert!((r - 1.0).abs() < 1e-5 && (g - 0.5).abs() < 1e-3 && (b - 0.5).abs() < 1e-3);
}

#[test]
fn a_mirror_ball_shows_the_environment_in_the_mirrored_direction() {
    for material in [mirror(1.0), pbr(metal(0.0))] {
        for height in [-0.5, 0.0, 0.3, 0.8f64] {
            let normal = DVec3::new(0.0, height, (1.0 - height * height).sqrt());
            let mirrored = DVec3::NEG_Z + normal * (2.0 * normal.z);
            let [r, g, b] = radiance(&ball(material.clone(), directions(), height));
            let expected = 0.5 + 0.5 * mirrored.y as f32;
            assert!((r - 1.0).abs() < 5e-3, "{r}");
            assert!((g - expected).abs() < 5e-3 && (b - 0.5).abs() < 5e-3, "{g} {expected}");
        }
    }
}

#[test]
fn a_clear_ball_of_the_index_of_air_is_not_there() {
    let glass = MetallicRoughness { transmission: 1.0, ior: 1.0, is_thin: false, ..plastic(0.0) };
    let with_inside = Material { ior: 1.0, ..pbr(glass) };
    for material in [Material::glass(1.0), with_inside] {
        let with = radiance(&ball(material, directions(), 0.3));
        let mut scene = ball(mirror(1.0), directions(), 0.3);
        scene.spheres.clear();
        assert_eq!(with, radiance(&scene));
    }
}

#[test]
fn in_a_white_world_white_surfaces_of_any_roughness_are_white() {
    let even = || Environment::even(Vec3::ONE);
    let mut worst = 0.0f64;
    for roughness in [0.0, 0.05, 0.1, 0.2, 0.25, 0.3, 0.5, 0.8, 1.0] {
        let varnish =
            MetallicRoughness { clearcoat: 1.0, clearcoat_roughness: 0.2, ..plastic(0.6) };
        let brushed = MetallicRoughness { anisotropy: 0.7, ..metal(roughness) };
        for factors in [metal(roughness), plastic(roughness), varnish, brushed] {
            for height in [0.0, 0.7, 0.95] {
                let [white, ..] = radiance(&ball(pbr(factors), even(), height));
                worst = worst.max((f64::from(white) - 1.0).abs());
            }
        }
    }
    println!("largest difference from white: {worst:.1e}");
    assert!(worst < 0.005, "{worst}");
}

#[test]
fn in_a_white_world_glass_balls_are_white() {
    for roughness in [0.0, 0.4] {
        let factors = MetallicRoughness { transmission: 1.0, is_thin: false, ..plastic(roughness) };
        let mut scene = ball(pbr(factors), Environment::even(Vec3::ONE), 0.4);
        scene.film.max_depth = 12;
        let [white, ..] = radiance(&scene);
        assert!((white - 1.0).abs() < 1e-3, "{roughness}: {white}");
    }
}

#[test]
fn a_matte_surface_reflects_the_irradiance_of_what_its_normal_sees() {
    // Above all is 1, and below all is dark: (1 + cos θ)/2 for a normal at θ from the top.
    let upper = || environment(|d| Vec3::splat(if d.y > 0.0 { 1.0 } else { 0.0 }));
    let matte = Material::matte(Vec3::splat(0.6));
    for height in [-0.9, -0.3, 0.0, 0.5, 0.95] {
        let [found, ..] = radiance(&ball(matte.clone(), upper(), height));
        let expected = 0.6 * 0.5 * (1.0 + height as f32);
        assert!((found - expected).abs() < 3e-3, "{height}: {found} {expected}");
    }
}

#[test]
fn phongs_highlight_in_an_even_environment_has_its_integral() {
    // An even environment of 1 is directional lights of 1/π each steradian: 2/(α + 1) of (r·ℓ)^α.
    let shiny = Material { specular: Vec3::ONE, shininess: 9.0, ..Material::matte(Vec3::ZERO) };
    let [found, ..] = radiance(&ball(shiny, Environment::even(Vec3::ONE), 0.0));
    assert!((found - 0.2).abs() < 1e-3, "{found}");
}

#[test]
fn physically_based_chalk_reflects_a_light_as_lambert_does() {
    // Without a reflection at its microfacets the base is Lambert's.
    let chalk = MetallicRoughness { base_color: Vec3::splat(0.5), specular: 0.0, ..plastic(1.0) };
    let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
    sphere(&mut scene, DVec3::ZERO, 1.0, pbr(chalk));
    scene.lights.push(Light::sun(DVec3::new(0.0, -0.6, -0.8)));
    let [found, ..] = radiance(&scene);
    assert!((found - 0.5 * 0.8).abs() < 1e-3, "{found}");
}

#[test]
fn ambient_occlusion_of_a_floor_before_a_wall_is_half_open() {
    // At the foot of an endless wall half of the sky is covered.
    let mut scene = seen_from(DVec3::new(1e-6, 3.0, 4.0), DVec3::new(1e-6, 0.0, 0.0));
    let black_wall = scene.add_material(black());
    let white = scene.add_material(Material::matte(Vec3::splat(0.001)));
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, white));
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::X, black_wall));
    scene.environment = Some(Environment::even(Vec3::splat(1000.0)));
    let open = radiance(&scene)[0];
    scene.film.ambient_occlusion = 256;
    let half = radiance(&scene)[0];
    // The cells of the irradiance that the horizon cuts lose 0.14% of an even light.
    assert!((open - 1.0).abs() < 2e-3 && (half - 0.5).abs() < 0.01, "{open} {half}");
}

#[test]
fn what_nothing_covers_has_all_of_the_light_with_any_number_of_rays() {
    let mut scene = ball(Material::matte(Vec3::ONE), directions(), 0.4);
    let without = radiance(&scene);
    for rays in [1, 3, 16] {
        scene.film.ambient_occlusion = rays;
        assert_eq!(radiance(&scene), without);
    }
}
