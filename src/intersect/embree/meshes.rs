//! The meshes of precision `certified`: user geometry, in world space or in spaces of their own.

use std::sync::Arc;

use crate::error::Result;
use crate::geometry::Bounds;
use crate::intersect::embree::frame::Frame;
use crate::intersect::embree::placements::{self, Placements};
use crate::intersect::embree::raw::{DeviceHandle, InnerScene};
use crate::intersect::embree::triangles::Triangles;
use crate::intersect::embree::user::Table;
use crate::intersect::embree::width::Width;
use crate::intersect::embree::{QUALITY, attach, certified, is_outsized, user, uses};
use crate::intersect::kept::Kept;
use crate::scene::{Instance, Mesh, Scene};
use embree4_sys::RTCSceneFlags;

/// What Embree keeps the addresses of.
#[derive(Default)]
pub struct Meshes {
    #[expect(clippy::vec_box, reason = "Embree keeps their addresses")]
    tables: Vec<Box<Triangles>>,
    own: Vec<Arc<Own>>,
    /// Which geometry they are, and what its callbacks read.
    placements: Option<(u32, Box<Placements>)>,
}

/// A mesh in a space of its own.
pub struct Own {
    pub scene: InnerScene,
    /// Where its f32 copies live.
    pub frame: Frame,
    /// Read by the callbacks; dropped after the scene that calls them.
    _table: Box<Triangles>,
}

impl Own {
    fn new(
        scene: &Scene,
        mesh: u32,
        bounds: Bounds,
        top: &embree4_rs::Scene,
        device: &DeviceHandle,
        width: Width,
    ) -> Result<Self> {
        let frame = Frame::around(bounds);
        let table = Triangles::own(scene, mesh, frame);
        let callbacks = certified::triangles(width);
        let geometry = user::geometry(&top.device, device, &*table, callbacks)?;
        let scene = InnerScene::new(device, QUALITY, RTCSceneFlags::NONE, &geometry)?;
        Ok(Self { scene, frame, _table: table })
    }
}

/// A mesh whose triangles are smaller than this share of the scene gets a space of its own: the
/// scene's padding would make its boxes overlap.
const SMALL: f64 = 1e-4;

impl Meshes {
    /// Attaches every instance: a mesh that stands once, and is not small, in world space, and so
    /// one that is outsized in its own; the others as placements. Where `all_instanced`, as for
    /// frames that share their meshes in `kept`, all are placements but the outsized ones.
    pub fn attach(
        &mut self,
        scene: &Scene,
        top: &embree4_rs::Scene,
        device: &DeviceHandle,
        (frame, width): (Frame, Width),
        boxes: &[Bounds],
        (all_instanced, mut kept): (bool, Option<&mut Kept<Own>>),
    ) -> Result<()> {
        let uses = uses(scene);
        let mut own: Vec<Option<Arc<Own>>> = vec![None; scene.meshes.len()];
        let mut placements = Box::new(Placements::new(frame));
        for (index, instance) in (0..).zip(&scene.instances) {
            let at = instance.mesh.0 as usize;
            let mesh = &scene.meshes[at];
            if mesh.triangles.is_empty() {
                continue;
            }
            let local = boxes[at];
            let bounds = placed(&local, instance);
            let once = !all_instanced && uses[at] == 1 && !is_small(mesh, &bounds, &frame);
            if once || is_outsized(&local) {
                let table = Triangles::placed(scene, index, frame);
                let callbacks = certified::triangles(width);
                attach(top, &user::geometry(&top.device, device, &*table, callbacks)?)?;
                self.tables.push(table);
                kept.iter_mut().for_each(|kept| kept.count_one());
                continue;
            }
            let own = match &own[at] {
                Some(there) => there,
                None => {
                    let make = || Own::new(scene, at as u32, local, top, device, width);
                    let made = Kept::get_or(&mut kept, at, mesh, make)?;
                    self.own.push(made.clone());
                    own[at].insert(made)
                }
            };
            placements.add(scene, index, bounds, &own.scene, own.frame);
        }
        if !placements.is_empty() {
            let callbacks = placements::callbacks(width);
            let geometry = user::geometry(&top.device, device, &*placements, callbacks)?;
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
        user::moved(top, *id, &**placements);
    }
}

/// The box in the world of an instance of a mesh with this box.
fn placed(mesh: &Bounds, instance: &Instance) -> Bounds {
    let bounds = mesh.transformed(&instance.transform);
    // A baked vertex may round to just outside the transformed box.
    bounds.padded(16.0 * f64::EPSILON * bounds.max_abs())
}

/// Whether a mesh that takes up `bounds` in the world has small triangles for the scene.
fn is_small(mesh: &Mesh, bounds: &Bounds, frame: &Frame) -> bool {
    let across = (mesh.triangles.len() as f64).sqrt();
    bounds.diagonal() < SMALL * frame.extent * across && bounds.diagonal() < 0.25 * frame.extent
}
