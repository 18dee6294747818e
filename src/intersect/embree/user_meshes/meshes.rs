//! The meshes as user geometry, in world space or in object space.

use crate::error::Result;
use crate::geometry::Bounds;
use crate::intersect::blas_cache::BlasCache;
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::{
    CommittedScene, PrimitiveTable, UserPrimitives, update_geometry,
};
use crate::intersect::embree::scene_builder::SceneBuilder;
use crate::intersect::embree::user_meshes::instances::{Blas, InstanceTable};
use crate::intersect::embree::user_meshes::triangle_table::TriangleTable;
use crate::intersect::object_space::world_bounds;
use crate::scene::{Mesh, Scene};

/// The user data of the meshes' geometries, whose addresses Embree keeps.
#[derive(Default)]
pub struct UserMeshes {
    #[expect(clippy::vec_box, reason = "Embree keeps their addresses")]
    triangles: Vec<Box<TriangleTable>>,
    /// The geometry of the instances, and their table.
    instances: Option<(u32, Box<InstanceTable>)>,
}

/// The share of the scene below which the triangles of a mesh are small: the scene's padding would
/// make their boxes overlap.
const SMALL: f64 = 1e-4;

impl UserMeshes {
    /// Attaches every instance of the meshes that are `included`, with triangles that are tested as `P`:
    /// the mesh of a single instance in world space, unless it is small; and the others in object
    /// space. Where the builder says that all are instanced, all are in object space.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub fn attach<P>(
        builder: &SceneBuilder<'_>,
        mut cache: Option<&mut BlasCache<Blas>>,
        included: &[bool],
    ) -> Result<Self>
    where
        P: UserPrimitives<Table = TriangleTable>,
    {
        let SceneBuilder { scene, mesh_bounds, space, .. } = *builder;
        let is_visible = |mesh: usize| included[mesh] && !scene.meshes[mesh].triangles.is_empty();
        // Decide which meshes have a BLAS.
        let instance_counts = builder.instance_counts();
        let bounds: Vec<Bounds> = scene
            .instances
            .iter()
            .map(|i| world_bounds(i, &mesh_bounds[i.mesh.0 as usize]))
            .collect();
        let mut has_blas = vec![false; scene.meshes.len()];
        for (instance, bounds) in scene.instances.iter().zip(&bounds) {
            let index = instance.mesh.0 as usize;
            let mesh = &scene.meshes[index];
            let in_world_space = !builder.all_instanced
                && instance_counts[index] == 1
                && !is_small(mesh, bounds, &space);
            has_blas[index] = is_visible(index) && !in_world_space;
        }
        // Build those, and attach the meshes that have none.
        let build = |mesh| Blas::new::<P>(builder, mesh);
        let blas = BlasCache::get_or_build(cache.as_deref_mut(), scene, &has_blas, build)?;
        let mut meshes = Self::default();
        let mut instances = Box::new(InstanceTable::new(space));
        for ((index, instance), bounds) in (0..).zip(&scene.instances).zip(bounds) {
            let mesh = instance.mesh.0 as usize;
            if let Some(blas) = &blas[mesh] {
                instances.push(index, instance, bounds, blas.clone());
            } else if is_visible(mesh) {
                let table = TriangleTable::in_world_space(scene, index, space);
                builder.attach_user_geometry::<P>(&table)?;
                meshes.triangles.push(table);
                cache.iter_mut().for_each(|cache| cache.count_uncached());
            }
        }
        // Attach the instances as one geometry.
        if !instances.is_empty() {
            let id = builder.attach_user_geometry::<InstanceTable>(&instances)?;
            meshes.instances = Some((id, instances));
        }
        Ok(meshes)
    }

    /// The number of instances in object space.
    pub fn instance_count(&self) -> u64 {
        self.instances.as_ref().map_or(0, |(_, instances)| instances.len() as u64)
    }

    /// Moves the instances with the indices `moved`.
    pub fn update(
        &mut self,
        top: &mut CommittedScene,
        scene: &Scene,
        mesh_bounds: &[Bounds],
        moved: &[u32],
    ) {
        let Some((id, instances)) = &mut self.instances else { return };
        for &index in moved {
            let instance = &scene.instances[index as usize];
            instances.update(
                index,
                instance,
                world_bounds(instance, &mesh_bounds[instance.mesh.0 as usize]),
            );
        }
        update_geometry(top, *id, &**instances);
    }
}

/// True if a mesh whose box in world space is `bounds` has small triangles for the scene.
fn is_small(mesh: &Mesh, bounds: &Bounds, space: &F32Space) -> bool {
    let across = (mesh.triangles.len() as f64).sqrt();
    bounds.diagonal() < SMALL * space.extent * across && bounds.diagonal() < 0.25 * space.extent
}
