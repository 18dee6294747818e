//! The meshes of precision `fast`: Embree's own triangles and instances.

use std::sync::Arc;

use embree4_rs::Device;
use embree4_rs::geometry::TriangleMeshGeometry;
use glam::{DAffine3, DVec3};

use crate::error::{Error, Result};
use crate::geometry::Bounds;
use crate::intersect::embree::frame::Frame;
use crate::intersect::embree::raw::{DeviceHandle, InnerScene, InstanceGeometry, move_instance};
use crate::intersect::embree::{QUALITY, attach, flags, is_outsized, uses};
use crate::intersect::kept::Kept;
use crate::scene::{Instance, Mesh, Scene};

/// A mesh in a space of its own, recentred: a model may stand far from its own origin.
pub struct Own {
    scene: InnerScene,
    center: DVec3,
}

impl Own {
    fn new(mesh: &Mesh, bounds: &Bounds, device: &Device, handle: &DeviceHandle) -> Result<Self> {
        let center = bounds.center();
        let local = |p: [f32; 3]| (DVec3::from(p.map(f64::from)) - center).as_vec3();
        let geometry = upload(device, mesh, |p| local(p).to_array())?;
        Ok(Self { scene: InnerScene::new(handle, QUALITY, flags(), &geometry)?, center })
    }
}

/// Attaches every instance: a mesh that stands once as its own triangles in world space, one that
/// stands several times through Embree's instances, unless it is outsized in its own space. Where
/// `all_instanced`, as for frames that share their meshes in `kept`, all stand through instances but
/// the outsized ones. Says which instance each geometry is, and how many are Embree's instances.
pub fn attach_meshes(
    scene: &Scene,
    top: &embree4_rs::Scene,
    device: &DeviceHandle,
    frame: &Frame,
    boxes: &[Bounds],
    (all_instanced, mut kept): (bool, Option<&mut Kept<Own>>),
) -> Result<(Vec<u32>, u64)> {
    let uses = uses(scene);
    let mut own: Vec<Option<Arc<Own>>> = scene.meshes.iter().map(|_| None).collect();
    let (mut instance_of, mut instanced) = (Vec::new(), 0);
    for (index, instance) in scene.instances.iter().enumerate() {
        let at = instance.mesh.0 as usize;
        let mesh = &scene.meshes[at];
        if mesh.triangles.is_empty() {
            continue;
        }
        if (uses[at] == 1 && !all_instanced) || is_outsized(&boxes[at]) {
            let geometry = upload(&top.device, mesh, |p| frame.point(instance.bake(p)))?;
            attach(top, &geometry)?;
            kept.iter_mut().for_each(|kept| kept.count_one());
        } else {
            let own = match &own[at] {
                Some(there) => there,
                None => {
                    let make = || Own::new(mesh, &boxes[at], &top.device, device);
                    let made = Kept::get_or(&mut kept, at, mesh, make)?;
                    own[at].insert(made)
                }
            };
            let columns = columns(instance, own.center, frame);
            attach(top, &InstanceGeometry::new(device, &own.scene, &columns)?)?;
            instanced += 1;
        }
        instance_of.push(index as u32);
    }
    Ok((instance_of, instanced))
}

/// Places again the instances that `moved`, of which none is outsized.
pub fn follow(
    scene: &Scene,
    top: &embree4_rs::Scene,
    frame: &Frame,
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

fn upload(
    device: &Device,
    mesh: &Mesh,
    place: impl Fn([f32; 3]) -> [f32; 3],
) -> Result<TriangleMeshGeometry> {
    let vertices: Vec<(f32, f32, f32)> = mesh.positions.iter().map(|&p| place(p).into()).collect();
    let triangles: Vec<(u32, u32, u32)> = mesh.triangles.iter().map(|&t| t.into()).collect();
    TriangleMeshGeometry::try_new(device, &vertices, &triangles)
        .map_err(|e| Error::failed(format!("Embree cannot take mesh `{}`: {e}", mesh.name)))
}

/// The matrix from the mesh's space, recentred on `center`, to the recentred world.
fn columns(instance: &Instance, center: DVec3, frame: &Frame) -> [[f32; 3]; 4] {
    let m = DAffine3::from_translation(-frame.center)
        * instance.transform
        * DAffine3::from_translation(center);
    [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis, m.translation]
        .map(|column| column.as_vec3().to_array())
}
