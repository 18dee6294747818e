//! The lights of a scene file.

use glam::{DVec3, Vec3};

use super::source::{Source, Span};
use super::spanned::At;
use super::tables::{Kind, LightTable};
use crate::error::Result;
use crate::load::spelling;
use crate::scene::{Light, LightKind, Shadow, Transfer};

/// The cone of a spot that says nothing of it, in degrees.
const DEFAULT_INNER_ANGLE: f64 = 0.0;
const DEFAULT_OUTER_ANGLE: f64 = 45.0;

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Kind::Point => "point",
            Kind::Directional => "directional",
            Kind::Spot => "spot",
            Kind::Ambient => "ambient",
        }
    }

    fn keys(self) -> &'static [&'static str] {
        match self {
            Kind::Point => &["position", "color", "intensity", "falloff", "range", "shadow"],
            Kind::Directional => &["direction", "color", "intensity", "shadow"],
            Kind::Spot => &[
                "position",
                "direction",
                "inner_angle",
                "outer_angle",
                "color",
                "intensity",
                "falloff",
                "range",
                "shadow",
            ],
            Kind::Ambient => &["color", "intensity"],
        }
    }
}

/// The light that a table describes.
pub fn light(source: &Source<'_>, table: &LightTable, transfer: Transfer) -> Result<Light> {
    check_keys(source, table)?;
    let color = table.color.map_or(Vec3::ONE, |c| c.linear(transfer));
    let mut intensity = color;
    if let Some(At { span, value }) = &table.intensity {
        intensity *= value.0 as f32;
        if !intensity.is_finite() {
            return Err(source.error(span, "`color` times `intensity` is too large"));
        }
    }
    let kind = kind(source, table)?;
    let shadow = match kind {
        LightKind::Ambient => Shadow::None,
        _ => table.shadow.as_ref().map(|shadow| shadow.value.0).unwrap_or_default(),
    };
    let name = table.name.as_ref().map(|name| name.value.clone()).unwrap_or_default();
    Ok(Light { name, kind, intensity, shadow })
}

fn kind(source: &Source<'_>, table: &LightTable) -> Result<LightKind> {
    let position = || -> Result<DVec3> {
        let position = table.position.as_ref().map(|p| p.value.0);
        position.ok_or_else(|| missing(source, table, "position"))
    };
    let direction = || -> Result<DVec3> {
        let direction = table.direction.as_ref().map(|d| d.value.0);
        direction.ok_or_else(|| missing(source, table, "direction"))
    };
    let falloff = table.falloff.as_ref().map(|f| f.value).unwrap_or_default();
    let range = table.range.as_ref().map_or(f64::INFINITY, |r| r.value.0);
    Ok(match table.kind.value {
        Kind::Ambient => LightKind::Ambient,
        Kind::Directional => LightKind::Directional { direction: direction()? },
        Kind::Point => LightKind::Point { position: position()?, falloff, range },
        Kind::Spot => {
            let (inner_angle, outer_angle) = cone(source, table)?;
            let (position, direction) = (position()?, direction()?);
            LightKind::Spot { position, direction, falloff, range, inner_angle, outer_angle }
        }
    })
}

fn missing(source: &Source<'_>, table: &LightTable, key: &str) -> crate::error::Error {
    let kind = table.kind.value.name();
    source.error(&table.kind.span, format!("a {kind} light needs the key `{key}`"))
}

/// The angles of a spot, in radians.
fn cone(source: &Source<'_>, table: &LightTable) -> Result<(f64, f64)> {
    let inner = table.inner_angle.as_ref().map_or(DEFAULT_INNER_ANGLE, |a| a.value.0);
    let outer = table.outer_angle.as_ref().map_or(DEFAULT_OUTER_ANGLE, |a| a.value.0);
    let (inner_angle, outer_angle) = (inner.to_radians(), outer.to_radians());
    let given = table.inner_angle.as_ref().or(table.outer_angle.as_ref());
    match given {
        Some(At { span, .. }) if inner_angle >= outer_angle => Err(source.error(
            span,
            format!("`inner_angle` ({inner}) must be less than `outer_angle` ({outer})"),
        )),
        _ => Ok((inner_angle, outer_angle)),
    }
}

/// Refuses keys that mean nothing for the kind of light.
fn check_keys(source: &Source<'_>, table: &LightTable) -> Result<()> {
    fn span<T>(value: &Option<At<T>>) -> Option<&Span> {
        value.as_ref().map(|v| &v.span)
    }
    let kind = table.kind.value;
    let given = [
        ("position", span(&table.position)),
        ("direction", span(&table.direction)),
        ("inner_angle", span(&table.inner_angle)),
        ("outer_angle", span(&table.outer_angle)),
        ("falloff", span(&table.falloff)),
        ("range", span(&table.range)),
        ("shadow", span(&table.shadow)),
    ];
    for (key, span) in given {
        if let Some(span) = span
            && !kind.keys().contains(&key)
        {
            let article = if kind == Kind::Ambient { "an" } else { "a" };
            let name = kind.name();
            let help = format!("its keys are {}", spelling::list(kind.keys()));
            return Err(source
                .error(&source.key(key, span), format!("{article} {name} light has no `{key}`"))
                .help(help));
        }
    }
    Ok(())
}
