//! The meshes of precision `fast`: Embree's own triangles and instances.

use std::sync::Arc;

use glam::DAffine3;
use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::Bounds;
use crate::intersect::blas_cache::BlasCache;
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::{CommittedScene, OwnedGeometry, new_mesh_geometry};
use crate::intersect::embree::scene_builder::{SCENE_FLAGS, SceneBuilder};
use crate::scene::{Instance, Mesh, Scene};

/// The BLAS of a mesh, in object space, recentred and scaled: a model may lie far from its own origin,
/// and be of any size.
pub struct Blas {
    scene: CommittedScene,
    /// The space of its f32 vertices.
    space: F32Space,
    /// The mesh whose indices Embree reads; dropped after the scene.
    _mesh: Arc<Mesh>,
}

impl Blas {
    fn new(builder: &SceneBuilder<'_>, mesh: usize) -> Result<Self> {
        let SceneBuilder { device, quality, .. } = builder;
        let space = F32Space::from_bounds(builder.mesh_bounds[mesh]);
        let mesh = &builder.scene.meshes[mesh];
        let geometry = new_mesh_geometry(device, mesh, *quality, |p| space.point(p))?;
        let scene = CommittedScene::new(device, *quality, SCENE_FLAGS, &geometry)?;
        Ok(Self { scene, space, _mesh: mesh.clone() })
    }
}

/// The geometries of the meshes.
pub struct Meshes {
    /// The instance of each geometry; ascending.
    pub instance_of: Vec<u32>,
    /// The number of instances in object space.
    pub instance_count: u64,
}

impl Meshes {
    /// Attaches every instance of the meshes that are `included`: the mesh of a single instance as
    /// triangles in world space, and the others as instances. Where the builder says that all are
    /// instanced, all are. Embree goes on reading the meshes.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub fn attach(
        builder: &SceneBuilder<'_>,
        mut cache: Option<&mut BlasCache<Blas>>,
        included: &[bool],
    ) -> Result<Self> {
        let SceneBuilder { scene, device, quality, space, .. } = *builder;
        // Build the BLAS of each mesh that has one.
        let counts = builder.instance_counts();
        let is_visible = |mesh: usize| {
            included[mesh] && counts[mesh] > 0 && !scene.meshes[mesh].triangles.is_empty()
        };
        let in_world_space = |mesh: usize| counts[mesh] == 1 && !builder.all_instanced;
        let has_blas: Vec<bool> =
            (0..counts.len()).map(|mesh| is_visible(mesh) && !in_world_space(mesh)).collect();
        let build = |mesh| Blas::new(builder, mesh);
        let blas = BlasCache::get_or_build(cache.as_deref_mut(), scene, &has_blas, build)?;
        // Make the geometries of all instances, several at a time.
        let instances: Vec<(u32, &Instance)> = (0..)
            .zip(&scene.instances)
            .filter(|(_, instance)| is_visible(instance.mesh.0 as usize))
            .collect();
        let geometry = |&(_, instance): &(u32, &Instance)| {
            let mesh = instance.mesh.0 as usize;
            if let Some(blas) = &blas[mesh] {
                let columns = object_to_f32_space(instance, &blas.space, &space);
                OwnedGeometry::instance(device, &blas.scene, &columns)
            } else {
                let to_f32_space = |p| space.point(instance.to_world(p));
                new_mesh_geometry(device, &scene.meshes[mesh], quality, to_f32_space)
            }
        };
        let geometries: Vec<_> = instances.par_iter().map(geometry).collect::<Result<_>>()?;
        // Attach them in order.
        geometries.iter().try_for_each(|geometry| builder.top.attach(geometry).map(|_| ()))?;
        let in_object_space = instances.iter().filter(|(_, i)| blas[i.mesh.0 as usize].is_some());
        let instance_count = in_object_space.count() as u64;
        if let Some(cache) = cache {
            (instance_count..instances.len() as u64).for_each(|_| cache.count_uncached());
        }
        let instance_of = instances.iter().map(|&(index, _)| index).collect();
        Ok(Self { instance_of, instance_count })
    }

    /// Moves the instances with the indices `moved`.
    pub fn update(
        &self,
        top: &mut CommittedScene,
        scene: &Scene,
        space: &F32Space,
        mesh_bounds: &[Bounds],
        moved: &[u32],
    ) {
        for index in moved {
            // A mesh without triangles has no geometry.
            let Ok(id) = self.instance_of.binary_search(index) else { continue };
            let instance = &scene.instances[*index as usize];
            let blas_space = F32Space::from_bounds(mesh_bounds[instance.mesh.0 as usize]);
            let columns = object_to_f32_space(instance, &blas_space, space);
            top.set_instance_transform(id as u32, &columns);
        }
    }
}

/// The columns of the matrix from the f32 space of a mesh's BLAS to that of the scene.
fn object_to_f32_space(
    instance: &Instance,
    blas_space: &F32Space,
    space: &F32Space,
) -> [[f32; 3]; 4] {
    let m = DAffine3::from_translation(-space.center)
        * instance.transform
        * DAffine3::from_translation(blas_space.center);
    let [x, y, z] = [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis]
        .map(|axis| axis * (space.scale / blas_space.scale));
    [x, y, z, m.translation * space.scale].map(|column| column.as_vec3().to_array())
}
