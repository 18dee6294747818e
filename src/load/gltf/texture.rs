//! Textures: samplers, pictures, and where on them a surface's coordinates fall.

use std::collections::HashMap;
use std::sync::Arc;

use gltf::json;
use gltf::json::texture::{Info, MagFilter, MinFilter, WrappingMode};
use gltf::json::validation::Checked;

use super::buffers::{Buffers, Target, cannot_have, get};
use crate::error::{Error, Place, Result};
use crate::load::guard::Guard;
use crate::load::picture;
use crate::load::tally::Tally;
use crate::scene::{Filter, Image, Texture, Transfer, Wrap};

/// Which texture coordinates a texture uses, and KHR_texture_transform's change to them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UvMap {
    /// The number of the TEXCOORD set.
    pub set: u32,
    transform: Option<Transform>,
}

#[derive(Clone, Debug, PartialEq)]
struct Transform {
    offset: [f32; 2],
    rotation: f32,
    scale: [f32; 2],
}

impl UvMap {
    /// What a reference to a texture says of its coordinates.
    pub fn of(info: &Info) -> Self {
        let extension = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref());
        let transform = extension.map(|t| Transform {
            offset: t.offset.0,
            rotation: t.rotation.0,
            scale: t.scale.0,
        });
        let set = extension.and_then(|t| t.tex_coord).unwrap_or(info.tex_coord);
        Self { set, transform }
    }

    /// The coordinates on the picture of a vertex's coordinates.
    ///
    /// Scale, then rotate, then offset. Positive angles turn counter-clockwise as one sees the
    /// picture, whose v runs down: so do Khronos' viewer and its TextureTransformTest, while the
    /// GLSL in the extension's text has the sign the other way.
    pub fn apply(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        let Some(t) = &self.transform else { return [u, v] };
        let (sin, cos) = t.rotation.sin_cos();
        let (u, v) = (u * t.scale[0], v * t.scale[1]);
        [cos * u + sin * v + t.offset[0], -sin * u + cos * v + t.offset[1]]
    }
}

/// The pictures of a file, decoded when they are first asked for.
pub struct Textures<'a> {
    root: &'a json::Root,
    guard: &'a Guard,
    buffers: &'a Buffers<'a>,
    /// Whether anything shows the pictures; otherwise they are only named.
    wanted: bool,
    images: HashMap<usize, Arc<Image>>,
    /// Pictures that name the same file are decoded once.
    by_uri: HashMap<&'a str, Arc<Image>>,
}

impl<'a> Textures<'a> {
    /// The textures of a file, whose pictures are read where they are `wanted`.
    pub fn new(
        root: &'a json::Root,
        guard: &'a Guard,
        buffers: &'a Buffers<'a>,
        wanted: bool,
    ) -> Self {
        Self { root, guard, buffers, wanted, images: HashMap::new(), by_uri: HashMap::new() }
    }

    /// A texture, its picture decoded. A picture that cannot be had is a warning, and a
    /// placeholder takes its place.
    ///
    /// # Errors
    /// When the file's own references lead nowhere.
    pub fn get(
        &mut self,
        index: usize,
        transfer: Transfer,
        by: &str,
        tally: &mut Tally,
    ) -> Result<Texture> {
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
        let wrap = sampler.map_or([Wrap::Repeat; 2], |s| [wrap(s.wrap_s), wrap(s.wrap_t)]);
        let filter = sampler.map_or(Filter::Linear, filter);
        let image = match source(texture) {
            Some(source) => self.image(source, &format!("textures[{index}].source"), tally)?,
            None => {
                tally.placeholder(format!("textures[{index}] has no picture that can be read"));
                Arc::new(picture::placeholder(&format!("textures[{index}]")))
            }
        };
        Ok(Texture { image, transfer, wrap, filter })
    }

    fn image(&mut self, index: usize, by: &str, tally: &mut Tally) -> Result<Arc<Image>> {
        if let Some(image) = self.images.get(&index) {
            return Ok(image.clone());
        }
        let image = get(&self.root.images, index, "image", by)?;
        let uri = image.uri.as_deref();
        let decoded = match uri.and_then(|uri| self.by_uri.get(uri)) {
            Some(decoded) => decoded.clone(),
            None => Arc::new(self.decode(image, index).unwrap_or_else(|error| {
                tally.placeholder(format!("{error}; a magenta checker takes its place"));
                picture::placeholder(&format!("images[{index}]"))
            })),
        };
        if let Some(uri) = uri {
            self.by_uri.insert(uri, decoded.clone());
        }
        self.images.insert(index, decoded.clone());
        Ok(decoded)
    }

    fn decode(&self, image: &json::Image, index: usize) -> Result<Image> {
        let at = format!("images[{index}]");
        let read = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => match self.buffers.resolve(uri) {
                Ok(Target::Data(bytes)) => picture::decode(&bytes, &at, self.guard, self.wanted),
                Ok(Target::File(file)) => picture::read(file, self.guard, self.wanted),
                Err(error) => Err(cannot_have("picture", uri, &error)),
            },
            (None, Some(view)) => {
                let bytes = self.buffers.view(view.value(), &format!("{at}.bufferView"))?;
                picture::decode(bytes, &at, self.guard, self.wanted)
            }
            (None, None) => Err(Error::input("the image has neither a URI nor a buffer view")),
        };
        read.map_err(|e| e.place(Place::Json(at)))
    }
}

/// The picture of a texture; that of EXT_texture_webp where there is one.
fn source(texture: &json::Texture) -> Option<usize> {
    let webp = || {
        let extension = texture.extensions.as_ref()?.others.get("EXT_texture_webp")?;
        usize::try_from(extension.get("source")?.as_u64()?).ok()
    };
    // The crate writes a missing source as the greatest index.
    let own = texture.source.value();
    webp().or((own != u32::MAX as usize).then_some(own))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transform_scales_then_turns_then_shifts() {
        let quarter = std::f32::consts::FRAC_PI_2;
        let transform = Transform { offset: [10.0, 20.0], rotation: quarter, scale: [2.0, 3.0] };
        let [u, v] = UvMap { set: 0, transform: Some(transform) }.apply([1.0, 0.0]);
        // (1, 0) becomes (2, 0), turns to (0, −2), which is up, and is shifted.
        assert!((u - 10.0).abs() < 1e-6 && (v - 18.0).abs() < 1e-6, "{u} {v}");
    }
}
