//! The cameras of a scene file.

use glam::DVec3;

use super::names::Names;
use super::source::{Source, Span};
use super::tables::CameraTable;
use super::values::unit;
use crate::error::Result;
use crate::scene::{Camera, Projection};

/// The vertical field of view, in degrees, of a camera that says nothing of it.
const DEFAULT_FOV_Y: f64 = 45.0;

/// The camera that a table describes; `width` is the film's, which `focal_px` refers to.
pub fn camera(
    source: &Source<'_>,
    table: &CameraTable,
    span: &Span,
    names: &Names,
    width: u32,
) -> Result<Camera> {
    let position = table.position.0;
    let (forward, toward) = match (&table.look_at, &table.direction) {
        (Some(target), None) => {
            let (_, point) = names.spot(source, target)?;
            let forward = unit(point - position).ok_or_else(|| {
                source
                    .error(&target.span, "the camera looks at the point where it stands")
                    .help("`look_at` must differ from `position`")
            })?;
            (forward, &target.span)
        }
        (None, Some(direction)) => (direction.value.0, &direction.span),
        (Some(_), Some(direction)) => {
            let key = source.key("direction", &direction.span);
            let message = "a camera has `look_at` or `direction`, not both";
            return Err(source.error(&key, message).help("leave one out"));
        }
        (None, None) => {
            let message = "[camera] needs the key `look_at`, or `direction`";
            return Err(source.error(span, message));
        }
    };
    let up = table.up.as_ref().map_or(DVec3::Y, |up| up.value.0);
    let lens = lens(source, table, width)?;
    let up_span = table.up.as_ref().map_or(toward, |up| &up.span);
    // From the origin, so that a position far out does not round the direction.
    let camera =
        Camera::look_at(DVec3::ZERO, forward, up, lens).map_err(|e| source.place(up_span, e))?;
    let name = table.name.as_ref().map(|name| name.value.clone()).unwrap_or_default();
    Ok(Camera { name, position, ..camera })
}

fn lens(source: &Source<'_>, table: &CameraTable, width: u32) -> Result<Projection> {
    let given: Vec<(&str, &Span, Projection)> = [
        table.fov_y.as_ref().map(|a| ("fov_y", &a.span, Projection::FovY(a.value.0.to_radians()))),
        table.fov_x.as_ref().map(|a| ("fov_x", &a.span, Projection::FovX(a.value.0.to_radians()))),
        table
            .focal_px
            .as_ref()
            .map(|d| ("focal_px", &d.span, Projection::FocalPx { focal: d.value.0, width })),
        table
            .ortho_height
            .as_ref()
            .map(|h| ("ortho_height", &h.span, Projection::OrthoHeight(h.value.0))),
    ]
    .into_iter()
    .flatten()
    .collect();
    match given[..] {
        [] => Ok(Projection::FovY(DEFAULT_FOV_Y.to_radians())),
        [(_, _, lens)] => Ok(lens),
        [(first, ..), (second, span, _), ..] => Err(source
            .error(
                &source.key(second, span),
                format!("a camera cannot have both `{first}` and `{second}`"),
            )
            .help("keep one of `fov_y`, `fov_x`, `focal_px` and `ortho_height`")),
    }
}
