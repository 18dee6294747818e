//! Textures: samplers, pictures, and where on them a surface's coordinates fall.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use glam::{Affine2, Mat2, Vec2};
use gltf::json;
use gltf::json::texture::{Info, MagFilter, MinFilter, WrappingMode};
use gltf::json::validation::Checked;

use super::buffers::{Buffers, Target, cannot_have, get, resolve};
use crate::error::{Error, Place, Result};
use crate::load::guard::Guard;
use crate::load::picture;
use crate::load::stand_in;
use crate::load::tally::Tally;
use crate::scene::{Filter, Scene, Texture, TextureId, Transfer, Wrap};

/// What a material's reference to a texture says: which one, by which coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// The number of the texture in the file.
    pub index: usize,
    /// The number of the TEXCOORD set.
    pub set: u32,
    /// KHR_texture_transform.
    transform: Affine2,
}

const TRANSFORM: &str = "KHR_texture_transform";

/// KHR_texture_transform, as far as a reference gives it.
#[derive(serde::Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Transform {
    offset: [f32; 2],
    rotation: f32,
    scale: [f32; 2],
    tex_coord: Option<u32>,
}

impl Default for Transform {
    fn default() -> Self {
        Self { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2], tex_coord: None }
    }
}

impl Transform {
    /// From a set of coordinates to those on the picture.
    ///
    /// Scale, then rotate, then offset. Positive angles turn counter-clockwise as one sees the
    /// picture, whose v runs down: so do Khronos' viewer and its TextureTransformTest, while the
    /// GLSL in the extension's text has the sign the other way.
    fn affine(&self) -> Affine2 {
        let (sin, cos) = self.rotation.sin_cos();
        let turn = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
        Affine2::from_mat2_translation(
            turn * Mat2::from_diagonal(self.scale.into()),
            self.offset.into(),
        )
    }
}

impl Slot {
    /// That of a plain reference.
    pub fn of(info: &Info) -> Self {
        let extension = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref());
        let transform = extension.map(|t| Transform {
            offset: t.offset.0,
            rotation: t.rotation.0,
            scale: t.scale.0,
            tex_coord: t.tex_coord,
        });
        Self::with(info.index.value(), info.tex_coord, transform)
    }

    /// That of a normal texture.
    pub fn of_normal(info: &json::material::NormalTexture) -> Self {
        let others = info.extensions.as_ref().and_then(|e| e.others.get(TRANSFORM));
        Self::with(info.index.value(), info.tex_coord, parsed(others))
    }

    /// That of an occlusion texture.
    pub fn of_occlusion(info: &json::material::OcclusionTexture) -> Self {
        let others = info.extensions.as_ref().and_then(|e| e.others.get(TRANSFORM));
        Self::with(info.index.value(), info.tex_coord, parsed(others))
    }

    fn with(index: usize, set: u32, transform: Option<Transform>) -> Self {
        let transform = transform.unwrap_or_default();
        let set = transform.tex_coord.unwrap_or(set);
        Self { index, set, transform: transform.affine() }
    }
}

/// A transform that the `gltf` crate leaves as it stands in the JSON; what is no transform is none.
fn parsed(extension: Option<&json::Value>) -> Option<Transform> {
    json::deserialize::from_value(extension?.clone()).ok()
}

/// The textures of a file. What they show is decoded when all are known, each picture once.
pub struct Textures<'a> {
    root: &'a json::Root,
    guard: &'a Guard,
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
        guard: &'a Guard,
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
        tally: &mut Tally,
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
        let image = stand_in::white(&format!("textures[{index}]"));
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
    pub fn decode(self, scene: &mut Scene, tally: &mut Tally) {
        let Self { guard, buffers, wanted, pictures, .. } = self;
        let folder = buffers.folder();
        let open = |picture: &Picture<'a>| match picture.source.clone()? {
            Source::Bytes(bytes) => Ok(picture::Source::Bytes(bytes, picture.at.clone())),
            Source::File(uri) => match resolve(uri, folder, guard) {
                Ok(Target::Data(bytes)) => {
                    Ok(picture::Source::Bytes(bytes.into(), picture.at.clone()))
                }
                Ok(Target::File(file)) => Ok(picture::Source::File(file)),
                Err(error) => Err(cannot_have("picture", uri, &error)),
            },
        };
        let images = picture::decode_all(&pictures, guard, open, |_| wanted);
        for (image, Picture { at, shown_by, .. }) in images.into_iter().zip(pictures) {
            let image = image.map_err(|e| e.place(Place::Json(at.clone())));
            stand_in::show(image, &at, shown_by.into_iter(), scene, tally);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transform_scales_then_turns_then_shifts() {
        let rotation = std::f32::consts::FRAC_PI_2;
        let (offset, scale) = ([10.0, 20.0], [2.0, 3.0]);
        let transform = Transform { offset, rotation, scale, tex_coord: None }.affine();
        let [u, v] = transform.transform_point2(Vec2::X).to_array();
        // (1, 0) becomes (2, 0), turns to (0, −2), which is up, and is shifted.
        assert!((u - 10.0).abs() < 1e-6 && (v - 18.0).abs() < 1e-6, "{u} {v}");
    }

    #[test]
    fn a_transform_may_choose_another_set() {
        let transform = serde_json::json!({"texCoord": 1, "scale": [2, 2]});
        let slot = Slot::with(3, 0, parsed(Some(&transform)));
        assert_eq!((slot.index, slot.set), (3, 1));
        assert_eq!(slot.transform.transform_point2(Vec2::ONE), Vec2::splat(2.0));
    }
}
