//! The validity checks of a texture.

use super::require::require;
use crate::error::Result;
use crate::scene::{Image, Texture};

/// Checks texture `i`, whose image must have been read if a material in use has the texture.
pub(super) fn check(i: usize, texture: &Texture, is_in_use: bool) -> Result<()> {
    // An image that was not read has neither size nor pixels.
    let Image { name, width, height, texels, .. } = &*texture.image;
    if !texture.image.is_read() && texels.is_empty() {
        return require(!is_in_use, || {
            format!(
                "texture {i} (`{name}`): the picture was not read, and a material in use shows it"
            )
        });
    }
    // One that was read must have as many pixels as its size tells.
    let (pixels, found) = (u64::from(*width) * u64::from(*height), texels.len());
    require(pixels > 0 && pixels == found as u64, || {
        format!("texture {i} (`{name}`): {width}x{height} pixels declared, {found} there")
    })?;
    let set = texture.set;
    require(set < 2, || {
        format!("texture {i}: there are two sets of texture coordinates, 0 and 1, not {set}")
    })?;
    require(texture.transform.is_finite(), || {
        format!("texture {i}: its transform must be finite, found {}", texture.transform)
    })
}
