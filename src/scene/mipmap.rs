//! The mipmap: ever smaller copies of an image (L. Williams, *Pyramidal Parametrics*, SIGGRAPH 1983).

use glam::Vec4;
use rayon::prelude::*;

use super::texels::Texels;
use crate::scene::Transfer;

/// One level of a mipmap.
#[derive(Clone, Debug)]
pub(crate) struct MipLevel {
    /// The width and height in texels.
    pub size: [u32; 2],
    /// The texels.
    pub texels: Texels,
}

/// Builds the levels of an image: smaller copies, each half as large as the one before, down to one
/// pixel. The image itself is not among them.
///
/// A texel is the mean, in linear colours, of the area that it covers, weighted by alpha, so that
/// transparent texels add no colour.
pub(super) fn levels(texels: &Texels, size: [u32; 2], transfer: Transfer) -> Vec<MipLevel> {
    let mut levels = Vec::new();
    let base = |i: usize| texels.linear(i, transfer);
    let mut before: Option<(Vec<Vec4>, [u32; 2])> = None;
    while before.as_ref().map_or(size, |(_, size)| *size) != [1, 1] {
        // From the level before, as it was before its colours were rounded.
        let (colors, size) = match &before {
            Some((colors, size)) => downsampled(&|i| colors[i], *size),
            None => downsampled(&base, size),
        };
        levels.push(MipLevel { size, texels: texels.encoded_like(&colors, transfer) });
        before = Some((colors, size));
    }
    levels
}

/// Returns an image at half its size, rounded down but at least 1.
fn downsampled(texel: &(dyn Fn(usize) -> Vec4 + Sync), size: [u32; 2]) -> (Vec<Vec4>, [u32; 2]) {
    let half = size.map(|n| (n / 2).max(1));
    let columns: Vec<_> = (0..half[0]).map(|x| BoxFilter::new(x, half[0], size[0])).collect();
    let row = |y: u32| {
        let rows = BoxFilter::new(y, half[1], size[1]);
        let mean = move |columns: &BoxFilter| {
            let (mut premultiplied, mut plain) = (Vec4::ZERO, Vec4::ZERO);
            for (y, wy) in rows.weights() {
                for (x, wx) in columns.weights() {
                    let color = texel(y * size[0] as usize + x);
                    plain += color * (wx * wy);
                    premultiplied += color * (wx * wy * color.w);
                }
            }
            if plain.w > 0.0 { (premultiplied / plain.w).truncate().extend(plain.w) } else { plain }
        };
        columns.iter().map(mean).collect::<Vec<_>>()
    };
    ((0..half[1]).into_par_iter().flat_map_iter(row).collect(), half)
}

/// The box filter of one texel of the shorter row: the 1 to 4 texels of the longer row that it covers.
#[derive(Clone, Copy)]
struct BoxFilter {
    first: usize,
    weights: [f32; 4],
}

impl BoxFilter {
    /// The filter of texel `index` of a row of `to` texels over a row of `from` texels.
    fn new(index: u32, to: u32, from: u32) -> Self {
        let ratio = f64::from(from) / f64::from(to);
        let (start, end) = (f64::from(index) * ratio, f64::from(index + 1) * ratio);
        let first = start.floor();
        let weights = std::array::from_fn(|i| {
            let left = first + i as f64;
            let covered = (end.min(left + 1.0) - start.max(left)).max(0.0);
            // Rounding may go beyond the last texel.
            if left >= f64::from(from) { 0.0 } else { (covered / ratio) as f32 }
        });
        Self { first: first as usize, weights }
    }

    /// The indices and weights of the covered texels.
    fn weights(self) -> impl Iterator<Item = (usize, f32)> + Clone {
        (self.first..).zip(self.weights).filter(|(_, weight)| *weight > 1e-6)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[u8]) -> Texels {
        Texels::Bytes(values.iter().map(|&x| [x, x, x, 255]).collect())
    }

    #[test]
    fn each_level_has_half_the_size_down_to_one_pixel() {
        let mipmap = levels(&grey(&[7; 35]), [7, 5], Transfer::Srgb);
        let sizes: Vec<_> = mipmap.iter().map(|level| level.size).collect();
        assert_eq!(sizes, [[3, 2], [1, 1]]);
        assert!(mipmap.iter().all(|level| level.texels.linear(0, Transfer::None).x == 7.0 / 255.0));
    }

    #[test]
    fn the_mean_is_that_of_linear_colours() {
        let mipmap = levels(&grey(&[0, 255]), [2, 1], Transfer::Srgb);
        // Half the light is 188 of 255 in sRGB.
        assert_eq!(mipmap[0].texels, grey(&[188]));
        let plain = levels(&grey(&[0, 255]), [2, 1], Transfer::None);
        assert_eq!(plain[0].texels, grey(&[128]));
    }

    #[test]
    fn a_texel_between_two_gives_half_to_each() {
        let mipmap = levels(&grey(&[0, 0, 30, 90, 90]), [5, 1], Transfer::None);
        // (0 + 0 + 30/2) / 2.5 and (30/2 + 90 + 90) / 2.5.
        assert_eq!(mipmap[0].texels, grey(&[6, 78]));
    }

    #[test]
    fn transparent_texels_add_no_colour() {
        let texels = Texels::Bytes(vec![[200, 0, 0, 255], [0, 200, 0, 0]]);
        let mipmap = levels(&texels, [2, 1], Transfer::None);
        assert_eq!(mipmap[0].texels, Texels::Bytes(vec![[200, 0, 0, 128]]));
    }

    #[test]
    fn one_pixel_has_no_smaller_copies() {
        assert!(levels(&grey(&[1]), [1, 1], Transfer::Srgb).is_empty());
    }
}
