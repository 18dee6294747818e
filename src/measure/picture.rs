//! The comparison of two pictures: RMSE, PSNR and the largest difference.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::{ReadChannels, ReadLayers};
use image::ImageFormat;
use serde::Serialize;

use crate::error::{Error, Result};
use crate::load::{self, Limits};
use crate::write::Format;

/// A picture as it is stored in a PNG, JPEG, WebP or EXR file.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The width and height in pixels.
    pub size: [u32; 2],
    /// The channels' names, in the order of their values. A is alpha: beside it the values of an EXR are
    /// premultiplied, and those of the other formats straight.
    pub channels: Vec<String>,
    /// The values of each pixel's channels: an EXR's floats, or else bytes over 255.
    pub values: Vec<f32>,
}

/// The differences of two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The root-mean-square difference of the values.
    pub rmse: f64,
    /// The peak signal-to-noise ratio for a peak of 1, −20 log₁₀ rmse in dB; infinite (null in JSON)
    /// when the pictures are equal.
    pub psnr: f64,
    /// The largest difference of two values.
    pub max: f64,
    /// The number of pixels with a value that differs by more than the tolerance.
    pub pixels_differing: u64,
}

impl Picture {
    /// Reads a PNG, JPEG, WebP or EXR, within the default limits.
    ///
    /// # Errors
    /// When the file cannot be read, is none of these, or exceeds a limit.
    pub fn read(path: &Path) -> Result<Self> {
        let [bytes] = load::read_for_comparison([path], Limits::default())?;
        Self::decode(path, &bytes)
    }

    /// Reads two pictures, within limits on both together. If only one of them has alpha, the other gets
    /// it, too, and is opaque.
    ///
    /// # Errors
    /// When a file cannot be read, is none of these formats, or they exceed a limit.
    pub fn read_pair(a: &Path, b: &Path, limits: Limits) -> Result<[Self; 2]> {
        // The memory for both is counted before either is decoded.
        let [first, second] = load::read_for_comparison([a, b], limits)?;
        let (mut a, mut b) = (Self::decode(a, &first)?, Self::decode(b, &second)?);
        a.add_alpha_as_in(&b);
        b.add_alpha_as_in(&a);
        Ok([a, b])
    }

    /// Adds the alpha of an opaque picture, if that is all that this one lacks of the channels of another.
    fn add_alpha_as_in(&mut self, other: &Self) {
        let Some(at) = other.channels.iter().position(|channel| channel == "A") else { return };
        let mut channels = self.channels.clone();
        channels.insert(at.min(channels.len()), "A".to_owned());
        if channels != other.channels {
            return;
        }
        let opaque = |pixel: &[f32]| [&pixel[..at], &[1.0], &pixel[at..]].concat();
        self.values = self.values.chunks(self.channels.len()).flat_map(opaque).collect();
        self.channels = channels;
    }

    /// Decodes the bytes of the file at a path.
    fn decode(path: &Path, bytes: &[u8]) -> Result<Self> {
        let damaged = |e: &dyn std::fmt::Display| {
            Error::input(format!("the picture cannot be decoded: {e}")).at(path)
        };
        // Only the kinds that are written can be compared, so the same names count; the advice differs.
        let format = Format::from_path(path).map_err(|_| {
            Error::input("only PNG, JPEG, WebP and EXR pictures can be compared").at(path)
        })?;
        let of_bytes = |format: ImageFormat| {
            let image = image::load_from_memory_with_format(bytes, format);
            let image = image.map_err(|e| damaged(&e))?;
            let size = [image.width(), image.height()];
            // A picture that is opaque everywhere has no alpha that matters.
            let rgba = image.color().has_alpha().then(|| image.to_rgba8().into_raw());
            let rgba = rgba.filter(|rgba| rgba.chunks(4).any(|pixel| pixel[3] < u8::MAX));
            let (channels, bytes): (&[&str], _) = match rgba {
                Some(rgba) => (&["R", "G", "B", "A"], rgba),
                None => (&["R", "G", "B"], image.into_rgb8().into_raw()),
            };
            Ok(Self {
                size,
                channels: channels.iter().map(|&name| name.to_owned()).collect(),
                values: bytes.iter().map(|&b| f32::from(b) / 255.0).collect(),
            })
        };
        match format {
            Format::Gif | Format::Apng => Err(Error::input("animated pictures cannot be compared")
                .at(path)
                .help("compare their frames: render them as `-o frame-####.png`")),
            Format::Png => of_bytes(ImageFormat::Png),
            Format::Jpeg => of_bytes(ImageFormat::Jpeg),
            Format::WebP => of_bytes(ImageFormat::WebP),
            Format::Exr => {
                let image = exr::prelude::read()
                    .no_deep_data()
                    .largest_resolution_level()
                    .all_channels()
                    .first_valid_layer()
                    .all_attributes()
                    .from_buffered(Cursor::new(bytes))
                    .map_err(|e| damaged(&e))?;
                let layer = image.layer_data;
                let (width, height) = (layer.size.width(), layer.size.height());
                let list = &layer.channel_data.list;
                // The channels are stored one after the other, and become the values of each pixel.
                let mut values = vec![0.0; width * height * list.len()];
                for (c, channel) in list.iter().enumerate() {
                    let pixels = channel.sample_data.values_as_f32();
                    for (value, x) in values.iter_mut().skip(c).step_by(list.len()).zip(pixels) {
                        *value = x;
                    }
                }
                let channels = list.iter().map(|c| c.name.to_string()).collect();
                Ok(Self { size: [width as u32, height as u32], channels, values })
            }
        }
    }
}

/// Computes the differences of two pictures of the same size and channels. Values that are the same
/// infinity, or both NaN, do not differ; a value that is finite in one picture only differs
/// infinitely.
///
/// # Errors
/// When the sizes or the channels differ.
pub fn compare_pictures(a: &Picture, b: &Picture, tolerance: f32) -> Result<Comparison> {
    if a.size != b.size {
        let [size, other] =
            [a, b].map(|picture| format!("{}x{}", picture.size[0], picture.size[1]));
        return Err(Error::input(format!("{size} and {other} pixels cannot be compared")));
    }
    if a.channels != b.channels {
        let (a, b) = (a.channels.join(", "), b.channels.join(", "));
        return Err(Error::input(format!("channels {a} and channels {b} cannot be compared"))
            .help("compare EXRs of the same view"));
    }
    // The same infinity or NaN in both does not differ.
    let difference = |(x, y): (&f32, &f32)| {
        if x == y || (x.is_nan() && y.is_nan()) {
            0.0
        } else {
            let d = f64::from((x - y).abs());
            if d.is_nan() { f64::INFINITY } else { d }
        }
    };
    // The sums over all values, and the pixels with one beyond the tolerance.
    let (mut squares, mut max, mut differing) = (0.0, 0.0f64, 0);
    let n = a.channels.len().max(1);
    for (p, q) in a.values.chunks(n).zip(b.values.chunks(n)) {
        let mut largest = 0.0f64;
        for d in p.iter().zip(q).map(difference) {
            squares += d * d;
            largest = largest.max(d);
        }
        max = max.max(largest);
        differing += u64::from(largest > f64::from(tolerance));
    }
    let rmse = (squares / a.values.len().max(1) as f64).sqrt();
    Ok(Comparison { rmse, psnr: -20.0 * rmse.log10(), max, pixels_differing: differing })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Picture {
        Picture {
            size: [values.len() as u32, 1],
            channels: vec!["Y".into()],
            values: values.to_vec(),
        }
    }

    #[test]
    fn equal_pictures_have_no_error_and_infinite_psnr() {
        let a = grey(&[0.5, f32::INFINITY, f32::NAN]);
        let c = compare_pictures(&a, &a, 0.0).unwrap();
        assert_eq!((c.rmse, c.psnr, c.pixels_differing), (0.0, f64::INFINITY, 0));
    }

    #[test]
    fn rmse_and_psnr_of_a_known_difference() {
        let c = compare_pictures(&grey(&[0.0, 0.0]), &grey(&[0.1, 0.1]), 0.0).unwrap();
        assert!((c.rmse - 0.1).abs() < 1e-7 && (c.psnr - 20.0).abs() < 1e-5, "{c:?}");
    }

    #[test]
    fn tolerance_decides_which_pixels_differ() {
        let c = compare_pictures(&grey(&[0.0, 0.0, 0.0]), &grey(&[0.0, 0.1, 0.2]), 0.15).unwrap();
        assert_eq!(c.pixels_differing, 1);
    }

    #[test]
    fn a_value_that_is_finite_in_one_picture_only_differs_infinitely() {
        let c = compare_pictures(&grey(&[f32::NAN]), &grey(&[0.0]), 1.0).unwrap();
        assert_eq!((c.max, c.pixels_differing), (f64::INFINITY, 1));
    }

    #[test]
    fn sizes_that_differ_are_an_error() {
        let error = compare_pictures(&grey(&[0.0]), &grey(&[0.0, 0.0]), 0.0).unwrap_err();
        assert_eq!(error.message(), "1x1 and 2x1 pixels cannot be compared");
    }
}
