//! A contact sheet of models beside the pictures that come with them, as those of Khronos' glTF Asset
//! Generator do: each folder's `Manifest.json` names models, pictures and where the camera stands.
//!
//! `cargo run --release --example contact_sheet -- FOLDER [NAME …]` writes `out/contact/NAME.png` for
//! each folder in FOLDER, or for those named: ours on the left of each pair, theirs on the right.

use envers::internals::Settings;
use envers::{Camera, Film, Light, LightKind, Loaded, Projection, Renderer, Shadow};
use std::error::Error;
use std::path::Path;

use glam::{DVec3, Vec3};
use image::imageops::{FilterType, replace, resize};
use image::{Rgba, RgbaImage};
use serde_json::Value;

/// The side of a picture on the sheet, in pixels, and how many pairs stand in a row.
const SIDE: u32 = 220;
const PAIRS: u32 = 4;
const GAP: u32 = 6;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder =
        arguments.next().ok_or("which folder? (one with folders that have a Manifest.json)")?;
    let mut names: Vec<String> = arguments.collect();
    if names.is_empty() {
        let all = std::fs::read_dir(&folder)?.flatten().filter(|e| e.path().is_dir());
        names = all.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
    }
    std::fs::create_dir_all("out/contact")?;
    for name in names {
        let folder = Path::new(&folder).join(&name);
        let Ok(text) = std::fs::read_to_string(folder.join("Manifest.json")) else { continue };
        let manifest: Value = serde_json::from_str(&text)?;
        let models = manifest["models"].as_array().ok_or("the manifest has no models")?;
        let rows = (models.len() as u32).div_ceil(PAIRS);
        let (width, height) = (PAIRS * (2 * SIDE + GAP), rows * (SIDE + GAP));
        let mut sheet = RgbaImage::from_pixel(width, height, Rgba([255; 4]));
        for (i, model) in (0..).zip(models) {
            let (x, y) = (i % PAIRS * (2 * SIDE + GAP), i / PAIRS * (SIDE + GAP));
            let file = folder.join(model["fileName"].as_str().unwrap_or_default());
            match ours(&file, model) {
                Ok(picture) => replace(&mut sheet, &picture, i64::from(x), i64::from(y)),
                Err(error) => println!("{}: {error}", file.display()),
            }
            let theirs = model["sampleImageName"].as_str().unwrap_or_default();
            if let Ok(picture) = image::open(folder.join(theirs)) {
                let picture = resize(&picture.into_rgba8(), SIDE, SIDE, FilterType::Triangle);
                replace(&mut sheet, &picture, i64::from(x + SIDE), i64::from(y));
            }
        }
        let to = format!("out/contact/{name}.png");
        sheet.save(&to)?;
        println!("{to}");
    }
    Ok(())
}

/// Our picture of a model, from where the manifest says that the camera stands.
fn ours(file: &Path, model: &Value) -> Result<RgbaImage, Box<dyn Error>> {
    let Loaded { mut scene, report, .. } = envers::load(file)?;
    report.warnings.iter().for_each(|warning| println!("{warning}"));
    let at = |i: usize| model["camera"]["translation"][i].as_f64().unwrap_or(0.0);
    let eye = DVec3::new(at(0), at(1), at(2));
    // Theirs are made by Babylon.js, whose cameras see 0.8 radians unless told otherwise.
    scene.cameras = vec![Camera::look_at(eye, DVec3::ZERO, DVec3::Y, Projection::FovY(0.8))?];
    scene.lights = vec![
        light(
            LightKind::Directional {
                direction: DVec3::new(0.3, -0.8, -0.5).normalize(),
                angle: 0.0,
            },
            0.6,
        ),
        light(
            LightKind::Directional {
                direction: DVec3::new(-0.2, 0.1, -1.0).normalize(),
                angle: 0.0,
            },
            0.4,
        ),
        light(LightKind::Ambient, 0.4),
    ];
    scene.film.size = [SIDE; 2];
    scene.film.background = Vec3::new(0.35, 0.34, 0.36);
    let film = Renderer::new(&scene).render()?.film;
    Ok(bytes(&film, &Settings::from_film(&scene.film)))
}

fn light(kind: LightKind, intensity: f32) -> Light {
    Light {
        name: String::new(),
        kind,
        intensity: Vec3::splat(intensity),
        shadow: Shadow::None,
        samples: 16,
        shape: None,
    }
}

fn bytes(film: &Film, settings: &Settings) -> RgbaImage {
    RgbaImage::from_fn(SIDE, SIDE, |x, y| {
        let [r, g, b] = settings.bytes(film.pixel(x, y));
        Rgba([r, g, b, 255])
    })
}
