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

/// An instance of a node's mesh.
#[derive(Clone, Copy)]
pub struct MeshInstance {
    /// The transform from the mesh's space to the node's.
    pub transform: DAffine3,
    /// The colour and alpha that multiply the base colour of the material.
    pub color: [f32; 4],
}

impl MeshInstance {
    /// The instance of a node that has one: in the node's own space, in the material's own colour.
    pub const PLAIN: Self = Self { transform: DAffine3::IDENTITY, color: [1.0; 4] };
}

/// Returns the instances of a node's mesh: a plain one if the node does not use the extension.
///
/// # Errors
/// When the extension's accessors cannot be read, or are not equally long.
pub fn instances(
    node: &SceneNode,
    accessors: &Accessors,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<MeshInstance>> {
    let extensions = node.node.extensions.as_ref();
    let Some(extension) = extensions.and_then(|e| e.others.get("EXT_mesh_gpu_instancing")) else {
        return Ok(vec![MeshInstance::PLAIN]);
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

    // Colours, under the name of a custom attribute or of a vertex attribute.
    let named = ["_COLOR_0", "COLOR_0"].into_iter().find_map(|name| Some((name, accessor(name)?)));
    let mut colors = match named {
        Some((name, index)) if accessors.width(index) == 3 => {
            let colors = accessors.normalized_floats::<3>(index, &path_of(name))?;
            colors.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect()
        }
        Some((name, index)) => accessors.normalized_floats::<4>(index, &path_of(name))?,
        None => vec![[1.0; 4]; count],
    };
    let is_bad = |x: &&mut f32| !(x.is_finite() && **x >= 0.0);
    let bad = colors.as_flattened_mut().iter_mut().filter(is_bad).map(|x| *x = 0.0).count();
    let reason = "{} colours of instances are negative or not finite and become 0";
    diagnostics.add(reason, bad as u64, || path.clone());

    // The instances, without those whose transform is not finite.
    let parts = translations.into_iter().zip(rotations).zip(scales).zip(colors);
    let instances = parts.map(|(((translation, rotation), scale), color)| {
        let rotation = unit_quaternion(rotation.map(f64::from)).unwrap_or(DQuat::IDENTITY);
        let (scale, translation) = (vector(scale), vector(translation));
        let transform = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
        MeshInstance { transform, color }
    });
    let mut instances: Vec<MeshInstance> = instances.collect();
    let before = instances.len();
    instances.retain(|instance| instance.transform.is_finite());
    let dropped = (before - instances.len()) as u64;
    let reason = "{} instances of a node are left out: a number is not finite";
    diagnostics.add(reason, dropped, || path);
    Ok(instances)
}
