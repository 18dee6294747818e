//! The lights, and their motion.

use glam::{DVec3, Vec3};

use super::SceneBuilder;
use super::objects::ObjectKind;
use crate::error::{Error, Result};
use crate::load::scene_file::schema::light_tables::{Kind, LightTable};
use crate::load::scene_file::schema::spanned::Spanned;
use crate::load::scene_file::source::{Source, Span};
use crate::load::spelling;
use crate::scene::animation::Animated;
use crate::scene::{DEFAULT_LIGHT_SAMPLES, Light, LightKind, Shadow, Transfer};

/// The default half-angle of a spot light within which it is whole, in degrees.
const DEFAULT_INNER_ANGLE: f64 = 0.0;
/// The default half-angle of a spot light beyond which there is no light, in degrees.
const DEFAULT_OUTER_ANGLE: f64 = 45.0;

impl SceneBuilder<'_> {
    /// Adds the light of a table with this index, and the shape by which it is seen.
    ///
    /// # Errors
    /// When its keys do not fit its kind or each other, or its intensity is beyond f32 at some time.
    pub fn add_light(&mut self, index: usize, table: &LightTable) -> Result<()> {
        let mut light = light(self.source, table, self.scene.film.transfer)?;
        light.shape = self.add_light_shape(index, table, &light)?;
        let animated = self.animated_light(table, &light)?;
        self.add_animated(animated);
        self.scene.lights.push(light);
        Ok(())
    }

    /// Returns the animation of the next light of the scene, if it has one.
    fn animated_light(&self, table: &LightTable, light: &Light) -> Result<Option<Animated>> {
        let Some(motion) = self.motion(&table.name) else { return Ok(None) };
        // The light at rest: where a keyed node moves it, at the origin of the node.
        let mut rest = light.clone();
        if motion.is_keyed
            && let Some(position) = rest.kind.position_mut()
        {
            *position = DVec3::ZERO;
        }
        // The curves of its keys; that of the intensity is a factor on the colour.
        let direction = motion.curves.direction.as_ref().map(|curve| curve.value.clone());
        let mut intensity = None;
        if let Some(Spanned { span, value: curve }) = &motion.curves.intensity {
            rest.intensity = color(table, self.scene.film.transfer);
            let greatest = curve.values.iter().fold(0.0f64, |a, &b| a.max(b));
            check_intensity(self.source, span, rest.intensity * greatest as f32)?;
            intensity = Some(curve.clone());
        }
        if motion.node.is_none() && direction.is_none() && intensity.is_none() {
            return Ok(None);
        }
        let light = self.scene.lights.len();
        Ok(Some(Animated::Light { light, node: motion.node, rest, direction, intensity }))
    }
}

impl Kind {
    /// Returns the keys that a light of this kind may have.
    fn keys(self) -> &'static [&'static str] {
        match self {
            Kind::Point => &["position", "color", "intensity", "falloff", "range", "shadow"],
            Kind::Directional => &["direction", "angle", "color", "intensity", "shadow", "samples"],
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
            Kind::Rectangle => &[
                "position",
                "direction",
                "size",
                "up",
                "color",
                "intensity",
                "shadow",
                "samples",
                "visible",
            ],
            Kind::Disk => &[
                "position",
                "direction",
                "radius",
                "color",
                "intensity",
                "shadow",
                "samples",
                "visible",
            ],
            Kind::Sphere => {
                &["position", "radius", "color", "intensity", "shadow", "samples", "visible"]
            }
        }
    }
}

/// Returns the light that a table describes.
fn light(source: &Source<'_>, table: &LightTable, transfer: Transfer) -> Result<Light> {
    check_keys(source, table)?;
    let mut intensity = color(table, transfer);
    if let Some(Spanned { span, value }) = &table.intensity {
        intensity *= value.0 as f32;
        check_intensity(source, span, intensity)?;
    }
    let kind = light_kind(source, table)?;
    let shadow = match kind {
        LightKind::Ambient => Shadow::None,
        _ => table.shadow.as_ref().map(|shadow| shadow.value.0).unwrap_or_default(),
    };
    let name = table.name.as_ref().map(|name| name.value.clone()).unwrap_or_default();
    let samples = table.samples.as_ref().map_or(DEFAULT_LIGHT_SAMPLES, |s| s.value.0);
    let light = Light { name, kind, intensity, shadow, samples, shape: None };
    if let Some(Spanned { span, .. }) = &table.samples
        && !light.has_extent()
    {
        let message = "a directional light has `samples` only with an `angle`";
        let help = "without an angle it is a point, and one shadow ray stands for it";
        return Err(source.error(&source.key_span("samples", span), message).help(help));
    }
    Ok(light)
}

/// Returns the linear colour of a light, white by default.
fn color(table: &LightTable, transfer: Transfer) -> Vec3 {
    table.color.map_or(Vec3::ONE, |c| c.to_linear(transfer))
}

/// Checks that an intensity is within f32.
fn check_intensity(source: &Source<'_>, span: &Span, intensity: Vec3) -> Result<()> {
    if intensity.is_finite() {
        return Ok(());
    }
    Err(source.error(span, "`color` times `intensity` is too large"))
}

/// Returns the kind of a light, with the values that it needs.
fn light_kind(source: &Source<'_>, table: &LightTable) -> Result<LightKind> {
    let missing = |key: &str| -> Error {
        let noun = ObjectKind::Light(table.kind.value).noun();
        source.error(&table.kind.span, format!("{noun} needs the key `{key}`"))
    };
    let position = || table.position.as_ref().map(|p| p.value.0).ok_or_else(|| missing("position"));
    let direction =
        || table.direction.as_ref().map(|d| d.value.0).ok_or_else(|| missing("direction"));
    let radius = || table.radius.as_ref().map(|r| r.value.0).ok_or_else(|| missing("radius"));
    let falloff = table.falloff.as_ref().map(|f| f.value).unwrap_or_default();
    let range = table.range.as_ref().map_or(f64::INFINITY, |r| r.value.0);
    Ok(match table.kind.value {
        Kind::Ambient => LightKind::Ambient,
        Kind::Directional => {
            let angle = table.angle.as_ref().map_or(0.0, |angle| angle.value.0.to_radians());
            LightKind::Directional { direction: direction()?, angle }
        }
        Kind::Point => LightKind::Point { position: position()?, falloff, range },
        Kind::Spot => {
            let (inner_angle, outer_angle) = cone_angles(source, table)?;
            let (position, direction) = (position()?, direction()?);
            LightKind::Spot { position, direction, falloff, range, inner_angle, outer_angle }
        }
        Kind::Rectangle => {
            let (center, normal) = (position()?, direction()?);
            let [u, v] = rectangle_axes(source, table, normal)?;
            let size = table.size.as_ref().ok_or_else(|| missing("size"))?;
            let [width, height] = size.value.0;
            LightKind::Rectangle { center, u: u * (0.5 * width), v: v * (0.5 * height) }
        }
        Kind::Disk => {
            LightKind::Disk { center: position()?, normal: direction()?, radius: radius()? }
        }
        Kind::Sphere => LightKind::Sphere { center: position()?, radius: radius()? },
    })
}

/// Returns the unit vectors along the width and the height of a rectangle with this normal.
fn rectangle_axes(source: &Source<'_>, table: &LightTable, normal: DVec3) -> Result<[DVec3; 2]> {
    let default_up = if normal.y.abs() > 0.999 { DVec3::Z } else { DVec3::Y };
    let up = table.up.as_ref().map_or(default_up, |up| up.value.0);
    let across = up.cross(normal);
    if let Some(Spanned { span, .. }) = &table.up
        && across.length() < 1e-9
    {
        let message = "the light's `up` points along its `direction`";
        return Err(source.error(span, message).help("choose an `up` across the direction"));
    }
    let across = across.normalize();
    Ok([across, normal.cross(across)])
}

/// Returns the inner and the outer half-angle of a spot light, in radians.
fn cone_angles(source: &Source<'_>, table: &LightTable) -> Result<(f64, f64)> {
    let inner = table.inner_angle.as_ref().map_or(DEFAULT_INNER_ANGLE, |a| a.value.0);
    let outer = table.outer_angle.as_ref().map_or(DEFAULT_OUTER_ANGLE, |a| a.value.0);
    let (inner_angle, outer_angle) = (inner.to_radians(), outer.to_radians());
    // The defaults fit each other, and so one of the two is given where they do not.
    if let Some(Spanned { span, .. }) = table.inner_angle.as_ref().or(table.outer_angle.as_ref())
        && inner_angle >= outer_angle
    {
        let message = format!("`inner_angle` ({inner}) must be less than `outer_angle` ({outer})");
        return Err(source.error(span, message));
    }
    Ok((inner_angle, outer_angle))
}

/// Checks that a light has only keys that mean something for its kind.
fn check_keys(source: &Source<'_>, table: &LightTable) -> Result<()> {
    fn span<T>(value: &Option<Spanned<T>>) -> Option<&Span> {
        value.as_ref().map(|v| &v.span)
    }
    // The keys that are given, of those that not every kind has.
    let kind = table.kind.value;
    let given = [
        ("position", span(&table.position)),
        ("direction", span(&table.direction)),
        ("size", span(&table.size)),
        ("up", span(&table.up)),
        ("radius", span(&table.radius)),
        ("angle", span(&table.angle)),
        ("inner_angle", span(&table.inner_angle)),
        ("outer_angle", span(&table.outer_angle)),
        ("falloff", span(&table.falloff)),
        ("range", span(&table.range)),
        ("shadow", span(&table.shadow)),
        ("samples", span(&table.samples)),
        ("visible", span(&table.visible)),
    ];
    for (key, span) in given {
        if let Some(span) = span
            && !kind.keys().contains(&key)
        {
            let message = format!("{} has no `{key}`", ObjectKind::Light(kind).noun());
            let help = format!("its keys are {}", spelling::list(kind.keys()));
            return Err(source.error(&source.key_span(key, span), message).help(help));
        }
    }
    Ok(())
}
