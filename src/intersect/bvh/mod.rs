//! The pure-Rust intersector: bounding-volume hierarchies in f64.
//!
//! One tree over the spheres, one over the instances, and one for each mesh in its own space. A
//! triangle is tested in world space, by the same function as everywhere, so that the tree only
//! decides which ones are tried.

mod build;
mod tree;

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::{Bounds, Hit, PrimitiveId, Ray, RayBatch, sphere};
use crate::intersect::blas_cache::{BlasCache, meshes_in_use};
use crate::intersect::brute_force::is_extreme;
use crate::intersect::frame_diff::FrameDiff;
use crate::intersect::object_space::ObjectSpace;
use crate::intersect::primitive::Primitives;
use crate::intersect::{BruteForce, Coherence, ExtraTests, Intersector, Precision};
use crate::scene::{Instance, Mesh, Scene, Sphere};
use build::build;
use tree::{Line, Tree};

/// The pure-Rust intersector.
pub struct Bvh<'s> {
    primitives: Primitives<'s>,
    spheres: Arc<Tree>,
    instances: Arc<Instances>,
    meshes: Vec<Arc<MeshTree>>,
}

/// Where the meshes stand.
#[derive(Default)]
struct Instances {
    tree: Tree,
    /// For each instance, the way into its mesh's space.
    entries: Vec<ObjectSpace>,
}

/// What frames share: the trees of the meshes, and those above them while nothing in these moves.
#[derive(Default)]
pub struct FrameCache {
    meshes: BlasCache<MeshTree>,
    spheres: Arc<Tree>,
    instances: Arc<Instances>,
    tops: u64,
}

impl FrameCache {
    /// How many meshes were built.
    pub fn built(&self) -> u64 {
        self.meshes.built()
    }

    /// How often a tree above them was built, or both.
    pub fn tops(&self) -> u64 {
        self.tops
    }
}

/// The tree over the triangles of a mesh, in its own space; empty for one that stands nowhere.
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

    /// As [`Bvh::build`], with the trees that are there already from a frame before, and what moved
    /// since, if all else is as it was.
    pub(super) fn build_sharing(
        scene: &'s Scene,
        precision: Precision,
        shared: &mut FrameCache,
        moved: Option<&FrameDiff>,
    ) -> Self {
        let primitives = Primitives { scene, precision };
        let meshes = mesh_trees(scene, Some(&mut shared.meshes));
        let (spheres_stay, instances_stay) =
            moved.map_or((false, false), |m| (m.spheres.is_empty(), m.instances.is_empty()));
        if !spheres_stay {
            shared.spheres = sphere_tree(scene).into();
        }
        if !instances_stay {
            shared.instances = Instances::new(scene, &meshes).into();
        }
        shared.tops += u64::from(!(spheres_stay && instances_stay));
        let (spheres, instances) = (shared.spheres.clone(), shared.instances.clone());
        Self { primitives, spheres, instances, meshes }
    }

    /// Calls `visit` with the hits on finite primitives that may be nearer than the limit that it
    /// keeps, until it returns true.
    fn visit(&self, ray: &Ray, limit: &mut f64, mut visit: impl FnMut(Hit, &mut f64) -> bool) {
        if is_extreme(ray.origin, ray.direction) {
            let brute = BruteForce::new(self.primitives.scene, self.primitives.precision);
            brute.all(ray).any(|hit| visit(hit, limit));
            return;
        }
        let inverse = sphere::inverse_length_squared(ray.direction);
        let line = Line::new(ray.origin, ray.direction, 0.0);
        let done = self.spheres.walk(&line, limit, |index, limit| {
            self.primitives.sphere(index, ray, inverse, *limit).is_some_and(|hit| visit(hit, limit))
        });
        if done {
            return;
        }
        self.instances.tree.walk(&line, limit, |instance, limit| {
            let mesh = self.primitives.scene.instances[instance as usize].mesh.0;
            let entry = &self.instances.entries[instance as usize];
            let (origin, direction) = entry.object_ray(ray.origin, ray.direction);
            let local = Line::new(origin, direction, entry.error(ray.origin));
            self.meshes[mesh as usize].0.walk(&local, limit, |triangle, limit| {
                let id = PrimitiveId::triangle(mesh, triangle, instance);
                self.primitives.triangle(id, ray, *limit).is_some_and(|hit| visit(hit, limit))
            })
        });
    }
}

/// The trees of the meshes that stand anywhere.
fn mesh_trees(scene: &Scene, mut kept: Option<&mut BlasCache<MeshTree>>) -> Vec<Arc<MeshTree>> {
    let there = |index, mesh| kept.as_ref().and_then(|kept| kept.get(index, mesh));
    let used = meshes_in_use(scene);
    let meshes: Vec<Arc<MeshTree>> = (scene.meshes.par_iter().enumerate())
        .map(|(i, mesh)| match used[i] {
            true => there(i, mesh).unwrap_or_else(|| MeshTree::new(mesh).into()),
            false => Arc::default(),
        })
        .collect();
    if let Some(kept) = &mut kept {
        for (i, (mesh, tree)) in scene.meshes.iter().zip(&meshes).enumerate() {
            if used[i] {
                kept.keep(i, mesh, tree);
            }
        }
    }
    meshes
}

fn sphere_tree(scene: &Scene) -> Tree {
    build(&scene.spheres.iter().map(Sphere::bounds).collect::<Vec<_>>())
}

impl Instances {
    fn new(scene: &Scene, meshes: &[Arc<MeshTree>]) -> Self {
        let placed = |i: &Instance| {
            let bounds = meshes[i.mesh.0 as usize].0.bounds().transformed(&i.transform);
            // A baked vertex may round to just outside the transformed box.
            bounds.padded(16.0 * f64::EPSILON * bounds.max_abs())
        };
        let placed: Vec<Bounds> = scene.instances.iter().map(placed).collect();
        let entries =
            scene.instances.iter().zip(&placed).map(|(i, b)| ObjectSpace::new(i, b)).collect();
        Self { tree: build(&placed), entries }
    }
}

impl MeshTree {
    fn new(mesh: &Mesh) -> Self {
        let point = |i: u32| {
            let [x, y, z] = mesh.positions[i as usize];
            DVec3::new(f64::from(x), f64::from(y), f64::from(z))
        };
        let bounds: Vec<Bounds> =
            mesh.triangles.par_iter().map(|t| Bounds::from_points(t.map(point))).collect();
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

    fn closest_extras(&self, _: &RayBatch) -> ExtraTests {
        ExtraTests { planes: !self.primitives.scene.planes.is_empty(), filters: false }
    }

    fn occluded_extras(&self) -> ExtraTests {
        ExtraTests { planes: !self.primitives.scene.planes.is_empty(), filters: false }
    }

    fn closest(&self, rays: &[Ray], _: Coherence, hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit for each ray");
        for (ray, best) in rays.iter().zip(hits) {
            *best = None;
            let mut limit = ray.tmax;
            self.visit(ray, &mut limit, |hit, limit| {
                Hit::keep_closest(best, hit);
                *limit = limit.min(hit.t);
                false
            });
            self.primitives.merge_planes(ray, best);
        }
    }

    fn occluded(&self, rays: &[Ray], _: Coherence, blocked: &mut [bool]) {
        assert_eq!(rays.len(), blocked.len(), "one answer for each ray");
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = self.primitives.planes_occlude(ray);
            if !*blocked {
                let mut limit = ray.tmax;
                self.visit(ray, &mut limit, |hit, _| {
                    *blocked = self.primitives.scene.blocks_light(hit.id);
                    *blocked
                });
            }
        }
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

    #[test]
    fn empty_scene_has_no_hits() {
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
