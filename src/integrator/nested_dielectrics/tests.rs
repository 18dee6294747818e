//! Tests of which dielectric fills which point.

use super::*;
use crate::intersect::{BruteForce, Precision};
use crate::scene::{Material, Mesh, Plane, Sphere};
use glam::DAffine3;

fn glass(ior: f64, priority: i32) -> Material {
    Material { transmit: Vec3::ONE, ior, priority, ..Material::default() }
}

/// Returns a scene of water below y = 0, a glass ball across its surface, a bubble in the ball, and an
/// opaque ball.
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
    let dielectrics = NestedDielectrics::new(scene);
    let intersector = BruteForce::new(scene, Precision::Fast);
    dielectrics.medium(&dielectrics.interior_at(point, scene, &intersector)).ior()
}

#[test]
fn the_smaller_of_two_dielectrics_fills_their_overlap() {
    let scene = pond(0);
    let at = |x, y| ior_at(&scene, DVec3::new(x, y, 0.0));
    assert_eq!([at(0.0, 9.0), at(0.0, -9.0)], [1.0, 1.33]);
    assert_eq!([at(0.0, 1.5), at(0.0, -1.5), at(0.0, -0.5)], [1.5, 1.5, 1.0]);
}

#[test]
fn priority_goes_before_size() {
    let scene = pond(1);
    let at = |x, y| ior_at(&scene, DVec3::new(x, y, 0.0));
    assert_eq!([at(0.0, -1.5), at(0.0, -0.5), at(0.0, 1.5)], [1.33, 1.33, 1.5]);
}

#[test]
fn a_surface_within_a_dielectric_of_higher_priority_is_hidden() {
    let scene = pond(0);
    let dielectrics = NestedDielectrics::new(&scene);
    let ball = dielectrics.interface(PrimitiveId::sphere(0), Side::Front, &InteriorList::default());
    assert!(!ball.is_hidden);
    let water = dielectrics.interface(PrimitiveId::plane(0), Side::Front, &ball.transmitted);
    assert!(water.is_hidden);
    let out = dielectrics.interface(PrimitiveId::sphere(0), Side::Back, &water.transmitted);
    assert!(!out.is_hidden);
    assert_eq!([&out.incident, &out.transmitted].map(|i| dielectrics.medium(i).ior()), [1.5, 1.33]);
}

#[test]
fn an_opaque_object_changes_no_interior_list() {
    let scene = pond(0);
    let dielectrics = NestedDielectrics::new(&scene);
    let interior = InteriorList::default().inserted(1);
    let media = dielectrics.interface(PrimitiveId::sphere(2), Side::Front, &interior);
    assert_eq!((&media.incident, &media.transmitted), (&interior, &interior));
    assert!(!media.is_hidden);
}

#[test]
fn a_ray_out_of_a_dielectric_that_it_never_entered_was_in_it() {
    let scene = pond(0);
    let dielectrics = NestedDielectrics::new(&scene);
    let media = dielectrics.interface(PrimitiveId::sphere(0), Side::Back, &InteriorList::default());
    assert_eq!(
        [&media.incident, &media.transmitted].map(|i| dielectrics.medium(i).ior()),
        [1.5, 1.0]
    );
}

/// Returns a glass tetrahedron, the corner of a cube.
fn corner(transform: DAffine3) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material(glass(1.5, 0));
    let mesh = scene.add_mesh(Mesh {
        positions: vec![[0., 0., 0.], [4., 0., 0.], [0., 4., 0.], [0., 0., 4.]].into(),
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        ..Mesh::default()
    });
    scene.instances.push(Instance::new(mesh, transform, material));
    scene
}

#[test]
fn a_point_within_a_closed_mesh_is_in_it_and_one_beside_it_is_not() {
    let scene = corner(DAffine3::IDENTITY);
    assert_eq!(ior_at(&scene, DVec3::splat(0.5)), 1.5);
    assert_eq!(ior_at(&scene, DVec3::splat(-0.5)), 1.0);
    assert_eq!(ior_at(&scene, DVec3::splat(3.0)), 1.0);
}

/// Returns the index of refraction behind the first surface that a ray to (½, ½, ½) hits.
fn ior_behind(scene: &Scene, origin: DVec3) -> f64 {
    let dielectrics = NestedDielectrics::new(scene);
    let intersector = BruteForce::new(scene, Precision::Fast);
    let ray = Ray::new(origin, DVec3::splat(0.5) - origin);
    let mut hit = [None];
    intersector.closest(&[ray], Coherence::Incoherent, &mut hit);
    let hit = hit[0].expect("the ray hits the corner");
    let side = Surface::new(scene, &ray, &hit).side;
    dielectrics
        .medium(&dielectrics.interface(hit.id, side, &InteriorList::default()).transmitted)
        .ior()
}

#[test]
fn a_mirrored_mesh_is_the_same_dielectric() {
    let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let scene = corner(DAffine3::from_translation(DVec3::X) * mirror);
    assert_eq!([ior_at(&scene, DVec3::splat(0.5)), ior_at(&scene, DVec3::splat(-1.0))], [1.5, 1.0]);
    assert_eq!(ior_behind(&scene, DVec3::new(0.5, -9.0, 0.5)), 1.5);
}

#[test]
fn a_mesh_that_winds_inward_is_the_same_dielectric() {
    let mut scene = corner(DAffine3::IDENTITY);
    let mesh = std::sync::Arc::make_mut(&mut scene.meshes[0]);
    mesh.triangles.iter_mut().for_each(|triangle| triangle.reverse());
    assert_eq!([ior_at(&scene, DVec3::splat(0.5)), ior_at(&scene, DVec3::splat(-1.0))], [1.5, 1.0]);
    assert_eq!(ior_behind(&scene, DVec3::new(0.5, -9.0, 0.5)), 1.5);
}
