//! The validity checks of a camera.

use super::require::{require, require_position, require_unit_length};
use crate::error::Result;
use crate::scene::{Camera, Projection, ThinLens};

/// Checks camera `i`.
pub(super) fn check(i: usize, camera: &Camera) -> Result<()> {
    let label = format!("camera {i} (`{}`)", camera.name);
    require_position(|| format!("{label}: position"), camera.position)?;
    require_unit_length(|| format!("{label}: forward"), camera.forward)?;
    require_unit_length(|| format!("{label}: right"), camera.right)?;
    require_unit_length(|| format!("{label}: up"), camera.up)?;
    let (value, in_range) = match camera.projection {
        Projection::FovY(a) | Projection::FovX(a) => {
            (a.to_degrees(), a > 0.0 && a < std::f64::consts::PI)
        }
        Projection::FocalPx { focal, width } => {
            (focal, focal > 0.0 && focal.is_finite() && width > 0)
        }
        Projection::OrthoHeight(h) => (h, h > 0.0 && h.is_finite()),
    };
    require(in_range, || {
        format!("{label}: its field of view, focal length or height is out of range: {value}")
    })?;
    let Some(ThinLens { aperture, focus_distance }) = camera.lens else { return Ok(()) };
    let is_length = |x: f64| x > 0.0 && x.is_finite();
    require(is_length(aperture) && is_length(focus_distance), || {
        format!(
            "{label}: its aperture {aperture} and focus distance {focus_distance} must be above 0"
        )
    })?;
    require(!matches!(camera.projection, Projection::OrthoHeight(_)), || {
        format!("{label}: an orthographic camera has no lens")
    })
}
