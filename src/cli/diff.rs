//! `envers diff`.

use serde::Serialize;

use crate::cli::args::Diff;
use crate::cli::{Outcome, Verdict, files, output};
use crate::error::Error;
use crate::film::{Film, View};
use crate::measure::flip::Seen;
use crate::measure::{Comparison, Picture, compare};
use crate::scene::Transfer;
use crate::write::{self, Format, Settings};

/// `diff --json`.
#[derive(Serialize)]
struct Found {
    #[serde(flatten)]
    compared: Comparison,
    /// Mean FLIP of what a screen shows; null where the pictures have no R, G and B.
    flip: Option<f64>,
}

pub fn run(arguments: &Diff) -> Outcome {
    output::check_json(arguments.json.as_ref())?;
    output::check_png(arguments.heatmap.as_ref())?;
    for input in [&arguments.a, &arguments.b] {
        files::check_input(input)?;
        if let Some(path) = arguments.heatmap.as_ref().filter(|path| files::same(path, input)) {
            return Err(Error::input("the heat map would overwrite a picture that it compares")
                .at(path)
                .help("choose another name"));
        }
    }
    let format = Format::from_path(&arguments.a)?;
    if format != Format::from_path(&arguments.b)? {
        return Err(Error::input("a PNG and an EXR cannot be compared")
            .at(&arguments.b)
            .help("compare a PNG with a PNG, and an EXR with an EXR of the same view"));
    }
    let (a, b) = (Picture::read(&arguments.a)?, Picture::read(&arguments.b)?);
    let found = compare(&a, &b, arguments.tolerance).map_err(|e| e.at(&arguments.b))?;
    let transfer = if format == Format::Png { Transfer::Srgb } else { Transfer::None };
    let seen = Seen::of(&a, transfer).zip(Seen::of(&b, transfer));
    let flip = seen.map(|(a, b)| a.flip(&b).mean);
    if output::stdout_is_free(arguments.json.as_ref()) {
        let shown = flip.map_or(String::new(), |mean| format!(", FLIP {mean:.6}"));
        output::print(&format!(
            "RMSE {:.6e}, PSNR {:.2} dB{shown}, largest difference {:.6e}, {} pixels differ by more \
             than {}\n",
            found.rmse, found.psnr, found.max, found.pixels_differing, arguments.tolerance
        ))?;
    }
    if let Some(path) = &arguments.json {
        output::write_json(path, &Found { compared: found, flip })?;
    }
    if let Some(path) = &arguments.heatmap {
        let settings = Settings { transfer: Transfer::None, ..Settings::default() };
        write::write(&heatmap(&a, &b, found.max), path, &settings)?;
    }
    Ok(if found.pixels_differing == 0 { Verdict::Good } else { Verdict::Bad })
}

/// The largest difference of each pixel, as a share of the largest of all.
fn heatmap(a: &Picture, b: &Picture, max: f64) -> Film {
    let n = a.channels.len();
    let mut film = Film::new(a.size, View::Beauty);
    for (pixel, (p, q)) in film.pixels.iter_mut().zip(a.values.chunks(n).zip(b.values.chunks(n))) {
        let differences = p.iter().zip(q).map(|(x, y)| if x == y { 0.0 } else { (x - y).abs() });
        let largest = differences.fold(0.0, f32::max);
        *pixel = [if max > 0.0 { (f64::from(largest) / max) as f32 } else { 0.0 }; 3];
    }
    film
}
