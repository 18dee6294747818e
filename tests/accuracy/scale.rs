//! One scene at every scale: the hits are the same ones, at distances that have the same scale.

use envers::{
    Bvh, Coherence, Hit, Instance, Intersector, Material, Mesh, Precision, Ray, Scene, Sphere,
};
use glam::{DAffine3, DVec3};

use crate::random_scenes::{ball, random_rays};

/// The powers of two that scale meshes, up to coordinates of 5e14 and down to those of 2e-15.
const POWERS: [i32; 9] = [-48, -44, -40, -20, 0, 20, 40, 44, 48];

/// A ball that is alone, two balls of one mesh and two spheres, at a scale. The numbers of the meshes
/// themselves have the scale 2^`mesh_power`, and their transforms what is left.
fn balls(power: i32, mesh_power: i32) -> Scene {
    let scale = f64::from(power).exp2();
    let mut scene = Scene::default();
    let material = scene.add_material(Material::default());
    let mesh = |level: u32| -> Mesh {
        let mut mesh = ball(level);
        let factor = f64::from(mesh_power).exp2();
        mesh.positions = mesh.positions.map(|_, p| p * factor);
        mesh
    };
    let (alone, twice) = (mesh(3), mesh(2));
    let (alone, twice) = (scene.add_mesh(alone), scene.add_mesh(twice));
    let shrink = DAffine3::from_scale(DVec3::splat(f64::from(power - mesh_power).exp2()));
    for (mesh, place) in [(alone, -1.5), (twice, 0.5), (twice, 2.5)] {
        let transform = DAffine3::from_translation(DVec3::new(place, 0.25, 0.0) * scale) * shrink;
        scene.instances.push(Instance::new(mesh, transform, material));
    }
    for y in [-1.5, 1.5] {
        scene.spheres.push(Sphere::new(DVec3::Y * y * scale, 0.5 * scale, material));
    }
    scene.check().unwrap();
    scene
}

/// The hits of rays from about the scene, with the distances divided by the scale.
fn hits(intersector: &dyn Intersector, power: i32) -> Vec<Option<Hit>> {
    let scale = f64::from(power).exp2();
    let rays: Vec<Ray> = random_rays(11, DVec3::ZERO, 2.5, 4000)
        .into_iter()
        .map(|ray| Ray::new(ray.origin * scale, ray.direction))
        .collect();
    let mut hits = vec![None; rays.len()];
    intersector.closest(&rays, Coherence::Incoherent, &mut hits);
    hits.iter_mut().flatten().for_each(|hit| hit.t /= scale);
    hits
}

/// True if the primitives and the distances are equal, and the weights to a few ulp of 1, as all that is
/// promised of these.
fn are_equal(found: &[Option<Hit>], expected: &[Option<Hit>]) -> bool {
    let is_equal = |(a, b): (&Option<Hit>, &Option<Hit>)| match (a, b) {
        (Some(a), Some(b)) => {
            (a.id, a.t) == (b.id, b.t) && (a.u - b.u).abs().max((a.v - b.v).abs()) < 1e-14
        }
        _ => a.is_none() && b.is_none(),
    };
    found.iter().zip(expected).all(is_equal)
}

/// Compares the hits at the scales `(power, mesh_power)` with those at scale 1.
fn check(precision: Precision, scales: &[(i32, i32)]) {
    let scene = balls(0, 0);
    let expected = hits(&Bvh::build(&scene, precision), 0);
    assert!(expected.iter().flatten().count() > 1000);
    #[cfg(feature = "embree")]
    let on_embree = hits(&envers::Embree::build(&scene, precision, 1).unwrap(), 0);
    for &(power, mesh_power) in scales {
        let scene = balls(power, mesh_power);
        let found = hits(&Bvh::build(&scene, precision), power);
        assert!(are_equal(&found, &expected), "2^{power}, meshes at 2^{mesh_power}: BVH");
        #[cfg(feature = "embree")]
        {
            let found = hits(&envers::Embree::build(&scene, precision, 1).unwrap(), power);
            assert!(are_equal(&found, &on_embree), "2^{power}, meshes at 2^{mesh_power}: Embree");
        }
    }
}

#[test]
fn fast_hits_the_same_at_every_scale() {
    check(Precision::Fast, &POWERS.map(|power| (power, power)));
}

#[test]
fn fast_hits_the_same_where_transforms_scale_the_meshes() {
    check(Precision::Fast, &[(48, 0), (-48, 0), (0, 48), (0, -48), (48, -48), (-48, 48)]);
}

#[test]
fn certified_hits_the_same_at_every_scale() {
    check(Precision::Certified, &POWERS.map(|power| (power, power)));
    check(Precision::Certified, &[(-300, 0), (-200, -100), (48, 0), (0, 60), (0, -60)]);
}
