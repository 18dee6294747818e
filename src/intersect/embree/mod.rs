//! The Embree intersector.
//!
//! Embree traverses recentred f32 copies of the rays (`f32_space`); planes are merged as for every
//! backend.
//!
//! Precision `fast`: spheres are one user geometry whose callbacks compute in f64 from the exact
//! rays (`fast::spheres`); the triangles that Embree reports (`fast::meshes`) are intersected again in
//! f64 (`fast::refine`). What this does not promise is which of two triangles is hit where f32 cannot
//! tell: along edges and at equal depths.
//!
//! Precision `certified`: spheres, triangles and instances are all user geometry
//! (`certified::meshes`, `certified::instances`), in boxes that no exact ray can miss with its f32 copy;
//! each is tested in f64 with an error bound, and exactly where that cannot tell
//! (`certified::resolve`).
//!
//! embree4-rs owns device, scene, meshes and their lifetimes. Its ray queries are not used: they
//! take records smaller than the library writes (`ffi::records`).

mod certified;
mod device;
mod f32_space;
mod fast;
mod ffi;
mod library_search;
mod packet;
mod scene_builder;
#[cfg(test)]
mod tests;
mod tlas;
mod user_meshes;

use std::sync::Arc;

use crate::error::Result;
use crate::geometry::{Bounds, Hit, HitBatch, PrimitiveId, Ray, RayBatch};
use crate::intersect::build_stats::BuildStats;
use crate::intersect::frame_diff::FrameDiff;
use crate::intersect::ray_ends::max_coordinate;
use crate::intersect::{Coherence, Crossing, Intersector, Precision, Query};
use crate::scene::{Instance, Scene};
use ffi::PacketWidth;
pub use ffi::open;
#[cfg(feature = "cli")]
pub use ffi::{library_path, peak_memory};
use packet::{ClosestQuery, OcclusionQuery, QueryScene};
pub(super) use scene_builder::BuildOptions;
pub(super) use tlas::FrameCache;
use tlas::Tlas;

/// The Embree intersector of one scene.
pub struct Embree<'s> {
    scene: &'s Scene,
    /// The largest absolute coordinate in the scene.
    max_coordinate: f64,
    /// True if every triangle blocks light.
    all_block_light: bool,
    /// True for each instance whose alpha is tested; empty where there is none.
    masked: Vec<bool>,
    tlas: Arc<Tlas>,
}

impl<'s> Embree<'s> {
    /// Builds a checked scene on `threads` threads (0: all there are).
    ///
    /// # Errors
    /// When the library is not as expected, or runs out of memory.
    pub fn build(scene: &'s Scene, precision: Precision, threads: usize) -> Result<Self> {
        Self::with_options(scene, BuildOptions { precision, threads, ..BuildOptions::default() })
    }

    /// Builds an intersector that traces ray by ray instead of in packets: to measure what packets
    /// bring, and to compare the two.
    ///
    /// # Errors
    /// The same as for [`Embree::build`].
    pub fn build_single(scene: &'s Scene, precision: Precision, threads: usize) -> Result<Self> {
        let width = Some(PacketWidth::One);
        let options = BuildOptions { precision, threads, width, ..BuildOptions::default() };
        Self::with_options(scene, options)
    }

    /// Builds a checked scene with other options.
    pub(super) fn with_options(scene: &'s Scene, options: BuildOptions) -> Result<Self> {
        Ok(Self::new(scene, Tlas::build(scene, options)?.into()))
    }

    /// Builds the scene of a frame, with what the cache has from the frame before. Only `diff` moved
    /// since; it is `None` where the scene is another one.
    pub(super) fn build_frame(
        scene: &'s Scene,
        options: BuildOptions,
        mesh_bounds: &[Bounds],
        cache: &mut FrameCache,
        diff: Option<&FrameDiff>,
    ) -> Result<Self> {
        Ok(Self::new(scene, cache.update_or_build(scene, options, mesh_bounds, diff)?))
    }

    fn new(scene: &'s Scene, tlas: Arc<Tlas>) -> Self {
        let blocks_light = |(i, instance): (u32, &Instance)| {
            scene.blocks_light(PrimitiveId::triangle(instance.mesh.0, 0, i))
        };
        let mut masked: Vec<bool> =
            (0..scene.instances.len() as u32).map(|i| scene.is_masked(i)).collect();
        if !masked.contains(&true) {
            masked.clear();
        }
        Self {
            scene,
            max_coordinate: max_coordinate(scene, &tlas.space.bounds),
            all_block_light: (0..).zip(&scene.instances).all(blocks_light),
            masked,
            tlas,
        }
    }

    /// The number of geometries of spheres, and of instances whose meshes are in object space.
    pub(super) fn stats(&self) -> BuildStats {
        self.tlas.stats()
    }

    /// The distance, in world units, by which the f32 rays may be off anywhere in the scene: what
    /// `fast` cannot tell apart. Within an instance it may be magnified by its transform.
    pub fn margin(&self) -> f64 {
        self.tlas.space.margin()
    }

    fn query_scene(&self) -> QueryScene<'_> {
        QueryScene {
            scene: self.scene,
            precision: self.tlas.precision,
            top: &self.tlas.scene,
            space: &self.tlas.space,
            instance_of: self.tlas.instance_of(),
            max_coordinate: self.max_coordinate,
            all_block_light: self.all_block_light,
            masked: &self.masked,
        }
    }
}

/// True if two rays may be in one batch, which holds either shadow rays or others.
fn is_same_kind(a: &Ray, b: &Ray) -> bool {
    a.shadow.is_some() == b.shadow.is_some()
}

/// The version of the Embree library, such as `4.4.0`.
///
/// # Errors
/// When the library cannot be opened.
pub fn version() -> Result<String> {
    Ok(device::open(1, None)?.version())
}

impl Intersector for Embree<'_> {
    fn name(&self) -> &'static str {
        "embree"
    }

    fn version(&self) -> String {
        self.tlas.scene.device.version()
    }

    fn uses_filter(&self, query: Query, rays: &RayBatch) -> bool {
        let is_needed = match query {
            Query::Closest => !rays.have_no_departures() || !self.masked.is_empty(),
            Query::Occluded => true,
        };
        self.tlas.precision == Precision::Fast && is_needed
    }

    fn closest(&self, rays: &[Ray], coherence: Coherence, hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit for each ray");
        let (mut batch, mut batch_hits) = (RayBatch::default(), HitBatch::default());
        let mut hits = hits.iter_mut();
        for rays in rays.chunk_by(is_same_kind) {
            batch.clear();
            batch.extend(rays);
            self.closest_batch(&batch, coherence, &mut batch_hits);
            batch_hits.iter().zip(&mut hits).for_each(|(from, to)| *to = from);
        }
    }

    fn occluded(&self, rays: &[Ray], coherence: Coherence, occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "one answer for each ray");
        let (mut batch, mut batch_occluded) = (RayBatch::default(), Vec::new());
        let mut occluded = occluded.iter_mut();
        for rays in rays.chunk_by(is_same_kind) {
            batch.clear();
            batch.extend(rays);
            self.occluded_batch(&batch, coherence, &mut batch_occluded);
            batch_occluded.iter().zip(&mut occluded).for_each(|(from, to)| *to = *from);
        }
    }

    fn closest_batch(&self, rays: &RayBatch, coherence: Coherence, hits: &mut HitBatch) {
        hits.resize(rays.len());
        let query = &self.query_scene();
        let width = self.tlas.scene.device.width;
        width.run(ClosestQuery { query, rays, coherence, hits });
    }

    fn occluded_batch(&self, rays: &RayBatch, coherence: Coherence, occluded: &mut Vec<bool>) {
        occluded.clear();
        occluded.resize(rays.len(), false);
        let query = &self.query_scene();
        let width = self.tlas.scene.device.width;
        width.run(OcclusionQuery { query, rays, coherence, occluded, crossings: None });
    }

    fn occluded_with_crossings(
        &self,
        rays: &RayBatch,
        coherence: Coherence,
        occluded: &mut Vec<bool>,
        crossings: &mut Vec<Crossing>,
    ) -> bool {
        occluded.clear();
        occluded.resize(rays.len(), false);
        let query = &self.query_scene();
        let width = self.tlas.scene.device.width;
        width.run(OcclusionQuery { query, rays, coherence, occluded, crossings: Some(crossings) });
        true
    }

    fn hits_on(&self, ray: &Ray, ids: &[PrimitiveId]) -> Vec<Hit> {
        self.query_scene().primitives().hits_in_order(ray, ids)
    }
}
