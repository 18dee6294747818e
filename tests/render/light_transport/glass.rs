//! Glass: refraction, Fresnel's shares, absorption.

use envers::scene::MetallicRoughness;
use envers::{Instance, Material, Mesh, Plane};
use glam::{DAffine3, DVec3, Vec3};

use super::one_pixel::*;

const GLASS: f64 = 1.5;

#[test]
fn light_bends_into_glass_by_snells_law() {
    // Down at 45° into a half-space of glass: sin θ₂ = sin 45° / 1.5, so that it comes to
    // x = 4 tan θ₂ at a depth of 4.
    let sine = 0.5f64.sqrt() / GLASS;
    let across = 4.0 * sine / (1.0 - sine * sine).sqrt();
    let seen = |x: f64| {
        let mut scene = seen_from(DVec3::new(-1.0, 1.0, 0.0), DVec3::ZERO);
        let water = scene.add_material(glass(GLASS));
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, water));
        sphere(&mut scene, DVec3::new(x, -4.0, 0.0), 1e-9, glow(1.0));
        radiance(&scene)[0]
    };
    assert!(seen(across) > 0.9);
    assert_eq!([seen(across + 1e-8), seen(across - 1e-8)], [0.0; 2]);
}

#[test]
fn glass_seen_head_on_reflects_four_hundredths() {
    let mut scene = seen_from(DVec3::Y, DVec3::ZERO);
    let ground = scene.add_material(glass(GLASS));
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, ground));
    sphere(&mut scene, DVec3::Y * 9.0, 1.0, glow(1.0));
    assert_near(radiance(&scene), 0.04);
}

#[test]
fn from_below_the_critical_angle_hides_what_is_above() {
    let seen = |degrees: f64| {
        let angle = degrees.to_radians();
        let eye = DVec3::new(-angle.sin(), -angle.cos(), 0.0);
        let mut scene = seen_from(eye, DVec3::ZERO);
        scene.film.background = Vec3::ONE;
        let water = scene.add_material(glass(GLASS));
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, water));
        // The bed is black, and all that can be seen of the sky comes through the surface.
        let bed = scene.add_material(black());
        scene.planes.push(Plane::new(DVec3::NEG_Y * 2.0, DVec3::Y, bed));
        radiance(&scene)[0]
    };
    let critical = (1.0 / GLASS).asin().to_degrees();
    assert!(seen(critical - 0.01) > 0.0);
    assert_eq!(seen(critical + 0.01), 0.0);
}

#[test]
fn a_glass_ball_focuses_parallel_rays_at_its_focal_length() {
    // f = nR / 2(n − 1) from its centre: 1.5 for n = 1.5 and R = 1.
    let focal = GLASS / (2.0 * (GLASS - 1.0));
    let seen = |at: f64| {
        let height = DVec3::Y * 1e-3;
        let mut scene = seen_from(DVec3::Z * 5.0 + height, height);
        sphere(&mut scene, DVec3::ZERO, 1.0, glass(GLASS));
        sphere(&mut scene, DVec3::NEG_Z * at, 1e-6, glow(1.0));
        radiance(&scene)
    };
    let through = 1.0 - head_on(GLASS);
    assert_near(seen(focal), through * through);
    // A thousandth of the height stands for a hundredth of the focal length.
    assert_eq!([seen(focal * 1.01), seen(focal * 0.99)], [[0.0; 3]; 2]);
}

#[test]
fn light_through_the_middle_of_a_ball_is_absorbed_over_its_diameter() {
    let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
    scene.film.background = Vec3::ONE;
    scene.film.max_depth = 2; // In and out, and not to and fro.
    let absorption = Vec3::splat(0.25);
    sphere(&mut scene, DVec3::ZERO, 1.5, Material { absorption, ..glass(GLASS) });
    let (face, left) = (head_on(GLASS), (-0.25f64 * 3.0).exp());
    assert_near(radiance(&scene), face + (1.0 - face).powi(2) * left);
}

#[test]
fn colours_are_absorbed_each_by_its_own() {
    let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
    scene.film.background = Vec3::ONE;
    let absorption = Vec3::new(0.0, 1.0, 2.0);
    sphere(&mut scene, DVec3::ZERO, 0.5, Material { absorption, ..glass(1.0) });
    let pixel = radiance(&scene);
    for (x, expected) in pixel.iter().zip([1.0, (-1f64).exp(), (-2f64).exp()]) {
        assert_near([*x; 3], expected);
    }
}

#[test]
fn glass_in_a_white_world_is_white() {
    // What is reflected and what goes through is all of the light, at every surface.
    for height in [0.0, 0.3, 0.9, 0.99] {
        let target = DVec3::Y * height;
        let mut scene = seen_from(DVec3::Z * 5.0 + target, target);
        scene.film.background = Vec3::ONE;
        scene.film.max_depth = 64;
        sphere(&mut scene, DVec3::ZERO, 1.0, glass(GLASS));
        assert_near(radiance(&scene), 1.0);
    }
}

#[test]
fn a_pane_lets_through_what_its_two_faces_leave() {
    let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
    let pane = scene.add_material(Material { thin: true, ..glass(GLASS) });
    let mesh = scene.add_mesh(Mesh {
        positions: vec![[-1., -1., 0.], [1., -1., 0.], [0., 1., 0.]].into(),
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    });
    scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, pane));
    sphere(&mut scene, DVec3::NEG_Z * 5.0, 1.0, glow(1.0));
    let face = head_on(GLASS);
    assert_near(radiance(&scene), 1.0 - 2.0 * face / (1.0 + face));
}

#[test]
fn a_tinted_pane_passes_its_colour() {
    let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
    scene.film.background = Vec3::ONE;
    let transmit = Vec3::new(1.0, 0.5, 0.25);
    let pane = Material { transmit, thin: true, ior: 1.0, ..black() };
    sphere(&mut scene, DVec3::ZERO, 1.0, pane);
    // A thin sphere is two panes.
    assert_eq!(radiance(&scene), (transmit * transmit).to_array());
}

#[test]
fn glass_on_a_smooth_mesh_bends_light_by_the_interpolated_normal() {
    let seen = |normal: [f32; 3]| {
        let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
        let pane = scene.add_material(glass(GLASS));
        let mesh = scene.add_mesh(Mesh {
            positions: vec![[-1., -1., 0.], [1., -1., 0.], [0., 1., 0.]].into(),
            triangles: vec![[0, 1, 2]],
            normals: vec![normal; 3],
            ..Mesh::default()
        });
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, pane));
        let n = DVec3::from(normal.map(f64::from)).normalize();
        let cosine = n.z;
        let behind = (1.0 - (1.0 - cosine * cosine) / (GLASS * GLASS)).sqrt();
        let out = DVec3::NEG_Z / GLASS + n * (cosine / GLASS - behind);
        sphere(&mut scene, out * 3.0, 1e-6, glow(1.0));
        radiance(&scene)[0]
    };
    assert!(seen([0.3, 0.0, 1.0]) > 0.9);
}

#[test]
fn a_dispersive_medium_bends_each_colour_by_its_own_index() {
    let factors = MetallicRoughness {
        metallic: 0.0,
        roughness: 0.0,
        ior: GLASS as f32,
        transmission: 1.0,
        is_thin: false,
        dispersion: 1.0,
        ..MetallicRoughness::default()
    };
    // n ± (n − 1) dispersion/40, and as above.
    let spread = (GLASS - 1.0) / 40.0;
    let across = [GLASS - spread, GLASS, GLASS + spread].map(|index| {
        let sine = 0.5f64.sqrt() / index;
        4.0 * sine / (1.0 - sine * sine).sqrt()
    });
    for (color, x) in across.into_iter().enumerate() {
        let mut scene = seen_from(DVec3::new(-1.0, 1.0, 0.0), DVec3::ZERO);
        let prism = scene.add_material(pbr(factors));
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, prism));
        sphere(&mut scene, DVec3::new(x, -4.0, 0.0), 1e-8, glow(1.0));
        let seen = radiance(&scene);
        for channel in 0..3 {
            let is_seen = seen[channel] > 0.9;
            assert!(is_seen == (channel == color) && (is_seen || seen[channel] == 0.0), "{seen:?}");
        }
    }
}

#[test]
fn a_dispersive_ball_in_a_white_world_is_white() {
    let factors = MetallicRoughness {
        metallic: 0.0,
        roughness: 0.0,
        transmission: 1.0,
        is_thin: false,
        dispersion: 3.0,
        ..MetallicRoughness::default()
    };
    for height in [0.0, 0.3, 0.7, 0.95] {
        let mut scene = seen_from(DVec3::new(0.0, height, 5.0), DVec3::new(0.0, height, 0.0));
        scene.film.background = Vec3::ONE;
        scene.film.max_depth = 40;
        sphere(&mut scene, DVec3::ZERO, 1.0, pbr(factors));
        assert_near(radiance(&scene), 1.0);
    }
}
