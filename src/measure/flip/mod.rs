//! LDR-FLIP: the difference of two pictures as perceived by a viewer who flips between them.
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
use filter::{Features, Filters};

/// The resolution at the usual viewing distance: a screen 0.7 m wide with 3840 pixels, seen from
/// 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 67.0;

/// The exponent that compresses colour differences.
const COLOR_EXPONENT: f32 = 0.7;
/// The colour difference, as a share of the largest, above which differences are compressed.
const KNEE: f32 = 0.4;
/// The value to which a colour difference at the knee is mapped.
const KNEE_VALUE: f32 = 0.95;
/// The exponent that enhances differences of edges and points.
const FEATURE_EXPONENT: f32 = 0.5;

/// The largest colour difference (that of green and blue), with [`COLOR_EXPONENT`] applied.
static MAX_COLOR_DIFFERENCE: LazyLock<f32> = LazyLock::new(|| {
    let [green, blue] = [Vec3::Y, Vec3::Z].map(color::linear_to_hunt_lab);
    color::hyab_distance(green, blue).powf(COLOR_EXPONENT)
});

/// A picture as it is perceived: its visible colours and features.
#[derive(Clone, Debug)]
pub struct PerceivedImage {
    size: [u32; 2],
    /// The L\*a\*b\* without the detail that the eye does not resolve, less colourful in the dark.
    colors: Vec<Vec3>,
    features: Vec<Features>,
}

/// The perceived difference of two pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// The mean of the map; in \[0, 1\].
    pub mean: f64,
    /// The difference at each pixel, row by row: from 0, where none is visible, to 1.
    pub map: Vec<f32>,
}

impl PerceivedImage {
    /// Creates the perceived image of `width · height` linear Rec. 709 values, clamped to \[0, 1\] (a
    /// NaN is 0), on a screen that shows this many pixels per degree of the view.
    ///
    /// # Panics
    /// When the number of values is not `width · height`.
    pub fn new(size: [u32; 2], linear: &[Vec3], pixels_per_degree: f64) -> Self {
        let [width, height] = size.map(|n| n as usize);
        assert_eq!(linear.len(), width * height, "{width}x{height} pixels");
        // A NaN fails the comparison and becomes 0.
        let clamp = |x: f32| if x > 0.0 { x.min(1.0) } else { 0.0 };
        let clamped = |c: &Vec3| c.map(clamp);
        let opponent: Vec<Vec3> =
            linear.par_iter().map(|c| color::linear_to_ycxcz(clamped(c))).collect();
        let filters = Filters::new(pixels_per_degree);
        let perceived = |c: &Vec3| color::linear_to_hunt_lab(clamped(&color::ycxcz_to_linear(*c)));
        let colors = filters.blur(&opponent, width).par_iter().map(perceived).collect();
        // The achromatic channel, from 0 for black to 1 for white.
        let grey: Vec<f32> = opponent.iter().map(|c| (c.x + 16.0) / 116.0).collect();
        Self { size, colors, features: filters.features(&grey, width) }
    }

    /// Creates the perceived image of a picture at [`PIXELS_PER_DEGREE`]; none if the picture has no
    /// channels R, G and B. `transfer` is the encoding of its values: sRGB for a PNG, none for an
    /// EXR. A picture with alpha is seen on black: an EXR is premultiplied, and a PNG is multiplied here.
    pub fn from_picture(picture: &Picture, transfer: Transfer) -> Option<Self> {
        let channel = |name: &str| picture.channels.iter().position(|c| c == name);
        let [r, g, b] = [channel("R")?, channel("G")?, channel("B")?];
        let pixels = picture.values.par_chunks(picture.channels.len());
        let alpha = channel("A").filter(|_| transfer != Transfer::None);
        let linear = |p: &[f32]| {
            let color = Vec3::from([p[r], p[g], p[b]].map(|x| transfer.decode(x)));
            alpha.map_or(color, |a| color * p[a])
        };
        let values: Vec<Vec3> = pixels.map(linear).collect();
        Some(Self::new(picture.size, &values, PIXELS_PER_DEGREE))
    }

    /// Computes the perceived difference of two pictures; it is symmetric.
    ///
    /// # Panics
    /// When they differ in size.
    pub fn flip(&self, other: &Self) -> Flip {
        assert_eq!(self.size, other.size, "pictures of one size");
        let color = self.colors.iter().zip(&other.colors).map(|(&a, &b)| color_difference(a, b));
        let feature = self.features.iter().zip(&other.features);
        let feature = feature.map(|(&a, &b)| feature_difference(a, b));
        let map: Vec<f32> = color.zip(feature).map(|(c, f)| c.powf(1.0 - f)).collect();
        let sum: f64 = map.iter().copied().map(f64::from).sum();
        Flip { mean: sum / map.len().max(1) as f64, map }
    }
}

/// Returns the difference of two L\*a\*b\* colours, in \[0, 1\]; differences above the knee are
/// mapped to \[`KNEE_VALUE`, 1\].
fn color_difference(a: Vec3, b: Vec3) -> f32 {
    let difference = color::hyab_distance(a, b).powf(COLOR_EXPONENT);
    let knee = KNEE * *MAX_COLOR_DIFFERENCE;
    if difference < knee {
        return difference / knee * KNEE_VALUE;
    }
    (KNEE_VALUE + (difference - knee) / (*MAX_COLOR_DIFFERENCE - knee) * (1.0 - KNEE_VALUE))
        .min(1.0)
}

/// Returns the larger of the differences of the edges and of the points, in \[0, 1\].
fn feature_difference(a: Features, b: Features) -> f32 {
    let larger = (a.edge - b.edge).abs().max((a.point - b.point).abs());
    (larger * std::f32::consts::FRAC_1_SQRT_2).powf(FEATURE_EXPONENT).min(1.0)
}
