//! The cameras of nodes.

use std::f64::consts::PI;

use glam::DVec3;
use gltf::json::{self, camera::Type, validation::Checked};

use super::nodes::SceneNode;
use crate::error::Result;
use crate::load::diagnostics::Diagnostics;
use crate::load::gltf::json::lookup;
use crate::scene::{Camera, Projection};

/// Returns the camera of a node, if it has one whose field of view and transform are valid.
///
/// # Errors
/// When the node refers to a missing camera.
pub fn camera(
    root: &json::Root,
    node: &SceneNode,
    diagnostics: &mut Diagnostics,
) -> Result<Option<Camera>> {
    let Some(index) = node.node.camera.map(|c| c.value()) else { return Ok(None) };
    let by = format_args!("nodes[{}].camera", node.index);
    let source = lookup(&root.cameras, index, "camera", by)?;

    // A camera looks along −Z of its node, whose scale does not count.
    let axes = node.to_world.matrix3;
    let position = node.to_world.translation;
    let target = position + axes.mul_vec3(DVec3::NEG_Z).normalize_or_zero();
    let up = axes.mul_vec3(DVec3::Y);
    let camera = projection(source)
        .and_then(|projection| Camera::look_at(position, target, up, projection).ok());
    if camera.is_none() {
        let reason = "{} cameras are left out: their field of view or transform is out of range";
        diagnostics.add(reason, 1, || format!("cameras[{index}]"));
    }
    Ok(camera.map(|camera| Camera { name: node.name_of(&source.name), ..camera }))
}

fn projection(source: &json::Camera) -> Option<Projection> {
    match source.type_ {
        Checked::Valid(Type::Perspective) => {
            let yfov = f64::from(source.perspective.as_ref()?.yfov);
            (yfov > 0.0 && yfov < PI).then_some(Projection::FovY(yfov))
        }
        Checked::Valid(Type::Orthographic) => {
            // `ymag` is half of the height. Some files have it negative, to flip the picture.
            let height = 2.0 * f64::from(source.orthographic.as_ref()?.ymag).abs();
            (height > 0.0 && height.is_finite()).then_some(Projection::OrthoHeight(height))
        }
        Checked::Invalid => None,
    }
}
