//! The decoder of images for textures.

use std::borrow::Cow;
use std::io::Cursor;
use std::path::PathBuf;

use image::{ColorType, DynamicImage, ImageDecoder, ImageReader, Rgb};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::load::images::ktx2::{self, undecodable};
use crate::load::images::{MAX_SIDE, exr_header};
use crate::load::limits::Limit;
use crate::load::sandbox::{OpenedFile, Sandbox};
use crate::scene::{Image, Texels};

/// The number of encoded images that are read into memory, and then decoded in parallel.
const BATCH: usize = 16;

/// The source of the bytes of an image (PNG, JPEG, WebP, TGA, BMP, Radiance HDR, OpenEXR or KTX 2).
pub enum Source<'a> {
    /// Bytes in memory, and the name of the image.
    Bytes(Cow<'a, [u8]>, String),
    /// A file.
    File(OpenedFile),
}

/// An image that is about to be decoded, within the limits, or only named.
struct PreparedImage<'a> {
    /// The encoded image; of a file that is only named nothing.
    bytes: Cow<'a, [u8]>,
    name: String,
    /// The path, if it is a file.
    path: Option<PathBuf>,
    /// The number of pixels of 8-bit numbers that take as much memory; none if it is only named.
    pixels: Option<u64>,
}

/// Decodes the images that are needed, in parallel; the others are only named, and their files only
/// have to be there. `open` opens the file of an image: few are open at a time.
///
/// The limits are charged in the order of the images, so that the first that is too much does not
/// depend on threads.
///
/// Each result is an error where the image cannot be opened or read, is of none of these formats,
/// is damaged, is larger than 32768 pixels on a side, or exceeds a limit.
pub fn decode_all<'a, T: Sync>(
    images: &[T],
    sandbox: &Sandbox,
    open: impl Fn(&T) -> Result<Source<'a>>,
    is_needed: impl Fn(&T) -> bool,
) -> Vec<Result<Image>> {
    let mut decoded = Vec::with_capacity(images.len());
    for batch in images.chunks(BATCH) {
        // Images are read and charged one by one, in order; only the decoding is parallel.
        let prepare =
            |image| open(image).and_then(|source| prepare(source, sandbox, is_needed(image)));
        let prepared: Vec<_> = batch.iter().map(prepare).collect();
        decoded.par_extend(prepared.into_par_iter().map(|image| image?.decode()));
    }
    decoded
}

/// Decodes the image in a file; returns also how many of its colours' values were negative or not finite, and
/// became 0.
///
/// # Errors
/// When the image cannot be opened or read, is damaged or too large, or exceeds a limit, as in [`decode_all`].
pub fn decode_one(file: OpenedFile, sandbox: &Sandbox) -> Result<(Image, u64)> {
    let prepared = prepare(Source::File(file), sandbox, true)?;
    let mut image = prepared.decode_unchecked()?;
    let invalid = remove_invalid_floats(&mut image.texels);
    Ok((image, invalid))
}

/// Reads the bytes of an image if it is needed, and charges the limits for what it will take.
fn prepare<'a>(
    source: Source<'a>,
    sandbox: &Sandbox,
    is_needed: bool,
) -> Result<PreparedImage<'a>> {
    let (bytes, name, path) = match source {
        Source::Bytes(bytes, name) => (bytes, name, None),
        Source::File(file) => {
            let path = file.path.clone();
            let bytes = if is_needed { file.read(sandbox)? } else { Vec::new() };
            (bytes.into(), path.display().to_string(), Some(path))
        }
    };
    let mut image = PreparedImage { bytes, name, path, pixels: None };
    if is_needed {
        image.pixels = Some(image.charge_limits(sandbox).map_err(|e| image.locate(e))?);
    }
    Ok(image)
}

/// Returns the bytes of an image that is compared with another one, and charges the limits for it: each
/// pixel, and the channels of an EXR, take about as much memory as four pixels of a texture, since they
/// become floats and several pictures of what is perceived.
///
/// # Errors
/// When the file cannot be read, the image's header is damaged, or it exceeds a limit.
#[cfg(feature = "measure")]
pub fn read_for_comparison(file: OpenedFile, sandbox: &Sandbox) -> Result<Vec<u8>> {
    let path = file.path.clone();
    let bytes = file.read(sandbox)?;
    let charge = || {
        let pixels = if exr_header::is_exr(&bytes) {
            exr_header::pixels(&bytes, true)?
        } else {
            let reader = ImageReader::new(Cursor::new(&bytes)).with_guessed_format();
            let reader = reader.map_err(undecodable)?;
            let (width, height) = reader.into_dimensions().map_err(undecodable)?;
            if width.max(height) > MAX_SIDE {
                return Err(Error::input(format!("the image is larger than {MAX_SIDE} on a side")));
            }
            u64::from(width) * u64::from(height) * 4
        };
        sandbox.consume_pixels(pixels, bytes.len() as u64)
    };
    charge().map_err(|error| error.at(&path))?;
    Ok(bytes)
}

impl PreparedImage<'_> {
    /// Adds the path to an error, if the image is a file.
    fn locate(&self, error: Error) -> Error {
        match &self.path {
            Some(path) => error.at(path),
            None => error,
        }
    }

    /// A reader of the formats of the `image` crate.
    fn reader(&self) -> Result<ImageReader<Cursor<&[u8]>>> {
        let mut reader = ImageReader::new(Cursor::new(&self.bytes[..]))
            .with_guessed_format()
            .map_err(|e| Error::input(format!("the image cannot be read: {e}")))?;
        if reader.format().is_none() && self.name.to_lowercase().ends_with(".tga") {
            // A TGA file has no signature to guess by.
            reader.set_format(image::ImageFormat::Tga);
        }
        Ok(reader)
    }

    /// Charges the limits for an image, and returns how many pixels of 8-bit numbers take as much
    /// memory.
    fn charge_limits(&self, sandbox: &Sandbox) -> Result<u64> {
        // The header tells the size, so that the limits are checked before any pixel is decoded.
        sandbox.consume(Limit::Pictures, 1)?;
        let ([width, height], depth, asked) = if ktx2::is_ktx(&self.bytes) {
            let ktx2::Header { size, is_float } = ktx2::header(&self.bytes)?;
            if size.into_iter().any(|side| side > MAX_SIDE) {
                return Err(Error::input(format!("the image is larger than {MAX_SIDE} on a side")));
            }
            (size, if is_float { 4 } else { 1 }, 0)
        } else {
            // Headers of EXR files say more than the size of the image.
            let asked = if exr_header::is_exr(&self.bytes) {
                exr_header::pixels(&self.bytes, false)?
            } else {
                0
            };
            let decoder = self.reader()?.into_decoder().map_err(undecodable)?;
            let size = decoder.dimensions();
            (size.into(), channel_bytes(decoder.color_type()), asked)
        };
        let pixels = (u64::from(width) * u64::from(height) * depth).max(asked);
        sandbox.consume_pixels(pixels, self.bytes.len() as u64)?;
        Ok(pixels)
    }

    fn decode(self) -> Result<Image> {
        let mut image = self.decode_unchecked()?;
        remove_invalid_floats(&mut image.texels);
        Ok(image)
    }

    /// Decodes the image with the floats that the file has.
    fn decode_unchecked(self) -> Result<Image> {
        let Some(pixels) = self.pixels else { return Ok(Image::unread(self.name)) };
        let decode = || {
            if ktx2::is_ktx(&self.bytes) {
                return Ok((ktx2::header(&self.bytes)?.size, ktx2::decode(&self.bytes)?));
            }
            let mut reader = self.reader()?;
            let mut limits = image::Limits::default();
            limits.max_image_width = Some(MAX_SIDE);
            limits.max_image_height = Some(MAX_SIDE);
            // Four channels, more than twice, and room for what decoders need besides.
            limits.max_alloc = Some((16 * pixels).saturating_add(1 << 26));
            reader.limits(limits);
            let image = reader.decode().map_err(undecodable)?;
            Ok(([image.width(), image.height()], texels(image)))
        };
        let (size, texels) = decode().map_err(|e| self.locate(e))?;
        Ok(Image::new(self.name, size, texels))
    }
}

/// The number of bytes of a channel, for the memory that pixels take.
fn channel_bytes(color: ColorType) -> u64 {
    use ColorType as C;
    match color {
        C::Rgb32F | C::Rgba32F => 4,
        C::L16 | C::La16 | C::Rgb16 | C::Rgba16 => 2,
        _ => 1,
    }
}

/// The pixels of an image, with channels as precise as the file has them.
fn texels(image: DynamicImage) -> Texels {
    use DynamicImage as D;
    match image {
        // Without a copy in between: an environment map may have a gigabyte.
        D::ImageRgb32F(image) => {
            let opaque = |&Rgb([r, g, b]): &Rgb<f32>| [r, g, b, 1.0];
            Texels::Floats(image.pixels().map(opaque).collect())
        }
        D::ImageRgba32F(_) => Texels::Floats(pixels(image.into_rgba32f().into_raw())),
        D::ImageLuma16(_) | D::ImageLumaA16(_) | D::ImageRgb16(_) | D::ImageRgba16(_) => {
            Texels::Words(pixels(image.into_rgba16().into_raw()))
        }
        _ => Texels::Bytes(pixels(image.into_rgba8().into_raw())),
    }
}

/// Sets floats that are negative or not finite to 0, and returns how many there were, without alpha.
fn remove_invalid_floats(texels: &mut Texels) -> u64 {
    let Texels::Floats(texels) = texels else { return 0 };
    let is_valid = |x: f32| x.is_finite() && x >= 0.0;
    let mut count = 0;
    for texel in texels {
        count += texel[..3].iter().filter(|x| !is_valid(**x)).count() as u64;
        *texel = texel.map(|x| if is_valid(x) { x } else { 0.0 });
    }
    count
}

/// Pixels of four values each.
fn pixels<T: Copy>(values: Vec<T>) -> Vec<[T; 4]> {
    values.as_chunks().0.to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::limits::Limits;
    use image::{ImageBuffer, ImageFormat, Rgba};
    use std::path::Path;

    fn encoded(image: DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    fn decoded(image: DynamicImage, format: ImageFormat) -> Texels {
        let sandbox = Sandbox::new(Path::new("a"), false, Limits::default()).unwrap();
        let bytes = encoded(image, format);
        let open = |_: &()| Ok(Source::Bytes(bytes.as_slice().into(), "a".to_owned()));
        decode_all(&[()], &sandbox, open, |_| true).remove(0).unwrap().texels
    }

    #[test]
    fn the_first_images_are_those_that_the_limits_allow() {
        let limits = Limits::default().with_limit(Limit::Pictures, 20);
        let sandbox = Sandbox::new(Path::new("a"), false, limits).unwrap();
        let red = DynamicImage::ImageRgb8(ImageBuffer::from_pixel(1, 1, Rgb([255, 0, 0])));
        let bytes = encoded(red, ImageFormat::Png);
        let open = |_: &usize| Ok(Source::Bytes(bytes.as_slice().into(), "a".to_owned()));
        let numbers: Vec<usize> = (0..50).collect();
        let decoded = decode_all(&numbers, &sandbox, open, |_| true);
        assert!(numbers.iter().zip(&decoded).all(|(&i, image)| image.is_ok() == (i < 20)));
    }

    #[test]
    fn eight_bits_stay_eight_bits() {
        let red = DynamicImage::ImageRgb8(ImageBuffer::from_pixel(1, 1, Rgb([255, 0, 0])));
        for format in [ImageFormat::Png, ImageFormat::Bmp, ImageFormat::WebP] {
            assert_eq!(decoded(red.clone(), format), Texels::Bytes(vec![[255, 0, 0, 255]]));
        }
    }

    #[test]
    fn sixteen_bits_stay_sixteen_bits() {
        let fine = DynamicImage::ImageRgb16(ImageBuffer::from_pixel(1, 1, Rgb([300, 0, 65535])));
        let expected = Texels::Words(vec![[300, 0, 65535, 65535]]);
        assert_eq!(decoded(fine, ImageFormat::Png), expected);
    }

    #[test]
    fn floats_stay_floats_in_exr() {
        let bright = Rgba([7.5f32, 0.25, 0.0, 1.0]);
        let bright = DynamicImage::ImageRgba32F(ImageBuffer::from_pixel(1, 1, bright));
        let expected = Texels::Floats(vec![[7.5, 0.25, 0.0, 1.0]]);
        assert_eq!(decoded(bright, ImageFormat::OpenExr), expected);
    }

    #[test]
    fn floats_stay_floats_in_radiance_images() {
        let bright =
            DynamicImage::ImageRgb32F(ImageBuffer::from_pixel(1, 1, Rgb([8.0f32, 2.0, 0.0])));
        let expected = Texels::Floats(vec![[8.0, 2.0, 0.0, 1.0]]);
        assert_eq!(decoded(bright, ImageFormat::Hdr), expected);
    }

    #[test]
    fn floats_that_are_negative_or_not_finite_become_zero() {
        let odd = Rgba([f32::NAN, -1.0, f32::INFINITY, 1.0]);
        let odd = DynamicImage::ImageRgba32F(ImageBuffer::from_pixel(1, 1, odd));
        let mut odd = texels(odd);
        assert_eq!(remove_invalid_floats(&mut odd), 3);
        assert_eq!(odd, Texels::Floats(vec![[0.0, 0.0, 0.0, 1.0]]));
    }
}
