//! The validity checks of the film's settings.

use super::require::{require, require_color};
use crate::error::Result;
use crate::scene::{AdaptiveSampling, FilmSettings, IntegratorKind};

/// The greatest number of pixels of a picture: 2²⁸, whose film takes 3 GiB.
pub const MAX_PIXELS: u64 = 1 << 28;
/// The greatest number of samples per pixel.
pub const MAX_SPP: u32 = 1 << 16;
/// The greatest number of reflections and refractions along a light path.
pub const MAX_DEPTH: u32 = 1 << 16;

/// The greatest number of rays of ambient occlusion.
pub const MAX_OCCLUSION_RAYS: u32 = 1024;

/// Checks the film's settings.
pub(super) fn check(film: &FilmSettings) -> Result<()> {
    check_size(film.size)?;
    let uniform = AdaptiveSampling { max: film.spp, threshold: AdaptiveSampling::THRESHOLD };
    let AdaptiveSampling { max, threshold } = film.adaptive.unwrap_or(uniform);
    check_samples(film.spp, max)?;
    require((0.0..=1.0).contains(&threshold), || {
        format!("the threshold must be from 0 to 1, found {threshold}")
    })?;
    require(film.adaptive.is_none() || film.integrator == IntegratorKind::Whitted, || {
        "adaptive samples are for the integrator whitted; path has the same number for all pixels"
            .to_owned()
    })
    .map_err(|e| e.help("give a number of samples (spp), or leave out `path`"))?;
    require_color(|| "the background".to_owned(), film.background)?;
    require(film.ambient_occlusion <= MAX_OCCLUSION_RAYS, || {
        let found = film.ambient_occlusion;
        format!("ambient_occlusion must be at most {MAX_OCCLUSION_RAYS} rays, found {found}")
    })?;
    require(film.max_depth <= MAX_DEPTH, || {
        format!("max_depth must be at most {MAX_DEPTH}, found {}", film.max_depth)
    })?;
    require((0.0..=1.0).contains(&film.cutoff), || {
        format!("the cutoff must be from 0 to 1, found {}", film.cutoff)
    })?;
    require(film.exposure.is_finite(), || {
        format!("the exposure must be finite, found {}", film.exposure)
    })
}

/// Checks the size of a picture.
///
/// # Errors
/// When a side is 0 or the picture has more than [`MAX_PIXELS`].
pub fn check_size(size: [u32; 2]) -> Result<()> {
    let [width, height] = size.map(u64::from);
    require(width > 0 && height > 0 && width * height <= MAX_PIXELS, || {
        format!("a picture of {width}x{height} pixels cannot be made")
    })
    .map_err(|e| e.help(format!("each side at least 1, and at most {MAX_PIXELS} pixels in all")))
}

/// Checks the least and the greatest number of samples per pixel.
///
/// # Errors
/// When either is 0 or above [`MAX_SPP`], or `max` is below `min`.
pub fn check_samples(min: u32, max: u32) -> Result<()> {
    for spp in [min, max] {
        require((1..=MAX_SPP).contains(&spp), || {
            format!("samples per pixel must be from 1 to {MAX_SPP}, found {spp}")
        })?;
    }
    require(min <= max, || {
        format!("the most samples per pixel, {max}, are fewer than the fewest, {min}")
    })
}
