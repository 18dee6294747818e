//! The filters of FLIP. Each is separable (a filter along rows after one along columns), or a sum of
//! two that are; beyond the border of a picture its outermost pixels repeat.

use glam::Vec3;
use rayon::prelude::*;

/// A term of the contrast sensitivity function, a · √(π/b) · exp(−π² x² / b) over degrees x, for
/// the achromatic, the red-green and the blue-yellow channel.
struct Sensitivity {
    a: Vec3,
    b: Vec3,
}

/// The contrast sensitivity function: the sum of these terms.
const SENSITIVITY: [Sensitivity; 2] = [
    Sensitivity { a: Vec3::new(1.0, 1.0, 34.1), b: Vec3::new(0.0047, 0.0053, 0.04) },
    Sensitivity { a: Vec3::new(0.0, 0.0, 13.5), b: Vec3::new(1e-5, 1e-5, 0.025) },
];
/// The width of the edges and points that are detected, in degrees.
const FEATURE: f64 = 0.082;

/// The taps of a filter for each channel, centred on the middle one.
type Taps = Vec<Vec3>;

/// The filters for one viewing distance.
pub struct Filters {
    /// The terms of the contrast sensitivity function.
    blurs: [Blur; 2],
    /// A Gaussian, and its first and second derivative.
    features: Taps,
}

/// A Gaussian blur, and its share in a sum.
struct Blur {
    taps: Taps,
    weight: Vec3,
}

/// The features that are detected at a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Features {
    /// The strength of an edge.
    pub edge: f32,
    /// The strength of a point.
    pub point: f32,
}

impl Filters {
    /// Creates the filters for a screen with this many pixels per degree of the view.
    pub fn new(pixels_per_degree: f64) -> Self {
        let pi = std::f64::consts::PI;
        let widest = SENSITIVITY[0].b.max_element();
        let radius = (3.0 * (f64::from(widest) / 2.0).sqrt() / pi * pixels_per_degree).ceil();
        // The terms of the sensitivity function, each with taps that add up to 1.
        let mut blurs = SENSITIVITY.map(|Sensitivity { a, b }| {
            let taps = taps(radius, |x| {
                let x = x / pixels_per_degree;
                b.to_array().map(|b| (-(pi * x).powi(2) / f64::from(b)).exp())
            });
            let sum: Vec3 = taps.iter().sum();
            let weight = a * b.map(|b| (std::f32::consts::PI / b).sqrt()) * sum * sum;
            Blur { taps: taps.iter().map(|t| *t / sum).collect(), weight }
        });
        let total = blurs[0].weight + blurs[1].weight;
        blurs.iter_mut().for_each(|blur| blur.weight /= total);

        // The detectors of edges and points.
        let deviation = 0.5 * FEATURE * pixels_per_degree;
        let features = taps((3.0 * deviation).ceil(), |x| {
            let gauss = (-(x / deviation).powi(2) / 2.0).exp();
            [gauss, -x * gauss, ((x / deviation).powi(2) - 1.0) * gauss]
        });
        Self { blurs, features: normalize(features) }
    }

    /// Returns a picture in YCxCz without the detail that the eye does not resolve.
    pub fn blur(&self, image: &[Vec3], width: usize) -> Vec<Vec3> {
        let [first, second] = self.blurs.each_ref().map(|Blur { taps, .. }| {
            let rows = along_rows(image, width, taps);
            along_columns(&rows, width, taps)
        });
        let [Blur { weight, .. }, Blur { weight: second_weight, .. }] = &self.blurs;
        first.iter().zip(second).map(|(a, b)| *a * *weight + b * *second_weight).collect()
    }

    /// Detects the features at each pixel of a grey picture.
    pub fn features(&self, grey: &[f32], width: usize) -> Vec<Features> {
        let taps = &self.features;
        let gauss: Taps = taps.iter().map(|t| Vec3::splat(t.x)).collect();
        let grey: Vec<Vec3> = grey.iter().copied().map(Vec3::splat).collect();
        let rows = along_rows(&grey, width, taps);
        let smooth: Vec<Vec3> = rows.iter().map(|v| Vec3::splat(v.x)).collect();
        let [x, y] = [along_columns(&rows, width, &gauss), along_columns(&smooth, width, taps)];
        let features =
            |(x, y): (&Vec3, &Vec3)| Features { edge: x.y.hypot(y.y), point: x.z.hypot(y.z) };
        x.iter().zip(&y).map(features).collect()
    }
}

/// Samples a filter at the pixels up to `radius` from its centre.
fn taps(radius: f64, value: impl Fn(f64) -> [f64; 3]) -> Taps {
    let radius = radius as i32;
    (-radius..=radius).map(|x| Vec3::from(value(f64::from(x)).map(|v| v as f32))).collect()
}

/// Returns the filter scaled so that its positive values add up to 1, and its negative ones, if any,
/// to −1.
fn normalize(taps: Taps) -> Taps {
    let positive: Vec3 = taps.iter().map(|t| t.max(Vec3::ZERO)).sum();
    let negative: Vec3 = taps.iter().map(|t| -t.min(Vec3::ZERO)).sum();
    let share = |t: Vec3| {
        Vec3::select(t.cmpgt(Vec3::ZERO), t / positive, t / negative.max(Vec3::splat(1e-30)))
    };
    taps.into_iter().map(share).collect()
}

/// Filters a picture along its rows.
fn along_rows(image: &[Vec3], width: usize, taps: &Taps) -> Vec<Vec3> {
    let (radius, last) = (taps.len() / 2, width - 1);
    let filtered = |row: &[Vec3], x: usize| -> Vec3 {
        let pixel = |k: usize| row[(x + k).saturating_sub(radius).min(last)];
        taps.iter().enumerate().map(|(k, tap)| *tap * pixel(k)).sum()
    };
    let rows = image.par_chunks(width);
    rows.flat_map_iter(|row| (0..width).map(move |x| filtered(row, x))).collect()
}

/// Filters a picture along its columns.
fn along_columns(image: &[Vec3], width: usize, taps: &Taps) -> Vec<Vec3> {
    let (radius, last) = (taps.len() / 2, image.len() / width - 1);
    let mut result = vec![Vec3::ZERO; image.len()];
    result.par_chunks_mut(width).enumerate().for_each(|(y, sums)| {
        for (k, tap) in taps.iter().enumerate() {
            let from = (y + k).saturating_sub(radius).min(last) * width;
            for (sum, value) in sums.iter_mut().zip(&image[from..from + width]) {
                *sum += *tap * *value;
            }
        }
    });
    result
}
