//! The pictures of a scene file: each file decoded once, all side by side.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use rayon::prelude::*;

use super::source::{Source, Span};
use super::spanned::At;
use super::tables::MapFilter;
use crate::error::Result;
use crate::load::picture;
use crate::scene::{Filter, Image, Scene, Texture, TextureId, Transfer};

/// The pictures that materials name, to be decoded when all are known.
#[derive(Default)]
pub struct Pictures {
    files: Vec<File>,
    /// Their numbers, by their canonical paths and whether they are to be read.
    numbers: HashMap<(PathBuf, bool), usize>,
    textures: HashMap<(usize, Transfer, MapFilter), TextureId>,
}

/// A picture to be decoded.
struct File {
    path: PathBuf,
    wanted: bool,
    /// Where it is named first.
    span: Span,
    shown_by: Vec<TextureId>,
}

impl Pictures {
    /// The texture for a picture that a material names; it is read if it is `wanted`.
    pub fn texture(
        &mut self,
        source: &Source<'_>,
        At { span, value: name }: &At<String>,
        transfer: Transfer,
        filter: MapFilter,
        wanted: bool,
        scene: &mut Scene,
    ) -> TextureId {
        let path = source.file(name);
        let same = (path.canonicalize().unwrap_or_else(|_| path.clone()), wanted);
        let files = &mut self.files;
        let number = *self.numbers.entry(same).or_insert_with(|| {
            files.push(File { path, wanted, span: span.clone(), shown_by: Vec::new() });
            files.len() - 1
        });
        *self.textures.entry((number, transfer, filter)).or_insert_with(|| {
            let texture = scene.add_texture(Texture {
                transfer,
                filter: if filter == MapFilter::Nearest { Filter::Nearest } else { Filter::Linear },
                mipmap: filter == MapFilter::Mipmap,
                ..Texture::new(Arc::new(Image::unread(name)))
            });
            files[number].shown_by.push(texture);
            texture
        })
    }

    /// Decodes them.
    ///
    /// # Errors
    /// When one of them cannot be read; of several the one that is named first.
    pub fn decode(self, source: &Source<'_>, scene: &mut Scene) -> Result<()> {
        let read = |file: &File| picture::read(&file.path, file.wanted);
        let images: Vec<_> = self.files.par_iter().map(read).collect();
        for (file, image) in self.files.iter().zip(images) {
            let image = Arc::new(image.map_err(|e| {
                let message = format!("the picture {}: {}", file.path.display(), e.message());
                let help = "a path is relative to the scene file's folder";
                source.error(&file.span, message).help(help)
            })?);
            for texture in &file.shown_by {
                scene.textures[texture.0 as usize].image = image.clone();
            }
        }
        Ok(())
    }
}
