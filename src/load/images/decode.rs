//! Decoding pictures for textures.

use std::borrow::Cow;
use std::io::Cursor;
use std::path::PathBuf;

use image::{ColorType, DynamicImage, ImageDecoder, ImageReader};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::load::images::ktx2;
use crate::load::limits::Limit;
use crate::load::sandbox::{OpenedFile, Sandbox};
use crate::scene::{Image, Texels};

/// The longest side of a picture, in pixels.
const MAX_SIDE: u32 = 1 << 15;
/// So many pixels for each byte of a file do not count.
const PIXELS_PER_BYTE: u64 = 16;

/// Where the bytes of a picture (PNG, JPEG, WebP, TGA, BMP, Radiance HDR, OpenEXR or KTX 2) are.
pub enum Source<'a> {
    /// Here, and by this name.
    Bytes(Cow<'a, [u8]>, String),
    /// In a file.
    File(OpenedFile),
}

/// A picture that is about to be decoded, or only named.
enum Ready<'a> {
    Unread(String),
    Encoded { bytes: Cow<'a, [u8]>, name: String, path: Option<PathBuf>, pixels: u64 },
}

/// So many pictures wait, encoded, until they are decoded side by side.
const TOGETHER: usize = 16;

/// Decodes pictures, if they are `wanted`; otherwise they are only named, and files only have to be
/// there. `open` says where each is, and opens its file, few at a time.
///
/// What they take of the limits they take in their order, so that which of them are one too many
/// does not depend on threads.
///
/// Each is an error where it cannot be opened or read, is of none of these formats, is damaged, is
/// larger than 32768 pixels on a side, or is one more, or larger, than the limits allow.
pub fn decode_all<'a, T: Sync>(
    pictures: &[T],
    guard: &Sandbox,
    open: impl Fn(&T) -> Result<Source<'a>>,
    wanted: impl Fn(&T) -> bool,
) -> Vec<Result<Image>> {
    let mut images = Vec::with_capacity(pictures.len());
    for some in pictures.chunks(TOGETHER) {
        let ready = |picture| open(picture).and_then(|from| ready(from, guard, wanted(picture)));
        let ready: Vec<_> = some.iter().map(ready).collect();
        images.par_extend(ready.into_par_iter().map(|ready| ready.and_then(Ready::decode)));
    }
    images
}

/// Reads the bytes of a picture, and takes of the limits what it will take.
fn ready<'a>(source: Source<'a>, guard: &Sandbox, wanted: bool) -> Result<Ready<'a>> {
    let (bytes, name, path) = match source {
        Source::Bytes(_, name) if !wanted => return Ok(Ready::Unread(name)),
        Source::Bytes(bytes, name) => (bytes, name, None),
        Source::File(file) => {
            let path = file.path.clone();
            let name = path.display().to_string();
            if !wanted {
                return Ok(Ready::Unread(name));
            }
            (file.read(guard)?.into(), name, Some(path))
        }
    };
    match weigh(&bytes, &name, guard) {
        Ok(pixels) => Ok(Ready::Encoded { bytes, name, path, pixels }),
        Err(error) => Err(match path {
            Some(path) => error.at(&path),
            None => error,
        }),
    }
}

fn reader<'a>(bytes: &'a [u8], name: &str) -> Result<ImageReader<Cursor<&'a [u8]>>> {
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|e| Error::input(format!("the picture cannot be read: {e}")))?;
    if reader.format().is_none() && name.to_lowercase().ends_with(".tga") {
        // A TGA file has no signature to guess by.
        reader.set_format(image::ImageFormat::Tga);
    }
    Ok(reader)
}

fn fail(error: image::ImageError) -> Error {
    Error::input(format!("the picture cannot be decoded: {error}"))
}

/// How many pixels of 8-bit numbers a picture takes as much memory as, which are taken of the limits.
fn weigh(bytes: &[u8], name: &str, guard: &Sandbox) -> Result<u64> {
    guard.take(Limit::Pictures, 1)?;
    let ([width, height], weight) = if ktx2::is_ktx(bytes) {
        let ktx2::Header { size, is_float } = ktx2::header(bytes)?;
        if size.into_iter().any(|side| side > MAX_SIDE) {
            return Err(Error::input(format!("the picture is larger than {MAX_SIDE} on a side")));
        }
        (size, if is_float { 4 } else { 1 })
    } else {
        let decoder = reader(bytes, name)?.into_decoder().map_err(fail)?;
        (decoder.dimensions().into(), weight(decoder.color_type()))
    };
    let pixels = u64::from(width) * u64::from(height) * weight;
    guard.take(Limit::Pixels, pixels.saturating_sub(PIXELS_PER_BYTE * bytes.len() as u64))?;
    Ok(pixels)
}

impl Ready<'_> {
    fn decode(self) -> Result<Image> {
        let (bytes, name, path, pixels) = match self {
            Self::Unread(name) => return Ok(Image::unread(name)),
            Self::Encoded { bytes, name, path, pixels } => (bytes, name, path, pixels),
        };
        let decode = || {
            if ktx2::is_ktx(&bytes) {
                return Ok((ktx2::header(&bytes)?.size, ktx2::decode(&bytes)?));
            }
            let mut reader = reader(&bytes, &name)?;
            let mut limits = image::Limits::default();
            limits.max_image_width = Some(MAX_SIDE);
            limits.max_image_height = Some(MAX_SIDE);
            // Four channels, more than twice, and room for what decoders need besides.
            limits.max_alloc = Some((16 * pixels).saturating_add(1 << 26));
            reader.limits(limits);
            let picture = reader.decode().map_err(fail)?;
            Ok(([picture.width(), picture.height()], texels(picture)))
        };
        let (size, texels) = decode().map_err(|e: Error| match &path {
            Some(path) => e.at(path),
            None => e,
        })?;
        Ok(Image::new(name, size, light(texels)))
    }
}

/// How many pixels of 8-bit numbers a pixel takes as much memory as.
fn weight(color: ColorType) -> u64 {
    use ColorType as C;
    match color {
        C::Rgb32F | C::Rgba32F => 4,
        C::L16 | C::La16 | C::Rgb16 | C::Rgba16 => 2,
        _ => 1,
    }
}

/// The pixels as finely as the file has them.
fn texels(picture: DynamicImage) -> Texels {
    use DynamicImage as D;
    match picture {
        D::ImageRgb32F(_) | D::ImageRgba32F(_) => {
            Texels::Floats(pixels(picture.into_rgba32f().into_raw()))
        }
        D::ImageLuma16(_) | D::ImageLumaA16(_) | D::ImageRgb16(_) | D::ImageRgba16(_) => {
            Texels::Words(pixels(picture.into_rgba16().into_raw()))
        }
        _ => Texels::Bytes(pixels(picture.into_rgba8().into_raw())),
    }
}

/// The same, where floats that are no light, negative or not finite, are 0.
fn light(mut texels: Texels) -> Texels {
    if let Texels::Floats(texels) = &mut texels {
        let is_light = |x: &f32| x.is_finite() && *x >= 0.0;
        texels.as_flattened_mut().iter_mut().filter(|x| !is_light(x)).for_each(|x| *x = 0.0);
    }
    texels
}

/// Four values a pixel.
fn pixels<T: Copy>(values: Vec<T>) -> Vec<[T; 4]> {
    values.as_chunks().0.to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::limits::Limits;
    use image::{ImageBuffer, ImageFormat, Rgb, Rgba};
    use std::path::Path;

    fn encoded(picture: DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    fn decoded(picture: DynamicImage, format: ImageFormat) -> Texels {
        let guard = Sandbox::new(Path::new("a"), false, Limits::default()).unwrap();
        let bytes = encoded(picture, format);
        let open = |_: &()| Ok(Source::Bytes(bytes.as_slice().into(), "a".to_owned()));
        decode_all(&[()], &guard, open, |_| true).remove(0).unwrap().texels
    }

    #[test]
    fn the_first_pictures_are_those_that_the_limits_allow() {
        let limits = Limits::default().with_limit(Limit::Pictures, 20);
        let guard = Sandbox::new(Path::new("a"), false, limits).unwrap();
        let red = DynamicImage::ImageRgb8(ImageBuffer::from_pixel(1, 1, Rgb([255, 0, 0])));
        let bytes = encoded(red, ImageFormat::Png);
        let open = |_: &usize| Ok(Source::Bytes(bytes.as_slice().into(), "a".to_owned()));
        let numbers: Vec<usize> = (0..50).collect();
        let made = decode_all(&numbers, &guard, open, |_| true);
        assert!(numbers.iter().zip(&made).all(|(&i, made)| made.is_ok() == (i < 20)));
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
    fn floats_stay_floats_in_radiance_pictures() {
        let bright =
            DynamicImage::ImageRgb32F(ImageBuffer::from_pixel(1, 1, Rgb([8.0f32, 2.0, 0.0])));
        let expected = Texels::Floats(vec![[8.0, 2.0, 0.0, 1.0]]);
        assert_eq!(decoded(bright, ImageFormat::Hdr), expected);
    }

    #[test]
    fn floats_that_are_no_light_become_none() {
        let odd = Rgba([f32::NAN, -1.0, f32::INFINITY, 1.0]);
        let odd = DynamicImage::ImageRgba32F(ImageBuffer::from_pixel(1, 1, odd));
        assert_eq!(light(texels(odd)), Texels::Floats(vec![[0.0, 0.0, 0.0, 1.0]]));
    }
}
