//! The values of flags, and their parsers.

use std::str::FromStr;
use std::time::Duration;

use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::error::{Error, Result};
use crate::film::View;
use crate::intersect::{Backend, BuildQuality, Precision};
use crate::load::{Limit, UpAxis};
use crate::measure::stress::Goal;
use crate::scene::check::{check_samples, check_size};
use crate::scene::{IntegratorKind, ShadingModel, Tone};

/// A ray tracing backend; none leaves the choice to the renderer.
pub type BackendChoice = Option<Backend>;

/// Returns the parser of a [`BackendChoice`].
pub fn backend_choice() -> impl TypedValueParser<Value = BackendChoice> {
    let choice = |name: String| match &*name {
        "auto" => Ok(None),
        name => named_backend(name).map(Some),
    };
    PossibleValuesParser::new(["auto", "embree", "rust"]).try_map(choice)
}

/// Returns the parser of a ray tracing backend.
pub fn backend() -> impl TypedValueParser<Value = Backend> {
    PossibleValuesParser::new(["embree", "rust"]).try_map(|name| named_backend(&name))
}

/// Returns the backend of a name, `embree` or `rust`. The name of Embree is known in every build, and an
/// error in one without Embree.
fn named_backend(name: &str) -> Result<Backend, &'static str> {
    match name {
        "rust" => Ok(Backend::Rust),
        #[cfg(feature = "embree")]
        _ => Ok(Backend::Embree),
        #[cfg(not(feature = "embree"))]
        _ => Err("this envers was built without Embree; its backend is `rust`"),
    }
}

/// The build quality of Embree's BVH; none leaves the choice to the renderer.
pub type BvhQuality = Option<BuildQuality>;

/// The names of values and the values.
pub type Choices<T> = [(&'static str, T)];

pub const PRECISIONS: &Choices<Precision> =
    &[("fast", Precision::Fast), ("certified", Precision::Certified)];
pub const BVH_QUALITIES: &Choices<BvhQuality> =
    &[("auto", None), ("low", Some(BuildQuality::Low)), ("medium", Some(BuildQuality::Medium))];
pub const VIEWS: &Choices<View> =
    &[("beauty", View::Beauty), ("normal", View::Normal), ("depth", View::Depth), ("id", View::Id)];
pub const SHADING_MODELS: &Choices<ShadingModel> =
    &[("pbr", ShadingModel::Pbr), ("phong", ShadingModel::Phong)];
pub const INTEGRATORS: &Choices<IntegratorKind> =
    &[("whitted", IntegratorKind::Whitted), ("path", IntegratorKind::Path)];
pub const UP_AXES: &Choices<UpAxis> = &[
    ("x", UpAxis::X),
    ("y", UpAxis::Y),
    ("z", UpAxis::Z),
    ("-x", UpAxis::NegX),
    ("-y", UpAxis::NegY),
    ("-z", UpAxis::NegZ),
];
pub const TONES: &Choices<Tone> = &{
    const fn choice(tone: Tone) -> (&'static str, Tone) {
        (tone.name(), tone)
    }
    [
        choice(Tone::None),
        choice(Tone::Reinhard),
        choice(Tone::Aces),
        choice(Tone::KhronosPbrNeutral),
        choice(Tone::Agx),
    ]
};

/// Returns the parser of a value that is chosen by name.
pub fn choice<T>(choices: &'static Choices<T>) -> impl TypedValueParser<Value = T>
where
    T: Copy + Send + Sync + 'static,
{
    let value = |name: String| {
        let found = choices.iter().find(|(choice, _)| *choice == name);
        found.expect("clap accepts no other names").1
    };
    PossibleValuesParser::new(choices.iter().map(|(name, _)| *name)).map(value)
}

/// The size of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// Width and height.
    Exact([u32; 2]),
    /// The width; the height follows in the scene's proportions.
    Width(u32),
}

/// Parses a picture's size, such as `1920x1080` or `640`.
pub fn size(text: &str) -> Result<Size, String> {
    let number = |text: &str| text.trim().parse::<u32>().ok();
    let parse = || match text.split_once(['x', 'X', '×']) {
        Some((width, height)) => Some(Size::Exact([number(width)?, number(height)?])),
        None => Some(Size::Width(number(text)?)),
    };
    let message =
        "expected WIDTHxHEIGHT in pixels, such as 1920x1080, or the width alone, such as 640";
    let size = parse().ok_or(message)?;
    // Of a width alone the height is known once the scene is loaded.
    let least = match size {
        Size::Exact(size) => size,
        Size::Width(width) => [width, 1],
    };
    check_size(least)
        .map_err(|e| format!("{} ({})", e.message(), e.advice().unwrap_or_default()))?;
    Ok(size)
}

/// Parses an elevation in degrees.
pub fn elevation(text: &str) -> Result<f64, String> {
    number(text, |x: &f64| x.abs() <= 90.0, "expected an angle from -90 to 90 degrees")
}

/// Parses the name of a goal, `G1` to `G13`.
pub fn goal(text: &str) -> Result<Goal, String> {
    let is_named = |goal: &Goal| goal.name().eq_ignore_ascii_case(text.trim());
    Goal::ALL.into_iter().find(is_named).ok_or("expected a goal, G1 to G13".to_owned())
}

/// Parses a time of an animation in seconds.
pub fn seconds(text: &str) -> Result<f64, String> {
    number(text, |x| (0.0..=1e15).contains(x), "expected seconds, from 0 to 1e15")
}

/// Parses a time limit in seconds.
pub fn duration(text: &str) -> Result<Duration, String> {
    number(text, |x| (1e-3..=1e6).contains(x), "expected seconds, from 0.001 to 1e6")
        .map(Duration::from_secs_f64)
}

/// Parses a number from 0 to 1.
pub fn share(text: &str) -> Result<f32, String> {
    number(text, |x| (0.0..=1.0).contains(x), "expected a number from 0 to 1")
}

/// Parses a finite number.
pub fn finite(text: &str) -> Result<f64, String> {
    number(text, |x: &f64| x.is_finite(), "expected a finite number")
}

/// Parses the tolerance of a comparison: a number, or a fraction such as `1/255`.
pub fn tolerance(text: &str) -> Result<f32, String> {
    let expected = "expected a number, 0 or above, or a fraction such as 1/255";
    let part = |text: &str| number(text, |x: &f64| x.is_finite() && *x >= 0.0, expected);
    let value = match text.split_once('/') {
        Some((above, below)) => part(above)? / part(below)?,
        None => part(text)?,
    };
    (value as f32).is_finite().then_some(value as f32).ok_or(expected.to_owned())
}

/// Parses a number that must be valid.
fn number<T: FromStr>(
    text: &str,
    is_valid: impl Fn(&T) -> bool,
    expected: &str,
) -> Result<T, String> {
    text.parse().ok().filter(is_valid).ok_or(expected.to_owned())
}

/// The fewest and the most samples of a pixel in adaptive sampling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleRange {
    pub min: u32,
    pub max: u32,
}

/// Parses a range of samples per pixel, such as `1..25`.
pub fn sample_range(text: &str) -> Result<SampleRange, String> {
    let parse = || {
        let (min, max) = text.split_once("..")?;
        Some(SampleRange { min: min.trim().parse().ok()?, max: max.trim().parse().ok()? })
    };
    let range = parse().ok_or("expected MIN..MAX samples per pixel, such as 1..25")?;
    check_samples(range.min, range.max).map_err(|e| e.message().to_owned())?;
    Ok(range)
}

/// A limit and its maximum, written as `NAME=NUMBER`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NamedLimit(pub Limit, pub u64);

impl FromStr for NamedLimit {
    type Err = Error;

    /// # Errors
    /// When the name is that of no limit, or the number is none from 0 to 2⁶⁴ − 1.
    fn from_str(text: &str) -> Result<Self> {
        let (name, number) =
            text.split_once('=').ok_or_else(|| Error::input("not of the form NAME=NUMBER"))?;
        let limit = Limit::ALL.into_iter().find(|limit| limit.name() == name).ok_or_else(|| {
            let names = Limit::ALL.map(Limit::name).join(", ");
            Error::input(format!("no limit is called `{name}`; they are {names}"))
        })?;
        let parsed = number.parse().map(|number| Self(limit, number));
        parsed.map_err(|_| Error::input(format!("`{number}` is no whole number below 2^64")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_of_samples_is_two_numbers_with_two_dots() {
        assert_eq!(sample_range("4..36"), Ok(SampleRange { min: 4, max: 36 }));
        for bad in ["4", "4..", "..4", "4-36", "4...36", "0..4", "36..4", "1..65537", "-1..4", ""] {
            assert!(sample_range(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn size_is_two_numbers_with_an_x_or_the_width() {
        assert_eq!(size("640x480"), Ok(Size::Exact([640, 480])));
        assert_eq!(size("640"), Ok(Size::Width(640)));
        for bad in ["0", "", "640x", "x480", "-1x5", "0x480", "1000000x1000000", "6.5x4"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_named_limit_reads_as_it_is_written() {
        for limit in Limit::ALL {
            let text = format!("{}=123", limit.name());
            assert_eq!(text.parse::<NamedLimit>().unwrap(), NamedLimit(limit, 123));
        }
    }

    #[test]
    fn what_is_no_limit_is_told_from_what_is_no_number() {
        let error = |text: &str| text.parse::<NamedLimit>().unwrap_err().to_string();
        assert!(error("pixel=3").contains("they are bytes, json"));
        assert!(error("pixels=-3").contains("no whole number"));
        assert!(error("pixels").contains("NAME=NUMBER"));
    }
}
