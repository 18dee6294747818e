//! The filters of FLIP. Each is a product of one along rows and one along columns, or a sum of two
//! such products; at the border of a picture its last pixels go on for ever.

use glam::Vec3;
use rayon::prelude::*;

/// A term of the contrast sensitivity function, a · √(π/b) · exp(−π² x² / b) over degrees x, for
/// the achromatic, the red-green and the blue-yellow channel.
struct Sensitivity {
    a: Vec3,
    b: Vec3,
}

const SENSITIVITY: [Sensitivity; 2] = [
    Sensitivity { a: Vec3::new(1.0, 1.0, 34.1), b: Vec3::new(0.0047, 0.0053, 0.04) },
    Sensitivity { a: Vec3::new(0.0, 0.0, 13.5), b: Vec3::new(1e-5, 1e-5, 0.025) },
];
/// The width of an edge or a point that the eye notices, in degrees.
const FEATURE: f64 = 0.082;

/// One filter for each channel, centred on the middle tap.
type Taps = Vec<Vec3>;

/// The filters for one distance.
pub struct Filters {
    /// The terms of the sensitivity function, with their weight.
    blurs: [(Taps, Vec3); 2],
    /// A Gaussian, its first and its second derivative.
    features: Taps,
}

impl Filters {
    pub fn new(pixels_per_degree: f64) -> Self {
        let pi = std::f64::consts::PI;
        let widest = SENSITIVITY[0].b.max_element();
        let radius = (3.0 * (f64::from(widest) / 2.0).sqrt() / pi * pixels_per_degree).ceil();
        let blurs = SENSITIVITY.map(|Sensitivity { a, b }| {
            let taps = taps(radius, |x| {
                let x = x / pixels_per_degree;
                b.to_array().map(|b| (-(pi * x).powi(2) / f64::from(b)).exp())
            });
            let sum: Vec3 = taps.iter().sum();
            let weight = a * b.map(|b| (std::f32::consts::PI / b).sqrt()) * sum * sum;
            (taps.iter().map(|t| *t / sum).collect::<Taps>(), weight)
        });
        let whole = blurs[0].1 + blurs[1].1;
        let deviation = 0.5 * FEATURE * pixels_per_degree;
        let features = taps((3.0 * deviation).ceil(), |x| {
            let gauss = (-(x / deviation).powi(2) / 2.0).exp();
            [gauss, -x * gauss, ((x / deviation).powi(2) - 1.0) * gauss]
        });
        Self {
            blurs: blurs.map(|(taps, weight)| (taps, weight / whole)),
            features: balanced(features),
        }
    }

    /// A picture in YCxCz without the detail that the eye does not resolve.
    pub fn blurred(&self, image: &[Vec3], width: usize) -> Vec<Vec3> {
        let [first, second] = self.blurs.each_ref().map(|(taps, weight)| {
            let rows = along_rows(image, width, taps);
            (along_columns(&rows, width, taps), *weight)
        });
        let pairs = first.0.into_iter().zip(second.0);
        pairs.map(|(a, b)| a * first.1 + b * second.1).collect()
    }

    /// How strong an edge each pixel of a grey picture is of, and how much it stands out as a
    /// point.
    pub fn features(&self, grey: &[f32], width: usize) -> Vec<[f32; 2]> {
        let taps = &self.features;
        let gauss: Taps = taps.iter().map(|t| Vec3::splat(t.x)).collect();
        let grey: Vec<Vec3> = grey.iter().copied().map(Vec3::splat).collect();
        let rows = along_rows(&grey, width, taps);
        let smooth: Vec<Vec3> = rows.iter().map(|v| Vec3::splat(v.x)).collect();
        let [x, y] = [along_columns(&rows, width, &gauss), along_columns(&smooth, width, taps)];
        x.iter().zip(&y).map(|(x, y)| [x.y.hypot(y.y), x.z.hypot(y.z)]).collect()
    }
}

/// A filter's values at the pixels up to `radius` from its centre.
fn taps(radius: f64, value: impl Fn(f64) -> [f64; 3]) -> Taps {
    let radius = radius as i32;
    (-radius..=radius).map(|x| Vec3::from(value(f64::from(x)).map(|v| v as f32))).collect()
}

/// The filter with its positive values adding up to 1, and its negative ones, if any, to −1.
fn balanced(taps: Taps) -> Taps {
    let positive: Vec3 = taps.iter().map(|t| t.max(Vec3::ZERO)).sum();
    let negative: Vec3 = taps.iter().map(|t| -t.min(Vec3::ZERO)).sum();
    let share = |t: Vec3| {
        Vec3::select(t.cmpgt(Vec3::ZERO), t / positive, t / negative.max(Vec3::splat(1e-30)))
    };
    taps.into_iter().map(share).collect()
}

fn along_rows(image: &[Vec3], width: usize, taps: &Taps) -> Vec<Vec3> {
    let (radius, last) = (taps.len() / 2, width - 1);
    let filtered = |row: &[Vec3], x: usize| -> Vec3 {
        let at = |k: usize| row[(x + k).saturating_sub(radius).min(last)];
        taps.iter().enumerate().map(|(k, tap)| *tap * at(k)).sum()
    };
    let rows = image.par_chunks(width);
    rows.flat_map_iter(|row| (0..width).map(move |x| filtered(row, x))).collect()
}

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
