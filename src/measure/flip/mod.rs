//! LDR-FLIP: how far two pictures differ to somebody who looks at one and then at the other.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild, *FLIP: A
//! Difference Evaluator for Alternating Images*, Proceedings of the ACM on Computer Graphics and
//! Interactive Techniques 3(2), HPG 2020. Every constant below is the paper's.
//!
//! In f32; next to black, where L\*a\*b\* is steep, that leaves 1e-5 of a pixel's difference open.
//! Means of five pairs (renders, noise, edges, black and white) agreed with those of the authors' own
//! program, version 1.7, to 3e-5.

mod color;
mod filter;
#[cfg(test)]
mod tests;

use std::sync::LazyLock;

use glam::Vec3;
use rayon::prelude::*;

use crate::measure::Picture;
use crate::scene::Transfer;
use filter::Filters;

/// The usual distance: a screen 0.7 m wide with 3840 pixels, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 67.0;

/// The exponent that compresses colour differences.
const COLOR_EXPONENT: f32 = 0.7;
/// Where, as a share of the largest colour difference, the slope of what is kept of it changes.
const KNEE: f32 = 0.4;
/// What a colour difference at the knee is worth.
const KNEE_VALUE: f32 = 0.95;
/// The exponent that enhances differences of edges and points.
const FEATURE_EXPONENT: f32 = 0.5;

/// The largest colour difference, compressed: that of green and blue.
static LARGEST: LazyLock<f32> = LazyLock::new(|| {
    let [green, blue] = [Vec3::Y, Vec3::Z].map(color::perceived);
    color::hyab(green, blue).powf(COLOR_EXPONENT)
});

/// A picture as an eye takes it in: what FLIP compares.
#[derive(Clone, Debug)]
pub struct Seen {
    size: [u32; 2],
    /// L\*a\*b\* without the detail that the eye does not resolve, fainter in the dark.
    colors: Vec<Vec3>,
    /// How strong an edge each pixel is of, and how much it stands out as a point.
    features: Vec<[f32; 2]>,
}

/// How far two pictures differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// The mean of the map; in \[0, 1\].
    pub mean: f64,
    /// For each pixel, row by row, 0 where nobody sees a difference, up to 1.
    pub map: Vec<f32>,
}

impl Seen {
    /// A picture of `width · height` linear Rec. 709 values, clamped to \[0, 1\] (what is not a
    /// number is 0), on a screen that shows so many pixels in a degree of the view.
    ///
    /// # Panics
    /// When the number of values is another one.
    pub fn new(size: [u32; 2], linear: &[Vec3], pixels_per_degree: f64) -> Self {
        let [width, height] = size.map(|n| n as usize);
        assert_eq!(linear.len(), width * height, "{width}x{height} pixels");
        // A NaN fails the comparison and becomes 0.
        let clamp = |x: f32| if x > 0.0 { x.min(1.0) } else { 0.0 };
        let clamped = |c: &Vec3| c.map(clamp);
        let opponent: Vec<Vec3> = linear.par_iter().map(|c| color::opponent(clamped(c))).collect();
        let filters = Filters::new(pixels_per_degree);
        let perceived = |c: &Vec3| color::perceived(clamped(&color::from_opponent(*c)));
        let colors = filters.blurred(&opponent, width).par_iter().map(perceived).collect();
        // The achromatic channel, from 0 for black to 1 for white.
        let grey: Vec<f32> = opponent.iter().map(|c| (c.x + 16.0) / 116.0).collect();
        Self { size, colors, features: filters.features(&grey, width) }
    }

    /// The R, G and B of a picture, seen at [`PIXELS_PER_DEGREE`]; none where it has no such
    /// channels. `transfer` is how its values are encoded: a PNG's are sRGB, an EXR's are not.
    pub fn of(picture: &Picture, transfer: Transfer) -> Option<Self> {
        let channel = |name: &str| picture.channels.iter().position(|c| c == name);
        let [r, g, b] = [channel("R")?, channel("G")?, channel("B")?];
        let pixels = picture.values.par_chunks(picture.channels.len());
        let values: Vec<Vec3> =
            pixels.map(|p| Vec3::from([p[r], p[g], p[b]].map(|x| transfer.decode(x)))).collect();
        Some(Self::new(picture.size, &values, PIXELS_PER_DEGREE))
    }

    /// How far two pictures differ; either may be the first.
    ///
    /// # Panics
    /// When they differ in size.
    pub fn flip(&self, other: &Seen) -> Flip {
        assert_eq!(self.size, other.size, "two sizes");
        let color = self.colors.iter().zip(&other.colors).map(|(&a, &b)| color_difference(a, b));
        let feature = self.features.iter().zip(&other.features);
        let feature = feature.map(|(&a, &b)| feature_difference(a, b));
        let map: Vec<f32> = color.zip(feature).map(|(c, f)| c.powf(1.0 - f)).collect();
        let sum: f64 = map.iter().copied().map(f64::from).sum();
        Flip { mean: sum / map.len().max(1) as f64, map }
    }
}

/// The difference of two colours: compressed, and with what exceeds the knee squeezed into
/// \[`KNEE_VALUE`, 1\].
fn color_difference(a: Vec3, b: Vec3) -> f32 {
    let difference = color::hyab(a, b).powf(COLOR_EXPONENT);
    let knee = KNEE * *LARGEST;
    if difference < knee {
        return difference / knee * KNEE_VALUE;
    }
    (KNEE_VALUE + (difference - knee) / (*LARGEST - knee) * (1.0 - KNEE_VALUE)).min(1.0)
}

/// The difference of edge and point, whichever is larger.
fn feature_difference([edge, point]: [f32; 2], [other_edge, other_point]: [f32; 2]) -> f32 {
    let larger = (edge - other_edge).abs().max((point - other_point).abs());
    (larger * std::f32::consts::FRAC_1_SQRT_2).powf(FEATURE_EXPONENT).min(1.0)
}
