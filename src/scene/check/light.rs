//! The validity checks of a light.

use std::f64::consts::PI;

use super::MAX_COORDINATE;
use super::require::{require, require_color, require_position, require_unit_length};
use crate::error::Result;
use crate::scene::{Light, LightKind, MAX_LIGHT_SAMPLES, MIN_SUN_ANGLE};

/// Checks light `i`.
pub(super) fn check(i: usize, light: &Light) -> Result<()> {
    let label = format!("light {i}");
    require_color(|| format!("{label}: intensity"), light.intensity)?;
    let has_samples = !light.has_extent() || (1..=MAX_LIGHT_SAMPLES).contains(&light.samples);
    require(has_samples, || {
        let found = light.samples;
        format!("{label}: samples must be from 1 to {MAX_LIGHT_SAMPLES}, found {found}")
    })?;
    match light.kind {
        LightKind::Ambient => Ok(()),
        LightKind::Directional { direction, angle } => {
            require_unit_length(|| format!("{label}: direction"), direction)?;
            require(angle == 0.0 || (MIN_SUN_ANGLE..=PI).contains(&angle), || {
                format!("{label}: angle must be 0, or from {MIN_SUN_ANGLE:e} to π, found {angle}")
            })
        }
        LightKind::Point { position: p, range, .. } => {
            require_position(|| format!("{label}: position"), p)?;
            require(range > 0.0, || format!("{label}: range must be above 0, found {range}"))
        }
        LightKind::Spot { position: p, direction, range, inner_angle, outer_angle, .. } => {
            require_position(|| format!("{label}: position"), p)?;
            require_unit_length(|| format!("{label}: direction"), direction)?;
            require(range > 0.0, || format!("{label}: range must be above 0, found {range}"))?;
            // A cone of at most half the space, to within the rounding of degrees.
            let right_angle = std::f64::consts::FRAC_PI_2 + 1e-12;
            let ordered = inner_angle >= 0.0 && inner_angle < outer_angle;
            require(ordered && outer_angle <= right_angle, || {
                let [inner, outer] = [inner_angle, outer_angle].map(f64::to_degrees);
                let range = "0 <= inner_angle < outer_angle <= 90 degrees";
                format!("{label}: {range}, found {inner} and {outer}")
            })
        }
        LightKind::Rectangle { center, u, v } => {
            require_position(|| format!("{label}: center"), center)?;
            for half_side in [u, v] {
                require_length(&label, "half-side", half_side.length())?;
            }
            let slant = u.dot(v).abs() / (u.length() * v.length());
            require(slant < 1e-6, || {
                format!("{label}: u and v must be perpendicular, found {u} and {v}")
            })
        }
        LightKind::Disk { center, normal, radius } => {
            require_position(|| format!("{label}: center"), center)?;
            require_unit_length(|| format!("{label}: normal"), normal)?;
            require_length(&label, "radius", radius)
        }
        LightKind::Sphere { center, radius } => {
            require_position(|| format!("{label}: center"), center)?;
            require_length(&label, "radius", radius)
        }
    }
}

/// Requires that a length of a light with an extent is above 0, and not beyond the greatest coordinate.
fn require_length(label: &str, name: &str, length: f64) -> Result<()> {
    // Squares of lengths must not underflow.
    require((1e-100..=MAX_COORDINATE).contains(&length), || {
        format!("{label}: {name} must be above 0 and at most 1e15, found {length}")
    })
}
