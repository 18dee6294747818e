//! The triangles of a mesh as the user data of a geometry.

use std::sync::Arc;

use crate::geometry::{Bounds, PrimitiveId};
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::PrimitiveTable;
use crate::intersect::embree::packet::QueryContext;
use crate::scene::{Instance, Mesh, Scene};

/// The triangles of a mesh as user data. The vertices themselves are baked from the scene when a
/// triangle is tested.
pub struct TriangleTable {
    mesh: Arc<Mesh>,
    mesh_index: u32,
    /// The instance that lies in world space and its index, or none for a mesh in object space, whose
    /// instance is in the query context.
    instance: Option<(u32, Instance)>,
    space: F32Space,
}

impl TriangleTable {
    /// Makes the table of an instance, in world space; on the heap since Embree keeps its address.
    pub fn in_world_space(scene: &Scene, index: u32, space: F32Space) -> Box<Self> {
        let instance = scene.instances[index as usize].clone();
        let table = Self::in_object_space(scene, instance.mesh.0, space);
        Box::new(Self { instance: Some((index, instance)), ..*table })
    }

    /// Makes the table of a mesh, in object space; on the heap since Embree keeps its address.
    pub fn in_object_space(scene: &Scene, mesh_index: u32, space: F32Space) -> Box<Self> {
        let mesh = scene.meshes[mesh_index as usize].clone();
        Box::new(Self { mesh, mesh_index, instance: None, space })
    }

    /// The id of the triangle with this index.
    #[inline(always)]
    pub fn id<const W: usize>(&self, index: u32, context: &QueryContext<'_, W>) -> PrimitiveId {
        let instance = self.instance.as_ref().map_or(context.instance, |(index, _)| *index);
        PrimitiveId::triangle(self.mesh_index, index, instance)
    }
}

impl PrimitiveTable for TriangleTable {
    fn len(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn bounds(&self, index: u32) -> (Bounds, &F32Space) {
        let vertices = self.mesh.triangle_vertices(index);
        let vertices = match &self.instance {
            Some((_, instance)) => vertices.map(|p| instance.to_world(p)),
            None => vertices,
        };
        (Bounds::from_points(vertices), &self.space)
    }
}
