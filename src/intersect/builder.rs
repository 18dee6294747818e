//! The builder of intersectors, for one picture or for the frames of an animation, which share the trees
//! of their meshes.

#[cfg(feature = "embree")]
use crate::error::Remedy;
use crate::error::Result;
use crate::geometry::Bounds;
use crate::intersect::blas_cache::meshes_in_use;
use crate::intersect::build_stats::BuildStats;
#[cfg(feature = "embree")]
use crate::intersect::embree::{self, Embree};
use crate::intersect::frame_diff::{FrameDiff, PreviousFrame};
use crate::intersect::{Backend, BuildQuality, Bvh, Intersector, Precision, bvh};
use crate::scene::Scene;

/// The builder of intersectors of checked scenes.
pub struct IntersectorBuilder {
    backend: Backend,
    precision: Precision,
    threads: usize,
    quality: BuildQuality,
    /// The trees that frames share; none for single pictures.
    cache: Option<FrameCache>,
    stats: BuildStats,
}

/// The trees that frames share, for either backend.
struct FrameCache {
    previous: PreviousFrame,
    bvh: bvh::FrameCache,
    #[cfg(feature = "embree")]
    embree: embree::FrameCache,
}

impl FrameCache {
    /// The numbers of meshes and TLASes that were built.
    fn stats(&self, backend: Backend) -> BuildStats {
        match backend {
            #[cfg(feature = "embree")]
            Backend::Embree => self.embree.stats(),
            Backend::Rust => self.bvh.stats(),
        }
    }
}

impl IntersectorBuilder {
    /// Makes a builder for pictures that have nothing in common, on `threads` threads (0: all there
    /// are).
    pub fn new(backend: Backend, precision: Precision, threads: usize) -> Self {
        Self {
            backend,
            precision,
            threads,
            quality: BuildQuality::default(),
            cache: None,
            stats: BuildStats::default(),
        }
    }

    /// Makes a builder for scenes that share meshes, each of which is built once, in object space,
    /// whether it moves or not. The TLAS is reused for the next scene, too, if that has the same
    /// objects, and the intersector of the scene before has been dropped.
    ///
    /// `animation_bounds` is the box in which they mostly lie, such as [`Scene::bounds_over_time`]:
    /// scenes that stay in it, and fill it, share the space of Embree's f32 numbers. An empty box is
    /// right, too.
    pub fn for_frames(
        backend: Backend,
        precision: Precision,
        threads: usize,
        animation_bounds: Bounds,
    ) -> Self {
        // The BVH is in f64.
        let _ = animation_bounds;
        let cache = FrameCache {
            previous: PreviousFrame::default(),
            bvh: bvh::FrameCache::default(),
            #[cfg(feature = "embree")]
            embree: embree::FrameCache::new(animation_bounds),
        };
        Self { cache: Some(cache), ..Self::new(backend, precision, threads) }
    }

    /// Sets the quality of the trees, which is medium unless it is set. The pure-Rust BVH has only one.
    pub fn with_quality(self, quality: BuildQuality) -> Self {
        Self { quality, ..self }
    }

    /// Builds the intersector of a checked scene.
    ///
    /// # Errors
    /// When Embree cannot be started or runs out of memory.
    pub fn build<'s>(&mut self, scene: &'s Scene) -> Result<Box<dyn Intersector + 's>> {
        let before = self.cache.as_ref().map(|cache| cache.stats(self.backend)).unwrap_or_default();
        // See what moved since the frame before, if it was of the same things.
        let diff = self.cache.as_mut().and_then(|cache| cache.previous.advance(scene));
        // Build, or update, the intersector.
        let (intersector, contents): (Box<dyn Intersector + 's>, _) = match self.backend {
            #[cfg(feature = "embree")]
            Backend::Embree => {
                let embree = self.build_embree(scene, diff.as_ref());
                let embree = embree.map_err(|e| e.remedied_by(Remedy::RustBackend))?;
                let contents = embree.stats();
                (Box::new(embree), contents)
            }
            Backend::Rust => {
                let contents = BuildStats {
                    sphere_geometries: u64::from(!scene.spheres.is_empty()),
                    object_space_instances: visible_instances(scene),
                    ..BuildStats::default()
                };
                (Box::new(self.build_bvh(scene, diff.as_ref())), contents)
            }
        };
        // Count what that took.
        let built = match &self.cache {
            None => {
                BuildStats { meshes_built: used_meshes(scene), tlas_built: 1, ..Default::default() }
            }
            Some(cache) => cache.stats(self.backend) - before,
        };
        self.count(scene, built, contents, &diff.unwrap_or_default());
        Ok(intersector)
    }

    #[cfg(feature = "embree")]
    fn build_embree<'s>(
        &mut self,
        scene: &'s Scene,
        diff: Option<&FrameDiff>,
    ) -> Result<Embree<'s>> {
        let options = embree::BuildOptions {
            precision: self.precision,
            threads: self.threads,
            quality: self.quality,
            width: None,
        };
        match &mut self.cache {
            None => Embree::with_options(scene, options),
            Some(FrameCache { previous, embree, .. }) => {
                Embree::build_frame(scene, options, previous.mesh_bounds(), embree, diff)
            }
        }
    }

    /// Builds a BVH, on the caller's rayon pool.
    fn build_bvh<'s>(&mut self, scene: &'s Scene, diff: Option<&FrameDiff>) -> Bvh<'s> {
        let _ = self.threads;
        match &mut self.cache {
            None => Bvh::build(scene, self.precision),
            Some(cache) => Bvh::build_frame(scene, self.precision, &mut cache.bvh, diff),
        }
    }

    /// Adds to the counts those of a scene: the trees that were `built`, the `contents` of its TLAS, and
    /// what moved.
    fn count(&mut self, scene: &Scene, built: BuildStats, contents: BuildStats, diff: &FrameDiff) {
        let BuildStats { meshes_built, tlas_built, .. } = built;
        self.stats += if tlas_built == 0 {
            BuildStats {
                tlas_updated: 1,
                instances_moved: diff.instances.len() as u64,
                spheres_moved: diff.spheres.len() as u64,
                ..built
            }
        } else {
            let instances = 0..scene.instances.len() as u32;
            BuildStats {
                meshes_built,
                tlas_built,
                instances_built: visible_instances(scene),
                masked_instances: instances.filter(|&i| scene.is_masked(i)).count() as u64,
                ..contents
            }
        };
        self.stats.meshes_reused += used_meshes(scene).saturating_sub(meshes_built);
    }

    /// The quality of its trees; none where Embree does not build them.
    pub fn quality(&self) -> Option<BuildQuality> {
        (self.backend != Backend::Rust).then_some(self.quality)
    }

    /// The counts of all intersectors so far.
    pub fn stats(&self) -> BuildStats {
        self.stats
    }
}

/// The number of meshes that have instances and triangles.
fn used_meshes(scene: &Scene) -> u64 {
    meshes_in_use(scene).into_iter().filter(|&used| used).count() as u64
}

/// The number of instances of meshes with triangles.
fn visible_instances(scene: &Scene) -> u64 {
    let is_visible = |i: u32| !scene.meshes[i as usize].triangles.is_empty();
    scene.instances.iter().filter(|i| is_visible(i.mesh.0)).count() as u64
}

impl std::fmt::Debug for IntersectorBuilder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("IntersectorBuilder").field("stats", &self.stats).finish_non_exhaustive()
    }
}
