//! The validity checks of a light.

use super::require::{require, require_color, require_position, require_unit_length};
use crate::error::Result;
use crate::scene::{Light, LightKind};

/// Checks light `i`.
pub(super) fn check(i: usize, light: &Light) -> Result<()> {
    let label = format!("light {i}");
    require_color(|| format!("{label}: intensity"), light.intensity)?;
    match light.kind {
        LightKind::Ambient => Ok(()),
        LightKind::Directional { direction } => {
            require_unit_length(|| format!("{label}: direction"), direction)
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
    }
}
