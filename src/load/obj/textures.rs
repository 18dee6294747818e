//! The textures of an OBJ file's materials, whose images are decoded when all are known.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use glam::{Affine2, Vec2};

use super::file_lookup::open_file;
use super::texture_map::TextureMap;
use crate::load::diagnostics::Diagnostics;
use crate::load::images::decode;
use crate::load::images::placeholder::{drop_normal_maps, set_image_or_placeholder};
use crate::load::images::texture_cache::{ImageIndex, TextureCache, transform_bits};
use crate::load::sandbox::Sandbox;
use crate::scene::{
    Channel, Image, MaterialId, NormalMap, Scene, Texture, TextureId, Transfer, Wrap,
};

/// The share of an image's pixels that must look like normals for it to be a normal map.
const MIN_NORMALS: f64 = 0.9;

/// The textures of a file.
pub struct Textures<'a> {
    sandbox: &'a Sandbox,
    /// The images by canonical path, or the path that they should have.
    cache: TextureCache<PathBuf, ImageFile, TextureKey>,
    /// The materials whose opacity is in their image's alpha, if it has one.
    alpha_preferred: Vec<MaterialId>,
    bumps: Vec<Bump>,
}

/// The key of a texture: its image, true if it is clamped, its curve and the bits of its transform.
type TextureKey = (ImageIndex, bool, Transfer, [u32; 6]);

/// An image file that an MTL file names.
struct ImageFile {
    /// The folder of the MTL file.
    folder: PathBuf,
    /// The name in the MTL file.
    name: String,
}

/// A `bump` that may be a normal map.
struct Bump {
    material: MaterialId,
    map: NormalMap,
}

impl<'a> Textures<'a> {
    /// Returns an empty collection of textures.
    pub fn new(sandbox: &'a Sandbox) -> Self {
        let cache = TextureCache::default();
        Self { sandbox, cache, alpha_preferred: Vec::new(), bumps: Vec::new() }
    }

    /// Returns the texture of a statement in the MTL file in `folder`.
    pub fn texture(
        &mut self,
        map: &TextureMap,
        transfer: Transfer,
        folder: &Path,
        scene: &mut Scene,
    ) -> TextureId {
        // Only a few files are open at a time: this one is opened again when it is decoded.
        let opened = open_file(self.sandbox, folder, &map.file);
        let path = opened.map_or_else(|_| folder.join(&map.file), |file| file.identity);
        let image = self
            .cache
            .image(path, || ImageFile { folder: folder.to_owned(), name: map.file.clone() });
        let transform = transform(map);
        let key = (image, map.is_clamped, transfer, transform_bits(transform));
        let wrap = if map.is_clamped { Wrap::Clamp } else { Wrap::Repeat };
        self.cache.texture(key, image, scene, |image| Texture {
            transfer,
            wrap: [wrap; 2],
            mipmap: true,
            transform,
            ..Texture::new(image)
        })
    }

    /// Records that a material's opacity is in its image's alpha, if that has one.
    pub fn prefer_alpha(&mut self, material: MaterialId) {
        self.alpha_preferred.push(material);
    }

    /// Records that the `bump` of a material may be a normal map.
    pub fn add_bump(&mut self, material: MaterialId, map: NormalMap) {
        self.bumps.push(Bump { material, map });
    }

    /// Decodes the images, in parallel, if the scene `needs_images`, and decides what depends on them.
    pub fn decode(self, needs_images: bool, scene: &mut Scene, diagnostics: &mut Diagnostics) {
        let Self { sandbox, cache, alpha_preferred, bumps } = self;
        let open = |file: &ImageFile| {
            open_file(sandbox, &file.folder, &file.name).map(decode::Source::File)
        };
        let mut missing = HashSet::new();
        for (cached, image) in cache.decode(sandbox, open, |_| needs_images) {
            let ImageFile { folder, name } = &cached.source;
            let image = image.map_err(|e| e.at(&folder.join(name)));
            if !set_image_or_placeholder(image, name, &cached.textures, scene, diagnostics) {
                missing.extend(cached.textures);
            }
        }
        drop_normal_maps(&missing, scene);
        // Opacities that are in an alpha channel.
        for material in alpha_preferred {
            let Scene { materials, textures, .. } = scene;
            let coverage = materials[material.0 as usize].coverage.as_mut();
            if let Some(Channel { texture, channel }) = coverage.and_then(|c| c.map.as_mut()) {
                let image = &textures[texture.0 as usize].image;
                if image.is_read() && !image.is_channel_full(3) {
                    *channel = 3;
                }
            }
        }
        // Bumps that are normal maps, as many programs write them.
        for Bump { material, map } in bumps {
            let image = &scene.textures[map.texture.0 as usize].image;
            if !image.is_read() || missing.contains(&map.texture) {
                continue;
            }
            let is_normal_map = is_normal_map(image);
            let material = &mut scene.materials[material.0 as usize];
            if is_normal_map {
                material.normal_map = Some(map);
            } else {
                let reason = "{} textures of heights (`bump`) are not read";
                diagnostics.unsupported(reason, 1, || format!("`{}`", material.name));
            }
        }
    }
}

/// Returns the transform from our texture coordinates, whose v runs down, to those of the image: MTL
/// scales those whose v runs up, and then shifts them.
fn transform(map: &TextureMap) -> Affine2 {
    let ([su, sv], [ou, ov]) = (map.scale, map.offset);
    Affine2::from_scale_angle_translation(Vec2::new(su, sv), 0.0, Vec2::new(ou, 1.0 - sv - ov))
}

/// True if an image is a normal map: nearly everywhere a vector of length 1 that points out of the
/// surface, and not a grey.
fn is_normal_map(image: &Image) -> bool {
    let count = image.texels.len();
    let is_normal = |i: &usize| {
        let n = image.texels.linear(*i, Transfer::None).truncate() * 2.0 - 1.0;
        (n.length() - 1.0).abs() < 0.2
            && n.z > 0.3
            && n.z > n.x.max(n.y) - 0.2
            && n.x.min(n.y) < n.z - 0.02
    };
    let normals = (0..count).filter(is_normal).count();
    normals as f64 >= MIN_NORMALS * count as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn greys_are_heights_and_blues_are_normals() {
        let image = |texel: [u8; 3]| {
            let [r, g, b] = texel;
            Image::from_bytes("", [1, 1], vec![[r, g, b, 255]])
        };
        let blues = [[128, 128, 255], [180, 128, 240], [128, 60, 230]];
        assert!(blues.iter().all(|&texel| is_normal_map(&image(texel))));
        assert!((0..=255).all(|grey| !is_normal_map(&image([grey; 3]))));
    }

    #[test]
    fn coordinates_are_scaled_and_then_shifted_with_v_up() {
        let map = TextureMap::parse("-s 2 3 -o .25 .5 a.png").unwrap();
        // u 1, v 1 becomes 2.25, 3.5: with v down, 0 becomes −2.5.
        assert_eq!(transform(&map).transform_point2(Vec2::new(1.0, 0.0)), Vec2::new(2.25, -2.5));
    }
}
