//! Pictures on surfaces.

use std::sync::{Arc, LazyLock};

use glam::Vec3;

use crate::scene::Transfer;

/// The index of a texture in `Scene::textures`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TextureId(pub u32);

/// One stored pixel: red, green, blue, alpha, 8 bits each as the file has them.
pub type Texel = [u8; 4];

/// A decoded picture, row by row from the upper left; or one that was not read, since nothing
/// shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Where it came from, for messages.
    pub name: String,
    /// Width in pixels, at least 1; 0 for one that was not read.
    pub width: u32,
    /// Height in pixels, at least 1; 0 for one that was not read.
    pub height: u32,
    /// `width · height` pixels.
    pub texels: Vec<Texel>,
}

impl Image {
    /// A picture that was not read. A scene in which a material in use shows it is not valid.
    pub fn unread(name: &str) -> Self {
        Self { name: name.to_owned(), width: 0, height: 0, texels: Vec::new() }
    }

    /// Whether it was read.
    pub fn is_read(&self) -> bool {
        self.width > 0 && self.height > 0
    }
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

/// A picture and how to read it.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The picture, shared by every texture that uses it.
    pub image: Arc<Image>,
    /// How its colours are encoded.
    pub transfer: Transfer,
    /// What lies beyond its edges, along u and v.
    pub wrap: [Wrap; 2],
    /// How its pixels are read.
    pub filter: Filter,
}

static SRGB: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| Transfer::Srgb.decode(i as f32 / 255.0)));

impl Texture {
    /// The linear colour at texture coordinates (u, v), (0, 0) being the upper left corner.
    ///
    /// Coordinates that are not finite read the upper left pixel.
    pub fn color(&self, uv: [f32; 2]) -> Vec3 {
        let x = uv[0] * self.image.width as f32;
        let y = uv[1] * self.image.height as f32;
        match self.filter {
            Filter::Nearest => self.texel(x.floor() as i64, y.floor() as i64),
            Filter::Linear => {
                let (x, y) = (x - 0.5, y - 0.5);
                let (x0, y0) = (x.floor(), y.floor());
                let (column, row) = (x0 as i64, y0 as i64);
                let (fx, fy) = (x - x0, y - y0);
                if !(fx.is_finite() && fy.is_finite()) {
                    return self.texel(0, 0);
                }
                let top = self.texel(column, row).lerp(self.texel(column + 1, row), fx);
                let low = self.texel(column, row + 1).lerp(self.texel(column + 1, row + 1), fx);
                top.lerp(low, fy)
            }
        }
    }

    fn texel(&self, column: i64, row: i64) -> Vec3 {
        let x = wrap(column, self.image.width, self.wrap[0]);
        let y = wrap(row, self.image.height, self.wrap[1]);
        let [r, g, b, _] = self.image.texels[y * self.image.width as usize + x];
        match self.transfer {
            Transfer::Srgb => Vec3::new(SRGB[r as usize], SRGB[g as usize], SRGB[b as usize]),
            Transfer::None => Vec3::new(r as f32, g as f32, b as f32) / 255.0,
        }
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

    fn texture(filter: Filter, wrap: Wrap) -> Texture {
        let texels = vec![[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]];
        let image = Image { name: String::new(), width: 2, height: 2, texels };
        Texture { image: Arc::new(image), transfer: Transfer::None, wrap: [wrap; 2], filter }
    }

    #[test]
    fn origin_is_the_upper_left() {
        assert_eq!(texture(Filter::Nearest, Wrap::Repeat).color([0.1, 0.1]), Vec3::X);
    }

    #[test]
    fn v_runs_down() {
        assert_eq!(texture(Filter::Nearest, Wrap::Repeat).color([0.1, 0.9]), Vec3::Z);
    }

    #[test]
    fn linear_filter_mixes_the_four_around_the_middle() {
        let color = texture(Filter::Linear, Wrap::Clamp).color([0.5, 0.5]);
        assert!((color - Vec3::splat(0.5)).length() < 1e-6, "{color}");
    }

    #[test]
    fn linear_filter_at_a_pixel_centre_is_that_pixel() {
        assert_eq!(texture(Filter::Linear, Wrap::Repeat).color([0.75, 0.25]), Vec3::Y);
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
            assert!(texture(Filter::Linear, Wrap::Repeat).color([bad, bad]).is_finite());
        }
    }
}
