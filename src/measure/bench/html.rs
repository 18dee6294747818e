//! The benchmark's HTML report: one page that needs no script, no network and no other file.

use std::fmt::Write;

use base64::Engine;
use image::ImageEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use rayon::prelude::*;

use super::machine::Machine;
use super::report::{BenchReport, ModeImage, ParetoRank, ReferenceSummary, Row, SkippedMode};
use crate::error::{Error, Result};

/// The style sheet, for light and dark mode.
const STYLE: &str = include_str!("report.css");

/// The width in pixels at which an image is shown, about half a page.
const SHOWN_WIDTH: u32 = 570;

/// The text on how to read the plot.
const HOW_TO_READ: &str = "\
The plot shows a mark for each mode: the time to build and render (the median of its runs, which \
alternate with those of the other modes) against the error of its image. Left is faster, down is \
closer to the reference. The grey steps are the Pareto front: the modes that no other beats in time \
and RMSE together. The number at a mark is the samples per pixel; two numbers are the fewest and the \
most of adaptive sampling. A setup named low uses Embree's low build quality.";

/// The text on the ranks relative to the Pareto front.
const RANKS: &str = "\
<b>front</b>: no other mode is as fast with as small an RMSE. <b>hits</b>: another is, but with more \
wrong hits. <b>dominated</b>: another is no slower, with no larger RMSE and no more wrong hits.";

/// The text on the columns of the table.
const COLUMNS: &str = "\
RMSE and max: the root-mean-square and the largest difference of the radiance, as \
<code>envers diff</code> computes them for EXRs. FLIP: the mean perceived difference of the PNGs, \
from 0 to 1, at 67 pixels per degree. Wrong hits: pixels in which the ray through the centre hits \
another primitive than a certified ray does.";

/// The text on the images.
const IMAGES: &str = "\
Each image as a PNG shows it, next to its FLIP map: from black (no visible difference from \
the reference) through red and yellow to white (0.5 and more). Hover over an image to see the \
reference in its place. Modes that render the same bytes share an image.";

/// Returns the report as an HTML page; `svg` is its [plot](super::plot()).
///
/// # Errors
/// When an image cannot be encoded.
pub fn html(report: &BenchReport, svg: &str) -> Result<String> {
    // The report, with the names of files and of the system escaped.
    let BenchReport { camera, threads, machine, reference, size: [width, height], .. } = report;
    let ReferenceSummary { spp, build_ms, render_ms, .. } = reference;
    let Machine { threads: logical, envers, .. } = machine;
    let [name, reference] = [&report.scene, &reference.mode].map(|name| escape(name));
    let [processor, system] = [&machine.processor, &machine.system].map(|name| escape(name));
    // Within a page the plot needs no name space, and fits the column.
    let svg = svg.replace(r#" xmlns="http://www.w3.org/2000/svg""#, "");
    let cores = machine.cores.map_or(String::new(), |cores| format!("{cores} cores, "));
    let embree = machine.embree.as_ref().map_or("none".to_owned(), |version| escape(version));
    // The images as data URIs, of which the first is the reference.
    let encoded = report.images.par_iter().map(|image| DataUris::new(image, report.size));
    let encoded = encoded.collect::<Result<Vec<_>>>()?;
    let figures = report.images.iter().zip(&encoded).skip(1);
    let figures: String = figures.map(|(image, encoded)| figure(image, encoded)).collect();
    Ok(format!(
        r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{name}: time and error</title>
<style>
{STYLE}.flip {{ background-image: url({picture}); }}
img, .flip {{ image-rendering: {rendering}; }}
</style>
</head>
<body>
<h1>{name}: time and error</h1>
<p>{width} × {height} pixels, camera {camera}, {threads} threads.</p>
<div class="plot">{svg}</div>
<p>{HOW_TO_READ}</p>
<h2>Modes</h2>
{table}
<p>{RANKS}</p>
<p>{COLUMNS}</p>
{skipped}<h2>Reference</h2>
<p><b>{reference}</b>: certified hits, {spp} samples per pixel; built in {build_ms:.0} ms and
rendered in {render_ms:.0} ms, once. Its hits equal those of exact arithmetic, on either backend. Its
samples are limited in number, so the error of a mode with nearly as many is underestimated.</p>
<h2>Machine</h2>
<table class="facts">
<tr><th>processor</th><td>{processor}</td></tr>
<tr><th>cores</th><td>{cores}{logical} threads at once</td></tr>
<tr><th>instruction sets</th><td>{features}</td></tr>
<tr><th>Embree</th><td>{embree}</td></tr>
<tr><th>envers</th><td>{envers}</td></tr>
<tr><th>system</th><td>{system}</td></tr>
</table>
<h2>Images</h2>
<p>{IMAGES}</p>
<figure>
<figcaption>the reference</figcaption>
<img src="{picture}" width="{width}" height="{height}" alt="the reference">
</figure>
{figures}</body>
</html>
"#,
        picture = encoded[0].image,
        // A picture that is scaled down needs smoothing; one that is scaled up keeps its pixels.
        rendering = if *width > SHOWN_WIDTH { "auto" } else { "pixelated" },
        table = table(&report.modes),
        skipped = skipped(&report.skipped),
        features = machine.features.join(", "),
    ))
}

/// Returns the table of the modes.
fn table(rows: &[Row]) -> String {
    let mut html = "<div class=\"wide\"><table>\n<tr><th>mode</th><th>runs</th><th>build ms</th>\
                    <th>render ms</th><th>total ms</th><th>RMSE</th><th>max</th><th>FLIP</th>\
                    <th>wrong hits</th><th>Pareto</th></tr>\n"
        .to_owned();
    for r in rows {
        let by = r.dominated_by.as_ref().map_or(String::new(), |by| format!(" by {}", escape(by)));
        let class = if r.rank == ParetoRank::Front { " class=\"front\"" } else { "" };
        let Row { runs, build_ms, render_ms, total_ms, rmse, max, flip, wrong_hits, .. } = r;
        let (mode, rank) = (escape(&r.mode), r.rank.name());
        let _ = writeln!(
            html,
            "<tr{class}><td>{mode}</td><td>{runs}</td><td>{build_ms:.1}</td><td>{render_ms:.1}</td>\
             <td>{total_ms:.1}</td><td>{rmse:.2e}</td><td>{max:.2e}</td><td>{flip:.5}</td>\
             <td>{wrong_hits}</td><td>{rank}{by}</td></tr>"
        );
    }
    html + "</table></div>"
}

/// Returns the section about skipped modes; empty if there are none.
fn skipped(modes: &[SkippedMode]) -> String {
    if modes.is_empty() {
        return String::new();
    }
    let item = |skipped: &SkippedMode| {
        format!("<li><b>{}</b>: {}</li>\n", escape(&skipped.mode), escape(&skipped.reason))
    };
    let items: String = modes.iter().map(item).collect();
    format!("<h2>Skipped modes</h2>\n<ul>\n{items}</ul>\n")
}

/// Returns an image and its FLIP map side by side.
fn figure(image: &ModeImage, DataUris { image: picture, flip }: &DataUris) -> String {
    let modes = escape(&image.modes.join(", "));
    format!(
        "<figure>\n<figcaption>{modes}: FLIP {:.5}</figcaption>\n<div class=\"pair\">\
         <div class=\"flip\"><img src=\"{picture}\" alt=\"{modes}\"></div>\
         <img src=\"{flip}\" alt=\"FLIP map\"></div>\n</figure>\n",
        image.mean
    )
}

/// An image and its FLIP map as data URIs.
struct DataUris {
    image: String,
    /// The FLIP map; empty where the image has none.
    flip: String,
}

impl DataUris {
    fn new(image: &ModeImage, size: [u32; 2]) -> Result<Self> {
        let flip: Vec<u8> = image.flip.iter().flat_map(|&flip| heat(flip * 2.0)).collect();
        let flip = if flip.is_empty() { String::new() } else { data_uri(&flip, size)? };
        Ok(Self { image: data_uri(&image.bytes, size)?, flip })
    }
}

/// Returns 8-bit RGB pixels as the data URI of a PNG.
fn data_uri(bytes: &[u8], [width, height]: [u32; 2]) -> Result<String> {
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive)
        .write_image(bytes, width, height, image::ExtendedColorType::Rgb8)
        .map_err(|e| Error::failed(format!("an image cannot be encoded: {e}")))?;
    let text = base64::engine::general_purpose::STANDARD.encode(png);
    Ok(format!("data:image/png;base64,{text}"))
}

/// Returns the heat map's colour of a value: black at 0, then red, yellow, and white at 1.
fn heat(x: f32) -> [u8; 3] {
    [3.0 * x, 3.0 * x - 1.0, 3.0 * x - 2.0].map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8)
}

/// Returns text with HTML's special characters escaped.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_goes_from_black_to_white() {
        assert_eq!([0.0, 0.5, 1.0, 9.0].map(heat), [[0; 3], [255, 128, 0], [255; 3], [255; 3]]);
    }

    #[test]
    fn names_cannot_be_taken_for_tags() {
        assert_eq!(escape("<a href=\"x\">&"), "&lt;a href=&quot;x&quot;&gt;&amp;");
    }
}
