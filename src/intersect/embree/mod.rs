//! The Embree intersector.
//!
//! Embree traverses recentred f32 copies of the rays (`frame`); planes are merged as for every
//! backend.
//!
//! Precision `fast`: spheres are one user geometry whose callbacks compute in f64 from the exact
//! rays (`spheres`); the triangles that Embree reports (`native`) are intersected again in f64
//! (`refine`). What this does not promise is which of two triangles is hit where f32 cannot tell:
//! along edges and at equal depths.
//!
//! Precision `certified`: spheres, triangles and instances are all user geometry (`meshes`,
//! `placements`), in boxes that no exact ray can miss with its f32 copy; each is tested in f64
//! with an error bound, and exactly where that cannot tell (`certified`).
//!
//! embree4-rs owns device, scene, meshes and their lifetimes. Its ray queries are not used: they
//! take records smaller than the library writes (`layout`).

mod certified;
mod f32_space;
mod fast;
mod ffi;
mod packet;
#[cfg(test)]
mod tests;
mod tlas;

use std::sync::{Arc, OnceLock};

use embree4_rs::geometry::Geometry;
use embree4_rs::{Device, SceneOptions};
use embree4_sys::{RTCDeviceProperty, RTCSceneFlags};

use crate::error::{Error, Result};
use crate::geometry::{Bounds, Hit, HitBatch, PrimitiveId, Ray, RayBatch};
use crate::intersect::blas_cache::BlasCache;
use crate::intersect::frame_diff::FrameDiff;
use crate::intersect::{
    BuildQuality, Coherence, ExtraTests, Intersector, Precision, self_intersection,
};
use crate::scene::check::MAX_COORDINATE;
use crate::scene::{Instance, Scene};
use f32_space::F32Space;
use ffi::abi_check::{self, failed};
use ffi::handles::{DeviceHandle, scene_handle};
pub use ffi::memory::peak as peak_memory;
use ffi::packet_width::PacketWidth;
use packet::query;
use tlas::Tlas;

/// What is asked of an intersector.
#[derive(Clone, Copy, Default)]
pub(super) struct BuildOptions {
    pub precision: Precision,
    /// How many threads build it; 0 means all there are.
    pub threads: usize,
    /// How good the trees are.
    pub quality: BuildQuality,
    /// How wide its packets are; none for the widest that is native.
    pub width: Option<PacketWidth>,
}

/// The Embree intersector of one scene.
pub struct Embree<'s> {
    scene: &'s Scene,
    /// The largest absolute coordinate in the scene.
    reach: f64,
    /// Whether every triangle blocks light.
    all_block: bool,
    /// Of which instances the alpha is tested; empty where it is of none.
    masked: Vec<bool>,
    top: Arc<Tlas>,
}

impl<'s> Embree<'s> {
    /// Builds a checked scene on `threads` threads (0: all there are).
    ///
    /// # Errors
    /// When the library is not as expected, or runs out of memory.
    pub fn build(scene: &'s Scene, precision: Precision, threads: usize) -> Result<Self> {
        Self::build_as(scene, BuildOptions { precision, threads, ..BuildOptions::default() })
    }

    /// As [`Embree::build`], but traces ray by ray instead of in packets: to measure what packets
    /// bring, and to compare the two.
    ///
    /// # Errors
    /// As [`Embree::build`].
    pub fn build_single(scene: &'s Scene, precision: Precision, threads: usize) -> Result<Self> {
        let width = Some(PacketWidth::One);
        Self::build_as(scene, BuildOptions { precision, threads, width, ..BuildOptions::default() })
    }

    pub(super) fn build_as(scene: &'s Scene, asked: BuildOptions) -> Result<Self> {
        let boxes = scene.mesh_bounds();
        let bounds = scene.bounds_with(&boxes);
        let device = new_device(scene, asked.threads)?;
        let top = Tlas::build(scene, device, asked, F32Space::around(bounds), &boxes, None)?;
        Ok(Self::of(scene, &bounds, top.into()))
    }

    /// As [`Embree::build`], where the boxes of the meshes are known, with what is there already
    /// from a frame before, of which only `moved` is not as it was there; nothing is known of that
    /// where the things are other ones.
    pub(super) fn build_sharing(
        scene: &'s Scene,
        asked: BuildOptions,
        boxes: &[Bounds],
        shared: &mut FrameCache,
        moved: Option<&FrameDiff>,
    ) -> Result<Self> {
        let bounds = scene.bounds_with(boxes);
        let frame = F32Space::on_stage(bounds, shared.stage);
        let top = shared.top(scene, asked, frame, boxes, moved)?;
        Ok(Self::of(scene, &bounds, top))
    }

    fn of(scene: &'s Scene, bounds: &Bounds, top: Arc<Tlas>) -> Self {
        let blocks = |(i, instance): (u32, &Instance)| {
            scene.blocks_light(PrimitiveId::triangle(instance.mesh.0, 0, i))
        };
        let all_block = (0..).zip(&scene.instances).all(blocks);
        let masked = masked(scene);
        Self { scene, reach: self_intersection::scene_reach(scene, bounds), all_block, masked, top }
    }

    /// How many geometries of spheres there are, and how many instances whose meshes are in spaces
    /// of their own.
    pub(super) fn work(&self) -> (u64, u64) {
        self.top.work()
    }

    /// How far, in world units, the f32 rays may be from the exact ones anywhere in the scene: what
    /// `fast` cannot tell apart. Within an instance it may be magnified by the instance's own
    /// space.
    pub fn margin(&self) -> f64 {
        self.top.frame.margin()
    }

    fn target(&self) -> query::Target<'_> {
        let top = &*self.top;
        query::Target {
            handle: scene_handle(&top.committed.scene),
            scene: self.scene,
            instance_of: &top.instance_of,
            frame: &top.frame,
            width: top.width,
            precision: top.precision,
            careful: false,
            reach: self.reach,
            all_block: self.all_block,
            masked: &self.masked,
        }
    }
}

/// Starts a device of `threads` threads (0: all there are), once the library is known to be as
/// expected.
fn new_device(scene: &Scene, threads: usize) -> Result<Device> {
    static CHECKED: OnceLock<std::result::Result<(), String>> = OnceLock::new();
    CHECKED
        .get_or_init(|| abi_check::check().map_err(|e| e.to_string()))
        .clone()
        .map_err(Error::failed)?;
    // Waking threads takes longer than a small tree does.
    let threads = if scene.primitive_count() < FEW { 1 } else { threads };
    Device::try_new(Some(&format!("threads={threads}\0"))).map_err(failed)
}

/// What frames share: a device, the meshes that were built on it, and the level above them.
pub(super) struct FrameCache {
    /// Where the frames take place, as far as that is known.
    stage: Bounds,
    fast: BlasCache<fast::meshes::Blas>,
    certified: BlasCache<certified::meshes::Blas>,
    /// That of the last frame.
    top: Option<Arc<Tlas>>,
    /// How many of them were built.
    tops: u64,
    /// Dropped after what stands on it.
    device: Option<DeviceHandle>,
}

impl FrameCache {
    /// Nothing yet, for frames that take place mostly within `stage`.
    pub(super) fn new(stage: Bounds) -> Self {
        let (fast, certified) = Default::default();
        Self { stage, fast, certified, top: None, tops: 0, device: None }
    }

    /// How many meshes were built.
    pub(super) fn built(&self) -> u64 {
        self.fast.built() + self.certified.built()
    }

    /// How many levels above the meshes were built.
    pub(super) fn tops(&self) -> u64 {
        self.tops
    }

    /// The level above the meshes for a scene: that of the frame before where only `moved` is not
    /// as it was there, and else a new one.
    fn top(
        &mut self,
        scene: &Scene,
        asked: BuildOptions,
        frame: F32Space,
        boxes: &[Bounds],
        moved: Option<&FrameDiff>,
    ) -> Result<Arc<Tlas>> {
        // Taken, so that nothing half changed stays behind an error.
        let mut last = self.top.take();
        // Whoever traces the last frame holds it, too: then it must not change.
        if let (Some(top), Some(moved)) = (last.as_mut().and_then(Arc::get_mut), moved)
            && top.can_follow(scene, &frame, boxes, moved)
        {
            top.follow(scene, &frame, boxes, moved)?;
        } else {
            let device = match &self.device {
                Some(there) => there.device(),
                None => new_device(scene, asked.threads)?,
            };
            last = Some(Tlas::build(scene, device, asked, frame, boxes, Some(self))?.into());
            self.tops += 1;
        }
        self.top.clone_from(&last);
        last.ok_or_else(|| Error::failed("no Embree scene was built"))
    }
}

/// How many primitives one thread builds a tree of in a few milliseconds.
const FEW: u64 = 1 << 12;

fn flags() -> RTCSceneFlags {
    RTCSceneFlags::ROBUST | RTCSceneFlags::FILTER_FUNCTION_IN_ARGUMENTS
}

/// Attaches a geometry, and says by which number Embree knows it.
fn attach(top: &embree4_rs::Scene, geometry: &dyn Geometry) -> Result<u32> {
    top.attach_geometry(geometry).map_err(failed)
}

/// Whether a mesh cannot be traced in its own space: f32 vertices reach 3e38, but Embree passes
/// over boxes beyond 1.8e18 without an error.
fn is_outsized(mesh: &Bounds) -> bool {
    mesh.max_abs() > MAX_COORDINATE
}

/// True for each instance whose alpha is tested; empty where no instance has a mask.
fn masked(scene: &Scene) -> Vec<bool> {
    let masked: Vec<bool> = (0..scene.instances.len() as u32).map(|i| scene.is_masked(i)).collect();
    if masked.contains(&true) { masked } else { Vec::new() }
}

/// How often each mesh stands in the scene.
fn uses(scene: &Scene) -> Vec<u32> {
    let mut uses = vec![0; scene.meshes.len()];
    scene.instances.iter().for_each(|i| uses[i.mesh.0 as usize] += 1);
    uses
}

fn version_of(device: &DeviceHandle) -> String {
    let of = |property| device.property(property);
    format!(
        "{}.{}.{}",
        of(RTCDeviceProperty::VERSION_MAJOR),
        of(RTCDeviceProperty::VERSION_MINOR),
        of(RTCDeviceProperty::VERSION_PATCH)
    )
}

/// The version of the Embree library, such as `4.4.0`.
///
/// # Errors
/// When the library does not start.
pub fn version() -> Result<String> {
    let device = Device::try_new(Some("threads=1\0")).map_err(failed)?;
    let scene = embree4_rs::Scene::try_new(device, SceneOptions::default()).map_err(failed)?;
    Ok(version_of(&DeviceHandle::of(&scene)))
}

impl Intersector for Embree<'_> {
    fn name(&self) -> &'static str {
        "embree"
    }

    fn version(&self) -> String {
        self.top.version.clone()
    }

    fn closest_extras(&self, rays: &RayBatch) -> ExtraTests {
        let asked = !rays.have_no_departures() || !self.masked.is_empty();
        let filters = self.top.precision == Precision::Fast && asked;
        ExtraTests { planes: !self.scene.planes.is_empty(), filters }
    }

    fn occluded_extras(&self) -> ExtraTests {
        ExtraTests {
            planes: !self.scene.planes.is_empty(),
            filters: self.top.precision == Precision::Fast,
        }
    }

    fn closest(&self, rays: &[Ray], coherence: Coherence, hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit for each ray");
        let (mut batch, mut found) = (RayBatch::default(), HitBatch::default());
        batch.extend(rays);
        self.closest_batch(&batch, coherence, &mut found);
        found.iter().zip(hits).for_each(|(found, hit)| *hit = found);
    }

    fn occluded(&self, rays: &[Ray], coherence: Coherence, blocked: &mut [bool]) {
        assert_eq!(rays.len(), blocked.len(), "one answer for each ray");
        let (mut batch, mut found) = (RayBatch::default(), Vec::new());
        batch.extend(rays);
        self.occluded_batch(&batch, coherence, &mut found);
        blocked.copy_from_slice(&found);
    }

    fn closest_batch(&self, rays: &RayBatch, coherence: Coherence, hits: &mut HitBatch) {
        hits.resize(rays.len());
        self.target().closest(rays, coherence, hits);
    }

    fn occluded_batch(&self, rays: &RayBatch, coherence: Coherence, blocked: &mut Vec<bool>) {
        blocked.clear();
        blocked.resize(rays.len(), false);
        self.target().occluded(rays, coherence, blocked);
    }
}
