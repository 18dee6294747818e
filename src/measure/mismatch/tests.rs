use super::*;
use crate::scene::{Instance, MaterialId, Mesh, Sphere};
use glam::DAffine3;

fn scene() -> Scene {
    let mut scene = Scene::default();
    let positions = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]].into();
    let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let mesh = scene.add_mesh(mesh);
    for z in [0.0, 1e-7, 1.0] {
        let transform = DAffine3::from_translation(DVec3::Z * z);
        scene.instances.push(Instance::new(mesh, transform, MaterialId(0)));
    }
    scene
}

fn hit(ray: &Ray, scene: &Scene, instance: u32) -> Hit {
    let id = PrimitiveId::triangle(0, 0, instance);
    let t = triangle::EdgeFunctions::new(scene.triangle_vertices(id), ray.origin, ray.direction).t;
    Hit { t, u: 0.0, v: 0.0, id }
}

fn classify(x: f64, instances: [Option<u32>; 2]) -> Option<MismatchCause> {
    let scene = scene();
    let ray = Ray::new(DVec3::new(x, 0.3, 2.0), DVec3::NEG_Z);
    let [a, b] = instances.map(|i| i.map(|i| hit(&ray, &scene, i)));
    MismatchClassifier { scene: &scene, margin: 1e-6 }.classify_hits(&ray, a.as_ref(), b.as_ref())
}

#[test]
fn miss_beside_an_edge_is_explained() {
    assert_eq!(classify(-5e-7, [Some(0), None]), Some(MismatchCause::Edge));
}

#[test]
fn miss_in_the_middle_of_a_triangle_is_not_explained() {
    assert_eq!(classify(0.3, [Some(0), None]), None);
}

#[test]
fn close_surfaces_are_a_tie() {
    assert_eq!(classify(0.3, [Some(0), Some(1)]), Some(MismatchCause::Tie));
}

#[test]
fn far_surfaces_are_not_a_tie() {
    assert_eq!(classify(0.3, [Some(0), Some(2)]), None);
}

#[test]
fn clearly_blocked_shadow_ray_is_not_explained() {
    let scene = scene();
    let ray = Ray::segment(DVec3::new(0.3, 0.3, 2.0), DVec3::new(0.3, 0.3, -2.0));
    assert_eq!(
        MismatchClassifier { scene: &scene, margin: 1e-6 }.classify_occlusion(&ray, true),
        None
    );
}

#[test]
fn shadow_ray_beside_an_edge_is_explained() {
    let scene = scene();
    let ray = Ray::segment(DVec3::new(-5e-7, 0.3, 2.0), DVec3::new(-5e-7, 0.3, -2.0));
    let classifier = MismatchClassifier { scene: &scene, margin: 1e-6 };
    assert_eq!(classifier.classify_occlusion(&ray, false), Some(MismatchCause::Edge));
}

#[test]
fn shadow_ray_far_from_everything_is_not_explained() {
    let scene = scene();
    let ray = Ray::segment(DVec3::new(-0.5, 0.3, 2.0), DVec3::new(-0.5, 0.3, -2.0));
    assert_eq!(
        MismatchClassifier { scene: &scene, margin: 1e-6 }.classify_occlusion(&ray, false),
        None
    );
}

/// Returns a unit sphere at distance 10, and a ray that passes its centre at `distance`.
fn beside_a_sphere(distance: f64) -> (Scene, Ray) {
    let spheres = vec![Sphere::new(DVec3::Z * 10.0, 1.0, MaterialId(0))];
    let ray = Ray::new(DVec3::X * distance, DVec3::Z);
    (Scene { spheres, ..Scene::default() }, ray)
}

#[test]
fn miss_of_a_sphere_that_the_ray_touches_is_explained() {
    let classify = |distance: f64| {
        let (scene, ray) = beside_a_sphere(distance);
        let hit = Hit { t: 10.0, u: 0.0, v: 0.0, id: PrimitiveId::sphere(0) };
        MismatchClassifier { scene: &scene, margin: 1e-6 }.classify_hits(&ray, Some(&hit), None)
    };
    assert_eq!(classify(1.0 + 1e-14), Some(MismatchCause::Tangency));
    // Within the margin of the f32 rays: spheres are not found with those.
    assert_eq!(classify(1.0 - 1e-9), None);
}

#[test]
fn shadow_ray_that_touches_a_sphere_is_explained() {
    let (scene, ray) = beside_a_sphere(1.0 + 1e-14);
    let classifier = MismatchClassifier { scene: &scene, margin: 1e-6 };
    assert_eq!(classifier.classify_occlusion(&ray, false), Some(MismatchCause::Tangency));
}

#[test]
fn shadow_ray_through_a_sphere_is_not_explained() {
    let (scene, ray) = beside_a_sphere(0.5);
    assert_eq!(
        MismatchClassifier { scene: &scene, margin: 1e-6 }.classify_occlusion(&ray, true),
        None
    );
}

#[test]
fn shadow_ray_that_ends_on_a_sphere_is_explained() {
    let (scene, ray) = beside_a_sphere(0.0);
    let ray = Ray { tmax: 9.0, ..ray };
    assert_eq!(
        MismatchClassifier { scene: &scene, margin: 1e-6 }.classify_occlusion(&ray, false),
        Some(MismatchCause::Tie)
    );
}
