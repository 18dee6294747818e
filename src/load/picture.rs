//! Decoding pictures for textures.

use std::io::Cursor;

use image::{DynamicImage, ImageReader};

use crate::error::{Error, Result};
use crate::load::guard::{Guard, Opened};
use crate::load::limits::Limit;
use crate::scene::{Image, Texels};

/// The longest side of a picture, in pixels.
const MAX_SIDE: u32 = 1 << 15;
/// So many pixels for each byte of a file do not count.
const PIXELS_PER_BYTE: u64 = 16;

/// Reads and decodes the picture in a file, if it is `wanted`; otherwise the file only has to be
/// there.
///
/// # Errors
/// When the file cannot be read or decoded.
pub fn read(file: Opened, guard: &Guard, wanted: bool) -> Result<Image> {
    let path = file.path.clone();
    let name = path.display().to_string();
    if !wanted {
        return Ok(Image::unread(name));
    }
    let bytes = file.read(guard)?;
    decode(&bytes, &name, guard, wanted).map_err(|e| e.at(&path))
}

/// Decodes a picture (PNG, JPEG, WebP, TGA, BMP, Radiance HDR or OpenEXR), if it is `wanted`; `name`
/// says where it came from.
///
/// # Errors
/// When it is none of these, is damaged, is larger than 32768 pixels on a side, or is one more,
/// or larger, than the limits allow.
pub fn decode(bytes: &[u8], name: &str, guard: &Guard, wanted: bool) -> Result<Image> {
    if !wanted {
        return Ok(Image::unread(name));
    }
    guard.take(Limit::Pictures, 1)?;
    let fail = |e: image::ImageError| Error::input(format!("the picture cannot be decoded: {e}"));
    let reader = || {
        let mut reader = ImageReader::new(Cursor::new(bytes))
            .with_guessed_format()
            .map_err(|e| Error::input(format!("the picture cannot be read: {e}")))?;
        if reader.format().is_none() && name.to_lowercase().ends_with(".tga") {
            // A TGA file has no signature to guess by.
            reader.set_format(image::ImageFormat::Tga);
        }
        Ok(reader)
    };
    let (width, height) = reader()?.into_dimensions().map_err(fail)?;
    let pixels = u64::from(width) * u64::from(height);
    guard.take(Limit::Pixels, pixels.saturating_sub(PIXELS_PER_BYTE * bytes.len() as u64))?;
    let mut reader = reader()?;
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    // Four 16-bit channels, twice, and room for what decoders need besides.
    limits.max_alloc = Some((16 * pixels).saturating_add(1 << 26));
    reader.limits(limits);
    let picture = reader.decode().map_err(fail)?;
    let size = [picture.width(), picture.height()];
    Ok(Image::new(name, size, texels(picture)))
}

/// The pixels as finely as the file has them.
fn texels(picture: DynamicImage) -> Texels {
    use DynamicImage as D;
    match picture {
        D::ImageRgb32F(_) | D::ImageRgba32F(_) => {
            let mut texels = pixels(picture.into_rgba32f().into_raw());
            // What is no light is none.
            let is_light = |x: &f32| x.is_finite() && *x >= 0.0;
            texels.as_flattened_mut().iter_mut().filter(|x| !is_light(x)).for_each(|x| *x = 0.0);
            Texels::Floats(texels)
        }
        D::ImageLuma16(_) | D::ImageLumaA16(_) | D::ImageRgb16(_) | D::ImageRgba16(_) => {
            Texels::Words(pixels(picture.into_rgba16().into_raw()))
        }
        _ => Texels::Bytes(pixels(picture.into_rgba8().into_raw())),
    }
}

/// Four values a pixel.
fn pixels<T: Copy>(values: Vec<T>) -> Vec<[T; 4]> {
    values.as_chunks().0.to_vec()
}

/// What stands in for a picture that cannot be had: a checker of magenta and black that nobody
/// takes for the real thing.
pub fn placeholder(name: &str) -> Image {
    let (magenta, black) = ([255, 0, 255, 255], [0, 0, 0, 255]);
    let texels = vec![magenta, black, black, magenta];
    Image::bytes(format!("{name} (missing)"), [2, 2], texels)
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
        let guard = Guard::new(Path::new("a"), false, Limits::default()).unwrap();
        decode(&encoded(picture, format), "a", &guard, true).unwrap().texels
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
        assert_eq!(texels(odd), Texels::Floats(vec![[0.0, 0.0, 0.0, 1.0]]));
    }
}
