//! The output files: a film written as PNG, JPEG, WebP, EXR, GIF or animated PNG, completely or not at
//! all.
//!
//! ```
//! use envers::{Film, View};
//! use envers::internals::{Settings, write};
//!
//! let folder = tempfile::tempdir().unwrap();
//! let film = Film { size: [1, 1], view: View::Beauty, pixels: vec![[0.5; 3]], alpha: None };
//! write(&film, &folder.path().join("grey.png"), &Settings::default())?;
//! # Ok::<(), envers::Error>(())
//! ```

mod atomic;
mod bytes;
mod exr;
mod movie;
mod still;
mod target;
mod temporary;

use std::path::Path;

use crate::error::{Error, Result};
use crate::film::Film;
use crate::scene::{FilmSettings, Tone, Transfer};

#[cfg(feature = "cli")]
pub use atomic::check as check_files;
pub use atomic::write_atomically;
pub use bytes::{bytes_per_pixel, encode as png_bytes};
pub use movie::Movie;
#[cfg(feature = "cli")]
pub use target::{folder_of, resolve};
#[cfg(all(feature = "cli", unix))]
pub use temporary::remove_all as remove_temporaries;

/// The format of an output file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// PNG: 8 bits per channel, clamped.
    Png,
    /// JPEG: 8 bits per channel, compressed with loss.
    Jpeg,
    /// WebP: 8 bits per channel, compressed without loss.
    WebP,
    /// OpenEXR: linear floats, unclamped.
    Exr,
    /// GIF: an animation with 256 colours per frame.
    Gif,
    /// Animated PNG: an animation whose frames have the pixels of a PNG.
    Apng,
}

/// The settings of an output file. `exposure`, `tone` and `transfer` map radiance to the bytes of
/// all formats but EXR, which always holds the radiance itself.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The exposure in stops: radiance is multiplied by 2 to the power of this.
    pub exposure: f64,
    /// The tone curve, which maps the exposed radiance to \[0, 1\].
    pub tone: Tone,
    /// The transfer function, which encodes the toned value.
    pub transfer: Transfer,
    /// True if an EXR stores 16-bit floats rather than 32-bit ones.
    pub half: bool,
    /// The quality of a JPEG, from 1 (smallest file) to 100 (nearest to the pixels).
    pub quality: u8,
    /// The metadata of an EXR: names and values of what determines the picture.
    pub metadata: Vec<(String, String)>,
}

impl Default for Settings {
    fn default() -> Self {
        let (exposure, tone, transfer) = (0.0, Tone::default(), Transfer::default());
        let (half, quality, metadata) = (false, Self::JPEG_QUALITY, Vec::new());
        Self { exposure, tone, transfer, half, quality, metadata }
    }
}

impl Settings {
    /// The quality of a JPEG unless another one is asked for.
    pub const JPEG_QUALITY: u8 = 90;

    /// The settings of a scene's film, with 32 bits, the default quality and no metadata.
    pub fn from_film(film: &FilmSettings) -> Self {
        let &FilmSettings { exposure, tone, transfer, .. } = film;
        Self { exposure, tone, transfer, ..Self::default() }
    }

    /// The bytes for the radiance of a pixel, computed in f64:
    /// round(255 · transfer(tone(2^exposure · radiance))).
    pub fn bytes(&self, radiance: [f32; 3]) -> [u8; 3] {
        let factor = self.exposure.exp2();
        let toned = self.tone.apply(radiance.map(|x| f64::from(x) * factor));
        toned.map(|x| (self.transfer.encode(x) * 255.0).round() as u8)
    }
}

impl Format {
    /// The format that a file's extension names.
    ///
    /// # Errors
    /// When the extension names no format that can be written.
    pub fn from_path(path: &Path) -> Result<Self> {
        match path.extension().unwrap_or_default().to_string_lossy().to_lowercase().as_str() {
            "png" => Ok(Format::Png),
            "jpg" | "jpeg" => Ok(Format::Jpeg),
            "webp" => Ok(Format::WebP),
            "exr" => Ok(Format::Exr),
            "gif" => Ok(Format::Gif),
            "apng" => Ok(Format::Apng),
            "" => Err("the output has no extension that tells its format".to_owned()),
            other => Err(format!("pictures that end in .{other} are not written")),
        }
        .map_err(|message| {
            let help =
                "name it .png, .jpg or .webp (8 bits), .exr (floats), .gif or .apng (animated)";
            Error::input(message).at(path).help(help)
        })
    }

    /// Checks that a picture of this format can be so large.
    ///
    /// # Errors
    /// When it cannot.
    pub fn check_size(self, [width, height]: [u32; 2], path: &Path) -> Result<()> {
        // The sides of a GIF and a JPEG have 16 bits. 16383 is the most that libwebp reads.
        let (name, limit) = match self {
            Format::Gif => ("a GIF", u32::from(u16::MAX)),
            Format::Jpeg => ("a JPEG", u32::from(u16::MAX)),
            Format::WebP => ("a WebP", 16383),
            Format::Png | Format::Exr | Format::Apng => return Ok(()),
        };
        if width.max(height) <= limit {
            return Ok(());
        }
        let other = if self.is_animated() { "an .apng" } else { "a .png" };
        Err(Error::input(format!("{name} cannot have {width}x{height} pixels"))
            .at(path)
            .help(format!("at most {limit} on a side; {other} can have more")))
    }

    /// Checks that a picture with alpha can have this format.
    ///
    /// # Errors
    /// When it cannot.
    pub fn check_alpha(self, path: &Path) -> Result<()> {
        let (message, help) = match self {
            Format::Jpeg => ("a JPEG has no alpha", "write a .png, .webp or .exr"),
            Format::Gif => ("a GIF has no alpha between none and all", "write an .apng"),
            Format::Png | Format::WebP | Format::Exr | Format::Apng => return Ok(()),
        };
        Err(Error::input(format!("the background is transparent, and {message}"))
            .at(path)
            .help(format!("{help}, or leave the background opaque")))
    }

    /// True if it can hold several frames.
    pub fn is_animated(self) -> bool {
        matches!(self, Format::Gif | Format::Apng)
    }
}

/// Checks that a picture could be written to `path`: that its format is known, and its folder exists
/// and is writable. Called before a picture is rendered.
///
/// # Errors
/// When it could not be written.
#[cfg(feature = "cli")]
pub fn check(path: &Path) -> Result<()> {
    Format::from_path(path)?;
    atomic::check([path])
}

/// Writes a film in the format that the extension names; an animated format then has one frame.
/// `Movie` writes several.
///
/// # Errors
/// When the file cannot be written; an older file then stays as it was.
pub fn write(film: &Film, path: &Path, settings: &Settings) -> Result<()> {
    let format = Format::from_path(path)?;
    format.check_size(film.size, path)?;
    if film.alpha.is_some() {
        format.check_alpha(path)?;
    }
    match format {
        Format::Png | Format::Jpeg | Format::WebP => still::write(film, path, settings, format),
        Format::Exr => exr::write(film, path, settings),
        Format::Gif | Format::Apng => {
            let mut movie = Movie::create(path, film.size, film.alpha.is_some(), 1, 1.0)?;
            movie.push(film, settings)?;
            movie.finish()
        }
    }
}
