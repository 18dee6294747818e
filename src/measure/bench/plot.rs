//! The benchmark's plot of run time against error.

use std::ops::Range;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::report::{BenchReport, ParetoRank, Row};
use crate::error::{Error, Result};

const SIZE: (u32, u32) = (900, 600);
/// The colours of the setups.
const COLORS: [RGBColor; 8] = [
    RGBColor(0x2f, 0x6d, 0xb5),
    RGBColor(0x2e, 0x8b, 0x57),
    RGBColor(0xd9, 0x9a, 0x2b),
    RGBColor(0xc4, 0x4e, 0x32),
    RGBColor(0x8a, 0x5a, 0xb5),
    RGBColor(0x2a, 0x9d, 0xa5),
    RGBColor(0xb5, 0x4a, 0x86),
    RGBColor(0x6b, 0x6b, 0x33),
];
const DARK: RGBColor = RGBColor(0x33, 0x33, 0x33);
const FRONT: RGBColor = RGBColor(0xb8, 0xb8, 0xb8);
const RADIUS: i32 = 6;

/// Returns the plot as SVG: the modes by their time to build and render and their RMSE, both on
/// logarithmic scales, with the Pareto front drawn as steps and dominated modes marked by crosses. A
/// mode without error is drawn on the lower border.
///
/// # Errors
/// When the plot cannot be drawn.
pub fn plot(report: &BenchReport) -> Result<String> {
    let mut svg = String::new();
    draw(&mut svg, report).map_err(|e| Error::failed(format!("the plot cannot be drawn: {e}")))?;
    Ok(svg)
}

fn draw(svg: &mut String, report: &BenchReport) -> Result<(), Box<dyn std::error::Error>> {
    let rows = &report.modes;
    let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let text = |size: u32| ("sans-serif", size).into_font().color(&DARK);
    // Axes, their labels and the grid.
    let times = axis_range(rows.iter().map(|r| r.total_ms));
    let errors = axis_range(rows.iter().map(|r| r.rmse));
    let position = |row: &Row| (row.total_ms, row.rmse.max(errors.start));
    let mut chart = ChartBuilder::on(&area)
        .margin(16)
        .margin_right(28)
        .caption(format!("{}: time and error", report.scene), text(22))
        .x_label_area_size(52)
        .y_label_area_size(84)
        .build_cartesian_2d(times.clone().log_scale(), errors.clone().log_scale())?;
    chart
        .configure_mesh()
        .x_desc("time to build and render, milliseconds (median)")
        .y_desc(format!("RMSE against {}", report.reference.mode))
        .x_labels(12)
        .y_labels(10)
        .x_label_formatter(&|x| axis_label(*x))
        .y_label_formatter(&|y| axis_label(*y))
        .label_style(text(15))
        .axis_desc_style(text(16))
        .bold_line_style(RGBColor(0xe2, 0xe2, 0xe2))
        .light_line_style(TRANSPARENT)
        .axis_style(RGBColor(0x88, 0x88, 0x88))
        .draw()?;
    // The Pareto front.
    let front = front_steps(rows, &position, &times, &errors);
    chart
        .draw_series(LineSeries::new(front, FRONT.stroke_width(5)))?
        .label("front")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 24, y)], FRONT.stroke_width(5)));
    // A curve for each setup, with a mark and a label for each mode.
    for (setup, color) in rows.chunk_by(|a, b| a.setup() == b.setup()).zip(COLORS.iter().cycle()) {
        let color = *color;
        chart
            .draw_series(LineSeries::new(curve(setup.iter(), &position), color.stroke_width(1)))?
            .label(setup[0].setup())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], color.stroke_width(3)));
        let ranked = |rank| setup.iter().filter(move |r| r.rank == rank).map(position);
        let (disc, ring) = (color.filled(), color.stroke_width(2));
        let [filled, open] = [disc, ring].map(|style| move |p| Circle::new(p, RADIUS, style));
        chart.draw_series(ranked(ParetoRank::Front).map(filled))?;
        chart.draw_series(ranked(ParetoRank::FewerWrongHits).map(open))?;
        chart.draw_series(ranked(ParetoRank::Dominated).map(|p| Cross::new(p, RADIUS, ring)))?;
        let above = text(13).color(&color).pos(Pos::new(HPos::Left, VPos::Bottom));
        let label = |row: &Row| {
            let error = if row.rmse > 0.0 { "" } else { ", no error" };
            format!("{}{error}", row.samples)
        };
        chart.draw_series(setup.iter().map(|row| {
            EmptyElement::at(position(row)) + Text::new(label(row), (6, -6), above.clone())
        }))?;
    }
    // The legend of the marks, which belong to no series.
    let (disc, ring) = (DARK.filled(), DARK.stroke_width(2));
    let none = || std::iter::empty::<Circle<(f64, f64), i32>>();
    let label = chart.draw_series(none())?.label("on the front");
    label.legend(move |(x, y)| Circle::new((x + 12, y), RADIUS, disc));
    let label = chart.draw_series(none())?.label("behind the front, fewer wrong hits");
    label.legend(move |(x, y)| Circle::new((x + 12, y), RADIUS, ring));
    let label = chart.draw_series(none())?.label("dominated");
    label.legend(move |(x, y)| Cross::new((x + 12, y), RADIUS, ring));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .label_font(text(15))
        .legend_area_size(34)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(0xbb, 0xbb, 0xbb))
        .margin(12)
        .draw()?;
    area.present()?;
    Ok(())
}

/// Returns the positions of modes, from the fastest to the slowest.
fn curve<'r>(
    rows: impl Iterator<Item = &'r Row>,
    position: &dyn Fn(&Row) -> (f64, f64),
) -> Vec<(f64, f64)> {
    let mut points: Vec<_> = rows.map(position).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// Returns the Pareto front as steps from the upper border to the right one. Some mode is at least as
/// good as any point on or above them.
fn front_steps(
    rows: &[Row],
    position: &dyn Fn(&Row) -> (f64, f64),
    times: &Range<f64>,
    errors: &Range<f64>,
) -> Vec<(f64, f64)> {
    let on_front = rows.iter().filter(|row| row.rank == ParetoRank::Front);
    let (mut error, mut line) = (errors.end, Vec::new());
    for (x, y) in curve(on_front, position) {
        line.extend([(x, error), (x, y)]);
        error = y;
    }
    line.push((times.end, error));
    line
}

/// Returns the range of an axis: the positive values, and a margin. Values of 0 extend the lower
/// margin.
fn axis_range(values: impl Iterator<Item = f64> + Clone) -> Range<f64> {
    let positive = || values.clone().filter(|x| *x > 0.0 && x.is_finite());
    let (least, most) = (positive().fold(f64::MAX, f64::min), positive().fold(0.0, f64::max));
    let (least, most) = if most > 0.0 { (least, most) } else { (1e-3, 1.0) };
    let (mut start, mut end) = (least / 4.0, most * 2.0);
    if values.clone().any(|x| x == 0.0) {
        start /= 5.0;
    }
    // The range contains powers of ten, so that the axis has labels.
    if end.log10().floor() - start.log10().ceil() < 1.0 {
        start = 10f64.powf(start.log10().floor());
        end = 10f64.powf(end.log10().ceil());
    }
    start..end
}

/// Returns the label of a number on an axis.
fn axis_label(x: f64) -> String {
    if (1e-4..1e5).contains(&x) {
        format!("{}", (x * 1e6).round() / 1e6)
    } else {
        format!("{x:.0e}")
    }
}
