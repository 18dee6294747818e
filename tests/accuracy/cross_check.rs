//! The intersectors against each other: brute force, BVH and Embree.

use envers::{BruteForce, Bvh, Coherence, Hit, Intersector, Precision, Ray, Scene};
use glam::DVec3;
use rayon::prelude::*;

use crate::random_scenes::{random_rays, random_scene};

const SCENES: u64 = 20;
const RAYS: usize = 100_000;

fn closest(intersector: &dyn Intersector, rays: &[Ray]) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    rays.par_chunks(1024)
        .zip(hits.par_chunks_mut(1024))
        .for_each(|(rays, hits)| intersector.closest(rays, Coherence::Incoherent, hits));
    hits
}

fn occluded(intersector: &dyn Intersector, rays: &[Ray]) -> Vec<bool> {
    let mut blocked = vec![false; rays.len()];
    rays.par_chunks(1024)
        .zip(blocked.par_chunks_mut(1024))
        .for_each(|(rays, blocked)| intersector.occluded(rays, Coherence::Incoherent, blocked));
    blocked
}

/// The scenes and rays of one run: about the origin, and far from it.
fn each_scene(mut check: impl FnMut(u64, &Scene, &[Ray])) {
    for seed in 0..SCENES {
        let offset =
            [DVec3::ZERO, DVec3::new(1e3, -2e3, 5e2), DVec3::splat(1e6)][seed as usize % 3];
        let size = [1.0, 100.0, 1e-2][(seed / 3) as usize % 3];
        let scene = random_scene(seed, offset, size);
        check(seed, &scene, &random_rays(seed + 1000, offset, size, RAYS));
    }
}

#[test]
fn bvh_equals_brute_force_to_the_bit() {
    each_scene(|seed, scene, rays| {
        let (expected, found) = (
            closest(&BruteForce::new(scene, Precision::Fast), rays),
            closest(&Bvh::build(scene, Precision::Fast), rays),
        );
        let hits = expected.iter().flatten().count();
        assert!(hits > RAYS / 10, "scene {seed}: too few hits to compare, {hits}");
        for (i, (a, b)) in expected.iter().zip(&found).enumerate() {
            assert_eq!(a, b, "scene {seed}, ray {i}: {:?}", rays[i]);
        }
    });
}

#[test]
fn bvh_occlusion_equals_brute_force() {
    each_scene(|seed, scene, rays| {
        let rays: Vec<Ray> =
            rays[..RAYS / 4].iter().map(|r| Ray::segment(r.origin, r.position(0.7))).collect();
        let expected = occluded(&BruteForce::new(scene, Precision::Fast), &rays);
        assert!(expected.contains(&true) && expected.contains(&false), "scene {seed}: all alike");
        assert_eq!(expected, occluded(&Bvh::build(scene, Precision::Fast), &rays), "scene {seed}");
    });
}

#[cfg(all(feature = "embree", feature = "measure"))]
mod embree {
    use super::*;
    use envers::Embree;
    use envers::Geometry;
    use envers::measure::MismatchClassifier;

    /// Compares with brute force; returns how many rays differ for a reason that f32 explains.
    fn explained(seed: u64, scene: &Scene, embree: &Embree<'_>, rays: &[Ray]) -> usize {
        let classifier = MismatchClassifier { scene, margin: embree.margin() };
        let (expected, found) =
            (closest(&BruteForce::new(scene, Precision::Fast), rays), closest(embree, rays));
        let mut count = 0;
        for (i, (a, b)) in expected.iter().zip(&found).enumerate().filter(|(_, (a, b))| a != b) {
            let cause = classifier.classify_hits(&rays[i], a.as_ref(), b.as_ref());
            let same = a.zip(*b).is_some_and(|(a, b)| a.id == b.id);
            assert!(cause.is_some() && !same, "scene {seed}, ray {i}: {a:?}, Embree {b:?}");
            count += 1;
        }
        count
    }

    #[test]
    fn embree_packets_equal_brute_force_up_to_explained_mismatches() {
        each_scene(|seed, scene, rays| {
            let found =
                explained(seed, scene, &Embree::build(scene, Precision::Fast, 1).unwrap(), rays);
            assert!(found <= RAYS / 10_000, "scene {seed}: {found} explained mismatches");
        });
    }

    #[test]
    fn embree_single_rays_equal_brute_force_up_to_explained_mismatches() {
        each_scene(|seed, scene, rays| {
            let embree = Embree::build_single(scene, Precision::Fast, 1).unwrap();
            let found = explained(seed, scene, &embree, &rays[..RAYS / 4]);
            assert!(found <= RAYS / 40_000, "scene {seed}: {found} explained mismatches");
        });
    }

    #[test]
    fn embree_occlusion_equals_brute_force_up_to_explained_mismatches() {
        each_scene(|seed, scene, rays| {
            let embree = Embree::build(scene, Precision::Fast, 1).unwrap();
            let classifier = MismatchClassifier { scene, margin: embree.margin() };
            let rays: Vec<Ray> =
                rays[..RAYS / 4].iter().map(|r| Ray::segment(r.origin, r.position(0.7))).collect();
            let expected = occluded(&BruteForce::new(scene, Precision::Fast), &rays);
            let found = occluded(&embree, &rays);
            for (i, truth) in expected.iter().enumerate().filter(|(i, b)| found[*i] != **b) {
                let cause = classifier.classify_occlusion(&rays[i], *truth);
                assert!(cause.is_some(), "scene {seed}, ray {i}: blocked is {truth}");
            }
        });
    }

    #[test]
    fn embree_spheres_equal_brute_force_to_the_bit() {
        each_scene(|seed, scene, rays| {
            let mut spheres = scene.clone();
            spheres.instances.clear();
            let embree = Embree::build(&spheres, Precision::Fast, 1).unwrap();
            let (expected, found) = (
                closest(&BruteForce::new(&spheres, Precision::Fast), rays),
                closest(&embree, rays),
            );
            let hits = expected.iter().flatten().filter(|h| h.id.geometry == Geometry::Spheres);
            assert!(hits.count() > RAYS / 100, "scene {seed}: too few sphere hits");
            assert_eq!(expected, found, "scene {seed}");
        });
    }

    #[test]
    fn embree_occlusion_equals_brute_force_on_spheres_and_planes() {
        each_scene(|seed, scene, rays| {
            let mut spheres = scene.clone();
            spheres.instances.clear();
            let rays: Vec<Ray> =
                rays[..RAYS / 4].iter().map(|r| Ray::segment(r.origin, r.position(0.7))).collect();
            let expected = occluded(&BruteForce::new(&spheres, Precision::Fast), &rays);
            let embree = Embree::build(&spheres, Precision::Fast, 1).unwrap();
            assert_eq!(expected, occluded(&embree, &rays), "scene {seed}");
        });
    }
}
