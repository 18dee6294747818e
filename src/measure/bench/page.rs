//! The report as one page that holds everything it shows, and needs no script and no network.

use std::fmt::Write;

use base64::Engine;
use image::ImageEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use rayon::prelude::*;

use super::report::{Plate, Report, Row, Standing};
use crate::error::{Error, Result};

/// Everything that looks like something: for paper in the light, and for the dark.
const STYLE: &str = include_str!("page.css");

/// How wide a picture is shown, about, in pixels.
const HALF_A_PAGE: u32 = 570;

const HOW_TO_READ: &str = "\
The plot has a mark for each mode: how long building and rendering take, the median of the runs, \
which took turns; and how far its picture is from the reference. Farther left is faster, farther \
down is nearer to the reference. The grey stairs are the front; they go through the modes that no \
other beats in time and RMSE together. The number at a mark is that of the samples per pixel; two \
numbers are the fewest and the most, where only some pixels have more. A setup that is called low has \
Embree's quickly built trees.";

const STANDINGS: &str = "\
<b>front</b>: no other mode is as fast with as small an RMSE. <b>hits</b>: one is, but with more wrong \
hits. <b>dominated</b>: another is no slower, has no larger an RMSE and no more wrong hits.";

const COLUMNS: &str = "\
RMSE and max: root of the mean squared difference, and the largest difference, of the radiance, as \
<code>envers diff</code> tells them of EXRs. FLIP: mean difference of the PNGs to an eye that flips \
between them, 0 to 1, at 67 pixels per degree. Wrong hits: pixels in which the ray through the \
centre meets another primitive than a certified ray does, or none.";

const PLATES: &str = "\
Each picture as a PNG shows it, and beside it its FLIP map: black where nobody sees a difference \
from the reference, then red, yellow, white, which stands for 0.5 and more. Point at a picture to \
see the reference in its place. Modes that make the same bytes share a picture.";

/// The report as HTML; `svg` is its [plot](super::plot()).
///
/// # Errors
/// When a picture cannot be encoded.
pub fn page(report: &Report, svg: &str) -> Result<String> {
    let Report { machine, reference, size: [width, height], .. } = report;
    let name = escape(&report.scene);
    // Within a page the plot needs no name space, and fits the column.
    let svg = svg.replace(r#" xmlns="http://www.w3.org/2000/svg""#, "");
    let cores = machine.cores.map_or(String::new(), |cores| format!("{cores} cores, "));
    let embree = machine.embree.as_ref().map_or("none".to_owned(), |version| escape(version));
    let images = report.plates.par_iter().map(|plate| images(plate, report.size));
    let images = images.collect::<Result<Vec<_>>>()?;
    let plates = report.plates.iter().zip(&images);
    let plates: String = plates.skip(1).map(|(plate, images)| figure(plate, images)).collect();
    Ok(format!(
        r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{name}: run time against error</title>
<style>
{STYLE}.flip {{ background-image: url({picture}); }}
img, .flip {{ image-rendering: {rendering}; }}
</style>
</head>
<body>
<h1>{name}: run time against error</h1>
<p>{width} × {height} pixels, camera {camera}, {threads} threads.</p>
<div class="plot">{svg}</div>
<p>{HOW_TO_READ}</p>
<h2>Modes</h2>
{table}
<p>{STANDINGS}</p>
<p>{COLUMNS}</p>
{left_out}<h2>Reference</h2>
<p><b>{reference_name}</b>: certified hits, {reference_spp} samples per pixel; built in {build:.0} ms and
rendered in {render:.0} ms, once. Its hits are those of exact arithmetic, on either backend; its
samples are finite in number, so a mode with nearly as many looks better than it is.</p>
<h2>Machine</h2>
<table class="facts">
<tr><th>processor</th><td>{processor}</td></tr>
<tr><th>cores</th><td>{cores}{logical} threads at once</td></tr>
<tr><th>instruction sets</th><td>{features}</td></tr>
<tr><th>Embree</th><td>{embree}</td></tr>
<tr><th>envers</th><td>{envers}</td></tr>
<tr><th>system</th><td>{system}</td></tr>
</table>
<h2>Pictures</h2>
<p>{PLATES}</p>
<figure>
<figcaption>the reference</figcaption>
<img src="{picture}" width="{width}" height="{height}" alt="the reference">
</figure>
{plates}</body>
</html>
"#,
        camera = report.camera,
        threads = report.threads,
        picture = images[0].0,
        // Shown smaller, a picture must not gain jags that it has not; shown larger, not lose any.
        rendering = if *width > HALF_A_PAGE { "auto" } else { "pixelated" },
        table = table(&report.modes),
        left_out = left_out(report),
        reference_name = escape(&reference.mode),
        reference_spp = reference.spp,
        build = reference.build_ms,
        render = reference.render_ms,
        processor = escape(&machine.processor),
        logical = machine.threads,
        features = machine.features.join(", "),
        envers = machine.envers,
        system = escape(&machine.system),
    ))
}

fn table(rows: &[Row]) -> String {
    let mut html = "<div class=\"wide\"><table>\n<tr><th>mode</th><th>runs</th><th>build ms</th>\
                    <th>render ms</th><th>total ms</th><th>RMSE</th><th>max</th><th>FLIP</th>\
                    <th>wrong hits</th><th>standing</th></tr>\n"
        .to_owned();
    for r in rows {
        let by = r.dominated_by.as_ref().map_or(String::new(), |by| format!(" by {}", escape(by)));
        let class = if r.standing == Standing::Front { " class=\"front\"" } else { "" };
        let _ = writeln!(
            html,
            "<tr{class}><td>{}</td><td>{}</td><td>{:.1}</td><td>{:.1}</td><td>{:.1}</td>\
             <td>{:.2e}</td><td>{:.2e}</td><td>{:.5}</td><td>{}</td><td>{}{by}</td></tr>",
            escape(&r.mode),
            r.runs,
            r.build_ms,
            r.render_ms,
            r.total_ms,
            r.rmse,
            r.max,
            r.flip,
            r.hits_wrong,
            r.standing.name()
        );
    }
    html + "</table></div>"
}

fn left_out(report: &Report) -> String {
    if report.left_out.is_empty() {
        return String::new();
    }
    let item = |l: &super::LeftOut| {
        format!("<li><b>{}</b>: {}</li>\n", escape(&l.mode), escape(&l.reason))
    };
    let items: String = report.left_out.iter().map(item).collect();
    format!("<h2>Left out</h2>\n<ul>\n{items}</ul>\n")
}

fn figure(plate: &Plate, (picture, map): &(String, String)) -> String {
    let modes = escape(&plate.modes.join(", "));
    format!(
        "<figure>\n<figcaption>{modes}: FLIP {:.5}</figcaption>\n<div class=\"pair\">\
         <div class=\"flip\"><img src=\"{picture}\" alt=\"{modes}\"></div>\
         <img src=\"{map}\" alt=\"where it differs\"></div>\n</figure>\n",
        plate.mean
    )
}

/// The picture and its map as data URIs; a picture without a map has an empty one.
fn images(plate: &Plate, size: [u32; 2]) -> Result<(String, String)> {
    let map: Vec<u8> = plate.flip.iter().flat_map(|&flip| heat(flip * 2.0)).collect();
    let map = if map.is_empty() { String::new() } else { data_uri(&map, size)? };
    Ok((data_uri(&plate.bytes, size)?, map))
}

fn data_uri(bytes: &[u8], [width, height]: [u32; 2]) -> Result<String> {
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive)
        .write_image(bytes, width, height, image::ExtendedColorType::Rgb8)
        .map_err(|e| Error::failed(format!("a picture cannot be encoded: {e}")))?;
    let text = base64::engine::general_purpose::STANDARD.encode(png);
    Ok(format!("data:image/png;base64,{text}"))
}

/// From black at 0 through red and yellow to white at 1.
fn heat(x: f32) -> [u8; 3] {
    [3.0 * x, 3.0 * x - 1.0, 3.0 * x - 2.0].map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8)
}

/// Text as HTML shows it as it is.
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
