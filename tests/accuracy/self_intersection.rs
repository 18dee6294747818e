//! Self-intersection avoidance: closed scenes of known radiance.

use envers::{
    Backend, Camera, Falloff, Geometry, Instance, Light, LightKind, Material, MaterialId, Mesh,
    Plane, Precision, PrimitiveId, Projection, RenderOptions, Renderer, Rendering, Scene, Shadow,
    Sphere,
};
use glam::{DAffine3, DQuat, DVec3, Vec3};

/// An empty scene with one double-sided material, seen from `eye` toward `target` through 48 × 48
/// pixels.
fn scene(eye: DVec3, target: DVec3) -> Scene {
    let mut scene = Scene::default();
    scene.film.size = [48, 48];
    let diffuse = Vec3::splat(0.5);
    scene.add_material(Material { diffuse, double_sided: true, ..Material::default() });
    let up = if (target - eye).normalize().y.abs() > 0.9 { DVec3::X } else { DVec3::Y };
    scene.cameras.push(Camera::look_at(eye, target, up, Projection::FovY(1.0)).unwrap());
    scene
}

fn lamp(scene: &mut Scene, position: DVec3) {
    let kind = LightKind::Point { position, falloff: Falloff::None, range: f64::INFINITY };
    light(scene, kind);
}

fn sun(scene: &mut Scene, direction: DVec3) {
    light(scene, LightKind::Directional { direction: direction.normalize(), angle: 0.0 });
}

fn light(scene: &mut Scene, kind: LightKind) {
    let light = Light::new(kind);
    scene.lights.push(light);
}

fn sphere(scene: &mut Scene, center: DVec3, radius: f64) {
    scene.spheres.push(Sphere::new(center, radius, MaterialId(0)));
}

fn ground(scene: &mut Scene) {
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, MaterialId(0)));
}

/// A level square of `n` × `n` cells, two triangles each, its sides twice `half` long.
fn floor(half: f32, n: u32) -> Mesh {
    let at = |i: u32| half * (2.0 * i as f32 / n as f32 - 1.0);
    let corner = |x: u32, z: u32| z * (n + 1) + x;
    let positions = (0..=n).flat_map(|z| (0..=n).map(move |x| [at(x), 0.0, at(z)])).collect();
    let cell = |x, z| {
        let [a, b, c, d] =
            [(x, z), (x, z + 1), (x + 1, z + 1), (x + 1, z)].map(|(x, z)| corner(x, z));
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..n).flat_map(|z| (0..n).flat_map(move |x| cell(x, z))).collect();
    Mesh { name: "floor".into(), positions, triangles, ..Mesh::default() }
}

fn add(scene: &mut Scene, mesh: Mesh, transform: DAffine3) {
    let mesh = scene.add_mesh(mesh);
    scene.instances.push(Instance::new(mesh, transform, MaterialId(0)));
}

fn backends() -> impl Iterator<Item = RenderOptions> {
    let mut backends = vec![Backend::Rust];
    if Backend::default() != Backend::Rust {
        backends.push(Backend::default());
    }
    backends.into_iter().flat_map(|backend| {
        [Precision::Fast, Precision::Certified].map(|precision| RenderOptions {
            backend: Some(backend),
            precision,
            threads: 1,
            ..RenderOptions::default()
        })
    })
}

/// Renders with every backend in every precision.
fn each(scene: &Scene, mut check: impl FnMut(Rendering, &str)) {
    for options in backends() {
        let name = format!("{:?} {}", options.backend, options.precision.name());
        check(Renderer::new(scene).options(options.clone()).render().unwrap(), &name);
    }
}

/// Asserts that each pixel is what Lambert's law says without any shadow: 0.5 times the cosine at
/// the point where the pixel's ray meets the first surface of `alone`.
#[track_caller]
fn assert_lit_as(scene: &Scene, alone: &Scene) {
    let mut open = alone.clone();
    open.lights.iter_mut().for_each(|l| l.shadow = Shadow::None);
    assert_alike(scene, &open);
}

/// Asserts that both scenes look the same, as they stand and turned and moved so that no coordinate
/// is a round number any more.
#[track_caller]
fn assert_alike(scene: &Scene, expected: &Scene) {
    assert_alike_here(scene, expected);
    for angle in [0.1, 0.7, 1.3] {
        let turn = DQuat::from_rotation_z(angle) * DQuat::from_rotation_x(0.5 * angle);
        let by = DVec3::new(3.3, -1.7, 0.9);
        assert_alike_here(&moved(scene, turn, by), &moved(expected, turn, by));
    }
}

/// Asserts that both scenes look the same, and that not all of it is black.
///
/// A point that lies on two coincident surfaces is computed from either: 1e-5 is far above what
/// that rounding does to a cosine, and far below a shadow.
#[track_caller]
fn assert_alike_here(scene: &Scene, expected: &Scene) {
    let options =
        RenderOptions { backend: Some(Backend::Rust), threads: 1, ..RenderOptions::default() };
    let expected = Renderer::new(expected).options(options.clone()).render().unwrap().film;
    let bright = expected.pixels.iter().filter(|p| p[0] > 0.01).count();
    assert!(bright > 300, "only {bright} pixels are lit: nothing would be shown");
    each(scene, |rendering, name| {
        let pairs = rendering.film.pixels.iter().zip(&expected.pixels);
        let off = pairs.filter(|(a, b)| (a[0] - b[0]).abs() > 1e-5).count();
        assert_eq!(off, 0, "{name}: pixels that differ");
    });
}

/// The whole scene, camera and lights included, turned about 0 and moved.
fn moved(scene: &Scene, turn: DQuat, by: DVec3) -> Scene {
    let mut scene = scene.clone();
    let point = |p: &mut DVec3| *p = turn * *p + by;
    let direction = |d: &mut DVec3| *d = turn * *d;
    for camera in &mut scene.cameras {
        point(&mut camera.position);
        [&mut camera.forward, &mut camera.right, &mut camera.up].into_iter().for_each(direction);
    }
    scene.spheres.iter_mut().for_each(|s| point(&mut s.center));
    for plane in &mut scene.planes {
        point(&mut plane.point);
        direction(&mut plane.normal);
    }
    for instance in &mut scene.instances {
        instance.transform = DAffine3::from_rotation_translation(turn, by) * instance.transform;
    }
    for light in &mut scene.lights {
        match &mut light.kind {
            LightKind::Point { position, .. } => point(position),
            LightKind::Directional { direction: d, .. } => direction(d),
            _ => unreachable!("no test has such a light"),
        }
    }
    scene
}

/// The scene without what `remove` takes out.
fn without(scene: &Scene, remove: impl FnOnce(&mut Scene)) -> Scene {
    let mut scene = scene.clone();
    remove(&mut scene);
    scene
}

// Coincident and coplanar surfaces

#[test]
fn plane_in_a_floor_shades_nothing() {
    let mut scene = scene(DVec3::new(0.3, 2.0, 3.0), DVec3::ZERO);
    add(&mut scene, floor(50.0, 7), DAffine3::IDENTITY);
    lamp(&mut scene, DVec3::new(1.0, 3.0, -2.0));
    let alone = scene.clone();
    ground(&mut scene);
    assert_lit_as(&scene, &alone);
}

#[test]
fn coincident_floors_shade_nothing() {
    let mut scene = scene(DVec3::new(0.3, 2.0, 3.0), DVec3::ZERO);
    add(&mut scene, floor(50.0, 7), DAffine3::IDENTITY);
    lamp(&mut scene, DVec3::new(1.0, 3.0, -2.0));
    let alone = scene.clone();
    scene.instances.push(scene.instances[0].clone());
    let turned = DAffine3::from_rotation_y(0.6);
    scene.instances.push(Instance { transform: turned, ..scene.instances[0].clone() });
    assert_lit_as(&scene, &alone);
}

#[test]
fn coplanar_floors_of_other_triangles_shade_nothing() {
    let mut scene = scene(DVec3::new(0.3, 2.0, 3.0), DVec3::ZERO);
    add(&mut scene, floor(50.0, 7), DAffine3::IDENTITY);
    lamp(&mut scene, DVec3::new(1.0, 3.0, -2.0));
    let alone = scene.clone();
    add(&mut scene, floor(11.0, 23), DAffine3::IDENTITY);
    assert_lit_as(&scene, &alone);
}

#[test]
fn flat_floor_in_grazing_light_does_not_shade_itself() {
    for angle in [1e-2, 1e-4, 1e-6] {
        let mut scene = scene(DVec3::new(0.3, 2.0, 3.0), DVec3::ZERO);
        add(&mut scene, floor(50.0, 23), DAffine3::from_translation(DVec3::Y * 0.1));
        scene.materials[0].diffuse = Vec3::splat((0.5 / angle) as f32);
        sun(&mut scene, DVec3::new(0.6, -angle, 0.8));
        let alone = scene.clone();
        assert_lit_as(&scene, &alone);
    }
}

#[test]
fn coincident_spheres_shade_nothing() {
    let mut scene = scene(DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO);
    sphere(&mut scene, DVec3::new(0.1, 0.2, 0.3), 0.7);
    lamp(&mut scene, DVec3::new(2.0, 1.0, 3.0));
    let alone = scene.clone();
    sphere(&mut scene, DVec3::new(0.1, 0.2, 0.3), 0.7);
    assert_lit_as(&scene, &alone);
}

#[test]
fn first_of_coincident_surfaces_is_seen_in_certified() {
    let mut scene = scene(DVec3::new(0.3, 2.0, 3.0), DVec3::ZERO);
    add(&mut scene, floor(50.0, 7), DAffine3::IDENTITY);
    scene.instances.push(scene.instances[0].clone());
    let rays = scene.cameras[0].ray_generator(scene.film.size);
    let rays: Vec<_> =
        (0..48 * 48).map(|i| rays.ray(f64::from(i % 48), f64::from(i / 48))).collect();
    for options in backends().filter(|o| o.precision == Precision::Certified) {
        let seen = |scene: &Scene| -> Vec<Option<PrimitiveId>> {
            let mut hits = vec![None; rays.len()];
            let intersector = options.backend().build(scene, options.precision, 1).unwrap();
            intersector.closest(&rays, envers::Coherence::Coherent, &mut hits);
            hits.into_iter().map(|hit| hit.map(|hit| hit.id)).collect()
        };
        let floors = seen(&scene);
        assert!(floors.iter().flatten().count() > 1000);
        assert!(floors.iter().flatten().all(|id| id.instance == 0), "{:?}", options.backend);
        let mut with_plane = scene.clone();
        ground(&mut with_plane);
        let plane = seen(&with_plane);
        assert!(plane.iter().flatten().all(|id| id.geometry == Geometry::Planes));
    }
}

// Touching surfaces

#[test]
fn ball_on_a_plane_is_lit_about_its_foot() {
    // From just above the ground, looking at where they touch. The lamp stands at the eye: what is
    // seen is lit.
    let eye = DVec3::new(0.0, 0.05, 0.3);
    let mut scene = scene(eye, DVec3::ZERO);
    ground(&mut scene);
    sphere(&mut scene, DVec3::Y, 1.0);
    lamp(&mut scene, eye);
    assert_lit_as(&scene, &scene.clone());
}

#[test]
fn point_where_a_ball_touches_its_ground_is_dark() {
    // No eye sees that point: the ray is made by hand.
    use envers::Departure;
    use envers::Ray;
    use envers::Side;
    let mut scene = scene(DVec3::new(0.0, 0.05, 0.3), DVec3::ZERO);
    ground(&mut scene);
    sphere(&mut scene, DVec3::Y, 1.0);
    for options in backends() {
        let intersector = options.backend().build(&scene, options.precision, 1).unwrap();
        let from = Some(Departure { id: PrimitiveId::plane(0), side: Side::Front });
        let up = Ray { departure: from, ..Ray::new(DVec3::ZERO, DVec3::new(0.1, 1.0, 0.2)) };
        let mut blocked = [false];
        intersector.occluded(&[up], envers::Coherence::Coherent, &mut blocked);
        assert_eq!(blocked, [true], "{options:?}");
    }
}

#[test]
fn ball_on_a_mesh_is_lit_as_on_a_plane() {
    let mut scene = scene(DVec3::new(0.0, 1.0, 3.0), DVec3::ZERO);
    sphere(&mut scene, DVec3::Y, 1.0);
    lamp(&mut scene, DVec3::new(2.0, 3.0, 1.0));
    let mut on_plane = scene.clone();
    ground(&mut on_plane);
    add(&mut scene, floor(4096.0, 3), DAffine3::IDENTITY);
    // The background beyond the floor's edge is below the horizon's row of pixels.
    assert_alike(&scene, &on_plane);
}

#[test]
fn balls_that_touch_are_lit_at_their_contact() {
    // The lamp and the eye look along the plane of contact, which neither ball reaches beyond.
    let mut scene = scene(DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO);
    sphere(&mut scene, DVec3::X, 1.0);
    sphere(&mut scene, DVec3::NEG_X, 1.0);
    lamp(&mut scene, DVec3::new(0.0, 0.0, 3.0));
    assert_lit_as(&scene, &scene.clone());
}

#[test]
fn ball_inside_another_that_it_touches_is_lit_by_a_lamp_between_them() {
    let mut scene = scene(DVec3::new(0.0, 0.0, -1.5), DVec3::Z);
    sphere(&mut scene, DVec3::ZERO, 2.0);
    sphere(&mut scene, DVec3::Z, 1.0);
    lamp(&mut scene, DVec3::new(0.0, 0.0, -1.5));
    assert_lit_as(&scene, &scene.clone());
}

#[test]
fn nested_spheres_keep_the_light_between_them() {
    // A lamp between two shells lights both; one outside or at the centre lights neither.
    let mut scene = scene(DVec3::new(0.0, 0.0, -1.5), DVec3::Z);
    sphere(&mut scene, DVec3::ZERO, 2.0);
    sphere(&mut scene, DVec3::ZERO, 1.0);
    lamp(&mut scene, DVec3::new(0.0, 0.0, -1.5));
    let between = scene.clone();
    lamp(&mut scene, DVec3::ZERO);
    lamp(&mut scene, DVec3::Z * 9.0);
    assert_lit_as(&scene, &between);
}

#[test]
fn shell_a_billionth_of_the_radius_away_keeps_all_light_out() {
    for radius in [1e-6, 1.0, 1e6] {
        let mut scene = scene(DVec3::Z * 0.5 * radius, DVec3::ZERO);
        sphere(&mut scene, DVec3::ZERO, radius);
        sphere(&mut scene, DVec3::ZERO, radius * (1.0 + 1e-9));
        lamp(&mut scene, DVec3::Z * 9.0 * radius);
        each(&scene, |rendering, name| {
            assert_eq!(rendering.statistics.counts.hits, 48 * 48, "{name}, radius {radius}");
            let lit = rendering.film.pixels.iter().filter(|p| **p != [0.0; 3]).count();
            assert_eq!(lit, 0, "{name}, radius {radius}");
        });
    }
}

// Surfaces that cut each other

#[test]
fn sphere_that_cuts_a_floor_is_lit_as_one_that_cuts_a_plane() {
    let mut scene = scene(DVec3::new(0.0, 1.0, 3.0), DVec3::ZERO);
    sphere(&mut scene, DVec3::Y * 0.3, 1.0);
    lamp(&mut scene, DVec3::new(2.0, 3.0, 1.0));
    let mut on_plane = scene.clone();
    ground(&mut on_plane);
    add(&mut scene, floor(4096.0, 3), DAffine3::IDENTITY);
    assert_alike(&scene, &on_plane);
}

#[test]
fn sphere_round_a_mesh_keeps_all_light_out() {
    let mut scene = scene(DVec3::new(0.0, 1.0, 1.0), DVec3::ZERO);
    add(&mut scene, floor(9.0, 9), DAffine3::IDENTITY);
    sphere(&mut scene, DVec3::ZERO, 2.0);
    lamp(&mut scene, DVec3::new(1.0, 9.0, 2.0));
    each(&scene, |rendering, name| {
        assert_eq!(rendering.statistics.counts.hits, 48 * 48, "{name}");
        assert!(rendering.film.pixels.iter().all(|p| *p == [0.0; 3]), "{name}");
    });
}

// Cameras inside and on surfaces

#[test]
fn camera_and_lamp_at_the_centre_of_a_sphere_see_its_full_colour() {
    for offset in [0.0, 1e3, 1e7] {
        let center = DVec3::splat(offset);
        let mut scene = scene(center, center + DVec3::Z);
        sphere(&mut scene, center, 1.0);
        lamp(&mut scene, center);
        each(&scene, |rendering, name| {
            // The cosine is 1 to within the rounding of coordinates, 1e7 · 2⁻⁵³ at most.
            for p in &rendering.film.pixels {
                assert!((p[0] - 0.5).abs() < 1e-6, "{name}, offset {offset}: {p:?}");
            }
        });
    }
}

#[test]
fn camera_on_a_sphere_sees_its_inside_or_nothing() {
    for (direction, hits) in [(DVec3::NEG_Z, 48 * 48), (DVec3::Z, 0)] {
        let mut scene = scene(DVec3::Z, DVec3::Z + direction);
        sphere(&mut scene, DVec3::ZERO, 1.0);
        lamp(&mut scene, DVec3::ZERO);
        each(&scene, |rendering, name| {
            assert_eq!(rendering.statistics.counts.hits, hits, "{name}");
            let expected = if hits == 0 { 0.0 } else { 0.5 };
            for p in &rendering.film.pixels {
                assert!((p[0] - expected).abs() < 1e-6, "{name}: {p:?}");
            }
        });
    }
}

/// Asserts the picture seen from the surface at 0 that `surface` adds, up at a ball.
#[track_caller]
fn seen_from_a_surface(surface: impl Fn(&mut Scene)) {
    let mut scene = scene(DVec3::ZERO, DVec3::new(0.0, 1.0, 0.2));
    sphere(&mut scene, DVec3::new(0.0, 3.0, 0.6), 1.0);
    lamp(&mut scene, DVec3::new(0.0, 0.5, 0.1));
    let alone = scene.clone();
    surface(&mut scene);
    // Moved, the eye would lie beside the surface by what that rounds.
    assert_alike_here(&scene, &alone);
}

#[test]
fn camera_on_a_plane_does_not_see_it() {
    seen_from_a_surface(ground);
}

#[test]
fn camera_on_a_triangle_does_not_see_it() {
    seen_from_a_surface(|scene| add(scene, floor(9.0, 3), DAffine3::IDENTITY));
}

#[test]
fn camera_on_an_edge_does_not_see_it() {
    seen_from_a_surface(|scene| add(scene, floor(9.0, 5), DAffine3::IDENTITY));
}

#[test]
fn camera_on_a_vertex_does_not_see_it() {
    seen_from_a_surface(|scene| add(scene, floor(9.0, 4), DAffine3::IDENTITY));
}

#[test]
fn removing_a_copy_changes_nothing() {
    // A room of everything twice: what one copy shows is what both show.
    let mut scene = scene(DVec3::new(0.5, 2.0, 5.0), DVec3::Y * 0.5);
    for _ in 0..2 {
        ground(&mut scene);
        sphere(&mut scene, DVec3::new(-0.8, 0.7, 0.0), 0.7);
        let turn = DQuat::from_rotation_x(1.2) * DQuat::from_rotation_z(0.4);
        let placed = DAffine3::from_rotation_translation(turn, DVec3::new(0.9, 0.8, -0.5));
        add(&mut scene, floor(0.7, 3), placed);
    }
    lamp(&mut scene, DVec3::new(2.0, 4.0, 3.0));
    let once = without(&scene, |s| {
        s.planes.pop();
        s.spheres.pop();
        s.instances.pop();
    });
    assert_alike(&scene, &once);
}
