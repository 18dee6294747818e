//! A ray that goes straight through surfaces meets each of them once, in order, whoever finds them.

use envers::{
    Backend, BruteForce, Bvh, Coherence, Departure, Geometry, Hit, Intersector, Material,
    MaterialId, Plane, Precision, Ray, Scene, Side, Sphere, Surface,
};
use glam::DVec3;

use crate::random_scenes::{random_rays, random_scene};

fn empty() -> Scene {
    let mut scene = Scene::default();
    scene.add_material(Material::default());
    scene
}

/// Returns all hits on each ray's way, in order.
pub fn crossings(scene: &Scene, intersector: &dyn Intersector, rays: &[Ray]) -> Vec<Vec<Hit>> {
    let mut all = vec![Vec::new(); rays.len()];
    let mut open: Vec<usize> = (0..rays.len()).collect();
    let mut ahead = rays.to_vec();
    while !open.is_empty() {
        let mut hits = vec![None; ahead.len()];
        intersector.closest(&ahead, Coherence::Incoherent, &mut hits);
        let (mut still, mut next) = (Vec::new(), Vec::new());
        for ((&i, ray), hit) in open.iter().zip(&ahead).zip(&hits) {
            let Some(hit) = hit else { continue };
            all[i].push(*hit);
            assert!(all[i].len() < 1000, "{ray:?} does not end");
            let side = Surface::new(scene, ray, hit).side;
            still.push(i);
            next.push(ray.continue_past(hit, side.opposite()));
        }
        (open, ahead) = (still, next);
    }
    all
}

fn same(a: &[Vec<Hit>], b: &[Vec<Hit>], rays: &[Ray]) {
    for ((a, b), ray) in a.iter().zip(b).zip(rays) {
        assert_eq!(a, b, "{ray:?}");
    }
}

#[test]
fn brute_force_bvh_and_embree_find_the_same_in_the_same_order() {
    for seed in 0..4 {
        let (offset, size) = (DVec3::splat(10f64.powi(seed)), 1.0);
        let scene = random_scene(seed as u64, offset, size);
        let mut rays = random_rays(9, offset, size, 1500);
        rays.iter_mut().step_by(3).for_each(|ray| ray.tmax = 1.0);
        let brute = BruteForce::new(&scene, Precision::Certified);
        let expected = crossings(&scene, &brute, &rays);
        let bvh = Bvh::build(&scene, Precision::Certified);
        same(&crossings(&scene, &bvh, &rays), &expected, &rays);
        let default = Backend::default().build(&scene, Precision::Certified, 1).unwrap();
        same(&crossings(&scene, &*default, &rays), &expected, &rays);
        let found: usize = expected.iter().map(Vec::len).sum();
        assert!(found > rays.len(), "{found}");
    }
}

#[test]
#[cfg(feature = "measure")]
fn exact_arithmetic_finds_the_same_in_the_same_order() {
    let scene = random_scene(5, DVec3::ZERO, 1.0);
    let rays = random_rays(3, DVec3::ZERO, 1.0, 300);
    let bvh = crossings(&scene, &Bvh::build(&scene, Precision::Certified), &rays);
    let oracle = envers::measure::oracle::Oracle::new(&scene);
    let place = |all: Vec<Vec<Hit>>| -> Vec<Vec<_>> {
        all.into_iter().map(|hits| hits.into_iter().map(|h| (h.t, h.id)).collect()).collect()
    };
    assert_eq!(place(bvh), place(crossings(&scene, &oracle, &rays)));
}

#[test]
fn in_fast_spheres_and_planes_are_all_crossed_on_either_backend() {
    let mut scene = random_scene(2, DVec3::ZERO, 1.0);
    (scene.instances, scene.meshes) = Default::default();
    let rays = random_rays(4, DVec3::ZERO, 1.0, 1500);
    let bvh = crossings(&scene, &Bvh::build(&scene, Precision::Fast), &rays);
    let default = Backend::default().build(&scene, Precision::Fast, 1).unwrap();
    same(&crossings(&scene, &*default, &rays), &bvh, &rays);
}

#[test]
fn occlusion_asks_only_about_what_lies_ahead() {
    let mut scene = empty();
    scene.spheres.push(Sphere::new(DVec3::Z * 5.0, 1.0, MaterialId(0)));
    for precision in [Precision::Fast, Precision::Certified] {
        for backend in [Backend::Rust, Backend::default()] {
            let intersector = backend.build(&scene, precision, 1).unwrap();
            let blocked = |t: f64, side: Side| {
                let hit = Hit { t, u: 0.0, v: 0.0, id: envers::PrimitiveId::sphere(0) };
                let ray = Ray::new(DVec3::ZERO, DVec3::Z).continue_past(&hit, side);
                let mut blocked = [false];
                intersector.occluded(&[ray], Coherence::Incoherent, &mut blocked);
                blocked[0]
            };
            assert_eq!([blocked(4.0, Side::Back), blocked(6.0, Side::Front)], [true, false]);
        }
    }
}

#[test]
fn surfaces_at_the_same_distance_are_each_met_once() {
    let mut scene = empty();
    scene.planes = vec![Plane::new(DVec3::Z * 3.0, DVec3::NEG_Z, MaterialId(0)); 3];
    scene.spheres = vec![Sphere::new(DVec3::Z * 4.0, 1.0, MaterialId(0)); 2];
    let ray = [Ray::new(DVec3::ZERO, DVec3::Z)];
    let default = Backend::default().build(&scene, Precision::Certified, 1).unwrap();
    let found = crossings(&scene, &*default, &ray);
    let order: Vec<_> = found[0].iter().map(|h| (h.t, h.id.geometry, h.id.primitive)).collect();
    use Geometry::{Planes, Spheres};
    let expected = [
        (3.0, Spheres, 0),
        (3.0, Spheres, 1),
        (3.0, Planes, 0),
        (3.0, Planes, 1),
        (3.0, Planes, 2),
        (5.0, Spheres, 0),
        (5.0, Spheres, 1),
    ];
    assert_eq!(order, expected);
}

#[test]
fn a_ray_that_touches_a_sphere_goes_in_and_out_once() {
    let mut scene = empty();
    let far = DVec3::splat(1e9);
    scene.spheres.push(Sphere::new(far + DVec3::Y, 1.0, MaterialId(0)));
    let ray = [Ray::new(far - DVec3::Z * 3.0, DVec3::Z)];
    for precision in [Precision::Fast, Precision::Certified] {
        for backend in [Backend::Rust, Backend::default()] {
            let intersector = backend.build(&scene, precision, 1).unwrap();
            let found = crossings(&scene, &*intersector, &ray);
            assert_eq!(found[0].iter().map(|h| h.t).collect::<Vec<_>>(), [3.0, 3.0]);
        }
    }
}

#[test]
fn a_ray_that_left_a_surface_does_not_meet_it_after_it_went_through_another() {
    let mut scene = empty();
    scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, MaterialId(0)));
    scene.spheres.push(Sphere::new(DVec3::Z * 4.0, 1.0, MaterialId(0)));
    let id = envers::PrimitiveId::sphere(0);
    let from = Some(Departure { id, side: Side::Front });
    let ray = [Ray { departure: from, ..Ray::new(DVec3::Z, DVec3::Z) }];
    let default = Backend::default().build(&scene, Precision::Certified, 1).unwrap();
    let found = crossings(&scene, &*default, &ray);
    assert_eq!(found[0].iter().map(|h| h.t).collect::<Vec<_>>(), [2.0, 4.0]);
}
