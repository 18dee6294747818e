//! What stands in for pictures that cannot be had.

use std::sync::Arc;

use crate::error::Result;
use crate::load::diagnostics::Diagnostics;
use crate::scene::{Image, Scene, TextureId, Transfer};

/// Gives a picture to the textures that show it; says whether it could be had.
///
/// Where it cannot, colours become a checker that nobody takes for the real thing. What is no colour
/// is as if there were no picture: white, which changes no factor, and no normal map.
pub fn show(
    image: Result<Image>,
    name: &str,
    shown_by: impl Iterator<Item = TextureId> + Clone,
    scene: &mut Scene,
    tally: &mut Diagnostics,
) -> bool {
    let error = match image {
        Ok(image) => {
            let image = Arc::new(image);
            shown_by.for_each(|id| scene.textures[id.0 as usize].image = image.clone());
            return true;
        }
        Err(error) => error,
    };
    let (checker, white) = (Arc::new(checker(name)), Arc::new(white(name)));
    let mut is_color = false;
    for id in shown_by {
        let texture = &mut scene.textures[id.0 as usize];
        if texture.transfer == Transfer::Srgb {
            texture.image = checker.clone();
            is_color = true;
            continue;
        }
        texture.image = white.clone();
        let maps = scene.materials.iter_mut().map(|material| &mut material.normal_map);
        maps.for_each(|map| _ = map.take_if(|map| map.texture == id));
    }
    let instead = match is_color {
        true => "a magenta checker takes its place",
        false => "what it would say is left out",
    };
    tally.placeholder(format!("{error}; {instead}"));
    false
}

/// A checker of magenta and black.
fn checker(name: &str) -> Image {
    let (magenta, black) = ([255, 0, 255, 255], [0, 0, 0, 255]);
    Image::from_bytes(format!("{name} (missing)"), [2, 2], vec![magenta, black, black, magenta])
}

/// One white pixel: what textures show until their pictures are decoded.
pub fn white(name: &str) -> Image {
    Image::from_bytes(format!("{name} (missing)"), [1, 1], vec![[255; 4]])
}
