//! The Embree scene that rays are traced in, and what frames reuse of it.
//!
//! Where anything moved, Embree builds the tree over spheres and instances again. Its refitting
//! (quality LOW for the scene, REFIT for the spheres) was tried: with one of 100,000 spheres in
//! motion it took a third less time to build, but rays took up to twice as long in precision
//! `certified`, and 50,000 instances took longer to build.

use std::sync::Arc;

use crate::error::{Error, Result};
use crate::geometry::Bounds;
use crate::intersect::Precision;
use crate::intersect::blas_cache::BlasCache;
use crate::intersect::build_stats::BuildStats;
use crate::intersect::embree::certified::{CertifiedSphere, CertifiedTriangle};
use crate::intersect::embree::device;
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::fast::{
    self, FastSpheres, FastTriangle, SphereTable, unresolved_meshes,
};
use crate::intersect::embree::ffi::{CommittedScene, DeviceHandle, update_geometry};
use crate::intersect::embree::scene_builder::{BuildOptions, SceneBuilder};
use crate::intersect::embree::user_meshes::{self, UserMeshes};
use crate::intersect::frame_diff::FrameDiff;
use crate::scene::{Mesh, Scene};

/// A committed Embree scene and what belongs to it.
pub struct Tlas {
    pub precision: Precision,
    pub space: F32Space,
    pub scene: CommittedScene,
    /// The geometry of the spheres, and the table that its callbacks read; dropped after the scene that
    /// calls them.
    spheres: Option<(u32, Box<SphereTable>)>,
    /// Embree's own triangles, in precision `fast`.
    own_meshes: fast::Meshes,
    user_meshes: UserMeshes,
    /// True for each mesh that is user geometry.
    is_user_mesh: Vec<bool>,
    /// The meshes whose indices Embree goes on reading; dropped after the scene.
    _meshes: Vec<Arc<Mesh>>,
}

impl Tlas {
    /// Builds a checked scene, for a single picture.
    ///
    /// # Errors
    /// When the library is not as expected, or runs out of memory.
    pub fn build(scene: &Scene, options: BuildOptions) -> Result<Self> {
        let mesh_bounds = scene.mesh_bounds();
        let space = F32Space::from_bounds(scene.bounds_with(&mesh_bounds));
        let device = device_for(scene, options)?;
        let builder =
            SceneBuilder::new(scene, &mesh_bounds, &device, options.quality, space, false)?;
        Self::from_builder(builder, options.precision, None)
    }

    /// Attaches meshes and spheres, and commits.
    fn from_builder(
        builder: SceneBuilder<'_>,
        precision: Precision,
        cache: Option<&mut FrameCache>,
    ) -> Result<Self> {
        let SceneBuilder { scene, space, device, .. } = builder;
        let is_user_mesh = are_user_meshes(scene, &space, precision);
        let is_own_mesh: Vec<bool> = is_user_mesh.iter().map(|is_user| !is_user).collect();
        let (own_cache, user_cache) =
            cache.map(|cache| (&mut cache.own_meshes, &mut cache.user_meshes)).unzip();
        // Embree's own first, so that their ids are indices.
        let own_meshes = fast::Meshes::attach(&builder, own_cache, &is_own_mesh)?;
        let attach = match precision {
            Precision::Fast => UserMeshes::attach::<FastTriangle>,
            Precision::Certified => UserMeshes::attach::<CertifiedTriangle>,
        };
        let user_meshes = attach(&builder, user_cache, &is_user_mesh)?;
        let mut spheres = None;
        if !scene.spheres.is_empty() {
            let table = SphereTable::new(scene, space);
            let id = match precision {
                Precision::Fast => builder.attach_user_geometry::<FastSpheres>(&table)?,
                Precision::Certified => builder.attach_user_geometry::<CertifiedSphere>(&table)?,
            };
            spheres = Some((id, table));
        }
        let _meshes = scene.meshes.clone();
        let scene = builder.top.commit(device)?;
        Ok(Self {
            precision,
            space,
            scene,
            spheres,
            own_meshes,
            user_meshes,
            is_user_mesh,
            _meshes,
        })
    }

    /// The instance of each geometry of Embree's own; empty in precision `certified`.
    pub fn instance_of(&self) -> &[u32] {
        &self.own_meshes.instance_of
    }

    /// The number of geometries of spheres, and of instances whose meshes are in object space.
    pub fn stats(&self) -> BuildStats {
        BuildStats {
            sphere_geometries: u64::from(self.spheres.is_some()),
            object_space_instances: self.own_meshes.instance_count
                + self.user_meshes.instance_count(),
            ..BuildStats::default()
        }
    }

    /// True if it can be updated to a frame of the same things whose f32 space is `space`: the f32
    /// copies are the same, and of the same kind.
    fn can_update(&self, scene: &Scene, space: &F32Space) -> bool {
        self.space.has_same_coordinates(space)
            && self.is_user_mesh == are_user_meshes(scene, space, self.precision)
    }

    /// Moves what `diff` names to where another frame has it, as [`Tlas::can_update`] allows. If
    /// anything moved, the scene is committed again, which builds no mesh.
    ///
    /// # Errors
    /// When Embree runs out of memory; then it is of no further use.
    fn update(
        &mut self,
        scene: &Scene,
        space: F32Space,
        mesh_bounds: &[Bounds],
        diff: &FrameDiff,
    ) -> Result<()> {
        self.space = space;
        if let Some((id, table)) = &mut self.spheres {
            table.update(scene);
            if !diff.spheres.is_empty() {
                update_geometry(&mut self.scene, *id, &**table);
            }
        }
        let (top, moved) = (&mut self.scene, &diff.instances);
        if !moved.is_empty() {
            self.own_meshes.update(top, scene, &space, mesh_bounds, moved);
            self.user_meshes.update(top, scene, mesh_bounds, moved);
        }
        if *diff == FrameDiff::default() { Ok(()) } else { top.recommit() }
    }
}

/// Returns for each mesh whether it is user geometry: in precision `certified` all are.
fn are_user_meshes(scene: &Scene, space: &F32Space, precision: Precision) -> Vec<bool> {
    match precision {
        Precision::Fast => unresolved_meshes(scene, space),
        Precision::Certified => vec![true; scene.meshes.len()],
    }
}

/// The number of primitives below which one thread builds a tree in a few milliseconds.
const FEW_PRIMITIVES: u64 = 1 << 12;

/// Returns the device to build a scene on.
fn device_for(scene: &Scene, options: BuildOptions) -> Result<DeviceHandle> {
    // Waking threads takes longer than a small tree does.
    let is_small = scene.primitive_count() < FEW_PRIMITIVES;
    device::open(if is_small { 1 } else { options.threads }, options.width)
}

/// The device, BLASes and TLAS that frames share.
pub struct FrameCache {
    /// The box in which most of the animation lies, or an empty one.
    animation_bounds: Bounds,
    own_meshes: BlasCache<fast::Blas>,
    user_meshes: BlasCache<user_meshes::Blas>,
    /// The TLAS of the last frame.
    tlas: Option<Arc<Tlas>>,
    /// The number of TLASes that were built.
    tlas_count: u64,
    /// The device, dropped after what is built on it.
    device: Option<DeviceHandle>,
}

impl FrameCache {
    /// Makes an empty cache, for frames that lie mostly within `animation_bounds`.
    pub fn new(animation_bounds: Bounds) -> Self {
        Self {
            animation_bounds,
            own_meshes: BlasCache::default(),
            user_meshes: BlasCache::default(),
            tlas: None,
            tlas_count: 0,
            device: None,
        }
    }

    /// The numbers of meshes and TLASes that were built.
    pub fn stats(&self) -> BuildStats {
        let meshes_built = self.own_meshes.built() + self.user_meshes.built();
        BuildStats { meshes_built, tlas_built: self.tlas_count, ..BuildStats::default() }
    }

    /// Returns the TLAS of a scene: that of the frame before, updated, if only `diff` moved; and else a
    /// new one.
    ///
    /// # Errors
    /// When the library is not as expected, or runs out of memory.
    pub fn update_or_build(
        &mut self,
        scene: &Scene,
        options: BuildOptions,
        mesh_bounds: &[Bounds],
        diff: Option<&FrameDiff>,
    ) -> Result<Arc<Tlas>> {
        let space = F32Space::for_animation(scene.bounds_with(mesh_bounds), self.animation_bounds);
        // Taken, so that nothing half changed stays behind an error.
        let mut last = self.tlas.take();
        // An intersector that still traces the last frame holds it, too: then it must not change.
        if let (Some(tlas), Some(diff)) = (last.as_mut().and_then(Arc::get_mut), diff)
            && tlas.can_update(scene, &space)
        {
            tlas.update(scene, space, mesh_bounds, diff)?;
        } else {
            let device = match &self.device {
                Some(device) => device.clone(),
                None => self.device.insert(device_for(scene, options)?).clone(),
            };
            let builder =
                SceneBuilder::new(scene, mesh_bounds, &device, options.quality, space, true)?;
            last = Some(Tlas::from_builder(builder, options.precision, Some(self))?.into());
            self.tlas_count += 1;
        }
        self.tlas.clone_from(&last);
        last.ok_or_else(|| Error::failed("no Embree scene was built"))
    }
}
