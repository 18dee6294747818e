//! Textures: samplers, pictures, and where on them a surface's coordinates fall.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use glam::Affine2;
use gltf::json;
use gltf::json::texture::{MagFilter, MinFilter, WrappingMode};
use gltf::json::validation::Checked;

use super::buffers::{Buffers, Target, cannot_have, get, resolve};
use super::slot::Slot;
use crate::error::{Error, Place, Result};
use crate::load::diagnostics::Diagnostics;
use crate::load::images::decode;
use crate::load::images::placeholder;
use crate::load::sandbox::Sandbox;
use crate::scene::{Filter, Scene, Texture, TextureId, Transfer, Wrap};

/// The textures of a file. What they show is decoded when all are known, each picture once.
pub struct Textures<'a> {
    root: &'a json::Root,
    guard: &'a Sandbox,
    buffers: &'a Buffers<'a>,
    /// Whether anything shows the pictures; otherwise they are only named.
    wanted: bool,
    /// Those that are in the scene, with what makes them different.
    /// By their numbers in the file, how they are read, and what was made of that.
    made: HashMap<usize, Vec<(Reading, TextureId)>>,
    /// Pictures that are still to be decoded.
    pictures: Vec<Picture<'a>>,
    numbers: HashMap<Key<'a>, usize>,
}

/// What makes two pictures one.
#[derive(PartialEq, Eq, Hash)]
enum Key<'a> {
    Data(&'a str),
    File(PathBuf),
    View(usize),
}

/// How a texture is read: by which coordinates, how its colours are encoded, and which set of the
/// scene places it.
type Reading = (Slot, Transfer, u8);

/// A picture that is still to be decoded, and the textures that show it.
struct Picture<'a> {
    source: Result<Source<'a>>,
    at: String,
    shown_by: Vec<TextureId>,
}

/// Where a picture's bytes are.
#[derive(Clone)]
enum Source<'a> {
    Bytes(Cow<'a, [u8]>),
    /// Of a file, by the URI: it is opened when it is read, so that few are open at a time.
    File(&'a str),
}

impl<'a> Textures<'a> {
    /// The textures of a file, whose pictures are read where they are `wanted`.
    pub fn new(
        root: &'a json::Root,
        guard: &'a Sandbox,
        buffers: &'a Buffers<'a>,
        wanted: bool,
    ) -> Self {
        let (made, pictures, numbers) = Default::default();
        Self { root, guard, buffers, wanted, made, pictures, numbers }
    }

    /// A texture that is placed by the scene's texture coordinates `set`.
    ///
    /// # Errors
    /// When the file's own references lead nowhere.
    pub fn get(
        &mut self,
        slot: Slot,
        set: u8,
        transfer: Transfer,
        by: &str,
        scene: &mut Scene,
        tally: &mut Diagnostics,
    ) -> Result<TextureId> {
        let key = (slot, transfer, set);
        let mut made = self.made.get(&slot.index).into_iter().flatten();
        if let Some(&(_, id)) = made.find(|(made, _)| *made == key) {
            return Ok(id);
        }
        let Slot { index, transform, .. } = slot;
        let texture = get(&self.root.textures, index, "texture", by)?;
        let sampler = match texture.sampler {
            Some(s) => Some(get(
                &self.root.samplers,
                s.value(),
                "sampler",
                &format!("textures[{index}].sampler"),
            )?),
            None => None,
        };
        let picture = match source(texture) {
            Some(source) => self.picture(source, &format!("textures[{index}].source"))?,
            None => self.missing(format!("textures[{index}]")),
        };
        let transform = match transform.is_finite() {
            true => transform,
            false => {
                tally.say(format!("textures[{index}]: a transform that is not finite is left out"));
                Affine2::IDENTITY
            }
        };
        let image = placeholder::white(&format!("textures[{index}]"));
        let id = scene.add_texture(Texture {
            transfer,
            wrap: sampler.map_or([Wrap::Repeat; 2], |s| [wrap(s.wrap_s), wrap(s.wrap_t)]),
            filter: sampler.map_or(Filter::Linear, filter),
            mipmap: sampler.is_none_or(has_mipmaps),
            set,
            transform,
            ..Texture::new(Arc::new(image))
        });
        self.pictures[picture].shown_by.push(id);
        self.made.entry(index).or_default().push((key, id));
        Ok(id)
    }

    /// The picture of an image, to be decoded; one that several images name is one.
    fn picture(&mut self, index: usize, by: &str) -> Result<usize> {
        let image = get(&self.root.images, index, "image", by)?;
        let at = format!("images[{index}]");
        let (key, source) = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => match self.buffers.resolve(uri) {
                Ok(Target::Data(bytes)) => (Some(Key::Data(uri)), Ok(Source::Bytes(bytes.into()))),
                Ok(Target::File(file)) => (Some(Key::File(file.identity)), Ok(Source::File(uri))),
                Err(error) => (None, Err(cannot_have("picture", uri, &error))),
            },
            (None, Some(view)) => {
                let bytes = self.buffers.view(view.value(), &format!("{at}.bufferView"));
                (Some(Key::View(view.value())), bytes.map(|bytes| Source::Bytes(bytes.into())))
            }
            (None, None) => {
                (None, Err(Error::input("the image has neither a URI nor a buffer view")))
            }
        };
        let next = self.pictures.len();
        let number = key.map_or(next, |key| *self.numbers.entry(key).or_insert(next));
        if number == next {
            self.pictures.push(Picture { source, at, shown_by: Vec::new() });
        }
        Ok(number)
    }

    /// A picture that is nowhere.
    fn missing(&mut self, at: String) -> usize {
        let source = Err(Error::input("there is no picture that can be read"));
        self.pictures.push(Picture { source, at, shown_by: Vec::new() });
        self.pictures.len() - 1
    }

    /// Decodes the pictures, side by side, and gives them to the textures of the scene that show
    /// them. One that cannot be had is a warning, and a placeholder takes its place.
    pub fn decode(self, scene: &mut Scene, tally: &mut Diagnostics) {
        let Self { guard, buffers, wanted, pictures, .. } = self;
        let folder = buffers.folder();
        let open = |picture: &Picture<'a>| match picture.source.clone()? {
            Source::Bytes(bytes) => Ok(decode::Source::Bytes(bytes, picture.at.clone())),
            Source::File(uri) => match resolve(uri, folder, guard) {
                Ok(Target::Data(bytes)) => {
                    Ok(decode::Source::Bytes(bytes.into(), picture.at.clone()))
                }
                Ok(Target::File(file)) => Ok(decode::Source::File(file)),
                Err(error) => Err(cannot_have("picture", uri, &error)),
            },
        };
        let images = decode::decode_all(&pictures, guard, open, |_| wanted);
        for (image, Picture { at, shown_by, .. }) in images.into_iter().zip(pictures) {
            let image = image.map_err(|e| e.place(Place::Json(at.clone())));
            placeholder::show(image, &at, shown_by.into_iter(), scene, tally);
        }
    }
}

/// The picture of a texture; that of an extension where there is one.
fn source(texture: &json::Texture) -> Option<usize> {
    let others = texture.extensions.as_ref().map(|extensions| &extensions.others);
    let of = |name: &str| usize::try_from(others?.get(name)?.get("source")?.as_u64()?).ok();
    // The crate writes a missing source as the greatest index.
    let own = texture.source.value();
    let packed = of("KHR_texture_basisu").or_else(|| of("EXT_texture_webp"));
    packed.or((own != u32::MAX as usize).then_some(own))
}

fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }
}

/// The filter for pictures seen from near; where only the one for afar is given, that.
fn filter(sampler: &json::texture::Sampler) -> Filter {
    use MinFilter::{Nearest, NearestMipmapLinear, NearestMipmapNearest};
    let far = matches!(
        sampler.min_filter,
        Some(Checked::Valid(Nearest | NearestMipmapLinear | NearestMipmapNearest))
    );
    match sampler.mag_filter {
        Some(Checked::Valid(MagFilter::Nearest)) => Filter::Nearest,
        Some(_) => Filter::Linear,
        None if far => Filter::Nearest,
        None => Filter::Linear,
    }
}

/// Whether pictures seen from afar are averaged: unless the sampler says that they are not.
fn has_mipmaps(sampler: &json::texture::Sampler) -> bool {
    use MinFilter::{Linear, Nearest};
    !matches!(sampler.min_filter, Some(Checked::Valid(Linear | Nearest)))
}
