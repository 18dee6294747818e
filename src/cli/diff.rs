//! The subcommand `envers diff`.

use std::process::ExitCode;

use serde::Serialize;

use crate::cli::paths::{self, InputFiles};
use crate::cli::{args::Diff, check_status, output, scene_args};
use crate::error::{Error, Result};
use crate::film::{Film, View};
use crate::measure::{Comparison, Picture, compare_pictures, flip::PerceivedImage};
use crate::scene::Transfer;
use crate::write::Format;

/// The result of a comparison: `diff --json`.
#[derive(Serialize)]
struct DiffResult {
    #[serde(flatten)]
    comparison: Comparison,
    /// The mean FLIP; null if the images have no R, G and B.
    flip: Option<f64>,
}

pub fn run(arguments: &Diff) -> Result<ExitCode> {
    // Check the outputs, and then the inputs, which must be of one kind.
    output::check_json(arguments.json.as_ref())?;
    output::check_extension(arguments.heatmap.as_ref(), "png", "a heat map must be a PNG")?;
    let inputs = [&*arguments.a, &*arguments.b];
    inputs.into_iter().try_for_each(paths::check_input)?;
    let outputs = [&arguments.json, &arguments.heatmap].into_iter().flatten();
    paths::check_outputs(outputs, &InputFiles::named(&inputs))?;
    let [is_exr, other_is_exr] =
        inputs.map(|path| Format::from_path(path).map(|format| format == Format::Exr));
    let is_exr = is_exr?;
    if is_exr != other_is_exr? {
        return Err(Error::input("an EXR can be compared with an EXR only").at(&arguments.b).help(
            "compare PNG, JPEG and WebP with each other, and an EXR with one of the same view",
        ));
    }
    if !is_exr && arguments.tolerance >= 1.0 {
        let message = format!(
            "--tolerance {}: the values of an 8-bit image are from 0 to 1, so any two images would pass",
            arguments.tolerance
        );
        return Err(Error::input(message)
            .help("for a difference of one step of the 255 give `--tolerance 1/255`"));
    }
    // Compare the values, and what a viewer perceives of them.
    let limits = scene_args::limits(&arguments.limit);
    let [a, b] = Picture::read_pair(&arguments.a, &arguments.b, limits)?;
    let comparison =
        compare_pictures(&a, &b, arguments.tolerance).map_err(|e| e.at(&arguments.b))?;
    let transfer = if is_exr { Transfer::None } else { Transfer::Srgb };
    let [first, second] = [&a, &b].map(|p| PerceivedImage::from_picture(p, transfer));
    let flip = first.zip(second).map(|(a, b)| a.flip(&b).mean);

    // Report the differences.
    let Comparison { rmse, psnr, max, pixels_differing } = comparison;
    let mean = flip.map_or(String::new(), |mean| format!(", FLIP {mean:.6}"));
    let text = format!(
        "RMSE {rmse:.6e}, PSNR {psnr:.2} dB{mean}, largest difference {max:.6e}, \
         {pixels_differing} pixels differ by more than {}\n",
        arguments.tolerance
    );
    output::report(arguments.json.as_ref(), &text, &DiffResult { comparison, flip })?;
    if let Some(path) = &arguments.heatmap {
        output::write_heatmap(path, &heatmap(&a, &b, max))?;
    }
    Ok(check_status(pixels_differing == 0))
}

/// Returns the largest difference of each pixel, as a share of the largest of all.
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
