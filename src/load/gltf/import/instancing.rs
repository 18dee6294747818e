//! EXT_mesh_gpu_instancing: several instances of the mesh of one node.

use glam::{DAffine3, DQuat};
use gltf::json::Value;

use super::nodes::SceneNode;
use super::vectors::{unit_quaternion, vector};
use crate::error::Result;
use crate::load::diagnostics::Diagnostics;
use crate::load::gltf::accessor::Accessors;
use crate::load::gltf::json::{as_index, at_path, error_at};
use crate::load::limits::Limit;

/// Returns the transforms of the instances of a node's mesh, in the node's space: one that changes
/// nothing if the node does not use the extension.
///
/// # Errors
/// When the extension's accessors cannot be read, or are not equally long.
pub fn transforms(
    node: &SceneNode,
    accessors: &Accessors,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<DAffine3>> {
    let extensions = node.node.extensions.as_ref();
    let Some(extension) = extensions.and_then(|e| e.others.get("EXT_mesh_gpu_instancing")) else {
        return Ok(vec![DAffine3::IDENTITY]);
    };
    let path = format!("nodes[{}].extensions.EXT_mesh_gpu_instancing.attributes", node.index);
    let path_of = |name: &str| format!("{path}.{name}");
    let attributes = extension.get("attributes").and_then(Value::as_object);

    // All attributes, also unknown ones, must have as many values as there are instances.
    let mut count = None;
    for (name, value) in attributes.into_iter().flatten() {
        let accessor = as_index(value)
            .ok_or_else(|| error_at(path_of(name), format!("{value} is no accessor")))?;
        let found = accessors.count(accessor);
        // The number of instances is limited before any of them is read.
        accessors.buffers.sandbox.check(Limit::Instances, found).map_err(at_path(path_of(name)))?;
        if *count.get_or_insert(found) != found {
            let message = format!("{found} values, where others have another number");
            return Err(error_at(path_of(name), message));
        }
    }
    let count = count.unwrap_or(0) as usize;

    // Their values, or the defaults.
    let accessor = |name: &str| attributes?.get(name).and_then(as_index);
    let vectors = |name: &str, default: f32| match accessor(name) {
        Some(index) => accessors.floats::<3>(index, &path_of(name)),
        None => Ok(vec![[default; 3]; count]),
    };
    let (translations, scales) = (vectors("TRANSLATION", 0.0)?, vectors("SCALE", 1.0)?);
    let rotations = match accessor("ROTATION") {
        Some(index) => accessors.floats::<4>(index, &path_of("ROTATION"))?,
        None => vec![[0.0, 0.0, 0.0, 1.0]; count],
    };

    // The transforms, without those that are not finite.
    let parts = translations.into_iter().zip(rotations).zip(scales);
    let transforms = parts.map(|((translation, rotation), scale)| {
        let rotation = unit_quaternion(rotation.map(f64::from)).unwrap_or(DQuat::IDENTITY);
        DAffine3::from_scale_rotation_translation(vector(scale), rotation, vector(translation))
    });
    let mut transforms: Vec<DAffine3> = transforms.collect();
    let before = transforms.len();
    transforms.retain(DAffine3::is_finite);
    let dropped = (before - transforms.len()) as u64;
    let reason = "{} instances of a node are left out: a number is not finite";
    diagnostics.add(reason, dropped, || path);
    Ok(transforms)
}
