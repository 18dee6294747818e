use super::*;
use crate::geometry::{Continuation, Departure, PrimitiveId, Side};
use crate::intersect::BuildQuality;
use crate::intersect::Bvh;
use crate::scene::{Instance, MaterialId, Mesh, Sphere};
use glam::{DAffine3, DVec3};

/// Numbers in [-1, 1) from a linear congruence (Knuth's MMIX constants).
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Spheres, a mesh with one instance and a mesh with two.
fn scene(state: &mut u64) -> Scene {
    let mut scene = Scene::default();
    let mut point = || DVec3::new(random(state), random(state), random(state));
    for _ in 0..40 {
        scene.spheres.push(Sphere::new(point() * 2.0, 0.15, MaterialId(0)));
    }
    for uses in [1, 2] {
        let positions = (0..60).map(|_| point().as_vec3().to_array()).collect();
        let triangles = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = scene.add_mesh(Mesh { positions, triangles, ..Mesh::default() });
        for _ in 0..uses {
            let transform = DAffine3::from_translation(point());
            scene.instances.push(Instance::new(mesh, transform, MaterialId(0)));
        }
    }
    scene
}

/// Rays of which a third leaves a sphere and a third a triangle, and a fourth has gone through a
/// sphere; not a multiple of any width.
fn rays(state: &mut u64) -> Vec<Ray> {
    (0..4003)
        .map(|i| {
            let mut point = || DVec3::new(random(state), random(state), random(state)) * 3.0;
            let (origin, target) = (point(), point());
            let id = match i % 3 {
                0 => None,
                1 => Some(PrimitiveId::sphere(i % 40)),
                _ => Some(PrimitiveId::triangle(0, i % 20, 0)),
            };
            let side = if i % 2 == 0 { Side::Front } else { Side::Back };
            let from = id.map(|id| Departure { id, side });
            let past = (i % 4 == 1).then(|| {
                let id = PrimitiveId::sphere(i % 40);
                Continuation { t: 0.3, crossed: Departure { id, side } }
            });
            Ray {
                departure: from,
                continuation: past,
                tmax: if i % 5 == 0 { 1.0 } else { f64::INFINITY },
                ..Ray::new(origin, target - origin)
            }
        })
        .collect()
}

fn check_width(width: PacketWidth) {
    compare(width, Precision::Fast, BuildQuality::Medium);
    compare(width, Precision::Certified, BuildQuality::Medium);
}

fn compare(width: PacketWidth, precision: Precision, quality: BuildQuality) {
    let mut state = 7;
    let scene = scene(&mut state);
    let rays = rays(&mut state);
    let options = BuildOptions { precision, threads: 1, quality, width: Some(width) };
    let embree = Embree::with_options(&scene, options).unwrap();
    let bvh = Bvh::build(&scene, precision);
    let closest = |i: &dyn Intersector| {
        let mut hits = vec![None; rays.len()];
        i.closest(&rays, Coherence::Incoherent, &mut hits);
        hits
    };
    assert_eq!(closest(&embree), closest(&bvh));
    let occluded = |i: &dyn Intersector| {
        let mut blocked = vec![false; rays.len()];
        i.occluded(&rays, Coherence::Coherent, &mut blocked);
        blocked
    };
    assert_eq!(occluded(&embree), occluded(&bvh));
}

#[test]
fn single_rays_equal_the_bvh() {
    check_width(PacketWidth::One);
}

#[test]
fn packets_of_four_equal_the_bvh() {
    check_width(PacketWidth::Four);
}

#[test]
#[cfg(target_arch = "x86_64")]
fn packets_of_eight_equal_the_bvh() {
    if PacketWidth::Eight.is_supported() {
        check_width(PacketWidth::Eight);
    }
}

#[test]
#[cfg(target_arch = "x86_64")]
fn packets_of_sixteen_equal_the_bvh() {
    if PacketWidth::Sixteen.is_supported() {
        check_width(PacketWidth::Sixteen);
    }
}

#[test]
fn trees_of_low_quality_equal_the_bvh() {
    compare(PacketWidth::One, Precision::Fast, BuildQuality::Low);
    compare(PacketWidth::One, Precision::Certified, BuildQuality::Low);
}

/// The hits of rays on `scene`, and the number of times that primitives were tested without a tree.
fn closest_and_count(intersector: &dyn Intersector, rays: &[Ray]) -> (Vec<Option<Hit>>, u32) {
    packet::BRUTE_FORCED.set(0);
    let mut hits = vec![None; rays.len()];
    intersector.closest(rays, Coherence::Coherent, &mut hits);
    let mut occluded = vec![false; rays.len()];
    intersector.occluded(rays, Coherence::Coherent, &mut occluded);
    assert_eq!(occluded, hits.iter().map(Option::is_some).collect::<Vec<_>>());
    (hits, packet::BRUTE_FORCED.get())
}

/// Rays toward points within 2 of the origin, from `distance` away, some of them with an end.
fn rays_from_afar(distance: f64) -> Vec<Ray> {
    let mut state = 3;
    (0..2003)
        .map(|i| {
            let mut point =
                || DVec3::new(random(&mut state), random(&mut state), random(&mut state));
            let (from, target) = (point().normalize() * distance, point() * 2.0);
            let tmax = if i % 3 == 0 { 2.0 } else { f64::INFINITY };
            Ray { tmax, ..Ray::new(from, target - from) }
        })
        .collect()
}

#[test]
fn rays_from_any_distance_are_traced_and_equal_the_bvh() {
    let scene = scene(&mut 7);
    for distance in [1e9, 1e12, 1e15] {
        let rays = rays_from_afar(distance);
        let embree = Embree::build(&scene, Precision::Certified, 1).unwrap();
        let (hits, brute_forced) = closest_and_count(&embree, &rays);
        assert_eq!(hits, closest_and_count(&Bvh::build(&scene, Precision::Certified), &rays).0);
        assert!(hits.iter().flatten().count() > 300, "too few hits from {distance:e}");
        assert_eq!(brute_forced, 0, "from {distance:e}");
    }
}

#[test]
fn fast_traces_rays_from_any_distance() {
    let scene = scene(&mut 7);
    for distance in [1e9, 1e12, 1e15] {
        let rays = rays_from_afar(distance);
        let certified = Bvh::build(&scene, Precision::Certified);
        let expected = closest_and_count(&certified, &rays).0.into_iter().flatten().count();
        let embree = Embree::build(&scene, Precision::Fast, 1).unwrap();
        packet::BRUTE_FORCED.set(0);
        let mut hits = vec![None; rays.len()];
        embree.closest(&rays, Coherence::Coherent, &mut hits);
        let found = hits.into_iter().flatten().count();
        // From 1e15 away the f64 of `fast` has lost the spheres; there only the work is counted.
        let is_lost = distance >= 1e15;
        assert!(is_lost || found.abs_diff(expected) <= 10, "{found} {expected} from {distance:e}");
        assert_eq!(packet::BRUTE_FORCED.get(), 0, "from {distance:e}");
    }
}

#[test]
fn a_tiny_mesh_far_away_is_traced_in_its_own_space() {
    let mut state = 7;
    let mut scene = scene(&mut state);
    let tiny = DAffine3::from_scale(DVec3::splat(1e-7));
    scene.instances.truncate(2);
    scene.instances[1].transform = tiny;
    let rays: Vec<Ray> = rays_from_afar(20.0)
        .into_iter()
        .map(|ray| {
            let target = ray.position(1.0);
            Ray::new(ray.origin, tiny.transform_point3(target) - ray.origin)
        })
        .collect();
    let embree = Embree::build(&scene, Precision::Certified, 1).unwrap();
    let (hits, brute_forced) = closest_and_count(&embree, &rays);
    assert_eq!(hits, closest_and_count(&Bvh::build(&scene, Precision::Certified), &rays).0);
    assert!(hits.iter().flatten().any(|hit| hit.id.instance == 1 && hit.u > 0.0));
    assert_eq!(brute_forced, 0);
}
