//! Pictures on surfaces.

use std::sync::Arc;

use glam::{Affine2, Vec2, Vec4};

use crate::scene::Transfer;
use crate::scene::image::Image;
use crate::scene::texels::Texels;

/// The index of a texture in `Scene::textures`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TextureId(pub u32);

/// One channel of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Channel {
    /// The texture.
    pub texture: TextureId,
    /// 0 to 3: red, green, blue, alpha.
    pub channel: u8,
}

/// What lies beyond the edges of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture again, mirrored every other time.
    Mirror,
    /// Its edge.
    Clamp,
}

/// How the pixels around a point become its colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The pixel that holds the point.
    Nearest,
    /// The four around it, in proportion.
    #[default]
    Linear,
}

/// A picture, how to read it, and how it is laid on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The picture, shared by every texture that uses it.
    pub image: Arc<Image>,
    /// How its colours are encoded; alpha never is, and float pixels are not.
    pub transfer: Transfer,
    /// What lies beyond its edges, along u and v.
    pub wrap: [Wrap; 2],
    /// How its pixels are read where they are seen no smaller than the picture's own.
    pub filter: Filter,
    /// Whether what a pixel of the film sees is averaged where it holds many of the texture's.
    pub mipmap: bool,
    /// Which of a mesh's two sets of texture coordinates places it: 0 or 1. Spheres and planes have
    /// one.
    pub set: u8,
    /// From these coordinates to the picture's own.
    pub transform: Affine2,
}

/// A point of a surface in texture coordinates, and the area around it that is seen as one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TexturePoint {
    /// The coordinates (u, v) of both sets, (0, 0) being the upper left corner of a picture.
    pub uv: [[f32; 2]; 2],
    /// For both sets, how the coordinates change from one end of the area to the other, along its
    /// greatest and its least extent; 0 where it is only a point.
    pub across: [[Vec2; 2]; 2],
}

/// So many places along the greater extent of an area are averaged at most; more would blur it
/// less where a surface is seen at a grazing angle.
const MAX_PROBES: f32 = 16.0;

impl Texture {
    /// A picture of colours in sRGB that repeats, with linear filtering and without mipmaps, by the
    /// first set of texture coordinates.
    pub fn new(image: Arc<Image>) -> Self {
        Self {
            image,
            transfer: Transfer::Srgb,
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Linear,
            mipmap: false,
            set: 0,
            transform: Affine2::IDENTITY,
        }
    }

    /// The linear colour and the alpha at a point, or, with mipmaps, of the area around it.
    ///
    /// Coordinates that are not finite read the upper left pixel.
    pub fn sample(&self, point: &TexturePoint) -> Vec4 {
        let set = usize::from(self.set & 1);
        let uv = self.transform.transform_point2(Vec2::from(point.uv[set]));
        let across = point.across[set];
        if self.mipmap && across != [Vec2::ZERO; 2] {
            return self.sample_anisotropic(uv, across);
        }
        self.sample_base(uv)
    }

    /// The colour at a point of the picture itself.
    fn sample_base(&self, uv: Vec2) -> Vec4 {
        let size = [self.image.width, self.image.height];
        match self.filter {
            Filter::Nearest => {
                let at = uv * Vec2::new(size[0] as f32, size[1] as f32);
                self.texel(&self.image.texels, size, at.x.floor() as i64, at.y.floor() as i64)
            }
            Filter::Linear => self.sample_bilinear(&self.image.texels, size, uv),
        }
    }

    /// The mean over an area, whose extent is `across`.
    ///
    /// Places along its greater extent, as far apart as its lesser one is wide, are averaged; each
    /// is read from the two levels of the pyramid whose pixels are next to that width (J. McCormack
    /// et al., *Feline: Fast Elliptical Lines for Anisotropic Texture Mapping*, SIGGRAPH 1999).
    fn sample_anisotropic(&self, uv: Vec2, across: [Vec2; 2]) -> Vec4 {
        let size = Vec2::new(self.image.width as f32, self.image.height as f32);
        let [a, b] = across.map(|x| self.transform.matrix2 * x);
        let [length_a, length_b] = [a, b].map(|x| (x * size).length());
        let (along, greater, lesser) = match length_a >= length_b {
            true => (a, length_a, length_b),
            false => (b, length_b, length_a),
        };
        let width = lesser.max(greater / MAX_PROBES).max(1.0);
        let count = (greater / width).ceil().clamp(1.0, MAX_PROBES);
        if !(greater.is_finite() && uv.is_finite()) || greater <= 1.0 {
            return self.sample_base(uv);
        }
        let level = width.log2();
        let places = (0..count as u32).map(|i| {
            let place = (i as f32 + 0.5) / count - 0.5;
            self.sample_trilinear(uv + along * place, level)
        });
        places.sum::<Vec4>() / count
    }

    /// The colour at a point of the pyramid, between two of its levels; 0 is the picture itself.
    fn sample_trilinear(&self, uv: Vec2, level: f32) -> Vec4 {
        let pyramid = self.image.mipmap(self.transfer).levels();
        let last = pyramid.len();
        let of = |level: usize| match level.min(last) {
            0 => {
                self.sample_bilinear(&self.image.texels, [self.image.width, self.image.height], uv)
            }
            level => self.sample_bilinear(&pyramid[level - 1].texels, pyramid[level - 1].size, uv),
        };
        let (whole, part) = (level.floor(), level.fract());
        match part == 0.0 || whole as usize >= last {
            true => of(whole as usize),
            false => of(whole as usize).lerp(of(whole as usize + 1), part),
        }
    }

    /// The four pixels around a point, in proportion.
    fn sample_bilinear(&self, texels: &Texels, size: [u32; 2], uv: Vec2) -> Vec4 {
        let (x, y) = (uv.x * size[0] as f32 - 0.5, uv.y * size[1] as f32 - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (column, row) = (x0 as i64, y0 as i64);
        let (fx, fy) = (x - x0, y - y0);
        let texel = |column, row| self.texel(texels, size, column, row);
        if !(fx.is_finite() && fy.is_finite()) {
            return texel(0, 0);
        }
        let top = texel(column, row).lerp(texel(column + 1, row), fx);
        let low = texel(column, row + 1).lerp(texel(column + 1, row + 1), fx);
        top.lerp(low, fy)
    }

    fn texel(&self, texels: &Texels, size: [u32; 2], column: i64, row: i64) -> Vec4 {
        let x = wrap(column, size[0], self.wrap[0]);
        let y = wrap(row, size[1], self.wrap[1]);
        texels.linear(y * size[0] as usize + x, self.transfer)
    }
}

/// The index, in `0..size`, that stands for `index`.
fn wrap(index: i64, size: u32, wrap: Wrap) -> usize {
    let size = i64::from(size);
    let inside = match wrap {
        Wrap::Repeat => index.rem_euclid(size),
        Wrap::Clamp => index.clamp(0, size - 1),
        Wrap::Mirror => {
            let twice = index.rem_euclid(2 * size);
            twice.min(2 * size - 1 - twice)
        }
    };
    inside as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn texture(filter: Filter, wrap: Wrap) -> Texture {
        let texels = vec![[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]];
        let image = Arc::new(Image::from_bytes("", [2, 2], texels));
        Texture { transfer: Transfer::None, wrap: [wrap; 2], filter, ..Texture::new(image) }
    }

    fn color(texture: &Texture, uv: [f32; 2]) -> Vec3 {
        texture.sample(&TexturePoint { uv: [uv; 2], ..TexturePoint::default() }).truncate()
    }

    #[test]
    fn origin_is_the_upper_left() {
        assert_eq!(color(&texture(Filter::Nearest, Wrap::Repeat), [0.1, 0.1]), Vec3::X);
    }

    #[test]
    fn v_runs_down() {
        assert_eq!(color(&texture(Filter::Nearest, Wrap::Repeat), [0.1, 0.9]), Vec3::Z);
    }

    #[test]
    fn linear_filter_mixes_the_four_around_the_middle() {
        let color = color(&texture(Filter::Linear, Wrap::Clamp), [0.5, 0.5]);
        assert!((color - Vec3::splat(0.5)).length() < 1e-6, "{color}");
    }

    #[test]
    fn linear_filter_at_a_pixel_centre_is_that_pixel() {
        assert_eq!(color(&texture(Filter::Linear, Wrap::Repeat), [0.75, 0.25]), Vec3::Y);
    }

    #[test]
    fn wraps_repeat_mirror_and_clamp() {
        let at = |w| (-3..6).map(|i| wrap(i, 2, w)).collect::<Vec<_>>();
        assert_eq!(at(Wrap::Repeat), [1, 0, 1, 0, 1, 0, 1, 0, 1]);
        assert_eq!(at(Wrap::Mirror), [1, 1, 0, 0, 1, 1, 0, 0, 1]);
        assert_eq!(at(Wrap::Clamp), [0, 0, 0, 0, 1, 1, 1, 1, 1]);
    }

    #[test]
    fn coordinates_that_are_not_finite_read_a_pixel() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut texture = texture(Filter::Linear, Wrap::Repeat);
            assert!(color(&texture, [bad, bad]).is_finite());
            texture.mipmap = true;
            let across = [[Vec2::splat(bad); 2]; 2];
            assert!(texture.sample(&TexturePoint { uv: [[bad; 2]; 2], across }).is_finite());
        }
    }

    #[test]
    fn the_set_and_the_transform_choose_the_place() {
        let mut texture = texture(Filter::Nearest, Wrap::Repeat);
        texture.set = 1;
        texture.transform = Affine2::from_translation(Vec2::new(0.5, 0.0));
        let point = TexturePoint { uv: [[0.9, 0.9], [0.1, 0.1]], ..TexturePoint::default() };
        assert_eq!(texture.sample(&point).truncate(), Vec3::Y);
    }

    /// A texture of 64 by 64 pixels, black and white in turn along u, with mipmaps.
    fn stripes() -> Texture {
        let texel = |i: usize| if i.is_multiple_of(2) { [0, 0, 0, 255] } else { [255; 4] };
        let image = Image::from_bytes("", [64; 2], (0..64 * 64).map(texel).collect());
        Texture { transfer: Transfer::None, mipmap: true, ..Texture::new(image.into()) }
    }

    fn over(texture: &Texture, across: [Vec2; 2]) -> f32 {
        texture.sample(&TexturePoint { uv: [[0.3; 2]; 2], across: [across; 2] }).x
    }

    #[test]
    fn an_area_of_many_pixels_is_seen_as_their_mean() {
        let wide = [Vec2::X * 0.25, Vec2::Y * 0.25];
        assert!((over(&stripes(), wide) - 0.5).abs() < 0.01);
    }

    #[test]
    fn an_area_of_less_than_a_pixel_is_seen_as_without_mipmaps() {
        let small = [Vec2::X / 65.0, Vec2::Y / 65.0];
        let plain = Texture { mipmap: false, ..stripes() };
        assert_eq!(over(&stripes(), small), over(&plain, small));
    }

    #[test]
    fn an_area_that_is_long_along_the_stripes_keeps_them_apart() {
        let long = [Vec2::Y * 0.2, Vec2::X / 64.0];
        let plain = Texture { mipmap: false, ..stripes() };
        assert!((over(&stripes(), long) - over(&plain, long)).abs() < 0.01);
    }
}
