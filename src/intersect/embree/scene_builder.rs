//! The settings and the unfinished Embree scene that the geometries of a TLAS are built with.

use embree4_sys::{RTCBuildQuality, RTCSceneFlags};

use crate::error::Result;
use crate::geometry::Bounds;
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::{
    DeviceHandle, OpenScene, PacketWidth, PrimitiveTable, UserPrimitives, new_geometry,
};
use crate::intersect::{BuildQuality, Precision};
use crate::scene::Scene;

/// The options of an Embree intersector.
#[derive(Clone, Copy, Default)]
pub struct BuildOptions {
    pub precision: Precision,
    /// The number of threads that build it; 0 means all there are.
    pub threads: usize,
    /// The quality of the trees.
    pub quality: BuildQuality,
    /// The width of its packets; none for the widest that is native.
    pub width: Option<PacketWidth>,
}

/// The flags of every Embree scene that triangles of Embree's own are attached to.
pub const SCENE_FLAGS: RTCSceneFlags =
    RTCSceneFlags(RTCSceneFlags::ROBUST.0 | RTCSceneFlags::FILTER_FUNCTION_IN_ARGUMENTS.0);

/// An unfinished Embree scene, and what its geometries are built of.
pub struct SceneBuilder<'a> {
    pub scene: &'a Scene,
    /// The boxes of the meshes in object space.
    pub mesh_bounds: &'a [Bounds],
    pub device: &'a DeviceHandle,
    pub quality: RTCBuildQuality,
    pub space: F32Space,
    /// True if every mesh gets a BLAS, also one with a single instance: for frames that share meshes.
    pub all_instanced: bool,
    pub top: OpenScene,
}

impl<'a> SceneBuilder<'a> {
    /// Begins an Embree scene.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub fn new(
        scene: &'a Scene,
        mesh_bounds: &'a [Bounds],
        device: &'a DeviceHandle,
        quality: BuildQuality,
        space: F32Space,
        all_instanced: bool,
    ) -> Result<Self> {
        let quality = match quality {
            BuildQuality::Low => RTCBuildQuality::LOW,
            BuildQuality::Medium => RTCBuildQuality::MEDIUM,
        };
        let top = OpenScene::new(device, quality, SCENE_FLAGS)?;
        Ok(Self { scene, mesh_bounds, device, quality, space, all_instanced, top })
    }

    /// Attaches the user geometry over `table`, which must outlive the scene, and returns its id.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub fn attach_user_geometry<P>(&self, table: &P::Table) -> Result<u32>
    where
        P: UserPrimitives<Table: PrimitiveTable>,
    {
        self.top.attach(&new_geometry::<P>(self.device, self.quality, table)?)
    }

    /// The number of instances of each mesh.
    pub fn instance_counts(&self) -> Vec<u32> {
        let mut counts = vec![0; self.scene.meshes.len()];
        self.scene.instances.iter().for_each(|i| counts[i.mesh.0 as usize] += 1);
        counts
    }
}
