//! Intersectors for one picture, or for the frames of an animation, which share what was built of
//! their meshes.

use crate::error::Result;
use crate::geometry::Bounds;
use crate::intersect::blas_cache::meshes_in_use;
#[cfg(feature = "embree")]
use crate::intersect::embree::{self, Embree};
use crate::intersect::frame_diff::PreviousFrame;
use crate::intersect::{Backend, BuildQuality, Bvh, Intersector, Precision, bvh};
use crate::scene::{MeshId, Scene};

/// What building took, and what was kept of a frame before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BuildStats {
    /// Meshes whose trees were built.
    pub meshes: u64,
    /// Meshes that were there already, from another frame.
    pub reused: u64,
    /// Times that the level above the meshes was built: the spheres, and where each mesh stands.
    pub tops: u64,
    /// Times that it was kept, with what moved in it placed again.
    pub tops_kept: u64,
    /// Instances of meshes that were placed in a level that was built.
    pub placed: u64,
    /// Instances that were placed again in one that was kept.
    pub moved: u64,
    /// Spheres that were placed again in a level that was kept.
    pub spheres_moved: u64,
    /// Times that a level that was built has spheres in it: in Embree a user geometry, in Rust a
    /// tree.
    pub sphere_sets: u64,
    /// Instances in a level that was built whose meshes are in spaces of their own.
    pub instanced: u64,
    /// Instances in a level that was built whose alpha is tested.
    pub masked: u64,
}

impl BuildStats {
    /// Each count, of this and another.
    fn with(self, other: Self, each: impl Fn(u64, u64) -> u64) -> Self {
        Self {
            meshes: each(self.meshes, other.meshes),
            reused: each(self.reused, other.reused),
            tops: each(self.tops, other.tops),
            tops_kept: each(self.tops_kept, other.tops_kept),
            placed: each(self.placed, other.placed),
            moved: each(self.moved, other.moved),
            spheres_moved: each(self.spheres_moved, other.spheres_moved),
            sphere_sets: each(self.sphere_sets, other.sphere_sets),
            instanced: each(self.instanced, other.instanced),
            masked: each(self.masked, other.masked),
        }
    }

    /// What a frame takes for which nothing is built that there is already: so many meshes.
    pub fn kept(meshes: u64) -> Self {
        Self { reused: meshes, tops_kept: 1, ..Self::default() }
    }
}

impl std::ops::AddAssign for BuildStats {
    fn add_assign(&mut self, other: Self) {
        *self = self.with(other, |a, b| a + b);
    }
}

impl std::ops::Sub for BuildStats {
    type Output = Self;

    /// What was built since there was only `before`.
    fn sub(self, before: Self) -> Self {
        self.with(before, |a, b| a - b)
    }
}

/// Builds intersectors of checked scenes.
pub struct IntersectorBuilder {
    backend: Backend,
    precision: Precision,
    threads: usize,
    quality: BuildQuality,
    /// What frames share; nothing for one picture.
    shared: Option<FrameCache>,
    built: BuildStats,
}

/// What frames share, for whichever backend it was built.
struct FrameCache {
    standing: PreviousFrame,
    trees: bvh::FrameCache,
    #[cfg(feature = "embree")]
    embree: embree::FrameCache,
}

impl IntersectorBuilder {
    /// A builder for pictures that have nothing in common, on `threads` threads (0: all there are).
    pub fn new(backend: Backend, precision: Precision, threads: usize) -> Self {
        Self {
            backend,
            precision,
            threads,
            quality: BuildQuality::default(),
            shared: None,
            built: BuildStats::default(),
        }
    }

    /// A builder for scenes that share meshes, each of which is built once: in a space of its own,
    /// in which it may stand still or move. The level above, of spheres and instances, is kept for
    /// the next scene, too, if that is of the same things, and the intersector of the one before
    /// is gone by then.
    ///
    /// `stage` is the box in which they mostly take place, such as [`Scene::bounds_over_time`]:
    /// scenes that stay in it, and fill it, share the space of Embree's f32 numbers. An empty box is
    /// right, too.
    pub fn for_frames(
        backend: Backend,
        precision: Precision,
        threads: usize,
        stage: Bounds,
    ) -> Self {
        // The BVH is in f64.
        let _ = stage;
        let shared = FrameCache {
            standing: PreviousFrame::default(),
            trees: bvh::FrameCache::default(),
            #[cfg(feature = "embree")]
            embree: embree::FrameCache::new(stage),
        };
        Self { shared: Some(shared), ..Self::new(backend, precision, threads) }
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
        let is_there = |mesh: MeshId| !scene.meshes[mesh.0 as usize].triangles.is_empty();
        let stand = scene.instances.iter().filter(|i| is_there(i.mesh)).count() as u64;
        let used = meshes_in_use(scene).into_iter().filter(|&used| used).count() as u64;
        let before = self.shared.as_ref().map_or(BuildStats::default(), FrameCache::built);
        let shared = self.shared.as_mut();
        let (intersector, moved, work): (Box<dyn Intersector + 's>, _, _) = match self.backend {
            #[cfg(feature = "embree")]
            Backend::Embree => {
                let asked = embree::BuildOptions {
                    precision: self.precision,
                    threads: self.threads,
                    quality: self.quality,
                    width: None,
                };
                let (built, moved) = match shared {
                    None => (Embree::build_as(scene, asked)?, None),
                    Some(shared) => {
                        let moved = shared.standing.advance(scene);
                        let (boxes, kept) = (shared.standing.boxes(), &mut shared.embree);
                        (Embree::build_sharing(scene, asked, boxes, kept, moved.as_ref())?, moved)
                    }
                };
                let work = built.work();
                (Box::new(built), moved, work)
            }
            Backend::Rust => {
                // The BVH is built on the caller's rayon pool, and always has all its levels.
                let _ = self.threads;
                let (built, moved) = match shared {
                    None => (Bvh::build(scene, self.precision), None),
                    Some(shared) => {
                        let moved = shared.standing.advance(scene);
                        let trees = &mut shared.trees;
                        (Bvh::build_sharing(scene, self.precision, trees, moved.as_ref()), moved)
                    }
                };
                (Box::new(built), moved, (u64::from(!scene.spheres.is_empty()), stand))
            }
        };
        let built = match &self.shared {
            None => BuildStats { meshes: used, tops: 1, ..BuildStats::default() },
            Some(shared) => shared.built() - before,
        };
        let moved = moved.unwrap_or_default();
        let (sphere_sets, instanced) = work;
        let masked =
            (0..scene.instances.len() as u32).filter(|&i| scene.is_masked(i)).count() as u64;
        self.built += match built.tops {
            0 => BuildStats {
                tops_kept: 1,
                moved: moved.instances.len() as u64,
                spheres_moved: moved.spheres.len() as u64,
                ..built
            },
            _ => BuildStats { placed: stand, sphere_sets, instanced, masked, ..built },
        };
        self.built.reused += used.saturating_sub(built.meshes);
        Ok(intersector)
    }

    /// How good its trees are; nothing where Embree does not build them.
    pub fn quality(&self) -> Option<BuildQuality> {
        (self.backend != Backend::Rust).then_some(self.quality)
    }

    /// What all intersectors so far took.
    pub fn stats(&self) -> BuildStats {
        self.built
    }
}

impl FrameCache {
    /// How many meshes, and levels above them, were built.
    fn built(&self) -> BuildStats {
        let (meshes, tops) = (self.trees.built(), self.trees.tops());
        #[cfg(feature = "embree")]
        let (meshes, tops) = (meshes + self.embree.built(), tops + self.embree.tops());
        BuildStats { meshes, tops, ..BuildStats::default() }
    }
}

impl std::fmt::Debug for IntersectorBuilder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Builder").field("built", &self.built).finish_non_exhaustive()
    }
}
