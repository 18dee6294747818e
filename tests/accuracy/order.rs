//! Surfaces whose distances round to the same float are hit in the order of their exact distances, by
//! every intersector; only truly equal distances go to the lowest id.

use envers::{
    Backend, BruteForce, Bvh, Camera, Coherence, Geometry, Hit, Instance, Intersector, Material,
    MaterialId, Mesh, Plane, Precision, Projection, Ray, Renderer, Scene, Sphere,
};
use envers_testing::Random;
use glam::{DAffine3, DVec3, Vec3};

use crate::continuation::crossings;

/// A scene of thin layers around the unit sphere: shells, planes and walls of triangles whose gaps are
/// a few ulp, in random order, all facing −x.
fn layers(random: &mut Random) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let gap = |random: &mut Random| {
        f64::EPSILON * random.below(4) as f64 * 8f64.powi(random.below(6) as i32)
    };
    for _ in 0..4 {
        let radius = 1.0 + gap(random);
        scene.spheres.push(Sphere::new(DVec3::ZERO, radius, material));
        let point = DVec3::X * (-1.0 - gap(random));
        scene.planes.push(Plane::new(point, DVec3::NEG_X, material));
        let wall = scene.add_mesh(Mesh {
            positions: vec![[0.0, -2.0, -2.0], [0.0, 2.0, -2.0], [0.0, 2.0, 2.0], [0.0, -2.0, 2.0]]
                .into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        });
        let transform = DAffine3::from_translation(DVec3::X * (-1.0 - gap(random)));
        scene.instances.push(Instance::new(wall, transform, material));
    }
    scene
}

/// Every intersector of precision `certified`, by name.
pub fn intersectors(scene: &Scene) -> Vec<(&'static str, Box<dyn Intersector + '_>)> {
    vec![
        ("brute force", Box::new(BruteForce::new(scene, Precision::Certified))),
        ("BVH", Box::new(Bvh::build(scene, Precision::Certified))),
        ("default", Backend::default().build(scene, Precision::Certified, 1).unwrap()),
    ]
}

#[test]
#[cfg(feature = "measure")]
fn thin_layers_are_crossed_in_their_exact_order_from_any_distance() {
    let mut random = Random(7);
    let place = |hits: &[Hit]| hits.iter().map(|h| (h.t, h.id)).collect::<Vec<_>>();
    let mut ties = 0;
    for exponent in 0..16 {
        for _ in 0..6 {
            let scene = layers(&mut random);
            let distance = 10f64.powi(exponent) * random.range(2.0, 5.0);
            let rays: Vec<Ray> = (0..20)
                .map(|i| {
                    let origin = DVec3::new(-distance, random.range(-0.1, 0.1), 0.0);
                    let direction =
                        if i < 10 { DVec3::X } else { DVec3::Y * random.range(-0.1, 0.1) - origin };
                    Ray::new(origin, direction * 10f64.powi(random.below(7) as i32 - 3))
                })
                .collect();
            let expected = crossings(&scene, &envers::measure::oracle::Oracle::new(&scene), &rays);
            for hits in &expected {
                ties += hits
                    .windows(2)
                    .filter(|pair| pair[0].t == pair[1].t && pair[0].id > pair[1].id)
                    .count();
            }
            for (name, intersector) in intersectors(&scene) {
                for ((found, expected), ray) in
                    crossings(&scene, &*intersector, &rays).iter().zip(&expected).zip(&rays)
                {
                    assert_eq!(place(found), place(expected), "{name}: {ray:?}");
                }
            }
        }
    }
    // The test would say nothing if the ids alone gave the order.
    assert!(ties > 5_000, "{ties}");
}

/// The picture of concentric balls, from the outermost in, by a camera far along z.
fn picture(scene: &mut Scene, radii: &[f64], distance: f64, backend: Backend) -> Vec<[f32; 3]> {
    scene.spheres = (0..)
        .zip(radii)
        .map(|(i, &r)| Sphere::new(DVec3::ZERO, r, MaterialId(i % scene.materials.len() as u32)))
        .collect();
    let projection = Projection::OrthoHeight(2.2);
    scene.cameras =
        vec![Camera::look_at(DVec3::Z * distance, DVec3::ZERO, DVec3::Y, projection).unwrap()];
    scene.film.background = Vec3::ONE;
    scene.film.max_depth = 64;
    let renderer = Renderer::new(scene).size([24, 24]).backend(backend);
    renderer.precision(Precision::Certified).render().unwrap().film.pixels
}

#[test]
fn a_shell_hides_the_ball_within_it_from_any_distance() {
    let glow = |emission: Vec3| Material { emission, ..Material::matte(Vec3::ZERO) };
    let mut scene = Scene::default();
    for (hidden, shell) in [(0, 1), (1, 0)] {
        scene.materials = vec![glow(Vec3::X), glow(Vec3::Y)];
        let mut radii = [1.0; 2];
        radii[shell] = 1.00000005;
        for backend in [Backend::Rust, Backend::default()] {
            let pixels = picture(&mut scene, &radii, 1e9, backend);
            assert!(pixels.iter().all(|pixel| pixel[hidden] == 0.0 || *pixel == [1.0; 3]));
            assert!(
                pixels.iter().filter(|pixel| pixel[shell] == 1.0 && pixel[2] == 0.0).count() > 300
            );
        }
    }
}

#[test]
fn clear_shells_let_through_what_their_number_says_from_any_distance() {
    let clear = Material { transmit: Vec3::splat(0.5), ior: 1.0, ..Material::matte(Vec3::ZERO) };
    for distance in [4.0, 1e6, 1e9] {
        for is_outer_first in [false, true] {
            let mut radii: Vec<f64> = (0..6).map(|k| 1.0 + f64::from(k) * 1e-11).collect();
            if is_outer_first {
                radii.reverse();
            }
            for backend in [Backend::Rust, Backend::default()] {
                let mut scene = Scene::default();
                scene.add_material(clear.clone());
                let pixels = picture(&mut scene, &radii, distance, backend);
                let seen: Vec<f32> =
                    pixels.iter().map(|pixel| pixel[0]).filter(|&x| x < 1.0).collect();
                assert!(seen.len() > 300);
                assert!(seen.iter().all(|&x| x == 0.5f32.powi(12)), "{distance}: {seen:?}");
            }
        }
    }
}

/// Two slanted squares in one plane of x and z, with other diagonals, and that plane itself, if `plane`.
fn coinciding_faces(plane: bool) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    if plane {
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::new(1.0, 0.0, -1.0), material));
    }
    for triangles in [[[0, 1, 2], [0, 2, 3]], [[3, 1, 0], [2, 1, 3]]] {
        let positions = vec![[-1., -1., -1.], [-1., 1., -1.], [1., 1., 1.], [1., -1., 1.]].into();
        let mesh = Mesh { positions, triangles: triangles.to_vec(), ..Mesh::default() };
        let mesh = scene.add_mesh(mesh);
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
    }
    scene
}

/// Rays from all around to points of the squares.
fn rays_to_faces() -> Vec<Ray> {
    let mut random = Random(3);
    (0..20_000)
        .map(|_| {
            let (origin, at) = (random.cube(5.0), random.cube(0.99));
            Ray::new(origin, DVec3::new(at.x, at.y, at.x) - origin)
        })
        .collect()
}

/// The shapes that rays hit, and how many miss.
fn shapes(intersector: &dyn Intersector, rays: &[Ray]) -> (Vec<Option<Geometry>>, usize) {
    let mut hits = vec![None; rays.len()];
    intersector.closest(rays, Coherence::Incoherent, &mut hits);
    let misses = hits.iter().filter(|hit| hit.is_none()).count();
    (hits.into_iter().map(|hit| hit.map(|hit| hit.id.geometry)).collect(), misses)
}

#[test]
fn fast_shows_of_faces_that_coincide_the_one_that_certified_shows() {
    let rays = rays_to_faces();
    for plane in [false, true] {
        let scene = coinciding_faces(plane);
        let (expected, misses) = shapes(&Bvh::build(&scene, Precision::Certified), &rays);
        assert_eq!(misses, 0);
        let found = shapes(&Bvh::build(&scene, Precision::Fast), &rays).0;
        assert!(found == expected, "BVH, with a plane: {plane}");
        // Which of two triangles Embree finds, f32 decides.
        #[cfg(feature = "embree")]
        if plane {
            let embree = envers::Embree::build(&scene, Precision::Fast, 1).unwrap();
            assert!(shapes(&embree, &rays).0 == expected, "Embree");
        }
    }
}
