//! The curves of an object's keys, from the tracks of the animation.

use glam::DVec3;

use super::objects::{NamedObject, ObjectKind};
use crate::error::Result;
use crate::load::scene_file::schema::animation_tables::{self, List, TrackTable};
use crate::load::scene_file::schema::light_tables::Kind;
use crate::load::scene_file::schema::spanned::Spanned;
use crate::load::scene_file::source::Source;
use crate::load::spelling;
use crate::scene::Projection;
use crate::scene::animation::{Curve, Interpolate, Interpolation};

/// The curves of an object's animated keys, each with the span of its values.
#[derive(Debug, Default)]
pub struct ObjectCurves {
    /// The position: `center`, `translate` or `position`.
    pub position: Option<Spanned<Curve<DVec3>>>,
    /// A model's angles, in radians.
    pub rotation: Option<Spanned<Curve<DVec3>>>,
    /// A model's factors of scale.
    pub scale: Option<Spanned<Curve<DVec3>>>,
    /// A sphere's radius.
    pub radius: Option<Spanned<Curve<f64>>>,
    /// The direction in which a light travels or a camera looks.
    pub direction: Option<Spanned<Curve<DVec3>>>,
    /// The points that a camera looks at.
    pub look_at: Option<Spanned<Curve<DVec3>>>,
    /// A light's intensity.
    pub intensity: Option<Spanned<Curve<f64>>>,
    /// The kind of a camera's projection and its values, in radians, pixels or units.
    pub projection: Option<(MakeProjection, Spanned<Curve<f64>>)>,
}

/// A function from a value, and the film's width in pixels, to a projection.
pub type MakeProjection = fn(f64, u32) -> Projection;

/// A key of a camera's projection, with the projection of its value: in radians, pixels or units.
pub type ProjectionKey = (&'static str, MakeProjection);

/// The vertical field of view.
pub const FOV_Y: ProjectionKey = ("fov_y", |angle, _| Projection::FovY(angle));
/// The horizontal field of view.
pub const FOV_X: ProjectionKey = ("fov_x", |angle, _| Projection::FovX(angle));
/// The focal length in pixels.
pub const FOCAL_PX: ProjectionKey =
    ("focal_px", |focal, width| Projection::FocalPx { focal, width });
/// The height of an orthographic view.
pub const ORTHO_HEIGHT: ProjectionKey =
    ("ortho_height", |height, _| Projection::OrthoHeight(height));
/// The advice where a camera has several of these keys.
pub const ONE_LENS: &str = "keep one of `fov_y`, `fov_x`, `focal_px` and `ortho_height`";

impl ObjectKind {
    /// Returns the keys of an object of this kind that can be animated.
    fn animated_keys(self) -> &'static [&'static str] {
        match self {
            Self::Sphere => &["center", "radius"],
            Self::Model => &["translate", "rotate", "scale"],
            Self::Light(Kind::Point | Kind::Rectangle | Kind::Disk | Kind::Sphere) => {
                &["position", "intensity"]
            }
            Self::Light(Kind::Spot) => &["position", "direction", "intensity"],
            Self::Light(Kind::Directional) => &["direction", "intensity"],
            Self::Light(Kind::Ambient) => &["intensity"],
            Self::Camera => {
                &["position", "look_at", "direction", "fov_y", "fov_x", "focal_px", "ortho_height"]
            }
        }
    }
}

/// Adds the curves of a track to those of its object.
///
/// # Errors
/// When the object has no such key, or a curve of it already; when times do not increase, or are not
/// as many as the values.
pub fn add_track(
    source: &Source<'_>,
    object: &NamedObject,
    table: &TrackTable,
    curves: &mut ObjectCurves,
) -> Result<()> {
    check_times(source, table)?;
    let mut track = TrackReader { source, object, table, is_empty: true };
    // Vectors.
    let smooth = Curve::<DVec3>::smooth;
    track.read("center", &table.center, |p| p.0, smooth, &mut curves.position)?;
    track.read("translate", &table.translate, |p| p.0, smooth, &mut curves.position)?;
    track.read("position", &table.position, |p| p.0, smooth, &mut curves.position)?;
    track.read("rotate", &table.rotate, |r| r.radians(), smooth, &mut curves.rotation)?;
    track.read("scale", &table.scale, |s| s.0, smooth, &mut curves.scale)?;
    track.read("direction", &table.direction, |d| d.0, smooth, &mut curves.direction)?;
    track.read("look_at", &table.look_at, |p| p.0, smooth, &mut curves.look_at)?;
    // Numbers.
    let smooth = Curve::<f64>::smooth;
    track.read("radius", &table.radius, |r| r.0, smooth, &mut curves.radius)?;
    track.read("intensity", &table.intensity, |i| i.0, smooth, &mut curves.intensity)?;
    // Projections, of which a camera has one.
    let lens = &mut curves.projection;
    track.read_projection(FOV_Y, &table.fov_y, |a| a.0.to_radians(), lens)?;
    track.read_projection(FOV_X, &table.fov_x, |a| a.0.to_radians(), lens)?;
    track.read_projection(FOCAL_PX, &table.focal_px, |d| d.0, lens)?;
    track.read_projection(ORTHO_HEIGHT, &table.ortho_height, |h| h.0, lens)?;
    // A camera has one aim, and a track changes something.
    let both = curves.look_at.is_some() && curves.direction.is_some();
    if both && object.kind == ObjectKind::Camera {
        let message = "a camera has `look_at` or `direction`, not both";
        return Err(source.error(&table.object.span, message).help("leave one out"));
    }
    if track.is_empty {
        let name = &object.name;
        let message = format!("the track says nothing of what changes of `{name}`");
        let keys = spelling::list(object.kind.animated_keys());
        return Err(source.error(&table.object.span, message).help(format!(
            "give it values for one or several of {keys}: one for each of its `times`"
        )));
    }
    Ok(())
}

/// Checks that a track has times, and that they increase.
fn check_times(source: &Source<'_>, table: &TrackTable) -> Result<()> {
    let times = &table.times.value.0;
    if let Some(pair) = times.windows(2).find(|w| w[1].value.0 <= w[0].value.0) {
        let (before, after) = (pair[0].value.0, &pair[1]);
        let message = format!("times must increase, and {} comes after {before}", after.value.0);
        return Err(source.error(&after.span, message));
    }
    if times.is_empty() {
        return Err(source.error(&table.times.span, "a track needs a time, and a value for it"));
    }
    Ok(())
}

/// A track while its curves are read.
struct TrackReader<'a> {
    source: &'a Source<'a>,
    object: &'a NamedObject,
    table: &'a TrackTable,
    /// True until a key with values is found.
    is_empty: bool,
}

impl TrackReader<'_> {
    /// Reads the curve of a key, where it is given, into a slot that must be empty. `smooth` makes the
    /// curve without corners.
    fn read<T, V: Interpolate>(
        &mut self,
        key: &str,
        list: &Option<Spanned<List<T>>>,
        value: impl Fn(&T) -> V,
        smooth: fn(Vec<f64>, Vec<V>) -> Curve<V>,
        slot: &mut Option<Spanned<Curve<V>>>,
    ) -> Result<()> {
        let Some(curve) = self.curve(key, list, value, smooth)? else { return Ok(()) };
        let key_span = self.source.key_span(key, &curve.span);
        if slot.replace(curve).is_none() {
            return Ok(());
        }
        let message = format!("another track says how `{key}` of `{}` changes", self.object.name);
        Err(self.source.error(&key_span, message).help("put all its times into one"))
    }

    /// Reads the curve of a camera's projection, as [`TrackReader::read`].
    fn read_projection<T>(
        &mut self,
        (key, make): ProjectionKey,
        list: &Option<Spanned<List<T>>>,
        value: impl Fn(&T) -> f64,
        slot: &mut Option<(MakeProjection, Spanned<Curve<f64>>)>,
    ) -> Result<()> {
        let Some(curve) = self.curve(key, list, value, Curve::<f64>::smooth)? else {
            return Ok(());
        };
        let key_span = self.source.key_span(key, &curve.span);
        if slot.replace((make, curve)).is_none() {
            return Ok(());
        }
        let message = "a camera has one lens, and a track says already how it changes";
        Err(self.source.error(&key_span, message).help(ONE_LENS))
    }

    /// Returns the curve of a key, where it is given: checks that the object has the key, and that
    /// there are as many values as times.
    fn curve<T, V: Interpolate>(
        &mut self,
        key: &str,
        list: &Option<Spanned<List<T>>>,
        value: impl Fn(&T) -> V,
        smooth: fn(Vec<f64>, Vec<V>) -> Curve<V>,
    ) -> Result<Option<Spanned<Curve<V>>>> {
        let Some(Spanned { span, value: List(list) }) = list else { return Ok(None) };
        self.is_empty = false;
        // The object must have the key.
        let kind = self.object.kind;
        if !kind.animated_keys().contains(&key) {
            let name = &self.object.name;
            let message = format!("`{name}` is {}, which has no `{key}`", kind.noun());
            let help = format!("what can change of it is {}", spelling::list(kind.animated_keys()));
            return Err(self.source.error(&self.source.key_span(key, span), message).help(help));
        }
        // There must be a value for each time.
        let times: Vec<f64> = self.table.times.value.0.iter().map(|time| time.value.0).collect();
        if list.len() != times.len() {
            let count =
                |n: usize, noun: &str| format!("{n} {noun}{}", if n == 1 { "" } else { "s" });
            let (values, times) = (count(list.len(), "value"), count(times.len(), "time"));
            let message = format!("`{key}`: {values} for {times}");
            return Err(self.source.error(span, message).help("a value for each time"));
        }
        // The curve through the values.
        let values = list.iter().map(value).collect();
        let value = match self.table.interpolation.unwrap_or_default() {
            animation_tables::Interpolation::Smooth => smooth(times, values),
            animation_tables::Interpolation::Linear => {
                Curve { times, values, interpolation: Interpolation::Linear }
            }
            animation_tables::Interpolation::Step => {
                Curve { times, values, interpolation: Interpolation::Step }
            }
        };
        Ok(Some(Spanned { span: span.clone(), value }))
    }
}
