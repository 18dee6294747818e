//! The scenes of `docs/gallery.md`.

use envers::internals::{Settings, png_bytes};
use envers::scene::Transfer;
use envers::{Film, LoadOptions, Loaded, RenderOptions, Renderer};
use std::path::{Path, PathBuf};

use image::RgbImage;

/// The size of the pictures in `docs/images/gallery/`.
const SIZE: [u32; 2] = [640, 360];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The names of the files in a folder with an ending, without it, sorted.
fn names(folder: &str, ending: &str) -> Vec<String> {
    let files = std::fs::read_dir(root().join(folder)).expect(folder);
    let paths = files.map(|entry| entry.expect("the folder can be read").path());
    let files = paths.filter(|path| path.extension().is_some_and(|e| e == ending));
    let stem = |path: PathBuf| path.file_stem().expect("ok: a file").display().to_string();
    let mut names: Vec<String> = files.map(stem).collect();
    names.sort();
    names
}

fn scenes() -> Vec<String> {
    names("assets/scenes/gallery", "toml")
}

/// A small picture of a scene, with the settings that make its bytes.
fn picture(
    name: &str,
    size: [u32; 2],
    spp: u32,
    options: &RenderOptions,
    depth: Option<u32>,
) -> (Film, Settings) {
    let path = root().join(format!("assets/scenes/gallery/{name}.toml"));
    let Loaded { mut scene, report, .. } =
        LoadOptions::default().size(size).load(&path).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(report.warnings, [""; 0], "{name}");
    scene.film.spp = spp;
    scene.film.max_depth = depth.unwrap_or(scene.film.max_depth);
    (
        Renderer::new(&scene).options(options.clone()).render().expect(name).film,
        Settings::from_film(&scene.film),
    )
}

#[test]
fn there_are_a_dozen_and_each_has_its_picture() {
    assert!(scenes().len() >= 12);
    assert_eq!(names("docs/images/gallery", "png"), scenes());
}

#[test]
fn the_page_shows_every_scene_with_its_file_picture_and_command() {
    let page = std::fs::read_to_string(root().join("docs/gallery.md")).expect("docs/gallery.md");
    for name in scenes() {
        let command = format!(
            "\nenvers render assets/scenes/gallery/{name}.toml --size 640x360 -o {name}.png\n"
        );
        let file = format!("](../assets/scenes/gallery/{name}.toml)");
        let shown = format!("](images/gallery/{name}.png)");
        for part in [command, file, shown] {
            assert!(page.contains(&part), "docs/gallery.md lacks {part:?}");
        }
    }
    assert_eq!(page.matches("](images/gallery/").count(), scenes().len());
}

#[test]
#[cfg(feature = "embree")]
fn both_backends_make_the_same_radiance_in_certified_at_depth_16() {
    use envers::Backend;
    use envers::Precision;
    for name in scenes() {
        let [embree, rust] = [Backend::Embree, Backend::Rust].map(|backend| {
            let options = RenderOptions {
                backend: Some(backend),
                precision: Precision::Certified,
                ..RenderOptions::default()
            };
            let bits = |film: Film| -> Vec<[u32; 3]> {
                film.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
            };
            bits(picture(&name, [48, 27], 1, &options, Some(16)).0)
        });
        assert!(embree == rust, "{name}");
    }
}

/// A picture of an eighth of the size has for its pixels the means of 8 by 8 of the committed one,
/// but for the places of the samples, which tell at edges, and for what was clamped.
#[test]
fn the_committed_pictures_are_those_of_the_scenes() {
    for name in scenes() {
        let path = root().join(format!("docs/images/gallery/{name}.png"));
        let committed = image::open(&path).expect("the picture can be read").into_rgb8();
        assert_eq!(committed.dimensions(), SIZE.into(), "{name}");
        let (film, settings) =
            picture(&name, SIZE.map(|s| s / 8), 64, &RenderOptions::default(), None);
        let difference = mean_difference(&committed, &film, &png_bytes(&film, &settings));
        assert!(difference < 2.5, "{name}: {difference} of 255");
    }
}

/// The mean difference of the bytes of a small picture from the means, in light, of the large one.
fn mean_difference(large: &RgbImage, film: &Film, small: &[u8]) -> f64 {
    let width = film.size[0] as usize;
    let light = |byte: u8| f64::from(Transfer::Srgb.decode(f32::from(byte) / 255.0));
    let mean = |at: usize| {
        let (x, y, channel) = (at / 3 % width, at / 3 / width, at % 3);
        let pixel = |i: usize| large.get_pixel((8 * x + i % 8) as u32, (8 * y + i / 8) as u32);
        let sum: f64 = (0..64).map(|i| light(pixel(i)[channel])).sum();
        255.0 * Transfer::Srgb.encode(sum / 64.0)
    };
    let difference = |(at, &byte): (usize, &u8)| (mean(at) - f64::from(byte)).abs();
    small.iter().enumerate().map(difference).sum::<f64>() / small.len() as f64
}
