//! The meshes of precision `certified`: user geometry, in world space or in spaces of their own.

use std::sync::Arc;

use crate::error::Result;
use crate::geometry::Bounds;
use crate::intersect::blas_cache::BlasCache;
use crate::intersect::embree::certified::callbacks;
use crate::intersect::embree::certified::instances::{self, Instances};
use crate::intersect::embree::certified::triangles::Triangles;
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::handles::{DeviceHandle, InnerScene};
use crate::intersect::embree::ffi::packet_width::PacketWidth;
use crate::intersect::embree::ffi::user_geometry;
use crate::intersect::embree::ffi::user_geometry::UserPrimitives;
use crate::intersect::embree::{attach, is_outsized, uses};
use crate::scene::{Instance, Mesh, Scene};
use embree4_sys::{RTCBuildQuality, RTCSceneFlags};

/// What Embree keeps the addresses of.
#[derive(Default)]
pub struct Meshes {
    #[expect(clippy::vec_box, reason = "Embree keeps their addresses")]
    tables: Vec<Box<Triangles>>,
    own: Vec<Arc<Blas>>,
    /// Which geometry they are, and what its callbacks read.
    placements: Option<(u32, Box<Instances>)>,
}

/// A mesh in a space of its own.
pub struct Blas {
    pub scene: InnerScene,
    /// Where its f32 copies live.
    pub frame: F32Space,
    /// Read by the callbacks; dropped after the scene that calls them.
    _table: Box<Triangles>,
}

impl Blas {
    fn new(
        scene: &Scene,
        mesh: u32,
        bounds: Bounds,
        device: &DeviceHandle,
        quality: RTCBuildQuality,
        width: PacketWidth,
    ) -> Result<Self> {
        let frame = F32Space::around(bounds);
        let table = Triangles::own(scene, mesh, frame);
        let callbacks = callbacks::triangles(width);
        let geometry = user_geometry::geometry(device, quality, &*table, callbacks)?;
        let scene = InnerScene::new(device, quality, RTCSceneFlags::NONE, &geometry)?;
        Ok(Self { scene, frame, _table: table })
    }
}

/// A mesh whose triangles are smaller than this share of the scene gets a space of its own: the
/// scene's padding would make its boxes overlap.
const SMALL: f64 = 1e-4;

impl Meshes {
    /// Attaches every instance: a mesh that stands once, and is not small, in world space, and so
    /// one that is outsized in its own; the others as placements. Where `all_instanced`, as for
    /// frames that share their meshes in `kept`, all are placements but the outsized ones. `local` are
    /// the boxes of the meshes.
    pub fn attach(
        &mut self,
        scene: &Scene,
        local: &[Bounds],
        top: &embree4_rs::Scene,
        device: &DeviceHandle,
        (frame, width, quality): (F32Space, PacketWidth, RTCBuildQuality),
        (all_instanced, mut kept): (bool, Option<&mut BlasCache<Blas>>),
    ) -> Result<()> {
        let uses = uses(scene);
        let world: Vec<Bounds> = (scene.instances.iter())
            .map(|instance| placed(&local[instance.mesh.0 as usize], instance))
            .collect();
        let mut has_own = vec![false; scene.meshes.len()];
        for (instance, bounds) in scene.instances.iter().zip(&world) {
            let at = instance.mesh.0 as usize;
            let mesh = &scene.meshes[at];
            let once = !all_instanced && uses[at] == 1 && !is_small(mesh, bounds, &frame);
            has_own[at] = !(mesh.triangles.is_empty() || once || is_outsized(&local[at]));
        }
        let make = |at: usize| Blas::new(scene, at as u32, local[at], device, quality, width);
        let own = BlasCache::all(kept.as_deref_mut(), scene, &has_own, make)?;
        let mut placements = Box::new(Instances::new(frame));
        for ((index, instance), bounds) in (0..).zip(&scene.instances).zip(world) {
            let at = instance.mesh.0 as usize;
            if let Some(own) = &own[at] {
                placements.add(scene, index, bounds, &own.scene, own.frame);
            } else if !scene.meshes[at].triangles.is_empty() {
                let table = Triangles::placed(scene, index, frame);
                let callbacks = callbacks::triangles(width);
                attach(top, &user_geometry::geometry(device, quality, &*table, callbacks)?)?;
                self.tables.push(table);
                kept.iter_mut().for_each(|kept| kept.count_one());
            }
        }
        self.own = own.into_iter().flatten().collect();
        if !placements.is_empty() {
            let callbacks = instances::callbacks(width);
            let geometry = user_geometry::geometry(device, quality, &*placements, callbacks)?;
            self.placements = Some((attach(top, &geometry)?, placements));
        }
        Ok(())
    }

    /// How many instances are placements.
    pub fn instanced(&self) -> u64 {
        self.placements.as_ref().map_or(0, |(_, placements)| placements.len() as u64)
    }

    /// Places again the instances that `moved`, of which none is outsized.
    pub fn follow(
        &mut self,
        scene: &Scene,
        top: &embree4_rs::Scene,
        boxes: &[Bounds],
        moved: &[u32],
    ) {
        let Some((id, placements)) = &mut self.placements else { return };
        for &index in moved {
            let instance = &scene.instances[index as usize];
            let bounds = placed(&boxes[instance.mesh.0 as usize], instance);
            placements.replace(instance, index, bounds);
        }
        user_geometry::moved(top, *id, &**placements);
    }
}

/// The box in the world of an instance of a mesh with this box.
fn placed(mesh: &Bounds, instance: &Instance) -> Bounds {
    let bounds = mesh.transformed(&instance.transform);
    // A baked vertex may round to just outside the transformed box.
    bounds.padded(16.0 * f64::EPSILON * bounds.max_abs())
}

/// Whether a mesh that takes up `bounds` in the world has small triangles for the scene.
fn is_small(mesh: &Mesh, bounds: &Bounds, frame: &F32Space) -> bool {
    let across = (mesh.triangles.len() as f64).sqrt();
    bounds.diagonal() < SMALL * frame.extent * across && bounds.diagonal() < 0.25 * frame.extent
}
