//! EXT_mesh_gpu_instancing: one node whose mesh stands in many places.

use glam::{DAffine3, DQuat, DVec3};
use gltf::json::Value;

use super::accessor::Accessors;
use super::nodes::Placed;
use crate::error::{Error, Place, Result};
use crate::load::diagnostics::Diagnostics;
use crate::load::limits::Limit;
use crate::load::sandbox::Sandbox;

/// Where a node's mesh stands, in the node's space; nothing where that is once, at its origin.
///
/// # Errors
/// When the extension's accessors cannot be read, or are not equally long.
pub fn places(
    Placed { node, index, .. }: &Placed,
    guard: &Sandbox,
    accessors: &Accessors,
    tally: &mut Diagnostics,
) -> Result<Option<Vec<DAffine3>>> {
    let extension = node.extensions.as_ref().and_then(|e| e.others.get("EXT_mesh_gpu_instancing"));
    let Some(extension) = extension else { return Ok(None) };
    let at = format!("nodes[{index}].extensions.EXT_mesh_gpu_instancing.attributes");
    let place = |name: &str| Place::Json(format!("{at}.{name}"));
    let attributes = extension.get("attributes").and_then(Value::as_object);
    let mut count = None;
    for (name, value) in attributes.into_iter().flatten() {
        let accessor = value
            .as_u64()
            .and_then(|i| usize::try_from(i).ok())
            .ok_or_else(|| Error::input(format!("{value} is no accessor")).place(place(name)))?;
        let found = accessors.count(accessor);
        guard.check(Limit::Instances, found).map_err(|e| e.place(place(name)))?;
        if *count.get_or_insert(found) != found {
            return Err(Error::input(format!("{found} values, where others have another number"))
                .place(place(name)));
        }
    }
    let count = count.unwrap_or(0) as usize;
    let accessor = |name: &str| attributes?.get(name)?.as_u64().map(|i| i as usize);
    let text = |name: &str| format!("{at}.{name}");
    let vectors = |name: &str, default: f32| match accessor(name) {
        Some(index) => accessors.floats::<3>(index, &text(name)),
        None => Ok(vec![[default; 3]; count]),
    };
    let (translations, scales) = (vectors("TRANSLATION", 0.0)?, vectors("SCALE", 1.0)?);
    let rotations = match accessor("ROTATION") {
        Some(index) => accessors.floats::<4>(index, &text("ROTATION"))?,
        None => vec![[0.0, 0.0, 0.0, 1.0]; count],
    };
    let vector = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    let made = translations.into_iter().zip(rotations).zip(scales).map(|((t, r), s)| {
        let rotation = DQuat::from_array(r.map(f64::from));
        let length = rotation.length();
        let rotation = if length > 0.0 { rotation / length } else { DQuat::IDENTITY };
        DAffine3::from_scale_rotation_translation(vector(s), rotation, vector(t))
    });
    let mut made: Vec<DAffine3> = made.collect();
    let before = made.len();
    made.retain(DAffine3::is_finite);
    let dropped = (before - made.len()) as u64;
    tally.add("{} instances of a node are left out: a number is not finite", dropped, || at);
    Ok(Some(made))
}
