//! KHR_lights_punctual: the lights of nodes.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::{DVec3, Vec3};
use gltf::json::extensions::scene::khr_lights_punctual::{Light as Source, Type};
use gltf::json::{self, validation::Checked};

use super::nodes::SceneNode;
use crate::error::Result;
use crate::load::diagnostics::Diagnostics;
use crate::load::gltf::json::lookup;
use crate::scene::{Falloff, Light, LightKind};

/// Returns the light of a node, if it has one of a known kind.
///
/// # Errors
/// When the node refers to a missing light.
pub fn light(
    root: &json::Root,
    node: &SceneNode,
    diagnostics: &mut Diagnostics,
) -> Result<Option<Light>> {
    let extension = node.node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
    let Some(index) = extension.map(|e| e.light.value()) else { return Ok(None) };
    let by = format_args!("nodes[{}].extensions.KHR_lights_punctual.light", node.index);
    // The light in the list of the root.
    let lights = root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
    let source = lookup(lights.map_or(&[][..], |l| &l.lights), index, "light", by)?;
    let path = || format!("extensions.KHR_lights_punctual.lights[{index}]");

    // Its kind and its place.
    let Some(kind) = light_kind(source, node, path, diagnostics) else {
        let reason = "{} lights are of no known kind, or point nowhere, and give no light";
        diagnostics.add(reason, 1, path);
        return Ok(None);
    };
    // Candela and lux measure what a surface receives; a light of ours what a white surface then
    // reflects, which is less by Lambert's π.
    let intensity = source.color.map(|c| (f64::from(c) * f64::from(source.intensity) / PI) as f32);

    // Numbers that no light can have count as 0.
    let is_valid = |x: f32| x.is_finite() && x >= 0.0;
    if !intensity.iter().all(|&x| is_valid(x)) {
        diagnostics.add("{} lights are negative or not finite, which counts as 0", 1, path);
    }
    let intensity = Vec3::from(intensity.map(|x| if is_valid(x) { x } else { 0.0 }));
    Ok(Some(Light::new(kind).with_name(node.name_of(&source.name)).with_intensity(intensity)))
}

fn light_kind(
    source: &Source,
    node: &SceneNode,
    path: impl Fn() -> String,
    diagnostics: &mut Diagnostics,
) -> Option<LightKind> {
    let Checked::Valid(kind) = source.type_ else { return None };
    // Place and direction are those of the node, and the light shines along its −Z.
    let position = node.to_world.translation;
    let direction = node.to_world.matrix3.mul_vec3(DVec3::NEG_Z).try_normalize();
    let falloff = Falloff::InverseSquare;
    // Without a range, or with one that is not valid, the light reaches everywhere.
    let valid_range = source.range.filter(|range| *range > 0.0);
    if source.range.is_some() && valid_range.is_none() {
        diagnostics.add("{} ranges of lights are not above 0 and are ignored", 1, &path);
    }
    let range = valid_range.map_or(f64::INFINITY, f64::from);
    Some(match kind {
        Type::Directional => LightKind::Directional { direction: direction?, angle: 0.0 },
        Type::Point => LightKind::Point { position, falloff, range },
        Type::Spot => {
            let spot = source.spot.as_ref();
            let outer = spot.map_or(FRAC_PI_4, |s| f64::from(s.outer_cone_angle));
            let inner = spot.map_or(0.0, |s| f64::from(s.inner_cone_angle));
            // A cone of no width gives no light, and its rim must be outside of its core.
            let outer_angle = if outer > 0.0 { outer.min(FRAC_PI_2) } else { FRAC_PI_4 };
            let inner_angle = if inner >= 0.0 { inner.min(outer_angle * 0.9999) } else { 0.0 };
            // f32 holds π/2, and any other angle, to seven digits.
            if (outer_angle - outer).abs() > 1e-6 || (inner_angle - inner).abs() > 1e-3 {
                let reason = "{} spots have cones out of range, which are brought into it";
                diagnostics.add(reason, 1, path);
            }
            let direction = direction?;
            LightKind::Spot { position, direction, falloff, range, inner_angle, outer_angle }
        }
    })
}
