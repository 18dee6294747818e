//! The Embree scene that rays are traced in, and what is kept of it from frame to frame.
//!
//! Where anything moved, Embree builds the tree over spheres and instances again. Its refitting
//! (quality LOW for the scene, REFIT for the spheres) was tried: with one of 100,000 spheres in
//! motion it took a third less time to build, but rays took up to twice as long in precision
//! `certified`, and 50,000 instances took longer to build.

use std::sync::Arc;

use embree4_rs::{CommittedScene, SceneOptions};
use embree4_sys::RTCBuildQuality;

use crate::error::{Error, Result};
use crate::geometry::Bounds;
use crate::intersect::embree::certified::callbacks as certified_callbacks;
use crate::intersect::embree::certified::meshes::Meshes;
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::fast::meshes as fast_meshes;
use crate::intersect::embree::fast::spheres::{self, SphereTable};
use crate::intersect::embree::ffi::abi_check::failed;
use crate::intersect::embree::ffi::handles::{DeviceHandle, commit_again};
use crate::intersect::embree::ffi::packet_width::PacketWidth;
use crate::intersect::embree::ffi::{memory, user_geometry};
use crate::intersect::embree::{BuildOptions, FrameCache, attach, flags, is_outsized, version_of};
use crate::intersect::frame_diff::FrameDiff;
use crate::intersect::{BuildQuality, Precision};
use crate::scene::{Mesh, Scene};

/// A committed Embree scene and what belongs to it.
pub struct Tlas {
    pub precision: Precision,
    pub width: PacketWidth,
    pub frame: F32Space,
    /// For each geometry that is attached, the instance that stands there; ascending.
    pub instance_of: Vec<u32>,
    /// How many of them are in spaces of their own.
    instanced: u64,
    pub committed: CommittedScene,
    pub version: String,
    /// Which geometry the spheres are, and what their callbacks read; dropped after the scene that
    /// calls them.
    spheres: Option<(u32, Box<SphereTable>)>,
    meshes: Meshes,
    /// Whose indices Embree goes on reading; dropped after the scene.
    _shown: Vec<Arc<Mesh>>,
}

// SAFETY: the only thing in it that is not Send and Sync by itself is the handle of a committed
// scene. Embree lets any thread trace a committed scene, and release it; it is changed through
// `&mut Top` only, when nobody traces it.
#[allow(unsafe_code)]
unsafe impl Send for Tlas {}
#[allow(unsafe_code)]
unsafe impl Sync for Tlas {}

impl Tlas {
    /// Builds a checked scene on a device, with what is there already of its meshes, whose boxes
    /// are `boxes`.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub fn build(
        scene: &Scene,
        device: embree4_rs::Device,
        asked: BuildOptions,
        frame: F32Space,
        boxes: &[Bounds],
        mut shared: Option<&mut FrameCache>,
    ) -> Result<Self> {
        let quality = match asked.quality {
            BuildQuality::Low => RTCBuildQuality::LOW,
            BuildQuality::Medium => RTCBuildQuality::MEDIUM,
        };
        let options = SceneOptions { build_quality: quality, flags: flags() };
        let top = embree4_rs::Scene::try_new(device, options).map_err(failed)?;
        let device = DeviceHandle::of(&top);
        memory::watch(&device);
        if let Some(shared) = &mut shared {
            shared.device.get_or_insert_with(|| DeviceHandle::of(&top));
        }
        let precision = asked.precision;
        let width = asked.width.unwrap_or_else(|| PacketWidth::native(&device));
        // Frames share meshes.
        let all_instanced = shared.is_some();
        let mut meshes = Meshes::default();
        let (instance_of, instanced) = match precision {
            Precision::Fast => {
                let kept = (all_instanced, shared.map(|shared| &mut shared.fast));
                fast_meshes::attach_meshes(scene, boxes, &top, &device, quality, &frame, kept)?
            }
            Precision::Certified => {
                let kept = (all_instanced, shared.map(|shared| &mut shared.certified));
                let how = (frame, width, quality);
                meshes.attach(scene, boxes, &top, &device, how, kept)?;
                (Vec::new(), meshes.instanced())
            }
        };
        let mut spheres = None;
        if !scene.spheres.is_empty() {
            let table = SphereTable::new(scene, frame);
            let callbacks = match precision {
                Precision::Fast => spheres::callbacks(width),
                Precision::Certified => certified_callbacks::spheres(width),
            };
            let id = attach(&top, &user_geometry::geometry(&device, quality, &*table, callbacks)?)?;
            spheres = Some((id, table));
        }
        let committed = top
            .commit()
            .map_err(|e| Error::failed(format!("Embree cannot build the scene: {e}")))?;
        let version = version_of(&device);
        Ok(Self {
            precision,
            width,
            frame,
            instance_of,
            instanced,
            committed,
            version,
            spheres,
            meshes,
            _shown: scene.meshes.clone(),
        })
    }

    /// How many geometries of spheres there are, and how many instances whose meshes are in spaces
    /// of their own.
    pub fn work(&self) -> (u64, u64) {
        (u64::from(self.spheres.is_some()), self.instanced)
    }

    /// Whether it can become the scene of another frame, in which only `moved` did, and which fits
    /// into `frame`.
    pub fn can_follow(
        &self,
        scene: &Scene,
        frame: &F32Space,
        boxes: &[Bounds],
        moved: &FrameDiff,
    ) -> bool {
        // What is outsized in its own space has its triangles in the world's.
        let stays = |&i: &u32| is_outsized(&boxes[scene.instances[i as usize].mesh.0 as usize]);
        self.frame.is_at(frame) && !moved.instances.iter().any(stays)
    }

    /// Becomes the scene of another frame, as [`Tlas::can_follow`] allows: what moved is placed
    /// again, and if anything did, the level above the meshes is committed again.
    ///
    /// # Errors
    /// When Embree runs out of memory; then it is of no further use.
    pub fn follow(
        &mut self,
        scene: &Scene,
        frame: &F32Space,
        boxes: &[Bounds],
        moved: &FrameDiff,
    ) -> Result<()> {
        self.frame = *frame;
        let top = &self.committed.scene;
        if let Some((id, table)) = &mut self.spheres {
            table.refresh(scene);
            if !moved.spheres.is_empty() {
                user_geometry::moved(top, *id, &**table);
            }
        }
        if !moved.instances.is_empty() {
            match self.precision {
                Precision::Fast => {
                    fast_meshes::follow(
                        scene,
                        top,
                        frame,
                        boxes,
                        &self.instance_of,
                        &moved.instances,
                    );
                }
                Precision::Certified => self.meshes.follow(scene, top, boxes, &moved.instances),
            }
        }
        if *moved == FrameDiff::default() {
            return Ok(());
        }
        commit_again(top)
    }
}
