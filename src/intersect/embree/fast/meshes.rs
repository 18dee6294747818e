//! The meshes of precision `fast`: Embree's own triangles and instances.

use std::sync::Arc;

use embree4_rs::geometry::Geometry;
use embree4_sys::RTCBuildQuality;
use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::Bounds;
use crate::intersect::blas_cache::BlasCache;
use crate::intersect::embree::f32_space::F32Space;
use crate::intersect::embree::ffi::handles::{
    DeviceHandle, InnerScene, InstanceGeometry, move_instance,
};
use crate::intersect::embree::ffi::mesh_geometry::MeshGeometry;
use crate::intersect::embree::{attach, flags, is_outsized, uses};
use crate::scene::{Instance, Mesh, Scene};

/// A mesh in a space of its own, recentred: a model may stand far from its own origin.
pub struct Blas {
    scene: InnerScene,
    center: DVec3,
    /// Whose indices Embree reads; dropped after the scene.
    _mesh: Arc<Mesh>,
}

impl Blas {
    fn new(
        mesh: &Arc<Mesh>,
        bounds: &Bounds,
        device: &DeviceHandle,
        quality: RTCBuildQuality,
    ) -> Result<Self> {
        let center = bounds.center();
        let local = |p: [f32; 3]| (DVec3::from(p.map(f64::from)) - center).as_vec3().to_array();
        let geometry = MeshGeometry::new(device, mesh, quality, local)?;
        let scene = InnerScene::new(device, quality, flags(), &geometry)?;
        Ok(Self { scene, center, _mesh: mesh.clone() })
    }
}

/// Attaches every instance: a mesh that stands once as its own triangles in world space, one that
/// stands several times through Embree's instances, unless it is outsized in its own space. Where
/// `all_instanced`, as for frames that share their meshes in `kept`, all stand through instances but
/// the outsized ones. Says which instance each geometry is, and how many are Embree's instances.
/// `bounds` are those of the meshes, which Embree goes on reading.
pub fn attach_meshes(
    scene: &Scene,
    bounds: &[Bounds],
    top: &embree4_rs::Scene,
    device: &DeviceHandle,
    quality: RTCBuildQuality,
    frame: &F32Space,
    (all_instanced, mut kept): (bool, Option<&mut BlasCache<Blas>>),
) -> Result<(Vec<u32>, u64)> {
    let uses = uses(scene);
    let in_world = |at: usize| (uses[at] == 1 && !all_instanced) || is_outsized(&bounds[at]);
    let is_there = |at: usize| uses[at] > 0 && !scene.meshes[at].triangles.is_empty();
    let has_own: Vec<bool> = (0..uses.len()).map(|at| is_there(at) && !in_world(at)).collect();
    let make = |at: usize| Blas::new(&scene.meshes[at], &bounds[at], device, quality);
    let own = BlasCache::all(kept.as_deref_mut(), scene, &has_own, make)?;

    let standing: Vec<_> = (0..)
        .zip(&scene.instances)
        .filter(|(_, instance)| is_there(instance.mesh.0 as usize))
        .collect();
    let geometry = |&(_, instance): &(u32, &Instance)| -> Result<Box<dyn Geometry + Send>> {
        let at = instance.mesh.0 as usize;
        Ok(match &own[at] {
            Some(own) => {
                let columns = columns(instance, own.center, frame);
                Box::new(InstanceGeometry::new(device, &own.scene, &columns)?)
            }
            None => Box::new(MeshGeometry::new(device, &scene.meshes[at], quality, |p| {
                frame.point(instance.to_world(p))
            })?),
        })
    };
    let geometries: Vec<_> = standing.par_iter().map(geometry).collect::<Result<_>>()?;
    geometries.iter().try_for_each(|geometry| attach(top, &**geometry).map(|_| ()))?;
    if let Some(kept) = kept {
        let outsized = standing.iter().filter(|(_, i)| own[i.mesh.0 as usize].is_none());
        outsized.for_each(|_| kept.count_one());
    }
    let instanced =
        standing.iter().filter(|(_, i)| own[i.mesh.0 as usize].is_some()).count() as u64;
    Ok((standing.iter().map(|&(index, _)| index).collect(), instanced))
}

/// Places again the instances that `moved`, of which none is outsized.
pub fn follow(
    scene: &Scene,
    top: &embree4_rs::Scene,
    frame: &F32Space,
    boxes: &[Bounds],
    instance_of: &[u32],
    moved: &[u32],
) {
    for index in moved {
        // What has no triangles is nowhere.
        let Ok(id) = instance_of.binary_search(index) else { continue };
        let instance = &scene.instances[*index as usize];
        let center = boxes[instance.mesh.0 as usize].center();
        move_instance(top, id as u32, &columns(instance, center, frame));
    }
}

/// The matrix from the mesh's space, recentred on `center`, to the recentred world.
fn columns(instance: &Instance, center: DVec3, frame: &F32Space) -> [[f32; 3]; 4] {
    let m = DAffine3::from_translation(-frame.center)
        * instance.transform
        * DAffine3::from_translation(center);
    [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis, m.translation]
        .map(|column| column.as_vec3().to_array())
}
