//! The values that flags take.

use std::time::Duration;

use clap::ValueEnum;

#[cfg(not(feature = "embree"))]
use crate::error::Error;
use crate::error::Result;
use crate::film::View;
use crate::intersect::{Backend, BuildQuality, Precision};
use crate::measure::stress::Goal;
use crate::scene::Tone;

#[derive(Clone, Copy, ValueEnum)]
pub enum BackendName {
    Embree,
    Rust,
}

impl BackendName {
    /// # Errors
    /// When Embree is asked for and not built in.
    pub fn backend(self) -> Result<Backend> {
        match self {
            BackendName::Rust => Ok(Backend::Rust),
            #[cfg(feature = "embree")]
            BackendName::Embree => Ok(Backend::Embree),
            #[cfg(not(feature = "embree"))]
            BackendName::Embree => Err(Error::input("this envers was built without Embree")
                .help("use `--backend rust`, or build with the feature `embree`")),
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
pub enum PrecisionName {
    Fast,
    Certified,
}

impl From<PrecisionName> for Precision {
    fn from(name: PrecisionName) -> Precision {
        match name {
            PrecisionName::Fast => Precision::Fast,
            PrecisionName::Certified => Precision::Certified,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
pub enum BvhName {
    Auto,
    Low,
    Medium,
}

impl BvhName {
    /// The quality that is asked for by name.
    pub fn quality(self) -> Option<BuildQuality> {
        match self {
            BvhName::Auto => None,
            BvhName::Low => Some(BuildQuality::Low),
            BvhName::Medium => Some(BuildQuality::Medium),
        }
    }
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub enum ViewName {
    Beauty,
    Normal,
    Depth,
    Id,
}

impl From<ViewName> for View {
    fn from(name: ViewName) -> View {
        match name {
            ViewName::Beauty => View::Beauty,
            ViewName::Normal => View::Normal,
            ViewName::Depth => View::Depth,
            ViewName::Id => View::Id,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
pub enum ToneName {
    None,
    Reinhard,
    Aces,
}

impl From<ToneName> for Tone {
    fn from(name: ToneName) -> Tone {
        match name {
            ToneName::None => Tone::None,
            ToneName::Reinhard => Tone::Reinhard,
            ToneName::Aces => Tone::Aces,
        }
    }
}

pub fn size(text: &str) -> std::result::Result<[u32; 2], String> {
    let parse = || {
        let (width, height) = text.split_once(['x', 'X', '×'])?;
        Some([width.trim().parse().ok()?, height.trim().parse().ok()?])
    };
    let size = parse().ok_or("expected WIDTHxHEIGHT in pixels, such as 1920x1080")?;
    crate::scene::check::check_size(size)
        .map_err(|e| format!("{} ({})", e.message(), e.advice().unwrap_or_default()))?;
    Ok(size)
}

pub fn goal(text: &str) -> std::result::Result<Goal, String> {
    let named = |goal: &Goal| goal.name().eq_ignore_ascii_case(text.trim());
    Goal::ALL.into_iter().find(named).ok_or("expected a goal, G1 to G7".to_owned())
}

pub fn seconds(text: &str) -> std::result::Result<f64, String> {
    let in_range = |x: &f64| (0.0..=1e15).contains(x);
    text.parse().ok().filter(in_range).ok_or("expected seconds, from 0 to 1e15".to_owned())
}

pub fn wait(text: &str) -> std::result::Result<Duration, String> {
    let in_range = |x: &f64| (1e-3..=1e6).contains(x);
    let seconds: Option<f64> = text.parse().ok().filter(in_range);
    seconds.map(Duration::from_secs_f64).ok_or("expected seconds, from 0.001 to 1e6".to_owned())
}

/// From how many to how many samples a pixel has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleRange {
    pub min: u32,
    pub max: u32,
}

pub fn sample_range(text: &str) -> std::result::Result<SampleRange, String> {
    let parse = || {
        let (min, max) = text.split_once("..")?;
        Some(SampleRange { min: min.trim().parse().ok()?, max: max.trim().parse().ok()? })
    };
    let range = parse().ok_or("expected MIN..MAX samples per pixel, such as 1..25")?;
    match crate::scene::check::check_samples(range.min, range.max) {
        Ok(()) => Ok(range),
        Err(e) => Err(e.message().to_owned()),
    }
}

pub fn share(text: &str) -> std::result::Result<f32, String> {
    let in_range = |x: &f32| (0.0..=1.0).contains(x);
    text.parse().ok().filter(in_range).ok_or("expected a number from 0 to 1".to_owned())
}

pub fn finite(text: &str) -> std::result::Result<f64, String> {
    text.parse().ok().filter(|x: &f64| x.is_finite()).ok_or("expected a finite number".to_owned())
}

pub fn not_negative(text: &str) -> std::result::Result<f32, String> {
    let in_range = |x: &f32| *x >= 0.0;
    text.parse().ok().filter(in_range).ok_or("expected a number, 0 or above".to_owned())
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
    fn size_is_two_numbers_with_an_x() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        for bad in ["640", "640x", "x480", "-1x5", "0x480", "1000000x1000000", "6.5x4"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }
}
