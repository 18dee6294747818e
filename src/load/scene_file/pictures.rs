//! The pictures of a scene file: each file decoded once, all side by side.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use super::source::{Source, Span};
use super::spanned::At;
use super::tables::MapFilter;
use crate::error::Result;
use crate::load::images::decode;
use crate::load::sandbox::Sandbox;
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
    /// As the scene file names it.
    name: String,
    wanted: bool,
    /// Where it is named first.
    span: Span,
    shown_by: Vec<TextureId>,
}

impl Pictures {
    /// The texture for a picture that a material names; it is read if it is `wanted`.
    ///
    /// # Errors
    /// When there is no such file, or it may not be read.
    pub fn texture(
        &mut self,
        (source, guard): (&Source<'_>, &Sandbox),
        At { span, value: name }: &At<String>,
        transfer: Transfer,
        filter: MapFilter,
        wanted: bool,
        scene: &mut Scene,
    ) -> Result<TextureId> {
        // Open files are few at a time: this one is opened again when it is read.
        let file = guard
            .open(source.folder(), &[name])
            .map_err(|e| source.cannot_have(span, "picture", name, &e))?;
        let same = (file.identity, wanted);
        let files = &mut self.files;
        let number = *self.numbers.entry(same).or_insert_with(|| {
            let (name, span) = (name.clone(), span.clone());
            files.push(File { name, wanted, span, shown_by: Vec::new() });
            files.len() - 1
        });
        Ok(*self.textures.entry((number, transfer, filter)).or_insert_with(|| {
            let texture = scene.add_texture(Texture {
                transfer,
                filter: if filter == MapFilter::Nearest { Filter::Nearest } else { Filter::Linear },
                mipmap: filter == MapFilter::Mipmap,
                ..Texture::new(Arc::new(Image::unread(name)))
            });
            files[number].shown_by.push(texture);
            texture
        }))
    }

    /// Decodes them.
    ///
    /// # Errors
    /// When one of them cannot be read; of several the one that is named first.
    pub fn decode(self, source: &Source<'_>, guard: &Sandbox, scene: &mut Scene) -> Result<()> {
        let open =
            |file: &File| guard.open(source.folder(), &[&file.name]).map(decode::Source::File);
        let images = decode::decode_all(&self.files, guard, open, |file| file.wanted);
        for (file, image) in self.files.iter().zip(images) {
            let fail = |e| source.cannot_have(&file.span, "picture", &file.name, &e);
            let image = Arc::new(image.map_err(fail)?);
            for texture in &file.shown_by {
                scene.textures[texture.0 as usize].image = image.clone();
            }
        }
        Ok(())
    }
}
