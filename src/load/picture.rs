//! Decoding pictures for textures.

use std::io::Cursor;
use std::path::Path;

use image::ImageReader;

use crate::error::{Error, Result};
use crate::scene::Image;

/// The longest side of a picture, in pixels, and the memory that decoding may take.
const MAX_SIDE: u32 = 1 << 15;
const MAX_BYTES: u64 = 1 << 30;

/// Reads and decodes the picture in a file, if it is `wanted`; otherwise the file only has to be
/// there.
///
/// # Errors
/// When the file cannot be read or decoded.
pub fn read(path: &Path, wanted: bool) -> Result<Image> {
    let name = path.display().to_string();
    if !wanted {
        super::check_file(path)?;
        return Ok(Image::unread(&name));
    }
    let bytes = super::read(path)?;
    decode(&bytes, &name, wanted).map_err(|e| e.at(path))
}

/// Decodes a picture (PNG, JPEG, WebP, TGA or BMP), if it is `wanted`; `name` says where it came
/// from.
///
/// # Errors
/// When it is none of these, is damaged, or is larger than 32768 pixels on a side.
pub fn decode(bytes: &[u8], name: &str, wanted: bool) -> Result<Image> {
    if !wanted {
        return Ok(Image::unread(name));
    }
    let fail = |e: image::ImageError| Error::input(format!("the picture cannot be decoded: {e}"));
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|e| Error::input(format!("the picture cannot be read: {e}")))?;
    if reader.format().is_none() && name.to_lowercase().ends_with(".tga") {
        // A TGA file has no signature to guess by.
        reader.set_format(image::ImageFormat::Tga);
    }
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    let pixels = reader.decode().map_err(fail)?.into_rgba8();
    let (width, height) = pixels.dimensions();
    let texels = pixels.pixels().map(|p| p.0).collect();
    Ok(Image { name: name.to_owned(), width, height, texels })
}

/// What stands in for a picture that cannot be had: a checker of magenta and black that nobody
/// takes for the real thing.
pub fn placeholder(name: &str) -> Image {
    let (magenta, black) = ([255, 0, 255, 255], [0, 0, 0, 255]);
    let texels = vec![magenta, black, black, magenta];
    Image { name: format!("{name} (missing)"), width: 2, height: 2, texels }
}
