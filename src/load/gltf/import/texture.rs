//! Textures: their samplers and images, which are decoded when all textures are known.

use std::collections::HashSet;
use std::fmt::Display;
use std::path::PathBuf;

use glam::Affine2;
use gltf::json::texture::{MagFilter, MinFilter, WrappingMode};
use gltf::json::{self, validation::Checked};

use super::texture_reference::TextureReference;
use crate::error::{Error, Result};
use crate::load::diagnostics::Diagnostics;
use crate::load::gltf::buffers::{Buffers, UriTarget, unreadable};
use crate::load::gltf::json::{as_index, at_path, lookup};
use crate::load::images::decode;
use crate::load::images::placeholder::{drop_normal_maps, set_image_or_placeholder};
use crate::load::images::texture_cache::{ImageIndex, TextureCache, transform_bits};
use crate::scene::{Filter, Scene, Texture, TextureId, Transfer, Wrap};

/// The textures of a file; the images that they show are decoded when all are known.
pub struct Textures<'a> {
    buffers: &'a Buffers<'a>,
    /// True if images are read; otherwise they are only named.
    reads_images: bool,
    cache: TextureCache<ImageKey<'a>, ImageSource<'a>, TextureKey>,
}

/// The identity of an image: two with the same key are decoded once.
#[derive(PartialEq, Eq, Hash)]
enum ImageKey<'a> {
    DataUri(&'a str),
    File(PathBuf),
    /// The bytes themselves: several views may have the same.
    Bytes(&'a [u8]),
}

/// The index of a texture in the file, the bits of its transform, the set of texture coordinates
/// in the scene's mesh, and the transfer function of its values.
type TextureKey = (usize, [u32; 6], u8, Transfer);

/// An image that is still to be decoded.
struct ImageSource<'a> {
    bytes: Result<ImageBytes<'a>>,
    /// Its JSON path.
    path: String,
}

/// The source of an image's bytes.
#[derive(Clone, Copy)]
enum ImageBytes<'a> {
    BufferView(&'a [u8]),
    /// In the URI or the file that it names, which is opened when it is read, so that few are open
    /// at a time.
    Uri(&'a str),
}

impl<'a> Textures<'a> {
    /// The textures of a file, without any so far.
    pub fn new(buffers: &'a Buffers<'a>, reads_images: bool) -> Self {
        Self { buffers, reads_images, cache: TextureCache::default() }
    }

    /// The texture of the scene for a material's reference, which is at the JSON path `by`; it is
    /// mapped by the texture coordinates `set` of the scene's mesh.
    ///
    /// # Errors
    /// When a reference in the file leads nowhere.
    pub fn texture(
        &mut self,
        reference: TextureReference,
        set: u8,
        transfer: Transfer,
        by: &str,
        scene: &mut Scene,
        diagnostics: &mut Diagnostics,
    ) -> Result<TextureId> {
        let TextureReference { index, mut transform, .. } = reference;
        let key = (index, transform_bits(transform), set, transfer);
        if let Some(known) = self.cache.find_texture(&key) {
            return Ok(known);
        }

        // Follow the texture's own references.
        let root = self.buffers.root;
        let path = format!("textures[{index}]");
        let texture = lookup(&root.textures, index, "texture", by)?;
        let lookup_sampler = |sampler: json::Index<_>| {
            let by = format_args!("{path}.sampler");
            lookup(&root.samplers, sampler.value(), "sampler", by)
        };
        let sampler = texture.sampler.map(lookup_sampler).transpose()?;
        let image = match image_index(texture) {
            Some(image) => self.image(image, format_args!("{path}.source"))?,
            None => {
                let bytes = Err(Error::input("there is no image that can be read"));
                self.cache.add_image(ImageSource { bytes, path: path.clone() })
            }
        };

        // Without a transform that is finite the coordinates would not be either.
        if !transform.is_finite() {
            diagnostics.note(format!("{path}: a transform that is not finite is left out"));
            transform = Affine2::IDENTITY;
        }

        // A texture without a sampler repeats, is interpolated, and has mipmaps.
        Ok(self.cache.texture(key, image, scene, |image| Texture {
            transfer,
            wrap: sampler.map_or([Wrap::Repeat; 2], |s| [wrap(s.wrap_s), wrap(s.wrap_t)]),
            filter: sampler.map_or(Filter::Linear, filter),
            mipmap: sampler.is_none_or(has_mipmaps),
            set,
            transform,
            ..Texture::new(image)
        }))
    }

    /// The image with an index in the file; several of one file or URI, or of the same bytes, are the same.
    fn image(&mut self, index: usize, by: impl Display) -> Result<ImageIndex> {
        let image = lookup(&self.buffers.root.images, index, "image", by)?;
        let path = format!("images[{index}]");
        let found = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => resolve(self.buffers, uri).map(|target| match target {
                UriTarget::Data(_) => (ImageKey::DataUri(uri), ImageBytes::Uri(uri)),
                UriTarget::File(file) => (ImageKey::File(file.identity), ImageBytes::Uri(uri)),
            }),
            (None, Some(view)) => {
                let bytes = self.buffers.view(view.value(), &format!("{path}.bufferView"));
                bytes.map(|b| (ImageKey::Bytes(b), ImageBytes::BufferView(b)))
            }
            (None, None) => Err(Error::input("the image has neither a URI nor a buffer view")),
        };
        Ok(match found {
            Ok((key, bytes)) => self.cache.image(key, || ImageSource { bytes: Ok(bytes), path }),
            Err(error) => self.cache.add_image(ImageSource { bytes: Err(error), path }),
        })
    }

    /// Decodes the images, in parallel, and gives them to the textures of the scene. For one that
    /// cannot be read there is a warning and a placeholder.
    pub fn decode_images(self, scene: &mut Scene, diagnostics: &mut Diagnostics) {
        let Self { buffers, reads_images, cache } = self;
        let open = |image: &ImageSource<'a>| {
            let bytes = match image.bytes.clone()? {
                ImageBytes::BufferView(bytes) => bytes.into(),
                ImageBytes::Uri(uri) => match resolve(buffers, uri)? {
                    UriTarget::Data(bytes) => bytes.into(),
                    UriTarget::File(file) => return Ok(decode::Source::File(file)),
                },
            };
            Ok(decode::Source::Bytes(bytes, image.path.clone()))
        };
        let mut missing = HashSet::new();
        for (cached, image) in cache.decode(buffers.sandbox, open, |_| reads_images) {
            let path = cached.source.path;
            let image = image.map_err(at_path(&path));
            if !set_image_or_placeholder(image, &path, &cached.textures, scene, diagnostics) {
                missing.extend(cached.textures);
            }
        }
        drop_normal_maps(&missing, scene);
    }
}

/// Decodes the data in the URI of an image, or opens the file that it names.
fn resolve(buffers: &Buffers, uri: &str) -> Result<UriTarget> {
    buffers.resolve(uri).map_err(|error| unreadable("image", uri, &error))
}

/// Returns the index of the image that a texture shows; that of an extension where there is one.
fn image_index(texture: &json::Texture) -> Option<usize> {
    let others = texture.extensions.as_ref().map(|extensions| &extensions.others);
    let in_extension = |name: &str| as_index(others?.get(name)?.get("source")?);
    // The crate writes a missing source as the greatest index.
    let own = Some(texture.source.value()).filter(|&index| index != u32::MAX as usize);
    in_extension("KHR_texture_basisu").or_else(|| in_extension("EXT_texture_webp")).or(own)
}

fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }
}

/// Returns the magnification filter; if there is only a minification filter, that.
fn filter(sampler: &json::texture::Sampler) -> Filter {
    use MinFilter::{Nearest, NearestMipmapLinear, NearestMipmapNearest};
    match (sampler.mag_filter, sampler.min_filter) {
        (Some(Checked::Valid(MagFilter::Nearest)), _) => Filter::Nearest,
        (None, Some(Checked::Valid(Nearest | NearestMipmapLinear | NearestMipmapNearest))) => {
            Filter::Nearest
        }
        _ => Filter::Linear,
    }
}

/// True if the texture has mipmaps: unless the sampler says that it has none.
fn has_mipmaps(sampler: &json::texture::Sampler) -> bool {
    use MinFilter::{Linear, Nearest};
    !matches!(sampler.min_filter, Some(Checked::Valid(Linear | Nearest)))
}
