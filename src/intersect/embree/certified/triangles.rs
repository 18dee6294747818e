//! The triangles of a mesh as user geometry.

use std::sync::Arc;

use glam::DVec3;

use crate::geometry::Bounds;
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::records::INVALID;
use crate::intersect::embree::ffi::user_geometry::UserPrimitives;
use crate::scene::{Instance, Mesh, Scene};

/// What the callbacks need of a mesh. The corners themselves are baked from the scene when a
/// triangle is tested.
pub struct Triangles {
    triangles: Arc<Mesh>,
    pub mesh: u32,
    /// The instance that stands in world space, or `INVALID` for a mesh in its own space, of
    /// which the context tells the instance.
    pub instance: u32,
    /// The same instance itself.
    placed: Option<Instance>,
    frame: F32Space,
}

impl Triangles {
    /// The triangles of `instance`, in world space. On the heap, since Embree keeps its address.
    pub fn placed(scene: &Scene, instance: u32, frame: F32Space) -> Box<Self> {
        let placed = scene.instances[instance as usize].clone();
        let mesh = placed.mesh.0;
        let triangles = scene.meshes[mesh as usize].clone();
        Box::new(Self { triangles, mesh, instance, placed: Some(placed), frame })
    }

    /// The triangles of a mesh, in its own space.
    pub fn own(scene: &Scene, mesh: u32, frame: F32Space) -> Box<Self> {
        let triangles = scene.meshes[mesh as usize].clone();
        Box::new(Self { triangles, mesh, instance: INVALID, placed: None, frame })
    }
}

impl UserPrimitives for Triangles {
    fn len(&self) -> usize {
        self.triangles.triangles.len()
    }

    fn bounds(&self, index: u32) -> (Bounds, &F32Space) {
        let corners = self.triangles.triangle_vertices(index);
        let corners = match &self.placed {
            Some(instance) => corners.map(|p| instance.to_world(p)),
            None => corners.map(|p| DVec3::from(p.map(f64::from))),
        };
        (Bounds::from_points(corners), &self.frame)
    }
}
