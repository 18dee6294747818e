//! The plot of the error of each formula for ray and sphere over the distance of the sphere.

use glam::DVec3;
use plotters::prelude::*;
use rayon::prelude::*;

use super::{Method, random::Random, sphere_distance, textbook};
use crate::error::{Error, Result};
use crate::geometry::Ray;
use crate::measure::oracle;

/// A formula that is plotted.
struct Curve {
    name: &'static str,
    color: RGBColor,
    method: Method,
    /// True if the formula gets arguments that are rounded to f32.
    is_f32: bool,
}

impl Curve {
    const fn new(name: &'static str, color: u32, method: Method, is_f32: bool) -> Self {
        let [_, red, green, blue] = color.to_be_bytes();
        Self { name, color: RGBColor(red, green, blue), method, is_f32 }
    }
}

const CURVES: [Curve; 4] = [
    Curve::new("b² − 4ac in f32", 0xc44e32, textbook::sphere_f32, true),
    Curve::new("b² − 4ac in f64", 0xd99a2b, textbook::sphere, false),
    Curve::new("Haines in f64 (fast)", 0x2f6db5, sphere_distance::fast, false),
    Curve::new("certified", 0x2e8b57, sphere_distance::certified, false),
];
const SIZE: (u32, u32) = (900, 560);

/// Returns the plot as SVG: for each formula the largest distance of its hits from the sphere, over the
/// distance of the sphere, both in radii. Each point is the largest of `rays` rays, aimed at a disc of
/// 1.1 radii.
///
/// The f32 formula gets arguments that f32 can represent, and is compared with the exact sphere of
/// these arguments, so that only the error of the formula itself is shown. Its curve ends where rays
/// that are rounded to f32 hardly ever hit their sphere. A ray that a formula misses does not count in
/// its maximum.
///
/// # Errors
/// When the plot cannot be drawn.
pub fn plot(seed: u64, rays: u64) -> Result<String> {
    let distances: Vec<f64> = (0..=40).map(|i| 2.0 * 5e9f64.powf(f64::from(i) / 40.0)).collect();
    let errors: Vec<[f64; CURVES.len()]> =
        distances.par_iter().map(|distance| max_errors(*distance, seed, rays)).collect();
    let mut svg = String::new();
    draw(&mut svg, &distances, &errors)
        .map_err(|e| Error::failed(format!("the plot cannot be drawn: {e}")))?;
    Ok(svg)
}

/// Returns the largest error of each formula at a distance; 0 where fewer than a quarter of the rays
/// hit the sphere.
fn max_errors(distance: f64, seed: u64, rays: u64) -> [f64; CURVES.len()] {
    let mut hits = [0u64; CURVES.len()];
    let mut errors = [0.0f64; CURVES.len()];
    let round = |v: DVec3, is_f32: bool| if is_f32 { v.as_vec3().as_dvec3() } else { v };
    for index in 0..rays {
        // A ray at a disc a little larger than the sphere, so that it also meets the silhouette.
        let random = &mut Random::new(seed, &format!("plot/{distance:e}"), index);
        let toward = random.direction();
        let center = toward * distance;
        let target = center + random.perpendicular(toward) * (1.1 * random.unit().sqrt());
        let direction = target.normalize();
        // The ray and sphere in f64 and in f32, and whether they hit.
        let arguments = [false, true].map(|is_f32| {
            let (center, direction) = (round(center, is_f32), round(direction, is_f32));
            let ray = Ray::new(DVec3::ZERO, direction);
            (center, ray, oracle::sphere(center, 1.0, &ray, false).is_some())
        });
        // The error of each formula, if the ray hits the sphere of its arguments.
        for (i, Curve { method, is_f32, .. }) in CURVES.iter().enumerate() {
            let (center, ray, is_hit) = arguments[usize::from(*is_f32)];
            if !is_hit {
                continue;
            }
            hits[i] += 1;
            if let Some(t) = method(center, 1.0, &ray).filter(|t| t.is_finite()) {
                let error = oracle::signed_distance(center, 1.0, &ray, t).abs();
                errors[i] = errors[i].max(error);
            }
        }
    }
    std::array::from_fn(|i| if hits[i] >= rays / 4 { errors[i] } else { 0.0 })
}

fn draw(
    svg: &mut String,
    distances: &[f64],
    errors: &[[f64; CURVES.len()]],
) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let text = |size: u32| ("sans-serif", size).into_font().color(&RGBColor(0x33, 0x33, 0x33));
    // Axes, their labels and the grid.
    let mut chart = ChartBuilder::on(&area)
        .margin(16)
        .margin_right(28)
        .caption("Error of the hit: its distance from the sphere, worst case", text(22))
        .x_label_area_size(52)
        .y_label_area_size(78)
        .build_cartesian_2d((2.0..1e10f64).log_scale(), (1e-17..1e5f64).log_scale())?;
    let power = |x: &f64| format!("1e{}", x.log10().round());
    chart
        .configure_mesh()
        .x_desc("distance of the sphere ÷ its radius")
        .y_desc("error ÷ radius")
        .x_labels(10)
        .y_labels(12)
        .x_label_formatter(&power)
        .y_label_formatter(&power)
        .label_style(text(15))
        .axis_desc_style(text(16))
        .bold_line_style(RGBColor(0xdd, 0xdd, 0xdd))
        .light_line_style(TRANSPARENT)
        .axis_style(RGBColor(0x88, 0x88, 0x88))
        .draw()?;
    // A curve for each formula.
    for (i, Curve { name, color, .. }) in CURVES.into_iter().enumerate() {
        let points = distances.iter().zip(errors).map(|(distance, errors)| (*distance, errors[i]));
        let points = points.filter(|(_, error)| *error > 0.0);
        chart
            .draw_series(LineSeries::new(points, color.stroke_width(3)))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], color.stroke_width(3)));
    }
    // The legend.
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .label_font(text(16))
        .legend_area_size(34)
        .background_style(WHITE.mix(0.9))
        .border_style(RGBColor(0xbb, 0xbb, 0xbb))
        .margin(12)
        .draw()?;
    area.present()?;
    Ok(())
}
