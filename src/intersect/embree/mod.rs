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

mod canary;
mod certified;
mod decide;
mod exact;
mod filter;
mod finish;
mod frame;
mod layout;
mod meshes;
mod native;
mod nearest;
mod packet;
mod placements;
mod planes;
mod query;
mod raw;
mod refine;
mod spheres;
#[cfg(test)]
mod tests;
mod triangles;
mod user;
mod width;

use std::sync::OnceLock;

use embree4_rs::geometry::Geometry;
use embree4_rs::{CommittedScene, Device, SceneOptions};
use embree4_sys::{RTCBuildQuality, RTCDeviceProperty, RTCSceneFlags};

use crate::error::{Error, Result};
use crate::geometry::{Bounds, Hit, Hits, Ray, Rays};
use crate::intersect::kept::Kept;
use crate::intersect::{Coherence, Intersector, Precision, leaving};
use crate::scene::Scene;
use crate::scene::check::MAX_COORDINATE;
use canary::failed;
use frame::Frame;
use meshes::Meshes;
use raw::{DeviceHandle, scene_handle};
use spheres::SphereTable;
use width::Width;

/// The Embree intersector of one scene.
pub struct Embree<'s> {
    scene: &'s Scene,
    frame: Frame,
    width: Width,
    precision: Precision,
    /// The largest absolute coordinate in the scene.
    reach: f64,
    /// For each geometry that is attached, the instance that stands there.
    instance_of: Vec<u32>,
    committed: CommittedScene,
    version: String,
    /// Read by the callbacks; dropped after the scene that calls them.
    _spheres: Option<Box<SphereTable>>,
    _meshes: Meshes,
}

// SAFETY: the only thing in it that is not Send and Sync by itself is the handle of a committed
// scene. Embree lets any thread trace a committed scene, and release it.
#[allow(unsafe_code)]
unsafe impl Send for Embree<'_> {}
#[allow(unsafe_code)]
unsafe impl Sync for Embree<'_> {}

impl<'s> Embree<'s> {
    /// Builds a checked scene on `threads` threads (0: all there are).
    ///
    /// # Errors
    /// When the library is not as expected, or runs out of memory.
    pub fn build(scene: &'s Scene, precision: Precision, threads: usize) -> Result<Self> {
        Self::build_sharing(scene, precision, threads, None)
    }

    /// As [`Embree::build`], with the meshes that are there already, on their device.
    pub(super) fn build_sharing(
        scene: &'s Scene,
        precision: Precision,
        threads: usize,
        shared: Option<&mut Shared>,
    ) -> Result<Self> {
        Self::with_width(scene, precision, threads, None, shared)
    }

    /// As [`Embree::build`], but traces ray by ray instead of in packets: to measure what packets
    /// bring, and to compare the two.
    ///
    /// # Errors
    /// As [`Embree::build`].
    pub fn build_single(scene: &'s Scene, precision: Precision, threads: usize) -> Result<Self> {
        Self::with_width(scene, precision, threads, Some(Width::One), None)
    }

    fn with_width(
        scene: &'s Scene,
        precision: Precision,
        threads: usize,
        width: Option<Width>,
        mut shared: Option<&mut Shared>,
    ) -> Result<Self> {
        static CHECKED: OnceLock<std::result::Result<(), String>> = OnceLock::new();
        CHECKED
            .get_or_init(|| canary::check().map_err(|e| e.to_string()))
            .clone()
            .map_err(Error::failed)?;

        let device = match shared.as_ref().and_then(|shared| shared.device.as_ref()) {
            Some(there) => there.device(),
            None => Device::try_new(Some(&format!("threads={threads}\0"))).map_err(failed)?,
        };
        let options = SceneOptions { build_quality: QUALITY, flags: flags() };
        let top = embree4_rs::Scene::try_new(device, options).map_err(failed)?;
        let device = DeviceHandle::of(&top);
        if let Some(shared) = &mut shared {
            shared.device.get_or_insert_with(|| DeviceHandle::of(&top));
        }
        let bounds = scene.bounds();
        let frame = Frame::around(bounds);
        let width = width.unwrap_or_else(|| Width::native(&device));

        let mut instance_of = Vec::new();
        let mut _meshes = Meshes::default();
        match precision {
            Precision::Fast => {
                let kept = shared.map(|shared| &mut shared.fast);
                instance_of = native::attach_meshes(scene, &top, &device, &frame, kept)?;
            }
            Precision::Certified => {
                let kept = shared.map(|shared| &mut shared.certified);
                _meshes.attach(scene, &top, &device, (frame, width), kept)?;
            }
        }
        let _spheres = (!scene.spheres.is_empty()).then(|| SphereTable::new(scene, frame));
        if let Some(table) = &_spheres {
            let callbacks = match precision {
                Precision::Fast => spheres::callbacks(width),
                Precision::Certified => certified::spheres(width),
            };
            attach(&top, &user::geometry(&top.device, &device, &**table, callbacks)?)?;
        }
        let committed = top
            .commit()
            .map_err(|e| Error::failed(format!("Embree cannot build the scene: {e}")))?;
        let version = version_of(&device);
        Ok(Self {
            scene,
            frame,
            width,
            precision,
            reach: leaving::scene_reach(scene, &bounds),
            instance_of,
            committed,
            version,
            _spheres,
            _meshes,
        })
    }

    /// How far, in world units, the f32 rays may be from the exact ones anywhere in the scene: what
    /// `fast` cannot tell apart. Within an instance it may be magnified by the instance's own
    /// space.
    pub fn margin(&self) -> f64 {
        self.frame.margin()
    }

    fn target(&self) -> query::Target<'_> {
        query::Target {
            handle: scene_handle(&self.committed.scene),
            scene: self.scene,
            instance_of: &self.instance_of,
            frame: &self.frame,
            width: self.width,
            precision: self.precision,
            careful: false,
            reach: self.reach,
        }
    }
}

/// What frames share: a device, and the meshes that were built on it.
#[derive(Default)]
pub(super) struct Shared {
    fast: Kept<native::Own>,
    certified: Kept<meshes::Own>,
    /// Dropped after what stands on it.
    device: Option<DeviceHandle>,
}

impl Shared {
    /// How many meshes were built.
    pub(super) fn built(&self) -> u64 {
        self.fast.built() + self.certified.built()
    }
}

const QUALITY: RTCBuildQuality = RTCBuildQuality::MEDIUM;

fn flags() -> RTCSceneFlags {
    RTCSceneFlags::ROBUST | RTCSceneFlags::FILTER_FUNCTION_IN_ARGUMENTS
}

fn attach(top: &embree4_rs::Scene, geometry: &dyn Geometry) -> Result<()> {
    top.attach_geometry(geometry).map(|_| ()).map_err(failed)
}

/// Whether a mesh cannot be traced in its own space: f32 vertices reach 3e38, but Embree passes
/// over boxes beyond 1.8e18 without an error.
fn is_outsized(mesh: &Bounds) -> bool {
    mesh.max_abs() > MAX_COORDINATE
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
        self.version.clone()
    }

    fn closest(&self, rays: &[Ray], coherence: Coherence, hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit for each ray");
        let (mut batch, mut found) = (Rays::default(), Hits::default());
        batch.extend(rays);
        self.closest_of(&batch, coherence, &mut found);
        found.iter().zip(hits).for_each(|(found, hit)| *hit = found);
    }

    fn occluded(&self, rays: &[Ray], coherence: Coherence, blocked: &mut [bool]) {
        assert_eq!(rays.len(), blocked.len(), "one answer for each ray");
        let (mut batch, mut found) = (Rays::default(), Vec::new());
        batch.extend(rays);
        self.occluded_of(&batch, coherence, &mut found);
        blocked.copy_from_slice(&found);
    }

    fn closest_of(&self, rays: &Rays, coherence: Coherence, hits: &mut Hits) {
        hits.reset(rays.len());
        self.target().closest(rays, coherence, hits);
    }

    fn occluded_of(&self, rays: &Rays, coherence: Coherence, blocked: &mut Vec<bool>) {
        blocked.clear();
        blocked.resize(rays.len(), false);
        self.target().occluded(rays, coherence, blocked);
    }
}
