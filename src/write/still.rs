//! The writer of PNG, JPEG and WebP: one picture, 8 bits per channel.

use std::io;
use std::path::Path;

use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};

use crate::error::Result;
use crate::film::Film;
use crate::write::{Format, Settings, png_bytes, write_atomically};

/// Writes a JPEG, a lossless WebP or, for any other format, a PNG.
pub fn write(film: &Film, path: &Path, settings: &Settings, format: Format) -> Result<()> {
    let bytes = png_bytes(film, settings);
    let [width, height] = film.size;
    let color =
        if film.alpha.is_some() { ExtendedColorType::Rgba8 } else { ExtendedColorType::Rgb8 };
    write_atomically(path, |out| {
        let written = match format {
            Format::Jpeg => JpegEncoder::new_with_quality(out, settings.quality)
                .write_image(&bytes, width, height, color),
            Format::WebP => {
                WebPEncoder::new_lossless(out).write_image(&bytes, width, height, color)
            }
            // Faster than choosing a filter for each row, and no larger: docs/performance.md.
            _ => PngEncoder::new_with_quality(out, CompressionType::Fast, FilterType::Paeth)
                .write_image(&bytes, width, height, color),
        };
        written.map_err(|error| match error {
            ImageError::IoError(error) => error,
            other => io::Error::other(other),
        })
    })
}
