//! Shadows of glass.

use envers::scene::{AlphaMode, Coverage};
use envers::{
    Backend, Camera, Falloff, Instance, Light, LightKind, Material, Mesh, Plane, Precision,
    Projection, Renderer, Scene, Shadow,
};
use glam::{DAffine3, DVec3, Vec3};

use super::one_pixel::*;

/// White ground, seen from the side, under a light at y = 10 that shines straight down on it.
fn ground(shadow: Shadow) -> Scene {
    let mut scene = seen_from(DVec3::new(0.0, 1.0, 9.0), DVec3::ZERO);
    let white = scene.add_material(Material { diffuse: Vec3::ONE, ..Material::default() });
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, white));
    let position = DVec3::Y * 10.0;
    scene.lights.push(Light {
        name: String::new(),
        kind: LightKind::Point { position, falloff: Falloff::None, range: f64::INFINITY },
        intensity: Vec3::ONE,
        shadow,
        samples: 16,
        shape: None,
    });
    scene
}

fn under(material: Material, shadow: Shadow) -> [f32; 3] {
    let mut scene = ground(shadow);
    sphere(&mut scene, DVec3::Y * 5.0, 1.0, material);
    radiance(&scene)
}

#[test]
fn a_glass_ball_takes_off_what_its_two_surfaces_reflect() {
    assert_near(under(glass(1.5), Shadow::Tinted), (1.0 - head_on(1.5)).powi(2));
}

#[test]
fn an_opaque_shadow_is_that_of_any_ball() {
    assert_eq!(under(glass(1.5), Shadow::Opaque), [0.0; 3]);
}

#[test]
fn a_light_without_shadow_shines_through_whole() {
    assert_near(under(glass(1.5), Shadow::None), 1.0);
}

#[test]
fn coloured_glass_tints_its_shadow_once_for_each_surface() {
    let transmit = Vec3::new(1.0, 0.5, 0.25);
    let pixel = under(Material { transmit, ..glass(1.0) }, Shadow::Tinted);
    assert_eq!(pixel, (transmit * transmit).to_array());
}

#[test]
fn absorbing_glass_tints_its_shadow_by_the_way_through_it() {
    let absorption = Vec3::splat(0.5);
    let pixel = under(Material { absorption, ..glass(1.0) }, Shadow::Tinted);
    assert_near(pixel, (-1f64).exp());
    let pixel = under(Material { absorption, ..glass(1.0) }, Shadow::Opaque);
    assert_eq!(pixel, [0.0; 3]);
}

#[test]
fn a_clear_ball_of_index_one_casts_no_shadow_of_either_kind() {
    assert_eq!(under(glass(1.0), Shadow::Tinted), [1.0; 3]);
    assert_eq!(under(glass(1.0), Shadow::Opaque), [1.0; 3]);
}

#[test]
fn what_is_opaque_within_glass_casts_its_shadow() {
    let mut scene = ground(Shadow::Tinted);
    sphere(&mut scene, DVec3::Y * 5.0, 1.0, glass(1.5));
    sphere(&mut scene, DVec3::Y * 5.0, 0.5, Material::default());
    assert_eq!(radiance(&scene), [0.0; 3]);
}

#[test]
fn glass_that_casts_no_shadow_takes_nothing_off() {
    let mut scene = ground(Shadow::Tinted);
    let absorption = Vec3::splat(0.5);
    sphere(&mut scene, DVec3::Y * 5.0, 1.0, Material { absorption, ..glass(1.5) });
    scene.spheres[0].casts_shadow = false;
    assert_near(radiance(&scene), 1.0);
}

#[test]
fn a_mesh_of_glass_that_casts_no_shadow_takes_nothing_off_whichever_way_it_winds() {
    for scale in [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0)] {
        let mut scene = ground(Shadow::Tinted);
        let absorption = Vec3::splat(0.5);
        let material = scene.add_material(Material { absorption, ..glass(1.5) });
        let mesh = scene.add_mesh(Mesh {
            positions: vec![[-2., 4., 3.], [2., 4., 3.], [0., 4., -3.], [0.3, 6., 0.2]].into(),
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            ..Mesh::default()
        });
        let mut tent = Instance::new(mesh, DAffine3::from_scale(scale), material);
        tent.casts_shadow = false;
        scene.instances.push(tent);
        assert_near(radiance(&scene), 1.0);
    }
}

/// A white bed under 4 of water that absorbs, seen from within the water, 2 above it.
fn pond() -> Scene {
    let mut scene = seen_from(DVec3::NEG_Y * 2.0, DVec3::NEG_Y * 4.0);
    let absorption = Vec3::splat(0.1);
    let water = scene.add_material(Material { absorption, ..glass(1.33) });
    let white = scene.add_material(Material { diffuse: Vec3::ONE, ..Material::default() });
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, water));
    scene.planes.push(Plane::new(DVec3::NEG_Y * 4.0, DVec3::Y, white));
    scene
}

#[test]
fn the_bed_of_a_pond_is_lit_through_the_water() {
    let mut scene = pond();
    scene.lights.push(Light {
        name: String::new(),
        kind: LightKind::Directional { direction: DVec3::NEG_Y, angle: 0.0 },
        intensity: Vec3::ONE,
        shadow: Shadow::Tinted,
        samples: 16,
        shape: None,
    });
    // 4 down and 2 up to the eye.
    assert_near(radiance(&scene), (1.0 - head_on(1.33)) * (-0.6f64).exp());
}

#[test]
fn a_light_in_the_water_is_absorbed_though_nothing_stands_in_its_way() {
    let mut scene = pond();
    let position = DVec3::NEG_Y;
    scene.lights.push(Light {
        name: String::new(),
        kind: LightKind::Point { position, falloff: Falloff::None, range: f64::INFINITY },
        intensity: Vec3::ONE,
        shadow: Shadow::Tinted,
        samples: 16,
        shape: None,
    });
    assert_near(radiance(&scene), (-0.5f64).exp());
}

/// Cards of alpha 0.1 and 0.3, one above the other over white ground, under a light that shines down
/// through all of them at a slant.
fn stack(count: u32) -> Scene {
    let mut scene = ground(Shadow::Tinted);
    scene.film.size = [24, 24];
    scene.cameras[0] =
        Camera::look_at(DVec3::new(0.0, 9.0, 6.0), DVec3::Y, DVec3::Y, Projection::FovY(0.5))
            .unwrap();
    let mesh = scene.add_mesh(Mesh {
        positions: vec![[-9., 0., -9.], [-9., 0., 9.], [9., 0., 9.], [9., 0., -9.]].into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    });
    let card = |alpha: f32| {
        let coverage = Some(Coverage { alpha, map: None, mode: AlphaMode::Blend });
        Material { coverage, thin: true, ior: 1.0, ..Material::matte(Vec3::splat(0.5)) }
    };
    let cards = [0.1, 0.3].map(|alpha| scene.add_material(card(alpha)));
    for i in 0..count {
        let transform = DAffine3::from_translation(DVec3::Y * (0.5 + f64::from(i) * 0.05));
        scene.instances.push(Instance::new(mesh, transform, cards[i as usize % 2]));
    }
    scene
}

#[test]
fn each_point_of_a_stack_of_layers_costs_one_shadow_ray() {
    for count in [1, 4, 16] {
        for backend in [Backend::Rust, Backend::default()] {
            for precision in [Precision::Fast, Precision::Certified] {
                let scene = stack(count);
                let renderer = Renderer::new(&scene).backend(backend).precision(precision);
                let rays = renderer.render().unwrap().statistics.counts.rays;
                // Every pixel sees the cards and the ground, and each of these the light.
                let points = 24 * 24 * (u64::from(count) + 1);
                assert_eq!(rays.shadow, points, "{count} cards on {}", backend.name());
            }
        }
    }
}

#[test]
fn layers_dim_light_as_glass_does_surface_by_surface() {
    for shadow in [Shadow::Tinted, Shadow::Opaque] {
        let mut layers = stack(9);
        layers.lights[0].shadow = shadow;
        // Glass out of sight, with which shadow rays go from surface to surface.
        let mut glassy = layers.clone();
        sphere(&mut glassy, DVec3::new(0.0, -50.0, 0.0), 1.0, glass(1.5));
        let picture = |scene: &Scene, backend| {
            let renderer = Renderer::new(scene).backend(backend).precision(Precision::Certified);
            let rendering = renderer.render().unwrap();
            (rendering.film.pixels, rendering.statistics.counts.rays.shadow)
        };
        for backend in [Backend::Rust, Backend::default()] {
            let [(at_once, few), (one_by_one, many)] =
                [&layers, &glassy].map(|scene| picture(scene, backend));
            assert_eq!(at_once, one_by_one, "{}", backend.name());
            assert!(few < many);
        }
        assert!(picture(&layers, Backend::Rust).0.iter().any(|pixel| pixel[0] > 0.0));
    }
}
