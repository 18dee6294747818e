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

use crate::geometry::{Bounds, Hit, PrimitiveId, Ray, sphere};
use crate::intersect::brute::is_extreme;
use crate::intersect::entry::Entry;
use crate::intersect::kept::{Kept, used};
use crate::intersect::primitive::Primitives;
use crate::intersect::{BruteForce, Coherence, Intersector, Precision};
use crate::scene::{Mesh, Scene, Sphere};
use build::build;
use tree::{Line, Tree};

/// The pure-Rust intersector.
pub struct Bvh<'s> {
    primitives: Primitives<'s>,
    spheres: Tree,
    instances: Tree,
    /// For each instance, the way into its mesh's space.
    entries: Vec<Entry>,
    meshes: Vec<Arc<MeshTree>>,
}

/// The tree over the triangles of a mesh, in its own space; empty for one that stands nowhere.
#[derive(Default)]
pub struct MeshTree(Tree);

impl<'s> Bvh<'s> {
    /// Builds the trees of a checked scene, on the current rayon pool.
    pub fn build(scene: &'s Scene, precision: Precision) -> Self {
        Self::build_sharing(scene, precision, None)
    }

    /// As [`Bvh::build`], with the trees of meshes that are there already.
    pub(super) fn build_sharing(
        scene: &'s Scene,
        precision: Precision,
        mut kept: Option<&mut Kept<MeshTree>>,
    ) -> Self {
        let there = |index, mesh| kept.as_ref().and_then(|kept| kept.get(index, mesh));
        let used = used(scene);
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
        let spheres: Vec<Bounds> = scene.spheres.iter().map(Sphere::bounds).collect();
        let placed: Vec<Bounds> = scene
            .instances
            .iter()
            .map(|i| {
                let bounds = meshes[i.mesh.0 as usize].0.bounds().transformed(&i.transform);
                // A baked vertex may round to just outside the transformed box.
                bounds.padded(16.0 * f64::EPSILON * bounds.max_abs())
            })
            .collect();
        let entries = scene.instances.iter().zip(&placed).map(|(i, b)| Entry::new(i, b)).collect();
        let (spheres, instances) = (build(&spheres), build(&placed));
        let primitives = Primitives { scene, precision };
        Self { primitives, spheres, instances, entries, meshes }
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
        self.instances.walk(&line, limit, |instance, limit| {
            let mesh = self.primitives.scene.instances[instance as usize].mesh.0;
            let entry = &self.entries[instance as usize];
            let (origin, direction) = entry.line(ray.origin, ray.direction);
            let local = Line::new(origin, direction, entry.error(ray.origin));
            self.meshes[mesh as usize].0.walk(&local, limit, |triangle, limit| {
                let id = PrimitiveId::triangle(mesh, triangle, instance);
                self.primitives.triangle(id, ray, *limit).is_some_and(|hit| visit(hit, limit))
            })
        });
    }
}

impl MeshTree {
    fn new(mesh: &Mesh) -> Self {
        let point = |i: u32| {
            let [x, y, z] = mesh.positions[i as usize];
            DVec3::new(f64::from(x), f64::from(y), f64::from(z))
        };
        let bounds: Vec<Bounds> =
            mesh.triangles.par_iter().map(|t| Bounds::of(t.map(point))).collect();
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
        assert_eq!(rays.len(), hits.len(), "one hit for each ray");
        for (ray, best) in rays.iter().zip(hits) {
            *best = None;
            let mut limit = ray.tmax;
            self.visit(ray, &mut limit, |hit, limit| {
                Hit::keep_first(best, hit);
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
