//! Both ends of shadow rays, in pictures: lamps that lie on surfaces, points on edges of closed meshes,
//! planes given by far points, flat caps.

use envers::{
    Backend, Camera, Coherence, Departure, Hit, Instance, Intersector, Light, Material, MaterialId,
    Mesh, Plane, Precision, PrimitiveId, Projection, Ray, Renderer, Scene, ShadowEnds, Side,
    Sphere, Surface,
};
use envers_testing::Random;
use glam::{DAffine3, DQuat, DVec3, Vec3};

const BOTH: [Precision; 2] = [Precision::Fast, Precision::Certified];

/// A scene of one white material, seen from `eye`.
fn scene(eye: DVec3, target: DVec3, up: DVec3, projection: Projection) -> Scene {
    let mut scene = Scene::default();
    scene.add_material(Material::matte(Vec3::ONE));
    scene.cameras.push(Camera::look_at(eye, target, up, projection).unwrap());
    scene
}

/// The red of each pixel, on each backend.
fn pictures(scene: &Scene, size: [u32; 2], precision: Precision) -> Vec<(&'static str, Vec<f32>)> {
    [Backend::Rust, Backend::default()]
        .into_iter()
        .map(|backend| {
            let renderer = Renderer::new(scene).size(size).backend(backend).precision(precision);
            let pixels = renderer.render().unwrap().film.pixels;
            (backend.name(), pixels.iter().map(|pixel| pixel[0]).collect())
        })
        .collect()
}

/// A closed cube [0, 1]³ whose faces point outward.
fn cube() -> Mesh {
    let corner = |i: usize| [i & 1, i >> 1 & 1, i >> 2].map(|bit| bit as f32);
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh {
        positions: (0..8).map(corner).collect(),
        triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..Mesh::default()
    }
}

fn add_cube(scene: &mut Scene, transform: DAffine3) {
    let mesh = scene.add_mesh(cube());
    scene.instances.push(Instance::new(mesh, transform, MaterialId(0)));
}

#[test]
fn a_lamp_on_a_ceiling_lights_all_that_sees_it() {
    let projection = Projection::FovY(0.9);
    let mut scene = scene(DVec3::new(0.3, 1.2, 3.0), DVec3::Y * 0.6, DVec3::Y, projection);
    scene.planes.push(Plane::new(DVec3::Y * 2.5, DVec3::NEG_Y, MaterialId(0)));
    let floor = DVec3::new(0.01, 1.0, 0.02);
    scene.planes.push(Plane::new(DVec3::ZERO, floor.normalize(), MaterialId(0)));
    scene.lights.push(Light::point(DVec3::new(0.4, 2.5, 0.3)));
    for precision in BOTH {
        for (backend, pixels) in pictures(&scene, [80, 60], precision) {
            // The floor is lit all over; the ceiling, which the lamp lies in, not at all.
            let (ceiling, floor) = pixels.split_at(80 * 20);
            assert!(floor.iter().all(|&x| x > 0.0), "{backend} {precision:?}");
            assert!(ceiling[..80 * 3].iter().all(|&x| x == 0.0), "{backend} {precision:?}");
        }
    }
}

#[test]
fn a_lamp_on_a_ball_lights_what_the_ball_does_not_hide() {
    let projection = Projection::OrthoHeight(8.0);
    let mut scene = scene(DVec3::Y * 9.0, DVec3::ZERO, DVec3::Z, projection);
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, MaterialId(0)));
    for side in [1.0, -1.0] {
        // At the bottom of the ball it lights the floor, and at the top it does not.
        let (center, radius) = (DVec3::new(0.1, 2.3, 0.2), 0.7);
        let lamp = center - DVec3::Y * (side * radius);
        scene.spheres = vec![Sphere::new(center, radius, MaterialId(0))];
        scene.lights = vec![Light::point(lamp)];
        for precision in BOTH {
            for (backend, pixels) in pictures(&scene, [64, 64], precision) {
                let row = &pixels[64 * 6..64 * 7];
                let lit = row.iter().filter(|&&x| x > 0.0).count();
                assert_eq!(lit, if side > 0.0 { 64 } else { 0 }, "{backend} {precision:?} {side}");
            }
        }
    }
}

#[test]
fn a_plane_reaches_the_foot_of_a_ball_wherever_its_point_lies() {
    let projection = Projection::FovY(0.6);
    let mut scene = scene(DVec3::new(0.0, 2.0, 6.0), DVec3::Y, DVec3::Y, projection);
    let mirror = scene.add_material(Material { reflect: Vec3::ONE, ..Material::matte(Vec3::ZERO) });
    let glow = Material { emission: Vec3::ONE, ..Material::matte(Vec3::ZERO) };
    let glow = scene.add_material(glow);
    scene.spheres.push(Sphere::new(DVec3::Y, 1.0, mirror));
    let mut shown = Vec::new();
    for far in [0.0, 1e9, 1e15] {
        scene.planes = vec![Plane::new(DVec3::X * far, DVec3::Y, glow)];
        shown.push(pictures(&scene, [64, 48], Precision::Certified));
    }
    for other in &shown[1..] {
        assert_eq!(other, &shown[0]);
    }
}

#[test]
fn a_closed_cube_lets_no_light_out_along_the_edges_on_which_it_stands() {
    // Pixel centres lie on the cube's foot edges exactly.
    let projection = Projection::OrthoHeight(8.125);
    let mut scene =
        scene(DVec3::new(2.0, 9.0, 2.0), DVec3::new(2.0, 0.0, 2.0), DVec3::NEG_Z, projection);
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, MaterialId(0)));
    add_cube(&mut scene, DAffine3::from_scale(DVec3::splat(4.0)));
    scene.lights.push(Light::point(DVec3::new(2.3, 1.0, 2.2)));
    for (backend, pixels) in pictures(&scene, [65, 65], Precision::Certified) {
        assert_eq!(pixels.iter().filter(|&&x| x > 0.0).count(), 0, "{backend}");
    }
    // From within, the same floor is lit up to the walls.
    scene.cameras[0] = Camera::look_at(
        DVec3::new(2.0, 3.5, 2.0),
        DVec3::new(2.0, 0.0, 2.0),
        DVec3::NEG_Z,
        Projection::OrthoHeight(8.125),
    )
    .unwrap();
    for (backend, pixels) in pictures(&scene, [65, 65], Precision::Certified) {
        let inside = |i: usize| (17..48).contains(&(i % 65)) && (17..48).contains(&(i / 65));
        assert!((0..65 * 65).filter(|&i| inside(i)).all(|i| pixels[i] > 0.0), "{backend}");
    }
}

#[test]
fn a_closed_mesh_separates_a_lamp_within_from_points_on_its_corners_without() {
    let mut random = Random(11);
    for _ in 0..60 {
        // A box turned by multiples of a quarter, whose vertices are exact, on a floor; and points on
        // its faces, edges and vertices, seen from outside and from inside.
        let mut scene = Scene::default();
        scene.add_material(Material::default());
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, MaterialId(0)));
        let size = DVec3::from([0; 3].map(|_| 2f64.powi(random.below(5) as i32 - 2)));
        let at = DVec3::new(random.below(9) as f64, 0.0, random.below(9) as f64)
            - 4.0 * (DVec3::X + DVec3::Z);
        add_cube(&mut scene, DAffine3::from_scale_rotation_translation(size, DQuat::IDENTITY, at));
        let from_box = |p: DVec3| at + p * size;
        let on = |random: &mut Random| match random.below(3) {
            0 => 0.0,
            1 => 1.0,
            _ => random.below(255) as f64 / 256.0 + 1.0 / 256.0,
        };
        let mut rays = Vec::new();
        let mut expected = Vec::new();
        for _ in 0..400 {
            let local = DVec3::new(on(&mut random), 0.0, on(&mut random));
            let lamp =
                DVec3::new(random.range(0.1, 0.9), random.range(0.1, 0.9), random.range(0.1, 0.9));
            let viewer = DVec3::new(
                random.range(-2.0, 3.0),
                random.range(0.01, 2.0),
                random.range(-2.0, 3.0),
            );
            let point = from_box(local);
            let (toward, viewer) = (from_box(lamp) - point, from_box(viewer) - point);
            rays.push(Ray {
                tmax: 1.0,
                departure: Some(Departure { id: PrimitiveId::plane(0), side: Side::Front }),
                shadow: Some(ShadowEnds { viewer }),
                ..Ray::new(point, toward)
            });
            let near = point + viewer * 1e-9;
            let [low, high] = [from_box(DVec3::ZERO), from_box(DVec3::ONE)];
            expected.push(near != near.clamp(low, high));
        }
        for (name, intersector) in certified(&scene) {
            let mut occluded = vec![false; rays.len()];
            intersector.occluded(&rays, Coherence::Coherent, &mut occluded);
            for (i, ray) in rays.iter().enumerate() {
                assert_eq!(occluded[i], expected[i], "{name}: {ray:?}");
            }
        }
    }
}

/// A torus of radii 0.75 and 0.25 about the y axis, with faces that point outward.
fn torus() -> Mesh {
    const AROUND: u32 = 16;
    const ACROSS: u32 = 8;
    let angle = |i: u32, n: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (i, j) in (0..AROUND).flat_map(|i| (0..ACROSS).map(move |j| (i, j))) {
        let ((sin, cos), (up, out)) = (angle(i, AROUND).sin_cos(), angle(j, ACROSS).sin_cos());
        let r = 0.75 + 0.25 * out;
        positions.push(DVec3::new(r * cos, 0.25 * up, r * sin).as_vec3().to_array());
        let at = |i: u32, j: u32| i % AROUND * ACROSS + j % ACROSS;
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    Mesh { positions: positions.into(), triangles, ..Mesh::default() }
}

/// A torus that stands on a plane.
fn torus_on_plane() -> Scene {
    let mut scene = Scene::default();
    scene.add_material(Material::default());
    scene.planes.push(Plane::new(DVec3::Y * -0.25, DVec3::Y, MaterialId(0)));
    let mesh = scene.add_mesh(torus());
    scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, MaterialId(0)));
    scene
}

/// Asserts that each of these shadow rays is occluded, whoever is asked.
fn assert_all_occluded(scene: &Scene, rays: &[Ray]) {
    for (name, intersector) in certified(scene) {
        let mut occluded = vec![false; rays.len()];
        intersector.occluded(rays, Coherence::Incoherent, &mut occluded);
        let lit = occluded.iter().position(|occluded| !occluded);
        assert_eq!(lit.map(|i| &rays[i]), None, "{name}");
    }
}

#[test]
fn a_point_just_farther_from_a_vertex_than_rounding_is_judged_with_all_faces_there() {
    // On the plane of one face at the vertex to within rounding, and not on that of the next: this ray
    // passed under the one and over the other.
    let ray = Ray {
        tmax: 1.0,
        departure: Some(Departure { id: PrimitiveId::triangle(0, 25, 0), side: Side::Front }),
        shadow: Some(ShadowEnds {
            viewer: DVec3::new(-1.956197426472513, 2.646606774109698, 0.9849874633304176),
        }),
        ..Ray::new(
            DVec3::new(0.35355338454247115, -8.043181690947037e-15, 0.3535533845424622),
            DVec3::new(-0.45902560266130954, 0.0483978287974809, 0.44122442558844754),
        )
    };
    assert_all_occluded(&torus_on_plane(), &[ray]);
}

#[test]
fn no_light_from_within_a_torus_reaches_points_near_its_vertices() {
    let scene = torus_on_plane();
    let mesh = &scene.meshes[0];
    let eyes = certified(&scene).remove(0).1;
    let mut random = Random(23);
    let mut rays = Vec::new();
    while rays.len() < 6_000 {
        // A ray from outside to near a vertex, and a lamp in the body of the torus.
        let triangle = random.below(mesh.triangles.len()) as u32;
        let [a, b, c] = mesh.triangle_vertices(triangle);
        let near = 2f64.powi(-38 - random.below(16) as i32);
        let target = a + ((b - a) * random.unit() + (c - a) * random.unit()) * near;
        let eye =
            DVec3::new(random.range(-3.0, 3.0), random.range(0.3, 3.0), random.range(-3.0, 3.0));
        let angle = random.below(16) as f64 / 16.0 * std::f64::consts::TAU;
        let out = 0.75 + random.range(-0.1, 0.1);
        let lamp = DVec3::new(out * angle.cos(), random.range(-0.1, 0.1), out * angle.sin());
        let seen = Ray::new(eye, target - eye);
        let mut hits = [None];
        eyes.closest(&[seen], Coherence::Incoherent, &mut hits);
        let Some(hit) = hits[0] else { continue };
        let surface = Surface::new(&scene, &seen, &hit);
        let toward = lamp - surface.position;
        if surface.facing_normal().dot(toward) > 0.0 {
            rays.push(Ray {
                tmax: 1.0,
                departure: Some(Departure { id: hit.id, side: surface.side }),
                shadow: Some(ShadowEnds { viewer: -seen.direction }),
                ..Ray::new(surface.position, toward)
            });
        }
    }
    assert_all_occluded(&scene, &rays);
}

#[test]
fn shadow_rays_and_others_may_be_asked_for_together() {
    let mut scene = Scene::default();
    scene.add_material(Material::default());
    scene.spheres.push(Sphere::new(DVec3::Z * 5.0, 1.0, MaterialId(0)));
    let plain = Ray::segment(DVec3::ZERO, DVec3::Z * 9.0);
    let shadow = Ray { shadow: Some(ShadowEnds { viewer: DVec3::X }), ..plain };
    let away = Ray { direction: -plain.direction, ..plain };
    let rays = [plain, shadow, shadow, away, shadow];
    for (name, intersector) in certified(&scene) {
        let (mut occluded, mut hits) = ([false; 5], [None; 5]);
        intersector.occluded(&rays, Coherence::Coherent, &mut occluded);
        intersector.closest(&rays, Coherence::Coherent, &mut hits);
        assert_eq!(occluded, [true, true, true, false, true], "{name}");
        assert_eq!(hits.map(|hit| hit.is_some()), occluded, "{name}");
    }
}

/// Every intersector of precision `certified`, and the oracle.
fn certified(scene: &Scene) -> Vec<(&'static str, Box<dyn Intersector + '_>)> {
    let mut all = crate::order::intersectors(scene);
    #[cfg(feature = "measure")]
    all.push(("oracle", Box::new(envers::measure::oracle::Oracle::new(scene))));
    all
}

#[test]
fn rays_that_leave_a_floor_hit_flat_caps_from_any_distance_beyond_rounding() {
    for height in [1e-9, 1e-12] {
        let mut scene = Scene::default();
        scene.add_material(Material::default());
        let cap = scene.add_mesh(Mesh {
            positions: vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, height as f32, 0.0]].into(),
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        });
        scene.instances.push(Instance::new(cap, DAffine3::IDENTITY, MaterialId(0)));
        scene.planes.push(Plane::new(DVec3::Z * -1e-7, DVec3::Z, MaterialId(0)));
        for off in [1e-4, 1e-7, 1e-13] {
            scene.planes[0].point = DVec3::Z * -off;
            let ray = Ray {
                departure: Some(Departure { id: PrimitiveId::plane(0), side: Side::Front }),
                ..Ray::new(DVec3::new(0.0, 0.25 * f64::from(height as f32), -off), DVec3::Z)
            };
            for (name, intersector) in certified(&scene) {
                let mut hits: [Option<Hit>; 1] = [None];
                intersector.closest(&[ray], Coherence::Coherent, &mut hits);
                assert_eq!(hits[0].map(|hit| hit.t), Some(off), "{name} {height} {off}");
            }
        }
    }
}

#[test]
#[cfg(feature = "measure")]
fn shadow_rays_of_touching_surfaces_are_those_of_exact_arithmetic() {
    let mut random = Random(3);
    let mut blocked = 0;
    for round in 0..12 {
        // Balls, boxes and planes that touch at coordinates with few bits, and lamps on them.
        let mut scene = Scene::default();
        scene.add_material(Material::default());
        let grid = |random: &mut Random| random.below(9) as f64 / 2.0 - 2.0;
        let point = |random: &mut Random| DVec3::new(grid(random), grid(random), grid(random));
        for _ in 0..4 {
            let radius = (1 + random.below(4)) as f64 / 2.0;
            scene.spheres.push(Sphere::new(point(&mut random), radius, MaterialId(0)));
            let size = DVec3::splat((1 + random.below(4)) as f64 / 2.0);
            let turn = DQuat::from_axis_angle(DVec3::Y, if round % 2 == 0 { 0.0 } else { 0.3 });
            let at = point(&mut random);
            add_cube(&mut scene, DAffine3::from_scale_rotation_translation(size, turn, at));
        }
        scene.planes.push(Plane::new(point(&mut random), DVec3::Y, MaterialId(0)));
        let rays: Vec<Ray> = (0..300)
            .map(|_| {
                let (origin, target) = (point(&mut random) * 4.0, point(&mut random));
                Ray::new(origin, target - origin)
            })
            .filter(|ray| ray.direction != DVec3::ZERO)
            .collect();
        let all = certified(&scene);
        let mut hits = vec![None; rays.len()];
        all[0].1.closest(&rays, Coherence::Incoherent, &mut hits);
        let shadow: Vec<Ray> = rays
            .iter()
            .zip(&hits)
            .filter_map(|(ray, hit)| {
                let surface = Surface::new(&scene, ray, hit.as_ref()?);
                let light = Light::point(point(&mut random));
                Some(surface.shadow_ray(ray.direction, &light.incident(surface.position)?))
            })
            .collect();
        let answers: Vec<_> = all
            .iter()
            .map(|(name, intersector)| {
                let mut occluded = vec![false; shadow.len()];
                intersector.occluded(&shadow, Coherence::Coherent, &mut occluded);
                let mut closest = vec![None; shadow.len()];
                intersector.closest(&shadow, Coherence::Coherent, &mut closest);
                (*name, occluded, closest)
            })
            .collect();
        let (_, expected, closest) = answers.last().unwrap();
        blocked += closest.iter().flatten().filter(|hit| hit.t == f64::from_bits(1)).count();
        for (name, occluded, found) in &answers {
            for (i, ray) in shadow.iter().enumerate() {
                assert_eq!(occluded[i], expected[i], "{name}: {ray:?}");
                let place = |hit: &Option<Hit>| hit.map(|h| (h.t, h.id));
                assert_eq!(place(&found[i]), place(&closest[i]), "{name}: {ray:?}");
            }
        }
    }
    assert!(blocked > 10, "{blocked}");
}
