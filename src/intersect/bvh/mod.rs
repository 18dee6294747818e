//! The pure-Rust intersector: bounding volume hierarchies in f64.
//!
//! There is one tree over the spheres, one over the instances, and one for each mesh in object space. A
//! triangle is tested in world space, by the same function as everywhere, so that the tree only
//! decides which ones are tested.

mod build;
mod tree;

use std::convert::Infallible;
use std::sync::Arc;

use rayon::prelude::*;

use crate::geometry::{Bounds, Hit, PrimitiveId, Ray, RayBatch};
use crate::intersect::blas_cache::{BlasCache, meshes_in_use};
use crate::intersect::brute_force::is_extreme;
use crate::intersect::build_stats::BuildStats;
use crate::intersect::frame_diff::FrameDiff;
use crate::intersect::object_space::{ObjectSpace, world_bounds};
use crate::intersect::order::NEAR_TIE;
use crate::intersect::primitive::{Primitives, RayTests};
use crate::intersect::{BruteForce, Coherence, Crossing, Intersector, Precision, trace_each};
use crate::scene::{Mesh, Scene, Sphere};
use build::build;
use tree::{TraversalRay, Tree};

/// The pure-Rust intersector.
pub struct Bvh<'s> {
    primitives: Primitives<'s>,
    spheres: Arc<Tree>,
    instances: Arc<Instances>,
    meshes: Vec<Arc<MeshTree>>,
}

/// The tree over the instances of meshes.
#[derive(Default)]
struct Instances {
    tree: Tree,
    object_spaces: Vec<ObjectSpace>,
}

/// The trees that frames share: those of the meshes, and those over spheres and over instances as
/// long as none of these move.
#[derive(Default)]
pub struct FrameCache {
    meshes: BlasCache<MeshTree>,
    spheres: Arc<Tree>,
    instances: Arc<Instances>,
    /// The number of frames for which a tree over spheres or instances was built.
    tlas_count: u64,
}

impl FrameCache {
    /// The numbers of BLASes and TLASes that were built.
    pub fn stats(&self) -> BuildStats {
        let meshes_built = self.meshes.built();
        BuildStats { meshes_built, tlas_built: self.tlas_count, ..BuildStats::default() }
    }
}

/// The tree over the triangles of a mesh, in object space; empty for a mesh without instances.
#[derive(Default)]
pub struct MeshTree(Tree);

impl<'s> Bvh<'s> {
    /// Builds the trees of a checked scene, on the current rayon pool.
    pub fn build(scene: &'s Scene, precision: Precision) -> Self {
        let primitives = Primitives { scene, precision };
        let meshes = mesh_trees(scene, None);
        let instances = Instances::new(scene, &meshes).into();
        Self { primitives, spheres: sphere_tree(scene).into(), instances, meshes }
    }

    /// Builds the trees of a frame, with those that the cache has from the frame before. `diff` is
    /// what has moved since then, or `None` if the scene is another one.
    pub(super) fn build_frame(
        scene: &'s Scene,
        precision: Precision,
        cache: &mut FrameCache,
        diff: Option<&FrameDiff>,
    ) -> Self {
        let primitives = Primitives { scene, precision };
        let meshes = mesh_trees(scene, Some(&mut cache.meshes));
        let spheres_moved = diff.is_none_or(|diff| !diff.spheres.is_empty());
        let instances_moved = diff.is_none_or(|diff| !diff.instances.is_empty());
        if spheres_moved {
            cache.spheres = sphere_tree(scene).into();
        }
        if instances_moved {
            cache.instances = Instances::new(scene, &meshes).into();
        }
        cache.tlas_count += u64::from(spheres_moved || instances_moved);
        let (spheres, instances) = (cache.spheres.clone(), cache.instances.clone());
        Self { primitives, spheres, instances, meshes }
    }

    /// Calls `visit` with the hits on finite primitives that may be closer than the limit, which `visit`
    /// may lower, until it returns true.
    fn visit(
        &self,
        tests: &RayTests<'_>,
        limit: &mut f64,
        mut visit: impl FnMut(Hit, &mut f64) -> bool,
    ) {
        let ray = tests.ray;
        if is_extreme(ray.origin, ray.direction) {
            let brute = BruteForce::new(self.primitives.scene, self.primitives.precision);
            brute.all_hits(ray).any(|hit| visit(hit, limit));
            return;
        }
        let world_ray = TraversalRay::new(ray.origin, ray.direction, 0.0);
        let done = self.spheres.traverse(&world_ray, limit, |index, limit| {
            tests.sphere(index, *limit).is_some_and(|hit| visit(hit, limit))
        });
        if done {
            return;
        }
        // A triangle may block a shadow ray at its origin from beside the ray's line.
        let beside = tests.corner_distance(self.instances.tree.bounds());
        let world_ray = TraversalRay::new(ray.origin, ray.direction, beside);
        self.instances.tree.traverse(&world_ray, limit, |instance, limit| {
            let mesh = self.primitives.scene.instances[instance as usize].mesh.0;
            let space = &self.instances.object_spaces[instance as usize];
            let (origin, direction) = space.object_ray(ray.origin, ray.direction);
            let error = space.error(ray.origin) + space.max_object_length(beside);
            let object_ray = TraversalRay::new(origin, direction, error);
            self.meshes[mesh as usize].0.traverse(&object_ray, limit, |triangle, limit| {
                let id = PrimitiveId::triangle(mesh, triangle, instance);
                tests.triangle(id, *limit).is_some_and(|hit| visit(hit, limit))
            })
        });
    }
}

/// Builds the trees of the meshes that have instances.
fn mesh_trees(scene: &Scene, cache: Option<&mut BlasCache<MeshTree>>) -> Vec<Arc<MeshTree>> {
    let build = |i: usize| Ok::<_, Infallible>(MeshTree::new(&scene.meshes[i]));
    let Ok(trees) = BlasCache::get_or_build(cache, scene, &meshes_in_use(scene), build);
    trees.into_iter().map(Option::unwrap_or_default).collect()
}

fn sphere_tree(scene: &Scene) -> Tree {
    build(&scene.spheres.iter().map(Sphere::bounds).collect::<Vec<_>>())
}

impl Instances {
    fn new(scene: &Scene, meshes: &[Arc<MeshTree>]) -> Self {
        let bounds: Vec<Bounds> = (scene.instances.iter())
            .map(|i| world_bounds(i, &meshes[i.mesh.0 as usize].0.bounds()))
            .collect();
        let object_spaces =
            scene.instances.iter().zip(&bounds).map(|(i, b)| ObjectSpace::new(i, b)).collect();
        Self { tree: build(&bounds), object_spaces }
    }
}

impl MeshTree {
    fn new(mesh: &Mesh) -> Self {
        let bounds: Vec<Bounds> =
            mesh.triangles.par_iter().map(|t| Bounds::from_points(mesh.corners(t))).collect();
        Self(build(&bounds))
    }
}

impl Intersector for Bvh<'_> {
    fn name(&self) -> &'static str {
        "rust"
    }

    fn version(&self) -> String {
        env!("CARGO_PKG_VERSION").to_owned()
    }

    fn closest(&self, rays: &[Ray], _: Coherence, hits: &mut [Option<Hit>]) {
        trace_each(rays, hits, |ray| {
            let tests = self.primitives.with_ray(ray);
            let (mut best, mut limit) = (None, ray.tmax);
            self.visit(&tests, &mut limit, |hit, limit| {
                tests.keep_closest(&mut best, hit);
                // What `fast` rounds up must be found, too, where faces coincide.
                *limit = limit.min(hit.t * (1.0 + NEAR_TIE));
                false
            });
            tests.merge_planes(&mut best);
            best
        });
    }

    fn occluded(&self, rays: &[Ray], _: Coherence, occluded: &mut [bool]) {
        trace_each(rays, occluded, |ray| {
            let tests = self.primitives.with_ray(ray);
            let mut occluded = tests.planes_occlude();
            if !occluded {
                self.visit(&tests, &mut { ray.tmax }, |hit, _| {
                    occluded = self.primitives.scene.blocks_light(hit.id);
                    occluded
                });
            }
            occluded
        });
    }

    fn occluded_with_crossings(
        &self,
        rays: &RayBatch,
        _: Coherence,
        occluded: &mut Vec<bool>,
        crossings: &mut Vec<Crossing>,
    ) -> bool {
        occluded.clear();
        crossings.clear();
        for (number, ray) in (0..).zip(rays.iter()) {
            let tests = self.primitives.with_ray(&ray);
            let is_active = ray.tmax > 0.0;
            let mut is_occluded = is_active && tests.planes_occlude();
            if is_active && !is_occluded {
                self.visit(&tests, &mut { ray.tmax }, |hit, _| {
                    is_occluded = self.primitives.scene.blocks_light(hit.id);
                    if !is_occluded {
                        crossings.push(Crossing { ray: number, id: hit.id });
                    }
                    is_occluded
                });
            }
            occluded.push(is_occluded);
        }
        true
    }

    fn hits_on(&self, ray: &Ray, ids: &[PrimitiveId]) -> Vec<Hit> {
        self.primitives.hits_in_order(ray, ids)
    }
}

impl std::fmt::Debug for Bvh<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let trees = self.meshes.len();
        f.debug_struct("Bvh").field("meshes", &trees).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Geometry;
    use crate::scene::MaterialId;
    use glam::DVec3;

    #[test]
    fn an_empty_scene_has_no_hits() {
        let scene = Scene::default();
        let mut hits = [None];
        let ray = [Ray::new(DVec3::ZERO, DVec3::X)];
        Bvh::build(&scene, Precision::Fast).closest(&ray, Coherence::Coherent, &mut hits);
        assert_eq!(hits, [None]);
    }

    #[test]
    fn equal_distances_go_to_the_lesser_primitive() {
        let spheres = vec![Sphere::new(DVec3::Z * 5.0, 1.0, MaterialId(0)); 9];
        let scene = Scene { spheres, ..Scene::default() };
        let mut hits = [None];
        let ray = [Ray::new(DVec3::ZERO, DVec3::Z)];
        Bvh::build(&scene, Precision::Fast).closest(&ray, Coherence::Coherent, &mut hits);
        let hit = hits[0].unwrap();
        assert_eq!((hit.id.geometry, hit.id.primitive), (Geometry::Spheres, 0));
    }
}
