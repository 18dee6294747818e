//! The reader of one glTF material: its textures and colours, and the vertex attributes it needs.

use std::fmt::Display;

use glam::Vec3;
use gltf::json::{self, texture::Info};

use crate::error::Result;
use crate::load::diagnostics::Diagnostics;
use crate::load::gltf::import::texture::Textures;
use crate::load::gltf::import::texture_reference::TextureReference;
use crate::scene::{Channel, Scene, TextureId, Transfer};

/// The vertex attributes that a material needs.
#[derive(Clone, Debug, Default)]
pub struct NeededAttributes {
    /// The TEXCOORD sets of its textures, at most two.
    pub uv_sets: Vec<u32>,
    /// True if it has a normal map.
    pub tangents: bool,
    /// True if the alpha of vertex colours counts.
    pub alpha: bool,
    /// True if neither texture coordinates nor vertex colours count.
    pub geometry_only: bool,
}

/// A material of the file that is being read.
pub struct MaterialReader<'m, 'a> {
    /// The material.
    pub source: &'a json::Material,
    /// Its extensions.
    pub extensions: Option<&'a json::extensions::material::Material>,
    /// Its JSON path.
    pub path: String,
    /// The vertex attributes that it needs, as far as it has been read.
    pub needed: NeededAttributes,
    /// The textures of the file.
    pub textures: &'m mut Textures<'a>,
    /// The scene, to which textures are added.
    pub scene: &'m mut Scene,
    /// The diagnostics of the load.
    pub diagnostics: &'m mut Diagnostics,
}

impl MaterialReader<'_, '_> {
    /// Returns a texture of the scene; `key` is the path of the reference within the material.
    ///
    /// # Errors
    /// When the reference, or one that it leads to, leads nowhere.
    pub fn texture(
        &mut self,
        reference: TextureReference,
        transfer: Transfer,
        key: impl Display,
    ) -> Result<TextureId> {
        // The mesh has two sets of texture coordinates at most: those that its material asks for
        // first.
        let sets = &mut self.needed.uv_sets;
        let set = match sets.iter().position(|&set| set == reference.uv_set) {
            Some(known) => known,
            None if sets.len() == 2 => {
                let reason = "{} textures are laid on by the first of more than two sets of \
                              texture coordinates";
                self.diagnostics.unsupported(reason, 1, || format!("{}.{key}", self.path));
                0
            }
            None => {
                sets.push(reference.uv_set);
                sets.len() - 1
            }
        };

        // The texture refers to the set by its place among those two.
        let by = format!("{}.{key}.index", self.path);
        self.textures.texture(reference, set as u8, transfer, &by, self.scene, self.diagnostics)
    }

    /// Returns a texture of colours, if there is a reference to one.
    ///
    /// # Errors
    /// When the reference, or one that it leads to, leads nowhere.
    pub fn color_texture(
        &mut self,
        info: Option<&Info>,
        key: impl Display,
    ) -> Result<Option<TextureId>> {
        info.map(|info| self.texture(TextureReference::from_info(info), Transfer::Srgb, key))
            .transpose()
    }

    /// Returns a channel of a texture of data, if there is a reference to one.
    ///
    /// # Errors
    /// When the reference, or one that it leads to, leads nowhere.
    pub fn channel(
        &mut self,
        info: Option<&Info>,
        channel: u8,
        key: impl Display,
    ) -> Result<Option<Channel>> {
        let Some(info) = info else { return Ok(None) };
        let texture = self.texture(TextureReference::from_info(info), Transfer::None, key)?;
        Ok(Some(Channel { texture, channel }))
    }

    /// Returns a colour that the scene accepts: finite and not negative.
    pub fn color(&mut self, color: [f32; 3], key: impl Display) -> Vec3 {
        let is_valid = |x: f32| x.is_finite() && x >= 0.0;
        if !color.iter().all(|&x| is_valid(x)) {
            let reason = "{} colours are negative or not finite and become 0";
            self.diagnostics.add(reason, 1, || format!("{}.{key}", self.path));
        }
        Vec3::from(color.map(|x| if is_valid(x) { x } else { 0.0 }))
    }

    /// Counts a feature of the material that is not supported.
    pub fn report_unsupported(&mut self, reason: &str) {
        self.diagnostics.unsupported(reason, 1, || self.path.clone());
    }
}

/// Returns a factor clamped to [0, 1]; what is no number becomes 1, the default.
pub fn clamped(x: f32) -> f32 {
    if x.is_nan() { 1.0 } else { x.clamp(0.0, 1.0) }
}
