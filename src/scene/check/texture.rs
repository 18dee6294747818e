//! The validity checks of a texture.

use super::require::require;
use crate::error::Result;
use crate::scene::Texture;

/// Checks texture `i`, whose image must have been read if a material in use has the texture.
pub(super) fn check(i: usize, texture: &Texture, is_in_use: bool) -> Result<()> {
    let image = &texture.image;
    if !image.is_read() && image.texels.is_empty() {
        return require(!is_in_use, || {
            format!(
                "texture {i} (`{}`): the picture was not read, and a material in use shows it",
                image.name
            )
        });
    }
    let pixels = u64::from(image.width) * u64::from(image.height);
    require(pixels > 0 && pixels == image.texels.len() as u64, || {
        format!(
            "texture {i} (`{}`): {}x{} pixels declared, {} there",
            image.name,
            image.width,
            image.height,
            image.texels.len()
        )
    })?;
    require(texture.set < 2, || {
        format!(
            "texture {i}: there are two sets of texture coordinates, 0 and 1, not {}",
            texture.set
        )
    })?;
    require(texture.transform.is_finite(), || {
        format!("texture {i}: its transform must be finite, found {}", texture.transform)
    })
}
