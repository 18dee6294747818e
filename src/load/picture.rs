//! Decoding pictures for textures.

use std::io::Cursor;

use image::ImageReader;

use crate::error::{Error, Result};
use crate::load::guard::{Guard, Opened};
use crate::load::limits::Limit;
use crate::scene::Image;

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
        return Ok(Image::unread(&name));
    }
    let bytes = file.read(guard)?;
    decode(&bytes, &name, guard, wanted).map_err(|e| e.at(&path))
}

/// Decodes a picture (PNG, JPEG, WebP, TGA or BMP), if it is `wanted`; `name` says where it came
/// from.
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
    let decoded = reader.decode().map_err(fail)?.into_rgba8();
    let (width, height) = decoded.dimensions();
    let texels = decoded.pixels().map(|p| p.0).collect();
    Ok(Image { name: name.to_owned(), width, height, texels })
}

/// What stands in for a picture that cannot be had: a checker of magenta and black that nobody
/// takes for the real thing.
pub fn placeholder(name: &str) -> Image {
    let (magenta, black) = ([255, 0, 255, 255], [0, 0, 0, 255]);
    let texels = vec![magenta, black, black, magenta];
    Image { name: format!("{name} (missing)"), width: 2, height: 2, texels }
}
