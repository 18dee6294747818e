//! How far the hits of each formula are from the sphere, as the sphere moves away.

use glam::DVec3;
use plotters::prelude::*;
use rayon::prelude::*;

use super::random::Random;
use super::{naive, spheres};
use crate::error::{Error, Result};
use crate::geometry::Ray;
use crate::measure::oracle;

/// A formula, its name and its colour.
type Curve = (&'static str, RGBColor, spheres::Method);

const CURVES: [Curve; 4] = [
    ("b² − 4ac in f32", RGBColor(0xc4, 0x4e, 0x32), naive::sphere_f32),
    ("b² − 4ac in f64", RGBColor(0xd9, 0x9a, 0x2b), naive::sphere),
    ("Haines in f64 (fast)", RGBColor(0x2f, 0x6d, 0xb5), spheres::fast),
    ("certified", RGBColor(0x2e, 0x8b, 0x57), spheres::certified),
];
const SIZE: (u32, u32) = (900, 560);

/// An SVG: for each formula the worst distance of its hits from the sphere, in radii, over the
/// distance of the sphere in radii; the worst of `rays` rays a point, aimed at a disc of 1.1 radii.
///
/// The f32 formula is given numbers that f32 holds, and judged by the sphere that these describe:
/// what is shown is the formula's own error. Its curve ends where such numbers hardly ever describe
/// a ray that meets its sphere. A ray that a formula says misses does not count in its maximum.
///
/// # Errors
/// When the picture cannot be drawn.
pub fn plot(seed: u64, rays: u64) -> Result<String> {
    let distances: Vec<f64> = (0..=40).map(|i| 2.0 * 5e9f64.powf(f64::from(i) / 40.0)).collect();
    let errors: Vec<[f64; CURVES.len()]> =
        distances.par_iter().map(|distance| worst(*distance, seed, rays)).collect();
    let mut svg = String::new();
    draw(&mut svg, &distances, &errors)
        .map_err(|e| Error::failed(format!("the plot cannot be drawn: {e}")))?;
    Ok(svg)
}

/// The worst error of each formula at a distance; 0 where there is none to show.
fn worst(distance: f64, seed: u64, rays: u64) -> [f64; CURVES.len()] {
    let mut worst = [(0u64, 0.0f64); CURVES.len()];
    for index in 0..rays {
        let random = &mut Random::new(seed, &format!("plot/{distance:e}"), index);
        let toward = random.direction();
        let center = toward * distance;
        let aim = center + random.across(toward) * (1.1 * random.unit().sqrt());
        let direction = aim.normalize();
        let single = |v: DVec3| v.as_vec3().as_dvec3();
        let given = [(single(center), single(direction)), (center, direction)];
        let given = given.map(|(center, direction)| (center, Ray::new(DVec3::ZERO, direction)));
        let hit = given.map(|(center, ray)| oracle::sphere(center, 1.0, &ray, false).is_some());
        for ((count, worst), (i, (_, _, method))) in worst.iter_mut().zip((0..).zip(CURVES)) {
            // The first formula is the one in f32.
            let which = usize::from(i > 0);
            let (center, ray) = &given[which];
            *count += u64::from(hit[which]);
            if let Some(t) = method(*center, 1.0, ray).filter(|t| t.is_finite() && hit[which]) {
                *worst = worst.max(oracle::height(*center, 1.0, ray, t).abs());
            }
        }
    }
    worst.map(|(count, error)| if count >= rays / 4 { error } else { 0.0 })
}

fn draw(
    svg: &mut String,
    distances: &[f64],
    errors: &[[f64; CURVES.len()]],
) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let text = |size: u32| ("sans-serif", size).into_font().color(&RGBColor(0x33, 0x33, 0x33));
    let mut chart = ChartBuilder::on(&area)
        .margin(16)
        .margin_right(28)
        .caption("Distance of the hit from the sphere, worst case", text(22))
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
    for (i, (name, color, _)) in CURVES.into_iter().enumerate() {
        let points: Vec<(f64, f64)> = distances
            .iter()
            .zip(errors)
            .map(|(d, e)| (*d, e[i]))
            .filter(|(_, error)| *error > 0.0)
            .collect();
        chart
            .draw_series(LineSeries::new(points, color.stroke_width(3)))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], color.stroke_width(3)));
    }
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
