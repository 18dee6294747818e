//! The intersectors, which find the hits of rays.
//!
//! An [`Intersector`] traces batches of rays. Its implementations find the same hits: `Embree` (with the
//! feature `embree`), [`Bvh`], the pure-Rust fallback and reference, and [`BruteForce`], for tests.
//! They share the intersection tests in [`primitive`], and differ in which primitives they test.

mod blas_cache;
mod brute_force;
mod build_quality;
mod build_stats;
mod builder;
mod bvh;
#[cfg(feature = "embree")]
mod embree;
mod frame_diff;
mod object_space;
mod order;
pub mod primitive;
mod ray_ends;

pub use brute_force::BruteForce;
pub use build_quality::BuildQuality;
pub use build_stats::BuildStats;
pub use builder::IntersectorBuilder;
pub use bvh::Bvh;
#[cfg(feature = "embree")]
pub use embree::{Embree, version as embree_version};
#[cfg(all(feature = "embree", feature = "cli"))]
pub use embree::{library_path as embree_library, peak_memory as embree_peak_memory};

#[cfg(feature = "embree")]
use crate::error::Remedy;
use crate::error::Result;
use crate::geometry::{Hit, HitBatch, PrimitiveId, Ray, RayBatch};
use crate::scene::Scene;

/// The coherence of the rays of a batch, which a packet tracer can use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coherence {
    /// Neighbours in the batch start and go alike, as primary and shadow rays do.
    Coherent,
    /// Neighbours in the batch differ, as secondary rays do.
    Incoherent,
}

/// A triangle that a ray may cross.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Crossing {
    /// The number of the ray in its batch.
    pub ray: u32,
    /// The triangle.
    pub id: PrimitiveId,
}

/// The kind of a query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// The query for closest hits.
    Closest,
    /// The query for whether rays are occluded.
    Occluded,
}

/// The intersector of one scene.
///
/// A ray hits what it crosses at 0 < t < `tmax`, both strictly, except the surface it left; a
/// tangent counts. Of several hits the least (t, geometry, primitive, instance) is the closest.
pub trait Intersector: Send + Sync {
    /// The name: `embree`, `rust` or `brute`.
    fn name(&self) -> &'static str;

    /// The version of the library that traces.
    fn version(&self) -> String;

    /// Finds the closest hit of each ray, and writes it to `hits` at the same index.
    ///
    /// # Panics
    /// When the two slices differ in length.
    fn closest(&self, rays: &[Ray], coherence: Coherence, hits: &mut [Option<Hit>]);

    /// Finds whether each ray is occluded by anything that blocks light, and writes it to `occluded` at
    /// the same index; see [`Scene::blocks_light`].
    ///
    /// # Panics
    /// When the two slices differ in length.
    fn occluded(&self, rays: &[Ray], coherence: Coherence, occluded: &mut [bool]);

    /// Finds the closest hits of rays in lanes; see [`Intersector::closest`].
    fn closest_batch(&self, rays: &RayBatch, coherence: Coherence, hits: &mut HitBatch) {
        let (indices, active) = active_rays(rays);
        let mut active_hits = vec![None; active.len()];
        self.closest(&active, coherence, &mut active_hits);
        hits.reset_to_misses(rays.len());
        indices.into_iter().zip(active_hits).for_each(|(i, hit)| hits.set(i, hit));
    }

    /// Finds whether rays in lanes are occluded; see [`Intersector::occluded`].
    fn occluded_batch(&self, rays: &RayBatch, coherence: Coherence, occluded: &mut Vec<bool>) {
        let (indices, active) = active_rays(rays);
        let mut active_occluded = vec![false; active.len()];
        self.occluded(&active, coherence, &mut active_occluded);
        occluded.clear();
        occluded.resize(rays.len(), false);
        indices.into_iter().zip(active_occluded).for_each(|(i, value)| occluded[i] = value);
    }

    /// Finds whether rays in lanes are occluded, as [`Intersector::occluded_batch`] does, and which triangles
    /// that let light through each ray that is not may cross: all that it crosses, in any order, perhaps
    /// several times, and perhaps others. Returns false if the intersector does not find these.
    fn occluded_with_crossings(
        &self,
        rays: &RayBatch,
        coherence: Coherence,
        occluded: &mut Vec<bool>,
        _crossings: &mut Vec<Crossing>,
    ) -> bool {
        self.occluded_batch(rays, coherence, occluded);
        false
    }

    /// Finds the hits of a ray on these primitives, one on each that it hits, in their order along the ray;
    /// none if the intersector does not find crossings.
    fn hits_on(&self, _ray: &Ray, _ids: &[PrimitiveId]) -> Vec<Hit> {
        Vec::new()
    }

    /// True if a filter callback accepts or rejects each candidate hit of these rays; for
    /// statistics.
    fn uses_filter(&self, _: Query, _: &RayBatch) -> bool {
        false
    }
}

/// Traces rays one by one.
///
/// # Panics
/// When the two slices differ in length.
fn trace_each<T>(rays: &[Ray], results: &mut [T], trace: impl Fn(&Ray) -> T) {
    assert_eq!(rays.len(), results.len(), "one result for each ray");
    rays.iter().zip(results).for_each(|(ray, result)| *result = trace(ray));
}

/// The rays of a batch that can hit anything, and their indices.
fn active_rays(rays: &RayBatch) -> (Vec<usize>, Vec<Ray>) {
    rays.iter().enumerate().filter(|(_, ray)| ray.tmax > 0.0).unzip()
}

/// The precision of hits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Hits by formulas in f64, and on Embree triangles found by f32 rays.
    #[default]
    Fast,
    /// Hits as exact arithmetic finds them on the scene as it is stored, for every ray.
    Certified,
}

impl Precision {
    /// The name: `fast` or `certified`.
    pub const fn name(self) -> &'static str {
        match self {
            Precision::Fast => "fast",
            Precision::Certified => "certified",
        }
    }
}

/// The library that an intersector traces with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// Intel Embree.
    #[cfg(feature = "embree")]
    Embree,
    /// The pure-Rust BVH.
    Rust,
}

impl Default for Backend {
    /// Returns Embree if it is built in and its library can be opened, and else the pure-Rust BVH.
    fn default() -> Self {
        Self::available()[0]
    }
}

impl Backend {
    /// The backends that can be used here, the fastest first: Embree if it is built in and its library can be
    /// opened, and the pure-Rust BVH. The first call opens the library.
    pub fn available() -> &'static [Self] {
        #[cfg(feature = "embree")]
        if embree::open().is_ok() {
            return &[Backend::Embree, Backend::Rust];
        }
        &[Backend::Rust]
    }

    /// Checks that the backend can be used here.
    ///
    /// # Errors
    /// When it is Embree, and its library cannot be opened.
    pub fn check(self) -> Result<()> {
        match self {
            #[cfg(feature = "embree")]
            Backend::Embree => embree::open().map_err(|e| e.remedied_by(Remedy::RustBackend)),
            Backend::Rust => Ok(()),
        }
    }

    /// The name of its intersectors.
    pub const fn name(self) -> &'static str {
        match self {
            #[cfg(feature = "embree")]
            Backend::Embree => "embree",
            Backend::Rust => "rust",
        }
    }

    /// Builds the intersector of a checked scene, on `threads` threads (0: all there are).
    ///
    /// # Errors
    /// When Embree's library cannot be opened, or Embree runs out of memory.
    pub fn build(
        self,
        scene: &Scene,
        precision: Precision,
        threads: usize,
    ) -> Result<Box<dyn Intersector + '_>> {
        IntersectorBuilder::new(self, precision, threads).build(scene)
    }
}
