//! The textures of an OBJ file's materials. What they show is decoded when all are known, each
//! picture once.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{Affine2, Vec2};

use super::files::find;
use super::map::Map;
use crate::load::diagnostics::Diagnostics;
use crate::load::images::decode;
use crate::load::images::placeholder;
use crate::load::sandbox::Sandbox;
use crate::scene::{
    Channel, Image, MaterialId, NormalMap, Scene, Texture, TextureId, Transfer, Wrap,
};

/// How much of a picture must look like normals for it to be one of normals.
const MOSTLY: f64 = 0.9;

/// The textures of a file.
pub struct Textures<'a> {
    guard: &'a Sandbox,
    /// Pictures that are still to be decoded.
    pictures: Vec<Picture>,
    /// Their numbers, by their canonical paths, or those that they should have.
    numbers: HashMap<PathBuf, usize>,
    /// Materials whose opacity is in the picture's alpha, if it has one.
    opacities: Vec<MaterialId>,
    /// Materials with a `bump` that may be a picture of normals, and how much it counts.
    bumps: Vec<(MaterialId, TextureId, f32, String)>,
}

/// How a texture shows its picture: whether clamped, by which curve, and where.
type Key = (bool, Transfer, Affine2);

/// A picture that is still to be decoded, and the textures that show it, each in another way.
struct Picture {
    /// The folder of the MTL file, and what that calls it.
    folder: PathBuf,
    name: String,
    shown_by: Vec<(Key, TextureId)>,
}

impl<'a> Textures<'a> {
    /// None yet.
    pub fn new(guard: &'a Sandbox) -> Self {
        let (pictures, numbers, opacities, bumps) = Default::default();
        Self { guard, pictures, numbers, opacities, bumps }
    }

    /// The texture of a statement, whose file is beside the MTL file in `folder`.
    pub fn get(
        &mut self,
        map: &Map,
        transfer: Transfer,
        folder: &Path,
        scene: &mut Scene,
    ) -> TextureId {
        // Files are many, and open ones few: this one is opened again when it is decoded.
        let found = find(self.guard, folder, &map.file);
        let path = found.map_or_else(|_| folder.join(&map.file), |file| file.identity);
        let pictures = &mut self.pictures;
        let number = *self.numbers.entry(path).or_insert_with(|| {
            let (folder, name) = (folder.to_owned(), map.file.clone());
            pictures.push(Picture { folder, name, shown_by: Vec::new() });
            pictures.len() - 1
        });
        let shown_by = &mut pictures[number].shown_by;
        let key = (map.clamp, transfer, transform(map));
        if let Some(&(_, id)) = shown_by.iter().find(|(made, _)| *made == key) {
            return id;
        }
        let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
        let id = scene.add_texture(Texture {
            transfer,
            wrap: [wrap; 2],
            mipmap: true,
            transform: key.2,
            ..Texture::new(Arc::new(placeholder::white(&map.file)))
        });
        shown_by.push((key, id));
        id
    }

    /// Notes that a material's opacity is in its picture's alpha, where that has one.
    pub fn prefer_alpha(&mut self, material: MaterialId) {
        self.opacities.push(material);
    }

    /// Notes that a `bump` may be a picture of normals.
    pub fn may_be_normals(
        &mut self,
        material: MaterialId,
        texture: TextureId,
        scale: f32,
        name: &str,
    ) {
        self.bumps.push((material, texture, scale, name.to_owned()));
    }

    /// Decodes the pictures, side by side, if they are `wanted`, and settles what depends on them.
    pub fn decode(self, wanted: bool, scene: &mut Scene, tally: &mut Diagnostics) {
        let open = |picture: &Picture| {
            find(self.guard, &picture.folder, &picture.name).map(decode::Source::File)
        };
        let images = decode::decode_all(&self.pictures, self.guard, open, |_| wanted);
        let mut missing = HashSet::new();
        for (image, picture) in images.into_iter().zip(&self.pictures) {
            let image = image.map_err(|e| e.at(&picture.folder.join(&picture.name)));
            let shown_by: Vec<_> = picture.shown_by.iter().map(|(_, id)| *id).collect();
            let (name, show) = (&picture.name, placeholder::set_image_or_placeholder);
            if !show(image, name, &shown_by, scene, tally) {
                missing.extend(shown_by);
            }
        }
        for material in self.opacities {
            let Scene { materials, textures, .. } = scene;
            let coverage = &mut materials[material.0 as usize].coverage;
            if let Some(Channel { texture, channel }) =
                coverage.as_mut().and_then(|c| c.map.as_mut())
            {
                let image = &textures[texture.0 as usize].image;
                if image.is_read() && !image.is_full(3) {
                    *channel = 3;
                }
            }
        }
        for (material, texture, scale, name) in self.bumps {
            let image = &scene.textures[texture.0 as usize].image;
            if !image.is_read() || missing.contains(&texture) {
                continue;
            }
            if are_normals(image) {
                let map = NormalMap { texture, scale };
                scene.materials[material.0 as usize].normal_map = Some(map);
            } else {
                let reason = "{} textures of heights (`bump`) are not read";
                tally.unsupported(reason, 1, || format!("`{name}`"));
            }
        }
    }
}

/// From our texture coordinates, whose v runs down, to those on the picture: MTL scales those whose v
/// runs up, and then shifts them.
fn transform(map: &Map) -> Affine2 {
    let ([su, sv], [ou, ov]) = (map.scale, map.offset);
    Affine2::from_scale_angle_translation(Vec2::new(su, sv), 0.0, Vec2::new(ou, 1.0 - sv - ov))
}

/// Whether a picture is one of normals: nearly everywhere a vector of length 1 that points out of
/// the surface, and not a grey.
fn are_normals(image: &Image) -> bool {
    let count = image.texels.len();
    let is_normal = |i: &usize| {
        let n = image.texels.linear(*i, Transfer::None).truncate() * 2.0 - 1.0;
        (n.length() - 1.0).abs() < 0.2
            && n.z > 0.3
            && n.z > n.x.max(n.y) - 0.2
            && n.x.min(n.y) < n.z - 0.02
    };
    let normals = (0..count).filter(is_normal).count();
    normals as f64 >= MOSTLY * count as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn greys_are_heights_and_blues_are_normals() {
        let picture = |texel: [u8; 3]| {
            let [r, g, b] = texel;
            Image::bytes("", [1, 1], vec![[r, g, b, 255]])
        };
        let blues = [[128, 128, 255], [180, 128, 240], [128, 60, 230]];
        assert!(blues.iter().all(|&texel| are_normals(&picture(texel))));
        assert!((0..=255).all(|grey| !are_normals(&picture([grey; 3]))));
    }

    #[test]
    fn coordinates_are_scaled_and_then_shifted_with_v_up() {
        let map = Map::parse("-s 2 3 -o .25 .5 a.png").unwrap();
        // u 1, v 1 becomes 2.25, 3.5: with v down, 0 becomes −2.5.
        assert_eq!(transform(&map).transform_point2(Vec2::new(1.0, 0.0)), Vec2::new(2.25, -2.5));
    }
}
