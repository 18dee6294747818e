//! The mipmaps of a scene's textures.

use rayon::prelude::*;

use crate::scene::{Material, Scene};

/// Builds the mipmaps of the textures in use that have them, in parallel.
pub fn build_mipmaps(scene: &Scene) {
    let mut is_used = vec![false; scene.textures.len()];
    for id in scene.materials_in_use().flat_map(Material::textures) {
        if let Some(is_used) = is_used.get_mut(id.0 as usize) {
            *is_used = true;
        }
    }
    scene.textures.par_iter().zip(is_used).for_each(|(texture, is_used)| {
        if is_used && texture.mipmap && texture.image.is_read() {
            texture.image.mipmap(texture.transfer);
        }
    });
}
