//! The textures of the materials in a scene file.

use std::path::PathBuf;

use super::SceneBuilder;
use crate::error::Result;
use crate::load::images::decode;
use crate::load::images::texture_cache::{ImageIndex, TextureCache, set_image};
use crate::load::sandbox::Sandbox;
use crate::load::scene_file::schema::material_table::MapFilter;
use crate::load::scene_file::schema::spanned::Spanned;
use crate::load::scene_file::source::Source;
use crate::scene::{Filter, Scene, Texture, TextureId, Transfer};

/// The textures so far, by image and sampling; and their images, by canonical path and whether they
/// are needed.
pub type Textures = TextureCache<(PathBuf, bool), ImageFile, (ImageIndex, Sampling)>;

/// An image file that the scene file names.
pub struct ImageFile {
    /// The name, with the span where the scene file names it first.
    name: Spanned<String>,
    /// True if an object shows the image.
    is_needed: bool,
}

/// The transfer curve and the filter with which a texture samples its image.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Sampling {
    /// The curve by which the image encodes light.
    pub transfer: Transfer,
    /// The filter.
    pub filter: MapFilter,
}

impl SceneBuilder<'_> {
    /// Returns the texture of an image that a material names, if it names one; the image is only read
    /// if it `is_needed`.
    ///
    /// # Errors
    /// When there is no such file, or it may not be read.
    pub fn texture(
        &mut self,
        name: Option<&Spanned<String>>,
        sampling: Sampling,
        is_needed: bool,
    ) -> Result<Option<TextureId>> {
        let Some(name) = name else { return Ok(None) };
        // Only a few files are open at a time: this one is opened again when it is decoded.
        let source = self.source;
        let file = self
            .sandbox
            .open(source.folder(), &[&name.value])
            .map_err(|e| source.unreadable(&name.span, "image", &name.value, &e))?;
        let image = self
            .textures
            .image((file.identity, is_needed), || ImageFile { name: name.clone(), is_needed });
        let Sampling { transfer, filter } = sampling;
        Ok(Some(self.textures.texture((image, sampling), image, &mut self.scene, |image| {
            Texture {
                transfer,
                filter: if filter == MapFilter::Nearest { Filter::Nearest } else { Filter::Linear },
                mipmap: filter == MapFilter::Mipmap,
                ..Texture::new(image)
            }
        })))
    }
}

/// Decodes the images of the textures.
///
/// # Errors
/// When an image cannot be read; the error is about the first such image that the file names.
pub fn decode_images(
    textures: Textures,
    source: &Source<'_>,
    sandbox: &Sandbox,
    scene: &mut Scene,
) -> Result<()> {
    let open = |file: &ImageFile| {
        sandbox.open(source.folder(), &[&file.name.value]).map(decode::Source::File)
    };
    for (cached, image) in textures.decode(sandbox, open, |file| file.is_needed) {
        let Spanned { span, value: name } = &cached.source.name;
        let image = image.map_err(|e| source.unreadable(span, "image", name, &e))?;
        set_image(image, &cached.textures, scene);
    }
    Ok(())
}
