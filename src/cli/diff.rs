//! `envers diff`.

use crate::cli::args::Diff;
use crate::cli::{Outcome, Verdict, output};
use crate::error::Error;
use crate::film::{Film, View};
use crate::measure::{Picture, compare};
use crate::scene::Transfer;
use crate::write::{self, Settings};

pub fn run(arguments: &Diff) -> Outcome {
    if arguments.tolerance < 0.0 || arguments.tolerance.is_nan() {
        return Err(Error::input(format!("--tolerance {} is not 0 or above", arguments.tolerance)));
    }
    output::check_json(arguments.json.as_ref())?;
    output::check_png(arguments.heatmap.as_ref())?;
    let (a, b) = (Picture::read(&arguments.a)?, Picture::read(&arguments.b)?);
    let found = compare(&a, &b, arguments.tolerance).map_err(|e| e.at(&arguments.b))?;
    if output::stdout_is_free(arguments.json.as_ref()) {
        println!(
            "RMSE {:.6e}, PSNR {:.2} dB, largest difference {:.6e}, {} pixels differ by more than {}",
            found.rmse, found.psnr, found.max, found.pixels_differing, arguments.tolerance
        );
    }
    if let Some(path) = &arguments.json {
        output::write_json(path, &found)?;
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
