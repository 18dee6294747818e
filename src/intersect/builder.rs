//! Intersectors for one picture, or for the frames of an animation, which share what was built of
//! their meshes.

use crate::error::Result;
#[cfg(feature = "embree")]
use crate::intersect::embree::{self, Embree};
use crate::intersect::kept::{Kept, used};
use crate::intersect::{Backend, BuildQuality, Bvh, Intersector, Precision, bvh};
use crate::scene::Scene;

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
    quality: BuildQuality,
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
        let (quality, built) = (BuildQuality::default(), Built::default());
        Self { backend, precision, threads, quality, shared: None, built }
    }

    /// A builder for scenes that share meshes, each of which is built once: in a space of its own,
    /// in which it may stand still or move. What is built anew is the level above, of spheres and
    /// instances.
    pub fn for_frames(backend: Backend, precision: Precision, threads: usize) -> Self {
        Self { shared: Some(Shared::default()), ..Self::new(backend, precision, threads) }
    }

    /// The same with trees of another quality than medium. The pure-Rust BVH has only one.
    pub fn with_quality(self, quality: BuildQuality) -> Self {
        Self { quality, ..self }
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
                let quality = self.quality;
                Box::new(Embree::build_sharing(scene, precision, threads, quality, shared)?)
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

    /// How good its trees are; nothing where Embree does not build them.
    pub fn quality(&self) -> Option<BuildQuality> {
        (self.backend != Backend::Rust).then_some(self.quality)
    }

    /// What all intersectors so far took.
    pub fn built(&self) -> Built {
        self.built
    }
}

impl Shared {
    /// How many meshes were built.
    fn built(&self) -> u64 {
        let trees = self.trees.built();
        #[cfg(feature = "embree")]
        return trees + self.embree.built();
        #[cfg(not(feature = "embree"))]
        trees
    }
}

impl std::fmt::Debug for Builder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Builder").field("built", &self.built).finish_non_exhaustive()
    }
}
