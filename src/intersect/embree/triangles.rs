//! The triangles of a mesh as user geometry.

use glam::DVec3;

use crate::geometry::{Bounds, PrimitiveId};
use crate::intersect::embree::frame::Frame;
use crate::intersect::embree::layout::INVALID;
use crate::intersect::embree::user::Table;
use crate::scene::Scene;

/// What the callbacks need of a mesh. The corners themselves are baked from the scene when a
/// triangle is tested.
pub struct Triangles<'s> {
    scene: &'s Scene,
    pub mesh: u32,
    /// The instance that stands in world space, or `INVALID` for a mesh in its own space, of
    /// which the context tells the instance.
    pub instance: u32,
    frame: Frame,
}

impl<'s> Triangles<'s> {
    /// The triangles of `instance`, in world space. On the heap, since Embree keeps its address.
    pub fn placed(scene: &'s Scene, instance: u32, frame: Frame) -> Box<Self> {
        let mesh = scene.instances[instance as usize].mesh.0;
        Box::new(Self { scene, mesh, instance, frame })
    }

    /// The triangles of a mesh, in its own space.
    pub fn own(scene: &'s Scene, mesh: u32, frame: Frame) -> Box<Self> {
        Box::new(Self { scene, mesh, instance: INVALID, frame })
    }
}

impl Table for Triangles<'_> {
    fn len(&self) -> usize {
        self.scene.meshes[self.mesh as usize].triangles.len()
    }

    fn bounds(&self, index: u32) -> (Bounds, &Frame) {
        let bounds = if self.instance == INVALID {
            let corners = self.scene.meshes[self.mesh as usize].corners(index);
            Bounds::of(corners.map(|p| DVec3::from(p.map(f64::from))))
        } else {
            let id = PrimitiveId::triangle(self.mesh, index, self.instance);
            Bounds::of(self.scene.triangle(id))
        };
        (bounds, &self.frame)
    }
}
