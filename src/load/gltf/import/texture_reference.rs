//! The references of materials to textures.

use glam::{Affine2, Mat2, Vec2};
use gltf::json::{self, extensions::texture::TextureTransform, texture::Info};

/// A reference to a texture, with the transform of its coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureReference {
    /// The index of the texture in the file.
    pub index: usize,
    /// The number of the TEXCOORD set.
    pub uv_set: u32,
    /// The transform of KHR_texture_transform, from the set's coordinates to those in the image.
    pub transform: Affine2,
}

const TRANSFORM: &str = "KHR_texture_transform";

impl TextureReference {
    /// The reference of a plain texture info.
    pub fn from_info(info: &Info) -> Self {
        let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.clone());
        Self::new(info.index.value(), info.tex_coord, transform)
    }

    /// The reference of a normal texture.
    pub fn from_normal(info: &json::material::NormalTexture) -> Self {
        let transform = info.extensions.as_ref().and_then(|e| e.others.get(TRANSFORM));
        Self::new(info.index.value(), info.tex_coord, transform.and_then(parse_transform))
    }

    /// The reference of an occlusion texture.
    pub fn from_occlusion(info: &json::material::OcclusionTexture) -> Self {
        let transform = info.extensions.as_ref().and_then(|e| e.others.get(TRANSFORM));
        Self::new(info.index.value(), info.tex_coord, transform.and_then(parse_transform))
    }

    fn new(index: usize, tex_coord: u32, transform: Option<TextureTransform>) -> Self {
        let transform = transform.unwrap_or_default();
        let uv_set = transform.tex_coord.unwrap_or(tex_coord);
        Self { index, uv_set, transform: affine(&transform) }
    }
}

/// Returns the affine transform: scale, then rotate, then offset.
///
/// Positive angles turn counter-clockwise as one sees the image, whose v runs down: so do Khronos'
/// viewer and its TextureTransformTest, while the GLSL in the extension's text has the sign the
/// other way.
fn affine(transform: &TextureTransform) -> Affine2 {
    let (sin, cos) = transform.rotation.0.sin_cos();
    let turn = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
    let scale = Mat2::from_diagonal(transform.scale.0.into());
    Affine2::from_mat2_translation(turn * scale, transform.offset.0.into())
}

/// Parses a transform that the `gltf` crate leaves as JSON, without its `extras`, which may be
/// anything; `None` if it is not one.
fn parse_transform(extension: &json::Value) -> Option<TextureTransform> {
    let mut transform = extension.clone();
    if let Some(properties) = transform.as_object_mut() {
        properties.remove("extras");
    }
    json::deserialize::from_value(transform).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transform_scales_then_turns_then_shifts() {
        let rotation = std::f32::consts::FRAC_PI_2;
        let (offset, scale) = ([10.0, 20.0], [2.0, 3.0]);
        let transform = serde_json::json!({"offset": offset, "rotation": rotation, "scale": scale});
        let transform = affine(&parse_transform(&transform).unwrap());
        let [u, v] = transform.transform_point2(Vec2::X).to_array();
        // (1, 0) becomes (2, 0), turns to (0, −2), which is up, and is shifted.
        assert!((u - 10.0).abs() < 1e-6 && (v - 18.0).abs() < 1e-6, "{u} {v}");
    }

    #[test]
    fn a_transform_may_choose_another_set() {
        let transform = serde_json::json!({"texCoord": 1, "scale": [2, 2]});
        let reference = TextureReference::new(3, 0, parse_transform(&transform));
        assert_eq!((reference.index, reference.uv_set), (3, 1));
        assert_eq!(reference.transform.transform_point2(Vec2::ONE), Vec2::splat(2.0));
    }
}
