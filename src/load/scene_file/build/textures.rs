//! The textures of the file's materials.

use std::path::PathBuf;

use super::SceneBuilder;
use crate::error::Result;
use crate::load::images::decode;
use crate::load::images::texture_cache::{ImageIndex, TextureCache, set_image};
use crate::load::sandbox::Sandbox;
use crate::load::scene_file::schema::spanned::At;
use crate::load::scene_file::schema::tables::MapFilter;
use crate::load::scene_file::source::Source;
use crate::scene::{Filter, Scene, Texture, TextureId, Transfer};

/// The textures so far: their images by canonical path and whether they are needed, and how the
/// textures sample them.
pub type Textures = TextureCache<(PathBuf, bool), ImageFile, (ImageIndex, Sampling)>;

/// An image file.
pub struct ImageFile {
    /// The name, where the scene file has it first.
    name: At<String>,
    /// True if something shows it.
    is_needed: bool,
}

/// The parameters that tell apart the textures of an image.
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
        name: Option<&At<String>>,
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
/// When one of them cannot be read; of several the one that is named first.
pub fn decode_images(
    textures: Textures,
    source: &Source<'_>,
    sandbox: &Sandbox,
    scene: &mut Scene,
) -> Result<()> {
    let open = |file: &ImageFile| {
        sandbox.open(source.folder(), &[&file.name.value]).map(decode::Source::File)
    };
    for decoded in textures.decode(sandbox, open, |file| file.is_needed) {
        let At { span, value: name } = &decoded.source.name;
        let image = decoded.image.map_err(|e| source.unreadable(span, "image", name, &e))?;
        set_image(image, &decoded.textures, scene);
    }
    Ok(())
}
