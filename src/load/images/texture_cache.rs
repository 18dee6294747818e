//! The textures of a file and the images that they show: each image is decoded once, and all of
//! them in parallel, when the whole file is known.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::Arc;

use glam::Affine2;

use super::decode::{self, decode_all};
use crate::error::Result;
use crate::load::sandbox::Sandbox;
use crate::scene::{Image, Scene, Texture, TextureId};

/// The textures of a file so far, and the images that are still to be decoded.
///
/// An `ImageKey` identifies an image, a `Source` says where its bytes are, and a `TextureKey`
/// identifies a texture: its image and how that is sampled.
pub struct TextureCache<ImageKey, Source, TextureKey> {
    images: Vec<CachedImage<Source>>,
    indices: HashMap<ImageKey, ImageIndex>,
    textures: HashMap<TextureKey, TextureId>,
}

/// The index of an image in a [`TextureCache`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ImageIndex(usize);

/// An image of a [`TextureCache`].
pub struct CachedImage<Source> {
    /// The source of its bytes, as it was given to the cache.
    pub source: Source,
    /// The textures that show it.
    pub textures: Vec<TextureId>,
}

impl<ImageKey, Source, TextureKey> Default for TextureCache<ImageKey, Source, TextureKey> {
    fn default() -> Self {
        Self { images: Vec::new(), indices: HashMap::new(), textures: HashMap::new() }
    }
}

impl<ImageKey: Eq + Hash, Source: Sync, TextureKey: Eq + Hash>
    TextureCache<ImageKey, Source, TextureKey>
{
    /// Returns the index of the image with this key, which is added with its `source` if it is new.
    pub fn image(&mut self, key: ImageKey, source: impl FnOnce() -> Source) -> ImageIndex {
        *self.indices.entry(key).or_insert_with(|| add(&mut self.images, source()))
    }

    /// Adds an image that is not the same as any other, and returns its index.
    pub fn add_image(&mut self, source: Source) -> ImageIndex {
        add(&mut self.images, source)
    }

    /// Returns the texture with this key, if there is one.
    pub fn find_texture(&self, key: &TextureKey) -> Option<TextureId> {
        self.textures.get(key).copied()
    }

    /// Returns the texture with this key, which shows `image`. If it is new, it is added to the
    /// scene as `build` makes it of an image that stands for the decoded one.
    pub fn texture(
        &mut self,
        key: TextureKey,
        image: ImageIndex,
        scene: &mut Scene,
        build: impl FnOnce(Arc<Image>) -> Texture,
    ) -> TextureId {
        *self.textures.entry(key).or_insert_with(|| {
            // An unread image stands for the one that is decoded later.
            let id = scene.add_texture(build(Arc::new(Image::unread(""))));
            self.images[image.0].textures.push(id);
            id
        })
    }

    /// Decodes the images that are needed, in parallel; the others are only named. Each comes with
    /// the error that prevented it, if it could not be read. `open` opens the file of an image: few
    /// are open at a time.
    pub fn decode<'b>(
        self,
        sandbox: &Sandbox,
        open: impl Fn(&Source) -> Result<decode::Source<'b>>,
        is_needed: impl Fn(&Source) -> bool,
    ) -> impl Iterator<Item = (CachedImage<Source>, Result<Image>)> {
        let open = |image: &CachedImage<Source>| open(&image.source);
        let is_needed = |image: &CachedImage<Source>| is_needed(&image.source);
        let decoded = decode_all(&self.images, sandbox, open, is_needed);
        self.images.into_iter().zip(decoded)
    }
}

fn add<Source>(images: &mut Vec<CachedImage<Source>>, source: Source) -> ImageIndex {
    images.push(CachedImage { source, textures: Vec::new() });
    ImageIndex(images.len() - 1)
}

/// Sets the image that textures of a scene show.
pub fn set_image(image: Image, textures: &[TextureId], scene: &mut Scene) {
    let image = Arc::new(image);
    for texture in textures {
        scene.textures[texture.0 as usize].image = image.clone();
    }
}

/// The bits of a transform, by which transforms can be keys; 0 and −0 are the same.
pub fn transform_bits(transform: Affine2) -> [u32; 6] {
    transform.to_cols_array().map(|x| (x + 0.0).to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textures_share_an_image_and_differ_by_how_they_sample_it() {
        let (mut cache, mut scene) = (TextureCache::default(), Scene::default());
        let [first, same, other] =
            ["a", "a", "b"].map(|name| cache.image(name, || name.to_owned()));
        assert_eq!(first, same);
        assert_ne!(first, other);
        let mut texture =
            |image, filter: u8| cache.texture((image, filter), image, &mut scene, Texture::new);
        let ids = [(first, 0), (same, 0), (first, 1), (other, 0)].map(|(i, s)| texture(i, s).0);
        assert_eq!(ids, [0, 0, 1, 2]);
        assert_eq!(cache.images[first.0].textures, [TextureId(0), TextureId(1)]);
    }

    #[test]
    fn images_that_are_added_are_never_the_same() {
        let mut cache = TextureCache::<(), _, ()>::default();
        assert_ne!(cache.add_image(0), cache.add_image(0));
    }

    #[test]
    fn zeros_of_both_signs_are_the_same_key() {
        let mut negative = Affine2::IDENTITY;
        negative.translation.x = -0.0;
        assert_eq!(transform_bits(negative), transform_bits(Affine2::IDENTITY));
    }
}
