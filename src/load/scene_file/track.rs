//! Keys of an object that change with time.

use glam::DVec3;

use super::animation_tables::{Interpolation as Between, List, TrackTable};
use super::names::{Object, What};
use super::source::{Source, Span};
use super::spanned::At;
use super::tables::Kind;
use crate::error::{Error, Result};
use crate::load::spelling;
use crate::scene::Projection;
use crate::scene::animation::{Curve, Interpolate, Interpolation};

/// What changes of an object.
#[derive(Debug, Default)]
pub struct Curves {
    /// Its place: `center`, `translate` or `position`.
    pub position: Option<At<Curve<DVec3>>>,
    /// A model's angles, in radians.
    pub rotation: Option<Curve<DVec3>>,
    /// A model's factors.
    pub scale: Option<Curve<DVec3>>,
    /// A sphere's radius.
    pub radius: Option<Curve<f64>>,
    /// Where a light travels, or a camera looks.
    pub direction: Option<Curve<DVec3>>,
    /// The points that a camera looks at.
    pub look_at: Option<Curve<DVec3>>,
    /// A light's intensity.
    pub intensity: Option<At<Curve<f64>>>,
    /// A camera's kind of lens and its values, in radians, pixels or units.
    pub lens: Option<(MakeLens, Curve<f64>)>,
}

/// A lens of a value, for a film of so many pixels in width.
pub type MakeLens = fn(f64, u32) -> Projection;

impl What {
    /// The keys that can change.
    fn keys(self) -> &'static [&'static str] {
        match self {
            What::Sphere => &["center", "radius"],
            What::Model => &["translate", "rotate", "scale"],
            What::Light(Kind::Point) => &["position", "intensity"],
            What::Light(Kind::Spot) => &["position", "direction", "intensity"],
            What::Light(Kind::Directional) => &["direction", "intensity"],
            What::Light(Kind::Ambient) => &["intensity"],
            What::Camera => {
                &["position", "look_at", "direction", "fov_y", "fov_x", "focal_px", "ortho_height"]
            }
        }
    }
}

/// Adds what a track says of an object.
pub fn curves(
    source: &Source<'_>,
    object: &Object,
    table: &TrackTable,
    curves: &mut Curves,
) -> Result<()> {
    let times = &table.times.value.0;
    if let Some(pair) = times.windows(2).find(|w| w[1].value.0 <= w[0].value.0) {
        let (before, after) = (pair[0].value.0, &pair[1]);
        let message = format!("times must increase, and {} comes after {before}", after.value.0);
        return Err(source.error(&after.span, message));
    }
    if times.is_empty() {
        return Err(source.error(&table.times.span, "a track needs a time, and a value for it"));
    }
    let mut track = Track { source, object, table, is_empty: true };
    track.place("center", &table.center, &mut curves.position)?;
    track.place("translate", &table.translate, &mut curves.position)?;
    track.place("position", &table.position, &mut curves.position)?;
    track.vectors("rotate", &table.rotate, |r| r.radians(), &mut curves.rotation)?;
    track.vectors("scale", &table.scale, |s| s.0, &mut curves.scale)?;
    track.vectors("direction", &table.direction, |d| d.0, &mut curves.direction)?;
    track.vectors("look_at", &table.look_at, |p| p.0, &mut curves.look_at)?;
    track.numbers("radius", &table.radius, |r| r.0, &mut curves.radius)?;
    let mut intensity = None;
    track.numbers("intensity", &table.intensity, |i| i.0, &mut intensity)?;
    if let Some((value, list)) = intensity.zip(table.intensity.as_ref()) {
        let at = At { span: list.span.clone(), value };
        track.once("intensity", &list.span, curves.intensity.replace(at).is_some())?;
    }
    let lens = &mut curves.lens;
    track.lens("fov_y", &table.fov_y, |a| a.0.to_radians(), |a, _| Projection::FovY(a), lens)?;
    track.lens("fov_x", &table.fov_x, |a| a.0.to_radians(), |a, _| Projection::FovX(a), lens)?;
    let focal_px = |focal, width| Projection::FocalPx { focal, width };
    track.lens("focal_px", &table.focal_px, |d| d.0, focal_px, lens)?;
    track.lens(
        "ortho_height",
        &table.ortho_height,
        |h| h.0,
        |h, _| Projection::OrthoHeight(h),
        lens,
    )?;
    let both = curves.look_at.is_some() && curves.direction.is_some();
    if both && object.what == What::Camera {
        let message = "a camera has `look_at` or `direction`, not both";
        return Err(source.error(&table.object.span, message).help("leave one out"));
    }
    if track.is_empty {
        let name = &object.name;
        let message = format!("the track says nothing of what changes of `{name}`");
        let keys = spelling::list(object.what.keys());
        return Err(source.error(&table.object.span, message).help(format!(
            "give it values for one or several of {keys}: one for each of its `times`"
        )));
    }
    Ok(())
}

struct Track<'a> {
    source: &'a Source<'a>,
    object: &'a Object,
    table: &'a TrackTable,
    is_empty: bool,
}

impl Track<'_> {
    /// The values of a key, where it is given: checked that the object has it, and that there are
    /// as many as times.
    fn values<T, V: Interpolate>(
        &mut self,
        key: &str,
        list: &Option<At<List<T>>>,
        value: impl Fn(&T) -> V,
    ) -> Result<Option<Vec<V>>> {
        let Some(At { span, value: List(list) }) = list else { return Ok(None) };
        self.is_empty = false;
        let what = self.object.what;
        if !what.keys().contains(&key) {
            let message =
                format!("`{}` is {}, which has no `{key}`", self.object.name, what.name());
            let help = format!("what can change of it is {}", spelling::list(what.keys()));
            return Err(self.source.error(&self.source.key(key, span), message).help(help));
        }
        let times = self.table.times.value.0.len();
        if list.len() != times {
            let plural = |n: usize, what: &str| match n {
                1 => format!("1 {what}"),
                _ => format!("{n} {what}s"),
            };
            let (values, times) = (plural(list.len(), "value"), plural(times, "time"));
            let message = format!("`{key}`: {values} for {times}");
            return Err(self.source.error(span, message).help("a value for each time"));
        }
        Ok(Some(list.iter().map(value).collect()))
    }

    fn curve<V: Interpolate>(
        &self,
        values: Vec<V>,
        smooth: impl Fn(Vec<f64>, Vec<V>) -> Curve<V>,
    ) -> Curve<V> {
        let times = self.table.times.value.0.iter().map(|t| t.value.0).collect();
        let interpolation = match self.table.interpolation.unwrap_or_default() {
            Between::Smooth => return smooth(times, values),
            Between::Linear => Interpolation::Linear,
            Between::Step => Interpolation::Step,
        };
        Curve { times, values, interpolation }
    }

    fn vectors<T>(
        &mut self,
        key: &str,
        list: &Option<At<List<T>>>,
        value: impl Fn(&T) -> DVec3,
        to: &mut Option<Curve<DVec3>>,
    ) -> Result<()> {
        let Some(values) = self.values(key, list, value)? else { return Ok(()) };
        let is_there = to.replace(self.curve(values, Curve::<DVec3>::smooth)).is_some();
        self.once(key, &list.as_ref().map_or(0..0, |list| list.span.clone()), is_there)
    }

    fn numbers<T>(
        &mut self,
        key: &str,
        list: &Option<At<List<T>>>,
        value: impl Fn(&T) -> f64,
        to: &mut Option<Curve<f64>>,
    ) -> Result<()> {
        let Some(values) = self.values(key, list, value)? else { return Ok(()) };
        let is_there = to.replace(self.curve(values, Curve::<f64>::smooth)).is_some();
        self.once(key, &list.as_ref().map_or(0..0, |list| list.span.clone()), is_there)
    }

    fn place(
        &mut self,
        key: &str,
        list: &Option<At<List<super::values::Point>>>,
        to: &mut Option<At<Curve<DVec3>>>,
    ) -> Result<()> {
        let mut curve = None;
        self.vectors(key, list, |p| p.0, &mut curve)?;
        let Some((value, list)) = curve.zip(list.as_ref()) else { return Ok(()) };
        let is_there = to.replace(At { span: list.span.clone(), value }).is_some();
        self.once(key, &list.span, is_there)
    }

    fn lens<T>(
        &mut self,
        key: &str,
        list: &Option<At<List<T>>>,
        value: impl Fn(&T) -> f64,
        make: MakeLens,
        to: &mut Option<(MakeLens, Curve<f64>)>,
    ) -> Result<()> {
        let mut curve = None;
        self.numbers(key, list, value, &mut curve)?;
        let Some((curve, list)) = curve.zip(list.as_ref()) else { return Ok(()) };
        if to.replace((make, curve)).is_none() {
            return Ok(());
        }
        let message = "a camera has one lens, and a track says already how it changes";
        Err(self
            .source
            .error(&self.source.key(key, &list.span), message)
            .help("keep one of `fov_y`, `fov_x`, `focal_px` and `ortho_height`"))
    }

    /// Refuses the second list of values for one key of an object.
    fn once(&self, key: &str, span: &Span, is_there: bool) -> Result<()> {
        if !is_there {
            return Ok(());
        }
        let error: Error = self.source.error(
            &self.source.key(key, span),
            format!("another track says how `{key}` of `{}` changes", self.object.name),
        );
        Err(error.help("put all its times into one"))
    }
}
