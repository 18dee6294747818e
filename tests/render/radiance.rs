//! Radiance that can be worked out by hand.

use envers::internals::Counts;
use envers::scene::Filter;
use envers::{
    AdaptiveSampling, Camera, Checker, Falloff, Instance, Light, LightKind, Material, MaterialId,
    Mesh, Plane, Projection, RenderOptions, Renderer, Scene, Shadow, Sphere,
};
use glam::{DAffine3, DVec3, Vec3};

/// A scene that is seen along −z from `z = 5` through one pixel, straight ahead.
fn scene(material: Material) -> Scene {
    let mut scene = Scene::default();
    scene.add_material(material);
    scene.film.size = [1, 1];
    let eye = DVec3::Z * 5.0;
    scene
        .cameras
        .push(Camera::look_at(eye, DVec3::ZERO, DVec3::Y, Projection::FovY(0.01)).unwrap());
    scene
}

fn light(kind: LightKind) -> Light {
    Light::new(kind)
}

fn point(position: DVec3, falloff: Falloff) -> Light {
    light(LightKind::Point { position, falloff, range: f64::INFINITY })
}

fn matt(diffuse: f32) -> Material {
    Material { diffuse: Vec3::splat(diffuse), ..Material::default() }
}

fn wall(scene: &mut Scene) {
    let mesh = scene.add_mesh(Mesh {
        positions: vec![[-9., -9., 0.], [9., -9., 0.], [9., 9., 0.], [-9., 9., 0.]].into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    });
    scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, MaterialId(0)));
}

/// The pixel, the same from every backend.
fn radiance(scene: &Scene) -> [f32; 3] {
    let (pixel, _) = rendered(scene);
    pixel
}

fn rendered(scene: &Scene) -> ([f32; 3], Counts) {
    use envers::Backend;
    let with = |backend| {
        let options =
            RenderOptions { backend: Some(backend), threads: 1, ..RenderOptions::default() };
        let rendering = Renderer::new(scene).options(options.clone()).render().unwrap();
        let mut counts = rendering.statistics.counts;
        counts.work.filters = 0; // Only Embree has any.
        (rendering.film.pixel(0, 0), counts)
    };
    let rust = with(Backend::Rust);
    assert_eq!(with(Backend::default()), rust, "the backends disagree");
    rust
}

fn assert_near(pixel: [f32; 3], expected: f32) {
    assert!(pixel.iter().all(|x| (x - expected).abs() < 1e-5), "{pixel:?} instead of {expected}");
}

#[test]
fn sphere_lit_head_on_has_its_diffuse_colour() {
    let mut scene = scene(matt(0.5));
    scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, MaterialId(0)));
    scene.lights.push(point(DVec3::Z * 9.0, Falloff::None));
    assert_near(radiance(&scene), 0.5);
}

#[test]
fn wall_lit_at_sixty_degrees_has_half_its_diffuse_colour() {
    let mut scene = scene(matt(0.8));
    wall(&mut scene);
    let direction = -DVec3::new(3f64.sqrt() / 2.0, 0.0, 0.5);
    scene.lights.push(light(LightKind::Directional { direction, angle: 0.0 }));
    assert_near(radiance(&scene), 0.4);
}

#[test]
fn inverse_square_light_at_distance_two_gives_a_quarter() {
    let mut scene = scene(matt(1.0));
    wall(&mut scene);
    scene.lights.push(point(DVec3::Z * 2.0, Falloff::InverseSquare));
    assert_near(radiance(&scene), 0.25);
}

#[test]
fn spot_lights_nothing_outside_its_cone() {
    let mut scene = scene(matt(1.0));
    wall(&mut scene);
    scene.lights.push(light(LightKind::Spot {
        position: DVec3::new(3.0, 0.0, 3.0),
        direction: DVec3::NEG_Z,
        falloff: Falloff::None,
        range: f64::INFINITY,
        inner_angle: 0.1,
        outer_angle: 0.5,
    }));
    assert_near(radiance(&scene), 0.0);
}

#[test]
fn phong_highlight_is_the_cosine_to_the_power_of_alpha() {
    let mut scene = scene(Material {
        diffuse: Vec3::ZERO,
        specular: Vec3::splat(0.5),
        shininess: 3.0,
        ..Material::default()
    });
    wall(&mut scene);
    // The view is reflected straight back, and the light stands 60° off it.
    let direction = -DVec3::new(3f64.sqrt() / 2.0, 0.0, 0.5);
    scene.lights.push(light(LightKind::Directional { direction, angle: 0.0 }));
    assert_near(radiance(&scene), 0.5 * 0.125);
}

#[test]
fn ambient_light_is_times_the_diffuse_colour() {
    let mut scene = scene(matt(0.5));
    wall(&mut scene);
    scene.lights.push(Light { intensity: Vec3::splat(0.3), ..light(LightKind::Ambient) });
    assert_near(radiance(&scene), 0.15);
}

#[test]
fn emission_is_added_whatever_the_light() {
    let mut scene = scene(Material { emission: Vec3::splat(0.25), ..matt(0.5) });
    wall(&mut scene);
    scene.lights.push(point(DVec3::Z * 9.0, Falloff::None));
    assert_near(radiance(&scene), 0.75);
}

#[test]
fn two_lights_add_up() {
    let mut scene = scene(matt(0.5));
    wall(&mut scene);
    scene.lights.push(point(DVec3::Z * 9.0, Falloff::None));
    scene.lights.push(light(LightKind::Directional { direction: DVec3::NEG_Z, angle: 0.0 }));
    assert_near(radiance(&scene), 1.0);
}

/// Lights that shine head-on onto a wall, with shadows and without: what it reflects is the sum of as
/// many products.
#[test]
fn thousands_of_lights_add_up_to_within_an_ulp() {
    for casts_shadows in [false, true] {
        let mut scene = scene(matt(0.7));
        wall(&mut scene);
        let mut expected = 0.0;
        for i in 0..5000 {
            let intensity = 0.1 + (i % 7) as f32;
            let sun = light(LightKind::Directional { direction: DVec3::NEG_Z, angle: 0.0 });
            let shadow = if casts_shadows { Shadow::default() } else { Shadow::None };
            scene.lights.push(Light { intensity: Vec3::splat(intensity), shadow, ..sun });
            expected += f64::from(0.7 * intensity);
        }
        let [red, ..] = radiance(&scene);
        assert!(red.to_bits().abs_diff((expected as f32).to_bits()) <= 1, "{red} {expected}");
    }
}

#[test]
fn a_constant_background_is_itself_at_any_number_of_samples() {
    let mut scene = scene(matt(1.0));
    scene.film.background = Vec3::new(0.1, 0.3, 0.7);
    let steps = [1, 2, 3, 5, 7, 9, 36, 49, 81, 225, 1000, 1024, 2025, 10_000, 65_536];
    let regular = steps.map(|spp| (spp, None));
    let adaptive = [(1, 9), (1, 81), (3, 17), (4, 36), (9, 2025), (7, 1000), (1, 4096)]
        .map(|(spp, max)| (spp, Some(AdaptiveSampling { max, threshold: 0.0 })));
    for (spp, adaptive) in regular.into_iter().chain(adaptive) {
        (scene.film.spp, scene.film.adaptive) = (spp, adaptive);
        assert_eq!(radiance(&scene), [0.1, 0.3, 0.7], "{spp} {adaptive:?}");
    }
}

#[test]
fn background_is_seen_where_nothing_stands() {
    let mut scene = scene(matt(0.5));
    scene.film.background = Vec3::splat(0.125);
    assert_near(radiance(&scene), 0.125);
}

#[test]
fn texture_and_vertex_colours_multiply_the_diffuse_colour() {
    use envers::Image;
    use envers::Texture;
    use envers::scene::Transfer;
    let mut scene = scene(matt(0.5));
    wall(&mut scene);
    std::sync::Arc::make_mut(&mut scene.meshes[0]).colors = vec![[0.5; 3]; 4];
    let image = Image::from_bytes("", [1, 1], vec![[51; 4]]);
    let texture = Texture { transfer: Transfer::None, ..Texture::new(image.into()) };
    let texture = scene.add_texture(texture);
    std::sync::Arc::make_mut(&mut scene.meshes[0]).uvs = vec![[0.0; 2]; 4];
    scene.materials[0].diffuse_map = Some(texture);
    scene.lights.push(point(DVec3::Z * 9.0, Falloff::None));
    assert_near(radiance(&scene), 0.5 * 0.5 * 0.2);
}

#[test]
fn checker_stands_in_place_of_the_diffuse_colour() {
    let mut scene = scene(matt(0.5));
    let mut plane = Plane::new(DVec3::new(-0.5, 0.5, 0.0), DVec3::Z, MaterialId(0));
    plane.checker = Some(Checker { colors: [Vec3::splat(0.75), Vec3::ZERO], size: 1.0 });
    scene.planes.push(plane);
    scene.lights.push(point(DVec3::Z * 9.0, Falloff::None));
    assert_near(radiance(&scene), 0.75);
}

#[test]
fn a_picture_on_a_wall_has_its_upper_left_corner_at_the_planes_point() {
    use envers::Image;
    use envers::Texture;
    use envers::scene::Transfer;
    // The eye looks at (0, 0), 3 units right of the point and 3 below it, on a picture of 8 units
    // and 4 by 4 texels: in the middle of its second column and second row.
    let mut scene = scene(matt(1.0));
    let mut plane = Plane::new(DVec3::new(-3.0, 3.0, 0.0), DVec3::Z, MaterialId(0));
    plane.texture_size = 8.0;
    scene.planes.push(plane);
    let texels = (0..16).map(|i| [i * 16; 4]).collect();
    let image = Image::from_bytes("", [4, 4], texels);
    let texture = scene.add_texture(Texture {
        transfer: Transfer::None,
        filter: Filter::Nearest,
        ..Texture::new(image.into())
    });
    scene.materials[0].diffuse_map = Some(texture);
    scene.lights.push(point(DVec3::Z * 9.0, Falloff::None));
    assert_near(radiance(&scene), 80.0 / 255.0);
}

#[test]
fn blocker_takes_the_light_away_and_counts_one_shadow_ray() {
    let mut scene = scene(matt(0.5));
    wall(&mut scene);
    scene.lights.push(point(DVec3::new(4.0, 0.0, 4.0), Falloff::None));
    assert_near(radiance(&scene), 0.5 * 0.5f32.sqrt());
    scene.spheres.push(Sphere::new(DVec3::new(2.0, 0.0, 2.0), 0.5, MaterialId(0)));
    let (pixel, counts) = rendered(&scene);
    assert_near(pixel, 0.0);
    assert_eq!(counts.rays.shadow, 1);
}

#[test]
fn object_that_casts_no_shadow_lets_the_light_through() {
    let mut scene = scene(matt(0.5));
    wall(&mut scene);
    scene.lights.push(point(DVec3::Z * 9.0, Falloff::None));
    let mut blocker = Sphere::new(DVec3::Z * 7.0, 0.5, MaterialId(0));
    blocker.casts_shadow = false;
    scene.spheres.push(blocker);
    assert_near(radiance(&scene), 0.5);
}

#[test]
fn instance_that_casts_no_shadow_lets_the_light_through() {
    let mut scene = scene(matt(0.5));
    wall(&mut scene);
    let screen = DAffine3::from_translation(DVec3::Z * 7.0);
    let mut blocker = Instance::new(scene.instances[0].mesh, screen, MaterialId(0));
    scene.lights.push(point(DVec3::Z * 9.0, Falloff::None));
    scene.instances.push(blocker.clone());
    assert_near(radiance(&scene), 0.0);
    blocker.casts_shadow = false;
    scene.instances[1] = blocker;
    assert_near(radiance(&scene), 0.5);
}

#[test]
fn light_without_shadow_shines_through_and_traces_no_shadow_ray() {
    let mut scene = scene(matt(0.5));
    wall(&mut scene);
    scene.spheres.push(Sphere::new(DVec3::Z * 7.0, 0.5, MaterialId(0)));
    scene.lights.push(Light { shadow: Shadow::None, ..point(DVec3::Z * 9.0, Falloff::None) });
    let (pixel, counts) = rendered(&scene);
    assert_near(pixel, 0.5);
    assert_eq!(counts.rays.shadow, 0);
}

#[test]
fn light_inside_a_sphere_leaves_its_outside_dark() {
    let mut scene = scene(matt(0.5));
    scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, MaterialId(0)));
    scene.lights.push(point(DVec3::ZERO, Falloff::None));
    assert_near(radiance(&scene), 0.0);
}

#[test]
fn inside_of_a_sphere_is_lit_only_when_double_sided() {
    let mut scene = scene(matt(0.5));
    scene.spheres.push(Sphere::new(DVec3::ZERO, 20.0, MaterialId(0)));
    scene.lights.push(point(DVec3::Z * 9.0, Falloff::None));
    assert_near(radiance(&scene), 0.0);
    scene.materials[0].double_sided = true;
    assert_near(radiance(&scene), 0.5);
}

#[test]
fn ground_far_from_the_origin_does_not_shadow_itself() {
    for offset in [0.0, 1e3, 1e7] {
        let mut scene = scene(matt(0.5));
        scene.film.size = [64, 64];
        let at = DVec3::splat(offset);
        let lens = Projection::FovY(0.8);
        let eye = at + DVec3::new(0.0, 1.0, 4.0);
        scene.cameras = vec![Camera::look_at(eye, at, DVec3::Y, lens).unwrap()];
        scene.spheres.push(Sphere::new(at - DVec3::Y * 6.4e6, 6.4e6, MaterialId(0)));
        let toward = DVec3::new(0.2, -1.0, 0.1).normalize();
        scene.lights.push(light(LightKind::Directional { direction: toward, angle: 0.0 }));
        let rendering = Renderer::new(&scene).render().unwrap();
        let lit = 0.5 * -toward.y as f32;
        let ground = rendering.film.pixels.iter().filter(|p| **p != [0.0; 3]).count();
        assert!(ground > 2000, "{ground} pixels at {offset}");
        for p in rendering.film.pixels.iter().filter(|p| **p != [0.0; 3]) {
            assert!((p[0] - lit).abs() < 1e-3, "{p:?} at {offset}");
        }
        assert_eq!(rendering.statistics.counts.rays.shadow, ground as u64);
        let hit = rendering.statistics.counts.hits;
        assert_eq!(hit, ground as u64, "ground shadowed by itself at {offset}");
    }
}
