//! The textures of surfaces, and how they are sampled.

use std::sync::Arc;

use glam::{Affine2, Vec2, Vec4};

use crate::scene::{Transfer, image::Image, texels::Texels};

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

/// The wrap mode: what lies beyond the edges of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Wrap {
    /// The image repeats.
    #[default]
    Repeat,
    /// The image repeats, mirrored every other time.
    Mirror,
    /// The pixels at the edge continue.
    Clamp,
}

/// The filter by which the pixels around a point become its colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Filter {
    /// The pixel that contains the point.
    Nearest,
    /// The bilinear mean of the four pixels around the point.
    #[default]
    Linear,
}

/// An image, how it is sampled, and how it is mapped onto a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The image, shared by every texture that uses it.
    pub image: Arc<Image>,
    /// The transfer function by which its colours are encoded; alpha and float pixels never are.
    pub transfer: Transfer,
    /// The wrap modes along u and v.
    pub wrap: [Wrap; 2],
    /// The filter where the film's pixels are no larger than the texture's.
    pub filter: Filter,
    /// True if it is averaged, by its mipmap, where a pixel of the film covers many of its own.
    pub mipmap: bool,
    /// The set of a mesh's texture coordinates that maps it: 0 or 1. Spheres and planes have one set.
    pub set: u8,
    /// The transform from these coordinates to the image's own.
    pub transform: Affine2,
}

/// A point of a surface in texture coordinates, with the footprint of the ray there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TexturePoint {
    /// The coordinates (u, v) of both sets, (0, 0) being the upper left corner of an image.
    pub uv: [[f32; 2]; 2],
    /// For both sets, the differences of the coordinates from one end of the footprint to the other,
    /// along its greatest and its least extent; 0 for a mere point.
    pub across: [[Vec2; 2]; 2],
}

/// The greatest number of probes along a footprint; more would blur less where a surface is seen at a
/// grazing angle.
const MAX_PROBES: f32 = 16.0;

impl Texture {
    /// A repeating texture of colours in sRGB, with linear filtering and without mipmaps, mapped by
    /// the first set of texture coordinates.
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

    /// Samples the linear colour and the alpha at a point, or, with mipmaps, over its footprint.
    ///
    /// Coordinates that are not finite give the upper left pixel.
    pub fn sample(&self, point: &TexturePoint) -> Vec4 {
        let set = usize::from(self.set & 1);
        let uv = self.transform.transform_point2(Vec2::from(point.uv[set]));
        let across = point.across[set];
        if self.mipmap && across != [Vec2::ZERO; 2] {
            return self.sample_anisotropic(uv, across);
        }
        self.sample_base(uv)
    }

    /// Samples the full-size image.
    fn sample_base(&self, uv: Vec2) -> Vec4 {
        let size = [self.image.width, self.image.height];
        match self.filter {
            Filter::Nearest => {
                let at = (uv * Vec2::new(size[0] as f32, size[1] as f32)).floor();
                self.texel(&self.image.texels, size, at.x as i64, at.y as i64)
            }
            Filter::Linear => self.sample_bilinear(&self.image.texels, size, uv),
        }
    }

    /// Samples the mean over a footprint, whose extent is `across`.
    ///
    /// It averages probes along the greater extent, as far apart as the lesser one is wide; each is
    /// interpolated between the two levels whose pixels are closest to that width (J. McCormack
    /// et al., *Feline: Fast Elliptical Lines for Anisotropic Texture Mapping*, SIGGRAPH 1999).
    fn sample_anisotropic(&self, uv: Vec2, across: [Vec2; 2]) -> Vec4 {
        // The axes of the footprint, and their lengths in pixels of the image.
        let size = Vec2::new(self.image.width as f32, self.image.height as f32);
        let [a, b] = across.map(|x| self.transform.matrix2 * x);
        let [length_a, length_b] = [a, b].map(|x| (x * size).length());
        let (along, greater, lesser) =
            if length_a >= length_b { (a, length_a, length_b) } else { (b, length_b, length_a) };
        // The width of a probe, and how many fill the footprint.
        let width = lesser.max(greater / MAX_PROBES).max(1.0);
        let count = (greater / width).ceil().clamp(1.0, MAX_PROBES);
        if !(greater.is_finite() && uv.is_finite()) || greater <= 1.0 {
            return self.sample_base(uv);
        }
        let level = width.log2();
        let probes = (0..count as u32).map(|i| {
            let offset = (i as f32 + 0.5) / count - 0.5;
            self.sample_trilinear(uv + along * offset, level)
        });
        probes.sum::<Vec4>() / count
    }

    /// Samples the mipmap between two of its levels, of which 0 is the image itself.
    fn sample_trilinear(&self, uv: Vec2, level: f32) -> Vec4 {
        let levels = self.image.mipmap(self.transfer);
        let last = levels.len();
        let sample = |level: usize| match level.min(last) {
            0 => {
                self.sample_bilinear(&self.image.texels, [self.image.width, self.image.height], uv)
            }
            level => self.sample_bilinear(&levels[level - 1].texels, levels[level - 1].size, uv),
        };
        let (whole, part) = (level.floor(), level.fract());
        if part == 0.0 || whole as usize >= last {
            return sample(whole as usize);
        }
        sample(whole as usize).lerp(sample(whole as usize + 1), part)
    }

    /// Samples one level by the bilinear mean of the four pixels around a point.
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

    /// The linear colour of one pixel, with wrapping.
    fn texel(&self, texels: &Texels, size: [u32; 2], column: i64, row: i64) -> Vec4 {
        let x = wrap(column, size[0], self.wrap[0]);
        let y = wrap(row, size[1], self.wrap[1]);
        texels.linear(y * size[0] as usize + x, self.transfer)
    }
}

/// Wraps an index to `0..size`.
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
