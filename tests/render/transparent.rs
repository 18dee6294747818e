//! A transparent background: alpha that can be worked out by hand, and radiance premultiplied by it.

use envers::internals::Counts;
use envers::{
    AdaptiveSampling, Backend, Camera, Film, Instance, Material, MaterialId, Mesh, Plane,
    Projection, RenderOptions, Renderer, Scene, Sphere, View,
};
use glam::{DAffine3, DVec3, Vec3};

/// A scene before a white background, seen along −z by a camera that sees one unit of length for each
/// pixel, 0 in the middle.
fn scene(size: u32, material: Material) -> Scene {
    let mut scene = Scene::default();
    scene.add_material(material);
    (scene.film.size, scene.film.background) = ([size; 2], Vec3::ONE);
    scene.film.transparent = true;
    let projection = Projection::OrthoHeight(f64::from(size));
    let eye = DVec3::Z * 99.0;
    scene.cameras.push(Camera::look_at(eye, DVec3::ZERO, DVec3::Y, projection).unwrap());
    scene
}

/// A sphere of radius 20.3 in the middle of 64 × 64 pixels.
fn ball(material: Material) -> Scene {
    let mut scene = scene(64, material);
    scene.spheres.push(Sphere::new(DVec3::ZERO, RADIUS, MaterialId(0)));
    scene
}

const RADIUS: f64 = 20.3;

/// A surface that leaves the share `transmit` of what is behind it uncovered, and emits the rest.
fn sheet(transmit: Vec3) -> Material {
    Material { transmit, thin: true, ior: 1.0, ..Material::emissive(Vec3::ONE - transmit) }
}

/// Adds a square across the picture at this z, of material 0; no edge of its triangles is in the middle.
fn add_square(scene: &mut Scene, z: f64) {
    let mesh = scene.add_mesh(Mesh {
        positions: vec![[-9., -8., 0.], [9., -8., 0.], [9., 10., 0.], [-9., 10., 0.]].into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    });
    let transform = DAffine3::from_translation(DVec3::Z * z);
    scene.instances.push(Instance::new(mesh, transform, MaterialId(0)));
}

/// The picture, the same from every backend, with what was counted.
#[track_caller]
fn rendered(scene: &Scene) -> (Film, Counts) {
    let with = |backend| {
        let options = RenderOptions { backend: Some(backend), ..RenderOptions::default() };
        let rendering = Renderer::new(scene).options(options).render().unwrap();
        (rendering.film, rendering.statistics.counts)
    };
    let rust = with(Backend::Rust);
    assert!(with(Backend::default()).0 == rust.0, "the backends disagree");
    rust
}

fn alpha(film: &Film) -> &[f32] {
    film.alpha.as_deref().expect("a transparent picture")
}

/// The radiance and the alpha of the one pixel of a picture.
#[track_caller]
fn pixel(scene: &Scene) -> ([f32; 3], f32) {
    let film = rendered(scene).0;
    assert_eq!(film.size, [1, 1]);
    (film.pixels[0], alpha(&film)[0])
}

#[test]
fn a_sphere_covers_its_disc() {
    let mut scene = ball(Material::emissive(Vec3::ONE));
    scene.film.spp = 64;
    let film = rendered(&scene).0;
    let area: f64 = alpha(&film).iter().map(|&a| f64::from(a)).sum();
    let disc = std::f64::consts::PI * RADIUS * RADIUS;
    assert!((area / disc - 1.0).abs() < 1e-3, "{area} of {disc}");
    for (i, &found) in alpha(&film).iter().enumerate() {
        // The share of a fine grid in the pixel that lies within the disc.
        let [x, y] = [i % 64, i / 64].map(|n| n as f64 - 32.0);
        let grid = (0..400).map(|k| [k % 20, k / 20].map(|n| (f64::from(n) + 0.5) / 20.0));
        let inside = grid.filter(|[dx, dy]| (x + dx).hypot(y + dy) < RADIUS).count();
        let expected = inside as f32 / 400.0;
        assert!((found - expected).abs() < 0.1, "{found} instead of {expected} in {x}, {y}");
        // All of the pixel may be inside, or outside.
        let nearest = [x, y].map(|n| n.max(-n - 1.0).max(0.0));
        let is_inside = (nearest[0] + 1.0).hypot(nearest[1] + 1.0) < RADIUS;
        let is_outside = nearest[0].hypot(nearest[1]) > RADIUS;
        assert!(!is_inside || found == 1.0, "{found} in {x}, {y}");
        assert!(!is_outside || found == 0.0, "{found} in {x}, {y}");
    }
}

#[test]
fn radiance_is_premultiplied_by_alpha_and_without_the_background() {
    let mut scene = ball(Material::emissive(Vec3::new(0.5, 0.25, 4.0)));
    scene.film.spp = 9;
    let film = rendered(&scene).0;
    assert!(alpha(&film).iter().any(|&a| a > 0.0 && a < 1.0));
    for (pixel, &a) in film.pixels.iter().zip(alpha(&film)) {
        for (x, color) in pixel.iter().zip([0.5, 0.25, 4.0]) {
            assert!((x - a * color).abs() < 1e-6, "{pixel:?} at alpha {a}");
        }
    }
}

#[test]
fn what_is_covered_is_as_before_an_opaque_background() {
    let transparent = ball(Material::emissive(Vec3::splat(0.5)));
    let mut opaque = transparent.clone();
    opaque.film.transparent = false;
    let (film, counts) = rendered(&transparent);
    let (opaque_film, opaque_counts) = rendered(&opaque);
    assert_eq!(opaque_film.alpha, None);
    for (i, &a) in alpha(&film).iter().enumerate() {
        let expected = if a == 1.0 { opaque_film.pixels[i] } else { [0.0; 3] };
        assert_eq!(film.pixels[i], expected);
    }
    assert_eq!(counts, opaque_counts, "no ray is traced for alpha");
}

#[test]
fn a_blended_sheet_covers_its_opacity() {
    let mut scene = scene(1, sheet(Vec3::splat(0.75)));
    add_square(&mut scene, 0.0);
    assert_eq!(pixel(&scene), ([0.25; 3], 0.25));
}

#[test]
fn a_tinted_sheet_covers_the_mean_of_what_its_channels_cover() {
    let mut scene = scene(1, sheet(Vec3::new(1.0, 0.5, 0.0)));
    add_square(&mut scene, 0.0);
    assert_eq!(pixel(&scene), ([0.0, 0.5, 1.0], 0.5));
}

#[test]
fn sheets_leave_uncovered_the_product_of_what_each_leaves() {
    let mut scene = scene(1, sheet(Vec3::splat(0.75)));
    add_square(&mut scene, 0.0);
    add_square(&mut scene, 1.0);
    let covered = 1.0 - 0.75 * 0.75;
    assert_eq!(pixel(&scene), ([covered; 3], covered));
}

#[test]
fn a_sheet_before_a_wall_is_covered() {
    let mut scene = scene(1, sheet(Vec3::splat(0.75)));
    add_square(&mut scene, 0.0);
    let wall = scene.add_material(Material::emissive(Vec3::ONE));
    scene.planes.push(Plane::new(DVec3::NEG_Z, DVec3::Z, wall));
    assert_eq!(pixel(&scene), ([1.0; 3], 1.0));
}

#[test]
fn glass_is_covered_and_shows_the_background() {
    let film = rendered(&ball(Material::glass(1.5))).0;
    let middle = 32 * 64 + 32;
    assert_eq!(alpha(&film)[middle], 1.0);
    // All light that glass does not absorb is reflected or refracted, from a white world.
    assert!((film.pixels[middle][0] - 1.0).abs() < 1e-3, "{:?}", film.pixels[middle]);
    assert!(alpha(&film).iter().all(|&a| a == 0.0 || a == 1.0));
    assert_eq!((alpha(&film)[0], film.pixels[0]), (0.0, [0.0; 3]));
}

#[test]
fn a_mirror_is_covered_and_shows_the_background() {
    let film = rendered(&ball(Material::mirror(Vec3::splat(0.5)))).0;
    let middle = 32 * 64 + 32;
    assert_eq!((film.pixels[middle], alpha(&film)[middle]), ([0.5; 3], 1.0));
}

#[test]
fn an_invisible_ball_covers_nothing() {
    let film = rendered(&ball(Material::glass(1.0))).0;
    assert!(alpha(&film).iter().all(|&a| a == 0.0));
    assert!(film.pixels.iter().all(|p| *p == [0.0; 3]));
}

#[test]
fn smoke_covers_what_it_absorbs() {
    let absorption = Vec3::splat(0.02);
    let mut scene = scene(1, Material { absorption, ..Material::glass(1.0) });
    scene.spheres.push(Sphere::new(DVec3::ZERO, RADIUS, MaterialId(0)));
    let (radiance, alpha) = pixel(&scene);
    let expected = 1.0 - (-2.0 * RADIUS * 0.02).exp();
    assert!((f64::from(alpha) - expected).abs() < 1e-6, "{alpha} instead of {expected}");
    assert_eq!(radiance, [0.0; 3]);
}

#[test]
fn a_camera_in_smoke_without_end_sees_nothing_uncovered() {
    let absorption = Vec3::splat(0.02);
    let mut scene = scene(1, Material { absorption, ..Material::glass(1.5) });
    // The half-space behind a plane above the camera.
    scene.planes.push(Plane::new(DVec3::Y * 5.0, DVec3::Y, MaterialId(0)));
    assert_eq!(pixel(&scene), ([0.0; 3], 1.0));
}

/// Sheets, a mirror and opaque spheres over one another.
fn varied() -> Scene {
    let mut scene = scene(48, sheet(Vec3::new(0.75, 0.5, 0.3)));
    let mirror = scene.add_material(Material::mirror(Vec3::splat(0.6)));
    let lamp = scene.add_material(Material::emissive(Vec3::new(0.3, 0.7, 0.2)));
    add_square(&mut scene, 9.0);
    scene.instances[0].transform = DAffine3::from_rotation_z(0.3);
    for (x, y, radius, material) in
        [(-9.0, 3.0, 8.3, mirror), (7.0, -8.0, 9.1, lamp), (11.0, 12.0, 3.7, lamp)]
    {
        scene.spheres.push(Sphere::new(DVec3::new(x, y, 0.0), radius, material));
    }
    scene
}

fn adaptive(scene: &Scene, min: u32, max: u32, threshold: f32) -> Scene {
    let mut scene = scene.clone();
    scene.film.spp = min;
    scene.film.adaptive = Some(AdaptiveSampling { max, threshold });
    scene
}

#[test]
fn alpha_is_the_same_on_any_number_of_threads() {
    for scene in [varied(), adaptive(&varied(), 1, 25, 0.1)] {
        let film = |threads| Renderer::new(&scene).threads(threads).render().unwrap().film;
        assert!(film(1) == film(2));
    }
}

#[test]
fn a_pixel_with_all_adaptive_samples_is_that_of_a_regular_picture() {
    for (min, max) in [(1, 25), (4, 36), (1, 81)] {
        // At threshold 0 all pixels disagree.
        let all = rendered(&adaptive(&varied(), min, max, 0.0)).0;
        let mut regular = varied();
        regular.film.spp = max;
        assert!(all == rendered(&regular).0, "{min}..{max}");
    }
}

#[test]
fn adaptive_samples_refine_the_edges_of_alpha() {
    let ball = ball(Material::emissive(Vec3::ONE));
    let mut many = ball.clone();
    many.film.spp = 225;
    let many = rendered(&many).0;
    let error = |scene: &Scene| {
        let film = rendered(scene).0;
        let pairs = alpha(&film).iter().zip(alpha(&many));
        pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>()
    };
    let mut four = ball.clone();
    four.film.spp = 4;
    assert!(error(&adaptive(&ball, 1, 25, 0.1)) < error(&four));
}

#[test]
fn debug_views_have_no_alpha() {
    let scene = ball(Material::default());
    for view in [View::Normal, View::Depth, View::Id] {
        assert_eq!(Renderer::new(&scene).view(view).render().unwrap().film.alpha, None);
    }
}

#[test]
fn a_renderer_makes_the_background_transparent() {
    let mut scene = ball(Material::default());
    scene.film.transparent = false;
    assert_eq!(Renderer::new(&scene).render().unwrap().film.alpha, None);
    let film = Renderer::new(&scene).transparent(true).render().unwrap().film;
    assert_eq!(alpha(&film)[0], 0.0);
}

#[test]
fn alpha_is_not_lost_in_a_jpeg_or_gif() {
    let folder = tempfile::tempdir().unwrap();
    let rendering = Renderer::new(&ball(Material::default())).render().unwrap();
    for name in ["a.jpg", "a.gif"] {
        let error = rendering.save(folder.path().join(name)).unwrap_err();
        assert!(error.message().contains("has no alpha"), "{error}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
