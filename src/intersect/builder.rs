//! Intersectors for one picture, or for the frames of an animation, which share what was built of
//! their meshes.

use std::sync::Arc;

use crate::error::Result;
#[cfg(feature = "embree")]
use crate::intersect::embree::{self, Embree};
use crate::intersect::{Backend, Bvh, Intersector, Precision, bvh};
use crate::scene::{Mesh, Scene};

/// How many meshes building took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Built {
    /// Meshes whose trees were built.
    pub meshes: u64,
    /// Meshes that were there already, from another frame.
    pub reused: u64,
}

impl std::ops::AddAssign for Built {
    fn add_assign(&mut self, other: Self) {
        self.meshes += other.meshes;
        self.reused += other.reused;
    }
}

impl std::ops::Sub for Built {
    type Output = Self;

    /// What was built since there was only `before`.
    fn sub(self, before: Self) -> Self {
        Self { meshes: self.meshes - before.meshes, reused: self.reused - before.reused }
    }
}

/// Builds intersectors of checked scenes.
pub struct Builder {
    backend: Backend,
    precision: Precision,
    threads: usize,
    /// What frames share; nothing for one picture.
    shared: Option<Shared>,
    built: Built,
}

/// What was built of meshes, for whichever backend it was.
#[derive(Default)]
struct Shared {
    trees: Kept<bvh::MeshTree>,
    #[cfg(feature = "embree")]
    embree: embree::Shared,
}

impl Builder {
    /// A builder for pictures that have nothing in common, on `threads` threads (0: all there are).
    pub fn new(backend: Backend, precision: Precision, threads: usize) -> Self {
        Self { backend, precision, threads, shared: None, built: Built::default() }
    }

    /// A builder for scenes that share meshes, each of which is built once: in a space of its own,
    /// in which it may stand still or move. What is built anew is the level above, of spheres and
    /// instances.
    pub fn for_frames(backend: Backend, precision: Precision, threads: usize) -> Self {
        Self { shared: Some(Shared::default()), ..Self::new(backend, precision, threads) }
    }

    /// Builds the intersector of a checked scene.
    ///
    /// # Errors
    /// When Embree cannot be started or runs out of memory.
    pub fn build<'s>(&mut self, scene: &'s Scene) -> Result<Box<dyn Intersector + 's>> {
        let used = used(scene).into_iter().filter(|&used| used).count() as u64;
        let before = self.shared.as_ref().map_or(0, |shared| shared.built());
        let (precision, threads) = (self.precision, self.threads);
        let shared = self.shared.as_mut();
        let intersector: Box<dyn Intersector + 's> = match self.backend {
            #[cfg(feature = "embree")]
            Backend::Embree => {
                let shared = shared.map(|shared| &mut shared.embree);
                Box::new(Embree::build_sharing(scene, precision, threads, shared)?)
            }
            Backend::Rust => {
                // The BVH is built on the caller's rayon pool.
                let _ = threads;
                Box::new(Bvh::build_sharing(scene, precision, shared.map(|s| &mut s.trees)))
            }
        };
        let after = self.shared.as_ref().map_or(used, |shared| shared.built());
        let meshes = after - before;
        self.built += Built { meshes, reused: used.saturating_sub(meshes) };
        Ok(intersector)
    }

    /// What all intersectors so far took.
    pub fn built(&self) -> Built {
        self.built
    }
}

impl Shared {
    /// How many meshes were built.
    fn built(&self) -> u64 {
        let trees = self.trees.built;
        #[cfg(feature = "embree")]
        return trees + self.embree.built();
        #[cfg(not(feature = "embree"))]
        trees
    }
}

/// What was built of meshes, by their index; the mesh itself is kept with it, to tell it from
/// another one in its place.
pub(in crate::intersect) struct Kept<T> {
    of: Vec<Option<(Arc<Mesh>, Arc<T>)>>,
    built: u64,
}

impl<T> Default for Kept<T> {
    fn default() -> Self {
        Self { of: Vec::new(), built: 0 }
    }
}

impl<T> Kept<T> {
    /// What was built of a mesh, if it was.
    pub fn get(&self, index: usize, mesh: &Arc<Mesh>) -> Option<Arc<T>> {
        let (of, built) = self.of.get(index)?.as_ref()?;
        Arc::ptr_eq(of, mesh).then(|| built.clone())
    }

    /// Keeps what was built of a mesh, unless it is what is kept already.
    pub fn keep(&mut self, index: usize, mesh: &Arc<Mesh>, built: &Arc<T>) {
        if self.of.len() <= index {
            self.of.resize_with(index + 1, || None);
        }
        if !matches!(&self.of[index], Some((_, kept)) if Arc::ptr_eq(kept, built)) {
            self.of[index] = Some((mesh.clone(), built.clone()));
            self.built += 1;
        }
    }

    /// What was built of a mesh, or else what `make` builds, and then is kept where there is a
    /// place for it.
    ///
    /// # Errors
    /// Those of `make`.
    #[cfg(feature = "embree")]
    pub fn get_or(
        kept: &mut Option<&mut Self>,
        index: usize,
        mesh: &Arc<Mesh>,
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Arc<T>> {
        if let Some(there) = kept.as_ref().and_then(|kept| kept.get(index, mesh)) {
            return Ok(there);
        }
        let made = Arc::new(make()?);
        if let Some(kept) = kept {
            kept.keep(index, mesh, &made);
        }
        Ok(made)
    }

    /// Counts a mesh that was built and cannot be kept.
    #[cfg(feature = "embree")]
    pub fn count_one(&mut self) {
        self.built += 1;
    }

    /// How many were built.
    pub fn built(&self) -> u64 {
        self.built
    }
}

/// Whether each mesh stands anywhere, with any triangles.
pub(in crate::intersect) fn used(scene: &Scene) -> Vec<bool> {
    let mut used = vec![false; scene.meshes.len()];
    for instance in &scene.instances {
        let mesh = instance.mesh.0 as usize;
        used[mesh] = !scene.meshes[mesh].triangles.is_empty();
    }
    used
}

impl std::fmt::Debug for Builder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Builder").field("built", &self.built).finish_non_exhaustive()
    }
}
