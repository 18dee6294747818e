//! Lights (KHR_lights_punctual) and cameras: what a node brings other than a mesh.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec3, Vec3};
use gltf::json;
use gltf::json::camera::Type as CameraType;
use gltf::json::extensions::scene::khr_lights_punctual::{Light as Source, Type};
use gltf::json::validation::Checked;

use super::buffers::get;
use super::nodes::Placed;
use crate::error::Result;
use crate::load::diagnostics::Diagnostics;
use crate::scene::{Camera, Falloff, Light, LightKind, Projection, Shadow};

/// The light that a node carries.
///
/// # Errors
/// When the node names a light that isn't there.
pub fn light(root: &json::Root, placed: &Placed, tally: &mut Diagnostics) -> Result<Option<Light>> {
    let extension = placed.node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
    let Some(index) = extension.map(|e| e.light.value()) else { return Ok(None) };
    let by = format!("nodes[{}].extensions.KHR_lights_punctual.light", placed.index);
    let lights = root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
    let source = get(lights.map_or(&[][..], |l| &l.lights), index, "light", &by)?;
    let at = format!("extensions.KHR_lights_punctual.lights[{index}]");
    let Some(kind) = kind(source, placed, &at, tally) else {
        tally.add("{} lights are of no known kind, or point nowhere, and give no light", 1, || at);
        return Ok(None);
    };
    // Candela and lux count what a surface receives; ours count what a white one then reflects,
    // which is less by Lambert's π.
    let intensity = source.color.map(|c| (f64::from(c) * f64::from(source.intensity) / PI) as f32);
    let sound = |x: f32| x.is_finite() && x >= 0.0;
    if !intensity.iter().all(|&x| sound(x)) {
        tally.add("{} lights are negative or not finite, which counts as 0", 1, || at);
    }
    Ok(Some(Light {
        name: name(&source.name, placed),
        kind,
        intensity: Vec3::from(intensity.map(|x| if sound(x) { x } else { 0.0 })),
        shadow: Shadow::default(),
    }))
}

fn kind(source: &Source, placed: &Placed, at: &str, tally: &mut Diagnostics) -> Option<LightKind> {
    let Checked::Valid(kind) = source.type_ else { return None };
    let position = placed.world.translation;
    let direction = placed.world.matrix3.mul_vec3(DVec3::NEG_Z).try_normalize();
    let falloff = Falloff::InverseSquare;
    let range = match source.range {
        Some(range) if range > 0.0 => f64::from(range),
        Some(_) => {
            tally.add("{} ranges of lights are not above 0 and are ignored", 1, || at.to_owned());
            f64::INFINITY
        }
        None => f64::INFINITY,
    };
    Some(match kind {
        Type::Directional => LightKind::Directional { direction: direction? },
        Type::Point => LightKind::Point { position, falloff, range },
        Type::Spot => {
            let spot = source.spot.as_ref();
            let outer = spot.map_or(PI / 4.0, |s| f64::from(s.outer_cone_angle));
            let inner = spot.map_or(0.0, |s| f64::from(s.inner_cone_angle));
            // A cone of no width gives no light, and its rim must lie outside of its core.
            let outer_angle = if outer > 0.0 { outer.min(FRAC_PI_2) } else { PI / 4.0 };
            let inner_angle = if inner >= 0.0 { inner.min(outer_angle * 0.9999) } else { 0.0 };
            // f32 can hold neither π/2 nor anything else to more than seven digits.
            if (outer_angle - outer).abs() > 1e-6 || (inner_angle - inner).abs() > 1e-3 {
                tally.add("{} spots have cones out of range, which are brought into it", 1, || {
                    at.to_owned()
                });
            }
            let direction = direction?;
            LightKind::Spot { position, direction, falloff, range, inner_angle, outer_angle }
        }
    })
}

/// The camera that a node carries.
///
/// # Errors
/// When the node names a camera that isn't there.
pub fn camera(
    root: &json::Root,
    placed: &Placed,
    tally: &mut Diagnostics,
) -> Result<Option<Camera>> {
    let Some(index) = placed.node.camera.map(|c| c.value()) else { return Ok(None) };
    let by = format!("nodes[{}].camera", placed.index);
    let source = get(&root.cameras, index, "camera", &by)?;
    let axes = placed.world.matrix3;
    let position = placed.world.translation;
    let target = position + axes.mul_vec3(DVec3::NEG_Z).normalize_or_zero();
    let made = lens(source)
        .and_then(|lens| Camera::look_at(position, target, axes.mul_vec3(DVec3::Y), lens).ok());
    match made {
        Some(camera) => Ok(Some(Camera { name: name(&source.name, placed), ..camera })),
        None => {
            tally.add(
                "{} cameras are left out: their field of view or transform is out of range",
                1,
                || format!("cameras[{index}]"),
            );
            Ok(None)
        }
    }
}

fn lens(source: &json::Camera) -> Option<Projection> {
    match source.type_ {
        Checked::Valid(CameraType::Perspective) => {
            let yfov = f64::from(source.perspective.as_ref()?.yfov);
            (yfov > 0.0 && yfov < PI).then_some(Projection::FovY(yfov))
        }
        Checked::Valid(CameraType::Orthographic) => {
            // ymag is half of the height. Some files have it negative, to turn the picture over.
            let height = 2.0 * f64::from(source.orthographic.as_ref()?.ymag).abs();
            (height > 0.0 && height.is_finite()).then_some(Projection::OrthoHeight(height))
        }
        Checked::Invalid => None,
    }
}

/// The object's own name, or else its node's.
fn name(own: &Option<String>, placed: &Placed) -> String {
    own.clone().or_else(|| placed.node.name.clone()).unwrap_or_default()
}
