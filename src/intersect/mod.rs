//! The hit layer: who finds what a ray meets.
//!
//! An [`Intersector`] is asked in batches. Its implementations answer alike: `Embree` (with the
//! feature `embree`), [`Bvh`], the pure-Rust fallback and judge, and [`BruteForce`], for tests.
//! They share the primitives' tests in [`primitive`]; what differs is which primitives they try.

mod blas_cache;
mod brute_force;
mod build_quality;
mod builder;
mod bvh;
#[cfg(feature = "embree")]
mod embree;
mod frame_diff;
mod object_space;
pub mod primitive;
mod self_intersection;

pub use brute_force::BruteForce;
pub use build_quality::BuildQuality;
pub use builder::{BuildStats, IntersectorBuilder};
pub use bvh::Bvh;
#[cfg(feature = "embree")]
pub use embree::{Embree, peak_memory as embree_peak_memory, version as embree_version};

use crate::error::Result;
use crate::geometry::{Hit, HitBatch, Ray, RayBatch};
use crate::scene::Scene;

/// Whether the rays of a batch go much the same way, which a packet tracer can use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coherence {
    /// Neighbours in the batch start and go alike, as primary and shadow rays do.
    Coherent,
    /// They do not, as after a bounce.
    Incoherent,
}

/// What an intersector does with the rays of a batch besides walking its trees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExtraTests {
    /// It tries each ray against planes.
    pub planes: bool,
    /// It looks at each hit that Embree finds, before Embree goes on.
    pub filters: bool,
}

/// Finds what rays meet in one scene.
///
/// A ray meets what it crosses at 0 < t < `tmax`, both strictly, except the surface it left; a
/// tangent counts. Of several the least (t, geometry, primitive, instance) is the closest.
pub trait Intersector: Send + Sync {
    /// What it is called: `embree`, `rust` or `brute`.
    fn name(&self) -> &'static str;

    /// The version of what does the work.
    fn version(&self) -> String;

    /// The closest hit of each ray, written to the same place in `hits`.
    ///
    /// # Panics
    /// When the two slices differ in length.
    fn closest(&self, rays: &[Ray], coherence: Coherence, hits: &mut [Option<Hit>]);

    /// Whether anything that blocks light stands in each ray's way, written to the same place in
    /// `blocked`; see [`Scene::blocks_light`].
    ///
    /// # Panics
    /// When the two slices differ in length.
    fn occluded(&self, rays: &[Ray], coherence: Coherence, blocked: &mut [bool]);

    /// What it does besides, when it looks for the closest hits of these rays.
    fn closest_extras(&self, _: &RayBatch) -> ExtraTests {
        ExtraTests::default()
    }

    /// What it does besides, when it looks for what stands in the way of any rays.
    fn occluded_extras(&self) -> ExtraTests {
        ExtraTests::default()
    }

    /// As [`Intersector::closest`], of rays that stand side by side.
    fn closest_batch(&self, rays: &RayBatch, coherence: Coherence, hits: &mut HitBatch) {
        let (places, all) = active_rays(rays);
        let mut found = vec![None; all.len()];
        self.closest(&all, coherence, &mut found);
        hits.reset_to_misses(rays.len());
        places.into_iter().zip(found).for_each(|(i, hit)| hits.set(i, hit));
    }

    /// As [`Intersector::occluded`], of rays that stand side by side.
    fn occluded_batch(&self, rays: &RayBatch, coherence: Coherence, blocked: &mut Vec<bool>) {
        let (places, all) = active_rays(rays);
        let mut found = vec![false; all.len()];
        self.occluded(&all, coherence, &mut found);
        blocked.clear();
        blocked.resize(rays.len(), false);
        places.into_iter().zip(found).for_each(|(i, found)| blocked[i] = found);
    }
}

/// The rays of a batch that may meet anything, and their places.
fn active_rays(rays: &RayBatch) -> (Vec<usize>, Vec<Ray>) {
    rays.iter().enumerate().filter(|(_, ray)| ray.tmax > 0.0).unzip()
}

/// How far a hit can be trusted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// The formulas in f64, and on Embree triangles found by f32 rays.
    #[default]
    Fast,
    /// The answer of exact arithmetic on the baked scene, for every ray.
    Certified,
}

impl Precision {
    /// What it is called: `fast` or `certified`.
    pub const fn name(self) -> &'static str {
        match self {
            Precision::Fast => "fast",
            Precision::Certified => "certified",
        }
    }
}

/// Which intersector to use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// Intel Embree.
    #[cfg(feature = "embree")]
    Embree,
    /// The pure-Rust BVH.
    Rust,
}

impl Default for Backend {
    /// Embree where it is compiled in.
    fn default() -> Self {
        #[cfg(feature = "embree")]
        return Backend::Embree;
        #[cfg(not(feature = "embree"))]
        Backend::Rust
    }
}

impl Backend {
    /// What its intersector is called.
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
    /// When Embree cannot be started or runs out of memory.
    pub fn build(
        self,
        scene: &Scene,
        precision: Precision,
        threads: usize,
    ) -> Result<Box<dyn Intersector + '_>> {
        IntersectorBuilder::new(self, precision, threads).build(scene)
    }
}
