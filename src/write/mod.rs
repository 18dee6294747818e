//! From film to file, whole or not at all.

mod atomic;
mod exr;
mod movie;
mod png;

use std::path::Path;

use crate::error::{Error, Result};
use crate::film::Film;
use crate::scene::{FilmSettings, Tone, Transfer};

pub use atomic::{check as check_file, write_atomically};
pub use movie::Movie;
pub use png::encode as png_bytes;

/// What an output file is, by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 bits a channel, clamped.
    Png,
    /// Linear floats, unclamped.
    Exr,
    /// Many frames of 256 colours each.
    Gif,
    /// Many frames with the pixels of a PNG each.
    Apng,
}

/// How to write a picture. `exposure`, `tone` and `transfer` are how a PNG shows radiance; an EXR
/// always holds the radiance itself.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Radiance is multiplied with 2 to the power of this.
    pub exposure: f64,
    /// What then brings it into \[0, 1\].
    pub tone: Tone,
    /// What that is encoded by.
    pub transfer: Transfer,
    /// Whether an EXR stores 16-bit floats rather than 32-bit ones.
    pub half: bool,
    /// What an EXR says of itself: names and values of what determines the picture.
    pub metadata: Vec<(String, String)>,
}

impl Settings {
    /// How a scene's film is shown; 32 bits, no metadata.
    pub fn from_film(film: &FilmSettings) -> Self {
        let &FilmSettings { exposure, tone, transfer, .. } = film;
        Self { exposure, tone, transfer, half: false, metadata: Vec::new() }
    }

    /// The byte of a PNG for the radiance of one channel, in f64:
    /// round(255 · transfer(tone(2^exposure · radiance))).
    pub fn byte(&self, radiance: f32) -> u8 {
        let toned = self.tone.apply(f64::from(radiance) * self.exposure.exp2());
        (self.transfer.encode(toned) * 255.0).round() as u8
    }
}

impl Format {
    /// The format that the file's extension names.
    ///
    /// # Errors
    /// When it names none that can be written.
    pub fn from_path(path: &Path) -> Result<Self> {
        match path.extension().unwrap_or_default().to_string_lossy().to_lowercase().as_str() {
            "png" => Ok(Format::Png),
            "exr" => Ok(Format::Exr),
            "gif" => Ok(Format::Gif),
            "apng" => Ok(Format::Apng),
            "" => Err(Error::input("the output has no extension that tells its format").at(path)),
            other => {
                Err(Error::input(format!("pictures that end in .{other} are not written")).at(path))
            }
        }
        .map_err(|e| e.help("name it .png (8 bits), .exr (floats), .gif or .apng (animated)"))
    }

    /// Whether it holds many frames.
    pub fn is_animated(self) -> bool {
        matches!(self, Format::Gif | Format::Apng)
    }
}

/// Checks that a picture could be written to `path`: that its format is known and its folder is
/// there and can be written to. Called before the work begins.
///
/// # Errors
/// When it could not.
pub fn check(path: &Path) -> Result<()> {
    Format::from_path(path)?;
    atomic::check(path)
}

/// Writes a film, in the format that the extension names; an animated one then has one frame. A
/// [`Movie`] writes many.
///
/// # Errors
/// When the file cannot be written; what stood there before then stands there still.
pub fn write(film: &Film, path: &Path, settings: &Settings) -> Result<()> {
    match Format::from_path(path)? {
        Format::Png => png::write(film, path, settings),
        Format::Exr => exr::write(film, path, settings),
        Format::Gif | Format::Apng => {
            let mut movie = Movie::create(path, film.size, 1, 1.0)?;
            movie.push(film, settings)?;
            movie.finish()
        }
    }
}
