//! Which body fills which place.

use super::*;
use crate::intersect::{BruteForce, Precision};
use crate::scene::{Material, Mesh, Plane, Sphere};
use glam::DAffine3;

fn glass(ior: f64, priority: i32) -> Material {
    Material { transmit: Vec3::ONE, ior, priority, ..Material::default() }
}

/// Water below y = 0, a glass ball across its surface, a bubble in the ball, an opaque ball.
fn pond(priority_of_water: i32) -> Scene {
    let mut scene = Scene::default();
    let water = scene.add_material(glass(1.33, priority_of_water));
    let ball = scene.add_material(glass(1.5, 0));
    let air = scene.add_material(glass(1.0, 0));
    let matt = scene.add_material(Material::default());
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, water));
    scene.spheres.push(Sphere::new(DVec3::ZERO, 2.0, ball));
    scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, air));
    scene.spheres.push(Sphere::new(DVec3::X * 9.0, 1.0, matt));
    scene
}

fn ior_at(scene: &Scene, point: DVec3) -> f64 {
    let bodies = NestedDielectrics::of(scene);
    let intersector = BruteForce::new(scene, Precision::Fast);
    bodies.medium(&bodies.holding(point, scene, &intersector)).ior
}

#[test]
fn the_smaller_of_two_bodies_fills_where_both_are() {
    let scene = pond(0);
    let at = |x, y| ior_at(&scene, DVec3::new(x, y, 0.0));
    assert_eq!([at(0.0, 9.0), at(0.0, -9.0)], [1.0, 1.33]);
    assert_eq!([at(0.0, 1.5), at(0.0, -1.5), at(0.0, -0.5)], [1.5, 1.5, 1.0]);
}

#[test]
fn a_greater_priority_goes_before_size() {
    let scene = pond(1);
    let at = |x, y| ior_at(&scene, DVec3::new(x, y, 0.0));
    assert_eq!([at(0.0, -1.5), at(0.0, -0.5), at(0.0, 1.5)], [1.33, 1.33, 1.5]);
}

#[test]
fn a_surface_within_a_body_that_goes_before_it_is_hidden() {
    let scene = pond(0);
    let bodies = NestedDielectrics::of(&scene);
    let ball = bodies.around(PrimitiveId::sphere(0), Side::Front, &InteriorList::default());
    assert!(!ball.is_hidden);
    let water = bodies.around(PrimitiveId::plane(0), Side::Front, &ball.behind);
    assert!(water.is_hidden);
    let out = bodies.around(PrimitiveId::sphere(0), Side::Back, &water.behind);
    assert!(!out.is_hidden);
    assert_eq!([&out.before, &out.behind].map(|i| bodies.medium(i).ior), [1.5, 1.33]);
}

#[test]
fn what_is_no_body_changes_nothing() {
    let scene = pond(0);
    let bodies = NestedDielectrics::of(&scene);
    let inside = InteriorList::default().with(1);
    let around = bodies.around(PrimitiveId::sphere(2), Side::Front, &inside);
    assert_eq!((&around.before, &around.behind), (&inside, &inside));
    assert!(!around.is_hidden);
}

#[test]
fn a_ray_out_of_a_body_that_it_never_entered_was_in_it() {
    let scene = pond(0);
    let bodies = NestedDielectrics::of(&scene);
    let around = bodies.around(PrimitiveId::sphere(0), Side::Back, &InteriorList::default());
    assert_eq!([&around.before, &around.behind].map(|i| bodies.medium(i).ior), [1.5, 1.0]);
}

/// A corner of a cube, of glass.
fn corner(transform: DAffine3) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(glass(1.5, 0));
    let mesh = scene.add_mesh(Mesh {
        positions: vec![[0., 0., 0.], [4., 0., 0.], [0., 4., 0.], [0., 0., 4.]],
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        ..Mesh::default()
    });
    scene.instances.push(Instance::new(mesh, transform, material));
    scene
}

#[test]
fn eye_within_a_closed_mesh_is_in_it_and_eye_beside_it_is_not() {
    let scene = corner(DAffine3::IDENTITY);
    assert_eq!(ior_at(&scene, DVec3::splat(0.5)), 1.5);
    assert_eq!(ior_at(&scene, DVec3::splat(-0.5)), 1.0);
    assert_eq!(ior_at(&scene, DVec3::splat(3.0)), 1.0);
}

/// What a ray into the corner at (½, ½, ½) finds behind the first surface that it meets.
fn ior_behind(scene: &Scene, origin: DVec3) -> f64 {
    let bodies = NestedDielectrics::of(scene);
    let intersector = BruteForce::new(scene, Precision::Fast);
    let ray = Ray::new(origin, DVec3::splat(0.5) - origin);
    let mut hit = [None];
    intersector.closest(&[ray], Coherence::Incoherent, &mut hit);
    let hit = hit[0].expect("the ray meets the corner");
    let side = Surface::new(scene, &ray, &hit).side;
    bodies.medium(&bodies.around(hit.id, side, &InteriorList::default()).behind).ior
}

#[test]
fn a_mirrored_mesh_is_the_same_body() {
    let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let scene = corner(DAffine3::from_translation(DVec3::X) * mirror);
    assert_eq!([ior_at(&scene, DVec3::splat(0.5)), ior_at(&scene, DVec3::splat(-1.0))], [1.5, 1.0]);
    assert_eq!(ior_behind(&scene, DVec3::new(0.5, -9.0, 0.5)), 1.5);
}

#[test]
fn a_mesh_that_winds_inward_is_the_same_body() {
    let mut scene = corner(DAffine3::IDENTITY);
    let mesh = std::sync::Arc::make_mut(&mut scene.meshes[0]);
    mesh.triangles.iter_mut().for_each(|triangle| triangle.reverse());
    assert_eq!([ior_at(&scene, DVec3::splat(0.5)), ior_at(&scene, DVec3::splat(-1.0))], [1.5, 1.0]);
    assert_eq!(ior_behind(&scene, DVec3::new(0.5, -9.0, 0.5)), 1.5);
}
