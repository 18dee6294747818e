//! The path tracer, held to closed forms, to numeric integration by fixed samples, and to itself.

use envers::internals::Tiling;
use envers::scene::{Environment, IntegratorKind, LightShape, MetallicRoughness, ThinLens};
use envers::{
    Backend, Camera, Instance, Light, Material, Mesh, Plane, Precision, Projection, RenderOptions,
    Renderer, Scene, Sphere,
};
use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::one_pixel::{metal, pbr, plastic};

/// A scene for one pixel, whose rays all go from `eye` to about `target`.
fn seen_from(eye: DVec3, target: DVec3) -> Scene {
    let mut scene = Scene::default();
    scene.film.size = [1, 1];
    scene.film.max_depth = 100;
    let up = if (target - eye).normalize().y.abs() > 0.9 { DVec3::Z } else { DVec3::Y };
    scene.cameras.push(Camera::look_at(eye, target, up, Projection::FovY(1e-4)).unwrap());
    scene
}

/// The mean of this many paths, in green.
fn traced(scene: &Scene, samples: u32) -> f64 {
    let mut scene = scene.clone();
    scene.film.integrator = IntegratorKind::Path;
    let rendering = Renderer::new(&scene).samples(samples).threads(1).render().unwrap();
    let counts = rendering.statistics.counts.not_finite;
    assert_eq!((counts.light, counts.surface, counts.sum), (0, 0, 0));
    f64::from(rendering.film.pixel(0, 0)[1])
}

#[track_caller]
fn assert_near(found: f64, expected: f64, bound: f64) {
    let error = found / expected - 1.0;
    println!("{found} for {expected}: {error:.1e}, bound {bound:.0e}");
    assert!(error.abs() < bound, "{found} instead of {expected}: {error:.1e}");
}

fn ball(scene: &mut Scene, center: DVec3, radius: f64, material: Material) {
    let material = scene.add_material(material);
    scene.spheres.push(Sphere::new(center, radius, material));
}

#[test]
fn in_a_white_world_what_loses_no_light_is_white() {
    let glass = Material { transmit: Vec3::ONE, ior: 1.5, ..Material::matte(Vec3::ZERO) };
    let mirror = Material { reflect: Vec3::ONE, ..Material::matte(Vec3::ZERO) };
    let clear = MetallicRoughness { transmission: 1.0, is_thin: false, ..plastic(0.0) };
    let materials = [
        ("matte", Material::matte(Vec3::ONE), 2e-3),
        ("glass", glass, 2e-3),
        ("mirror", mirror, 1e-5),
        ("metal", pbr(metal(0.0)), 1e-3),
        ("satin", pbr(metal(0.4)), 1e-2),
        ("rough metal", pbr(metal(1.0)), 1e-2),
        ("plastic", pbr(plastic(0.3)), 1e-2),
        ("chalk", pbr(plastic(1.0)), 1e-2),
        ("clear", pbr(clear), 1e-2),
        ("thin", pbr(MetallicRoughness { is_thin: true, ..clear }), 1e-2),
    ];
    for (name, material, bound) in materials {
        for height in [0.0, 0.6, 0.9] {
            let eye = DVec3::new(0.0, height, 5.0);
            let mut scene = seen_from(eye, eye - DVec3::Z);
            scene.environment = Some(Environment::even(Vec3::ONE));
            ball(&mut scene, DVec3::ZERO, 1.0, material.clone());
            print!("{name} at {height}: ");
            assert_near(traced(&scene, 4096), 1.0, bound);
        }
    }
}

#[test]
fn within_a_glowing_shell_light_adds_up_to_the_sum_of_all_reflections() {
    // Everywhere e + ρ L = L.
    for (albedo, emission) in [(0.5f32, 1.0f32), (0.8, 0.3)] {
        let expected = f64::from(emission / (1.0 - albedo));
        let shell = Material {
            emission: Vec3::splat(emission),
            double_sided: true,
            ..Material::matte(Vec3::splat(albedo))
        };
        let eye = DVec3::new(0.2, 0.1, 0.0);
        let mut sphere = seen_from(eye, DVec3::new(0.5, 0.9, 0.3));
        ball(&mut sphere, DVec3::ZERO, 2.0, shell.clone());
        assert_near(traced(&sphere, 4096), expected, 2e-2);
        // The same in a box of triangles, whose light is sampled, too.
        let mut room = seen_from(eye, DVec3::new(0.5, 0.9, 0.3));
        let material = room.add_material(shell);
        let mesh = room.add_mesh(cube());
        room.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
        assert_near(traced(&room, 4096), expected, 2e-2);
    }
}

/// A cube from -1 to 1.
fn cube() -> Mesh {
    let corner = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 1.0 } else { -1.0 });
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { positions: (0..8).map(corner).collect::<Vec<_>>().into(), triangles, ..Mesh::default() }
}

/// White ground at y = 0, seen at the origin from the side.
fn ground(material: Material) -> Scene {
    let mut scene = seen_from(DVec3::new(0.0, 1.0, 9.0), DVec3::ZERO);
    let material = scene.add_material(material);
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, material));
    scene
}

/// Adds the shape by which a light is seen.
fn show(scene: &mut Scene, index: usize) {
    let light = scene.lights[index].clone();
    let material = scene.add_material(Material::emissive(light.intensity));
    if let envers::LightKind::Sphere { center, radius } = light.kind {
        scene.lights[index].shape = Some(LightShape::Sphere(scene.spheres.len() as u32));
        let sphere = Sphere::new(center, radius, material);
        scene.spheres.push(Sphere { casts_shadow: false, ..sphere });
    } else if let envers::LightKind::Rectangle { center, u, v } = light.kind {
        let square = Mesh {
            positions: vec![[-1., -1., 0.], [1., -1., 0.], [1., 1., 0.], [-1., 1., 0.]].into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        scene.materials[material.0 as usize].cull_back_faces = true;
        scene.lights[index].shape = Some(LightShape::Instance(scene.instances.len() as u32));
        let mesh = scene.add_mesh(square);
        let axes = DMat3::from_cols(u, v, u.cross(v).normalize());
        let transform = DAffine3 { matrix3: axes, translation: center };
        let instance = Instance::new(mesh, transform, material);
        scene.instances.push(Instance { casts_shadow: false, ..instance });
    }
}

#[test]
fn the_closed_forms_of_area_lights_hold_whether_they_are_seen_or_not() {
    // A sphere of radius r at distance d: r²/d². A disk: r²/(r² + d²).
    let sphere = Light::sphere(DVec3::Y * 2.0, 1.0);
    let disk = Light::disk(DVec3::Y * 2.0, DVec3::NEG_Y, 1.0);
    for (light, expected) in [(sphere, 0.25), (disk, 0.2)] {
        for is_seen in [false, true] {
            let mut scene = ground(Material::matte(Vec3::ONE));
            scene.lights.push(light.clone());
            if is_seen {
                show(&mut scene, 0);
            }
            assert_near(traced(&scene, 4096), expected, 5e-3);
        }
    }
}

#[test]
fn the_back_of_a_panel_is_dark() {
    // Z × X is upward, and the ground is below.
    for (v, is_lit) in [(DVec3::X, false), (DVec3::NEG_X, true)] {
        let mut scene = ground(Material::matte(Vec3::ONE));
        scene.lights.push(Light::rectangle(DVec3::Y, DVec3::Z, v));
        show(&mut scene, 0);
        assert_eq!(traced(&scene, 1024) > 0.1, is_lit);
        assert!(is_lit || traced(&scene, 1024) == 0.0);
    }
}

#[test]
fn surfaces_that_emit_light_shine_like_lights() {
    let mut scene = ground(Material::matte(Vec3::ONE));
    ball(&mut scene, DVec3::Y * 2.0, 1.0, Material::emissive(Vec3::ONE));
    assert_near(traced(&scene, 4096), 0.25, 5e-3);
    // A cube, of which its lower face alone is seen: Lambert's formula for a polygon.
    let mut scene = ground(Material::matte(Vec3::ONE));
    let material = scene.add_material(Material::emissive(Vec3::splat(2.0)));
    let mesh = scene.add_mesh(cube());
    let transform = DAffine3::from_translation(DVec3::new(1.0, 3.0, 0.5));
    scene.instances.push(Instance::new(mesh, transform, material));
    let corners =
        [[0., -0.5], [2., -0.5], [2., 1.5], [0., 1.5]].map(|[x, z]| DVec3::new(x, 2.0, z));
    let edges = (0..4).map(|i| {
        let [a, b] = [corners[i].normalize(), corners[(i + 1) % 4].normalize()];
        a.dot(b).acos() * a.cross(b).normalize().y
    });
    let expected = 2.0 * (edges.sum::<f64>() / std::f64::consts::TAU).abs();
    assert_near(traced(&scene, 4096), expected, 5e-3);
}

#[test]
fn glossy_surfaces_reflect_the_same_of_a_light_as_by_fixed_samples() {
    for factors in [metal(0.35), plastic(0.5), metal(1.0), plastic(1.0)] {
        for light in [
            Light::sphere(DVec3::new(0.0, 1.5, -9.0), 2.0),
            Light::rectangle(DVec3::new(0.5, 2.0, -6.0), DVec3::X, DVec3::new(0.0, 1.0, 0.2)),
        ] {
            for is_seen in [false, true] {
                let mut scene = ground(pbr(factors));
                scene.lights.push(light.clone().with_samples(1024));
                if is_seen {
                    show(&mut scene, 0);
                }
                let fixed = Renderer::new(&scene).samples(16).render().unwrap();
                let expected = f64::from(fixed.film.pixel(0, 0)[1]);
                assert_near(traced(&scene, 16_384), expected, 1.5e-2);
            }
        }
    }
}

#[test]
fn a_layer_before_an_environment_that_is_not_visible_shows_the_background() {
    let mut scene = seen_from(DVec3::Z * 5.0, DVec3::ZERO);
    scene.film.background = Vec3::splat(0.25);
    scene.environment = Some(Environment::even(Vec3::ONE).with_visible(false));
    // A grey veil that reflects nothing.
    let veil = Material {
        transmit: Vec3::splat(0.5),
        thin: true,
        ior: 1.0,
        ..Material::matte(Vec3::ZERO)
    };
    let veil = scene.add_material(veil);
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Z, veil));
    assert_near(traced(&scene, 16), 0.125, 1e-6);
}

#[test]
fn ambient_light_is_that_of_an_even_environment_and_is_occluded() {
    let mut scene = ground(Material::matte(Vec3::splat(0.6)));
    scene.lights.push(Light::ambient(Vec3::splat(0.5)));
    assert_near(traced(&scene, 1024), 0.3, 1e-4);
    let mut below = ground(Material::matte(Vec3::splat(0.6)));
    below.lights.push(Light::ambient(Vec3::splat(0.5)));
    ball(&mut below, DVec3::Y * 2.0, 1.0, Material::matte(Vec3::ZERO));
    // The ball covers a quarter of the irradiance.
    assert_near(traced(&below, 16_384), 0.3 * 0.75, 1e-2);
}

#[test]
fn a_lens_shows_points_out_of_focus_as_disks_of_their_circle_of_confusion() {
    // A lamp of radius 0.5 at distance 10 is seen from the middle of a lens of diameter 1, which is focused at 5: a ray
    // through the rim of the lens meets the plane of the lamp as far from its middle as it left from that of the lens.
    let seen = |radius: f64, focus_distance: f64| {
        let mut scene = seen_from(DVec3::ZERO, DVec3::NEG_Z);
        scene.cameras[0].lens = Some(ThinLens { aperture: 1.0, focus_distance });
        let lamp = scene.add_material(Material::emissive(Vec3::ONE));
        let square = Mesh {
            positions: vec![[-1., -1., 0.], [1., -1., 0.], [1., 1., 0.], [-1., 1., 0.]].into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let mesh = scene.add_mesh(square);
        let transform = DAffine3 {
            matrix3: DMat3::from_diagonal(DVec3::new(radius, radius, 1.0)),
            translation: DVec3::NEG_Z * 10.0,
        };
        scene.instances.push(Instance::new(mesh, transform, lamp));
        traced(&scene, 4096)
    };
    // A square of half a side 0.25 covers 4 · 0.25² of a disk of radius 0.5, the blur at twice the focus.
    let pi = std::f64::consts::PI;
    assert_near(seen(0.25, 5.0), 4.0 * 0.25 * 0.25 / (pi * 0.25), 5e-3);
    // In focus it is sharp.
    assert_near(seen(0.25, 10.0), 1.0, 1e-6);
    // From a focus twice as far the blur is half as wide.
    assert_near(seen(0.1, 20.0), 4.0 * 0.1 * 0.1 / (pi * 0.25 * 0.25), 5e-3);
}

/// A scene of everything, 24×16 pixels.
fn mixed() -> Scene {
    let mut scene = seen_from(DVec3::new(0.0, 1.5, 6.0), DVec3::new(0.0, 0.8, 0.0));
    scene.cameras[0].projection = Projection::FovY(0.8);
    scene.film.size = [24, 16];
    scene.film.max_depth = 6;
    let floor = scene.add_material(Material::matte(Vec3::splat(0.5)));
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, floor));
    ball(&mut scene, DVec3::new(-1.5, 1.0, 0.0), 1.0, pbr(metal(0.3)));
    let glass = Material { transmit: Vec3::ONE, ior: 1.5, ..Material::matte(Vec3::ZERO) };
    ball(&mut scene, DVec3::new(1.0, 1.0, 0.5), 1.0, glass);
    scene.lights.push(Light::rectangle(DVec3::Y * 4.0, DVec3::X, DVec3::Z).with_samples(4));
    show(&mut scene, 0);
    scene.lights.push(Light::point(DVec3::new(3.0, 3.0, 2.0)).with_intensity(Vec3::splat(0.3)));
    scene.environment = Some(Environment::studio());
    scene.film.integrator = IntegratorKind::Path;
    scene
}

#[test]
fn a_picture_is_the_same_on_any_threads_in_any_tiles_and_on_both_backends() {
    let scene = mixed();
    let picture = |backend, threads, tiling: Option<Tiling>| {
        let mut options = RenderOptions {
            backend: Some(backend),
            precision: Precision::Certified,
            threads,
            ..RenderOptions::default()
        };
        options.tiling = tiling.unwrap_or(options.tiling);
        Renderer::new(&scene).options(options).samples(8).render().unwrap().film.pixels
    };
    let first = picture(Backend::Rust, 1, None);
    assert!(first.iter().flatten().any(|x| *x > 0.0));
    for threads in [1, 2, 8] {
        assert!(picture(Backend::default(), threads, None) == first, "{threads} threads");
    }
    for [rows, columns] in [[1, 24], [5, 7], [16, 3]] {
        let tiling = Tiling { rows, columns, ..Tiling::default() };
        assert!(picture(Backend::default(), 2, Some(tiling)) == first, "{rows} {columns}");
    }
}

#[test]
fn another_seed_gives_other_noise_about_the_same_mean() {
    let mut scene = mixed();
    let picture = |scene: &Scene| Renderer::new(scene).samples(64).render().unwrap().film.pixels;
    let first = picture(&scene);
    scene.film.seed = 1;
    let second = picture(&scene);
    assert!(first != second);
    let mean = |pixels: &[[f32; 3]]| pixels.iter().map(|p| f64::from(p[1])).sum::<f64>();
    assert_near(mean(&second), mean(&first), 1e-2);
}
