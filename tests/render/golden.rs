//! Small pictures of every scene in `assets/scenes/`, against those committed in `tests/golden/`,
//! through every backend of this build: no channel of any pixel may differ by more than 1 of 255.
//!
//! `ENVERS_BLESS=1 cargo test --test render golden` writes them anew, and fails all the same: look at
//! them, and run the tests again without it. On a mismatch, `target/golden-failures/` shows the
//! expected picture, the difference and the actual one side by side.

use std::path::{Path, PathBuf};

use envers::internals::{Settings, png_bytes};
use envers::{Backend, LoadOptions, RenderOptions, Renderer};
use image::{Rgb, RgbImage};

/// The most that a channel may differ, of 255.
const TOLERANCE: u8 = 1;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Renders `assets/scenes/NAME.toml` small.
fn picture(name: &str, [width, height]: [u32; 2], spp: u32, backend: Backend) -> RgbImage {
    let path = root().join("assets/scenes").join(name).with_extension("toml");
    let mut scene =
        LoadOptions::default().size([width, height]).load(&path).expect("the scene loads").scene;
    scene.film.spp = spp;
    let options = RenderOptions { backend: Some(backend), ..RenderOptions::default() };
    let film =
        Renderer::new(&scene).options(options.clone()).render().expect("the scene renders").film;
    let settings = Settings::from_film(&scene.film);
    RgbImage::from_raw(width, height, png_bytes(&film, &settings)).expect("ok: three bytes a pixel")
}

/// Holds a scene to its golden picture, through one backend.
fn compare(name: &str, golden: &Path, actual: &RgbImage, backend: &str) -> Result<(), String> {
    let expected = image::open(golden)
        .map_err(|e| {
            let golden = golden.display();
            format!("{golden}: {e}\nENVERS_BLESS=1 makes it; then look at it")
        })?
        .into_rgb8();
    if expected.dimensions() != actual.dimensions() {
        return Err(format!("{}: the golden picture is of another size", golden.display()));
    }
    let differences = || {
        let pixels = expected.pixels().zip(actual.pixels());
        pixels.map(|(a, b)| [0, 1, 2].map(|i| a[i].abs_diff(b[i])))
    };
    let over = differences().filter(|d| d.iter().any(|&d| d > TOLERANCE)).count();
    if over == 0 {
        return Ok(());
    }
    let largest = differences().flatten().max().unwrap_or(0);
    let triptych = triptych(&expected, actual);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("golden-failures");
    let file = folder.join(format!("{}-{backend}.png", name.replace('/', "-")));
    std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
    triptych.save(&file).map_err(|e| e.to_string())?;
    Err(format!(
        "{over} pixels of {name} differ with {backend}, by at most {largest} of 255: expected, \
         difference and actual are in {}",
        file.display()
    ))
}

/// Expected, difference and actual side by side; differences are magnified, so that 1 shows.
fn triptych(expected: &RgbImage, actual: &RgbImage) -> RgbImage {
    let (width, height) = expected.dimensions();
    RgbImage::from_fn(3 * width, height, |x, y| {
        let (a, b) = (expected.get_pixel(x % width, y), actual.get_pixel(x % width, y));
        match x / width {
            0 => *a,
            1 => Rgb([0, 1, 2].map(|i| a[i].abs_diff(b[i]).saturating_mul(32))),
            _ => *b,
        }
    })
}

/// One scene, through all backends of this build.
fn check(name: &str, size: [u32; 2], spp: u32) {
    let golden: PathBuf = root().join("tests/golden").join(name.replace('/', "-") + ".png");
    let rust = picture(name, size, spp, Backend::Rust);
    if std::env::var_os("ENVERS_BLESS").is_some() {
        rust.save(&golden).expect("the golden picture can be written");
        panic!("{} is written: look at it, and run again without ENVERS_BLESS", golden.display());
    }
    // Where there is no Embree the default is the same backend once more.
    let default = picture(name, size, spp, Backend::default());
    let results = [("rust", rust), ("default", default)];
    let failures: Vec<String> = results
        .into_iter()
        .filter_map(|(backend, picture)| compare(name, &golden, &picture, backend).err())
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn far() {
    check("tutorial/2-2-far", [80, 80], 1);
}

#[test]
fn circle() {
    check("tutorial/3-1-circle", [160, 80], 1);
}

#[test]
fn lambert() {
    check("tutorial/3-2-lambert", [160, 80], 1);
}

#[test]
fn phong() {
    check("tutorial/3-3-phong", [160, 80], 1);
}

#[test]
fn first_frame_of_the_orbit() {
    check("tutorial/6-4-orbit", [160, 80], 4);
}

#[test]
fn alpha_10() {
    check("tutorial/3-3-alpha-10", [160, 80], 1);
}

#[test]
fn alpha_30() {
    check("tutorial/3-3-alpha-30", [160, 80], 1);
}

#[test]
fn alpha_100() {
    check("tutorial/3-3-alpha-100", [160, 80], 1);
}

#[test]
fn two_spheres_without_shadows() {
    check("tutorial/4-0-two-spheres", [160, 80], 4);
}

#[test]
fn shadows() {
    check("tutorial/4-1-shadows", [160, 80], 4);
}

#[test]
fn recursion() {
    check("tutorial/4-2-recursion", [160, 80], 4);
}

#[test]
fn reflections() {
    check("tutorial/4-2-reflections", [160, 80], 4);
}

#[test]
fn two_mirrors() {
    check("tutorial/4-2-two-mirrors", [160, 80], 4);
}

#[test]
fn bodies() {
    check("tutorial/4-3-bodies", [160, 80], 4);
}

#[test]
fn transparency() {
    check("tutorial/4-3-transparency", [160, 80], 4);
}

#[test]
fn plane() {
    check("tutorial/5-plane", [160, 80], 4);
}

#[test]
fn texture_on_planes() {
    check("tutorial/5-texture", [160, 80], 4);
}

#[test]
fn water() {
    check("tutorial/5-water", [160, 80], 4);
}

#[test]
fn broken_stick() {
    check("tutorial/6-1-broken-stick", [160, 80], 4);
}

#[test]
fn classes() {
    check("tutorial/6-2-classes", [160, 80], 4);
}

#[test]
fn terms_of_phong() {
    check("tutorial/6-3-phong-terms", [160, 80], 4);
}

#[test]
fn room() {
    check("room", [160, 90], 4);
}

#[test]
fn vase() {
    check("vase", [160, 90], 4);
}

/// A scene added to `assets/scenes/` needs a golden picture.
#[test]
fn every_scene_has_a_golden_picture() {
    for (folder, prefix) in [("assets/scenes", ""), ("assets/scenes/tutorial", "tutorial-")] {
        for entry in std::fs::read_dir(root().join(folder)).expect("the folder is there") {
            let path = entry.expect("the folder can be read").path();
            if path.extension().is_none_or(|e| e != "toml") {
                continue;
            }
            let stem = path.file_stem().expect("ok: it has an extension").display();
            let golden = root().join(format!("tests/golden/{prefix}{stem}.png"));
            assert!(golden.exists(), "{} is missing", golden.display());
        }
    }
}
