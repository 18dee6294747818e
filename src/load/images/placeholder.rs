//! Placeholders for images that cannot be read.

use std::collections::HashSet;
use std::sync::Arc;

use super::texture_cache::set_image;
use crate::error::Result;
use crate::load::diagnostics::Diagnostics;
use crate::scene::{Image, Scene, TextureId, Transfer};

/// Gives an image to the textures that show it, or a placeholder if it could not be read; returns
/// true if it was read.
///
/// The placeholder of a colour is a checker of magenta and black, which nobody takes for the real
/// image. Other values are as without an image: white, which changes no factor, and no normal map, once
/// [`drop_normal_maps`] was called with the textures.
pub fn set_image_or_placeholder(
    image: Result<Image>,
    name: &str,
    textures: &[TextureId],
    scene: &mut Scene,
    diagnostics: &mut Diagnostics,
) -> bool {
    let error = match image {
        Ok(image) => {
            set_image(image, textures, scene);
            return true;
        }
        Err(error) => error,
    };
    // A checker of magenta and black, and one white pixel.
    let name = format!("{name} (missing)");
    let (magenta, black) = ([255, 0, 255, 255], [0, 0, 0, 255]);
    let checker = vec![magenta, black, black, magenta];
    let checker = Arc::new(Image::from_bytes(name.clone(), [2, 2], checker));
    let white = Arc::new(Image::from_bytes(name, [1, 1], vec![[255; 4]]));

    let mut is_color = false;
    for &id in textures {
        let texture = &mut scene.textures[id.0 as usize];
        if texture.transfer == Transfer::Srgb {
            texture.image = checker.clone();
            is_color = true;
            continue;
        }
        texture.image = white.clone();
    }

    // One warning says what stands in the place of the image.
    let instead = if is_color {
        "a magenta checker takes its place"
    } else {
        "what it would say is left out"
    };
    diagnostics.placeholder(format!("{error}; {instead}"));
    false
}

/// Drops the normal maps of textures whose images are missing.
pub fn drop_normal_maps(missing: &HashSet<TextureId>, scene: &mut Scene) {
    for material in &mut scene.materials {
        material.normal_map.take_if(|map| missing.contains(&map.texture));
    }
}
