//! Exposure, tone curve and transfer: how a PNG shows the radiance that an EXR holds.

use super::*;
use envers::measure::Picture;

/// [`SPHERE`] with keys of its film, in light of which much is brighter than white.
fn bright(film: &str) -> Folder {
    let scene = SPHERE.replace("[film]", &format!("[film]\n{film}"));
    Folder::with(&(scene + "intensity = 4\n"))
}

/// Renders a PNG and an EXR in one run, and holds every byte of the one to the documented formula
/// of the other's floats.
#[track_caller]
fn agree(folder: &Folder, flags: &str, exposure: f64, tone: fn(f64) -> f64, curve: fn(f64) -> f64) {
    agree_in_color(folder, flags, exposure, move |color| color.map(tone), curve);
}

/// The same for a tone curve that looks at the whole colour.
#[track_caller]
fn agree_in_color(
    folder: &Folder,
    flags: &str,
    exposure: f64,
    tone: impl Fn([f64; 3]) -> [f64; 3],
    curve: fn(f64) -> f64,
) {
    folder.run(&format!("render scene.toml {flags} -o a.png -o a.exr")).good();
    let (_, bytes) = pixels(&folder.read("a.png"));
    let exr = Picture::read(&folder.path("a.exr")).unwrap();
    let order = ["R", "G", "B"].map(|name| exr.channels.iter().position(|c| c == name).unwrap());
    let radiance: Vec<f64> =
        exr.values.chunks(3).flat_map(|pixel| order.map(|i| f64::from(pixel[i]))).collect();
    assert!(radiance.iter().any(|&x| x > 2.0) && radiance.iter().any(|&x| x < 0.1));
    assert_eq!(bytes.len(), radiance.len());
    for (bytes, color) in bytes.chunks(3).zip(radiance.chunks(3)) {
        let toned = tone([0, 1, 2].map(|i| exposure.exp2() * color[i]));
        let expected = toned.map(|x| (255.0 * curve(x)).round());
        assert_eq!([0, 1, 2].map(|i| f64::from(bytes[i])), expected, "of radiance {color:?}");
    }
}

fn clamp(x: f64) -> f64 {
    x.min(1.0)
}

fn reinhard(x: f64) -> f64 {
    x / (1.0 + x)
}

fn aces(x: f64) -> f64 {
    (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).min(1.0)
}

fn linear(x: f64) -> f64 {
    x
}

fn srgb(x: f64) -> f64 {
    if x <= 0.0031308 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

#[test]
fn without_a_tone_curve_png_and_exr_agree_by_the_formula() {
    agree(&bright(""), "", 0.0, clamp, srgb);
    agree(&bright("transfer = \"none\""), "", 0.0, clamp, linear);
}

#[test]
fn with_reinhards_curve_png_and_exr_agree_by_the_formula() {
    agree(&bright("tone = \"reinhard\""), "", 0.0, reinhard, srgb);
    agree(&bright("tone = \"reinhard\"\ntransfer = \"none\""), "", 0.0, reinhard, linear);
}

#[test]
fn with_the_curve_of_aces_png_and_exr_agree_by_the_formula() {
    agree(&bright("tone = \"aces\""), "", 0.0, aces, srgb);
    agree(&bright("tone = \"aces\"\ntransfer = \"none\""), "", 0.0, aces, linear);
}

/// Khronos PBR Neutral, written from its specification.
fn neutral(color: [f64; 3]) -> [f64; 3] {
    let least = color.into_iter().fold(f64::MAX, f64::min);
    let offset = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let color = color.map(|x| x - offset);
    let peak = color.into_iter().fold(0.0, f64::max);
    if peak < 0.76 {
        return color;
    }
    let new_peak = 1.0 - 0.24 * 0.24 / (peak + 0.24 - 0.76);
    let white = 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0);
    color.map(|x| {
        let compressed = x * new_peak / peak;
        compressed + (new_peak - compressed) * white
    })
}

#[test]
fn with_khronos_pbr_neutral_png_and_exr_agree_by_the_formula() {
    agree_in_color(&bright("tone = \"khronos-pbr-neutral\""), "", 0.0, neutral, srgb);
    agree_in_color(&bright(""), "--tone khronos-pbr-neutral --exposure 1", 1.0, neutral, srgb);
}

#[test]
fn agx_shows_what_is_brighter_than_white_without_clipping() {
    let folder = bright("");
    folder.run("render scene.toml --tone agx -o agx.png -o clipped.exr").good();
    folder.run("render scene.toml -o none.png").good();
    let [agx, none] = ["agx.png", "none.png"].map(|name| pixels(&folder.read(name)).1);
    let clipped = |bytes: &[u8]| bytes.iter().filter(|byte| **byte == 255).count();
    assert!(clipped(&none) > 100 && clipped(&agx) == 0);
}

#[test]
fn with_the_scenes_exposure_png_and_exr_agree_by_the_formula() {
    agree(&bright("exposure = -1.7\ntone = \"aces\""), "", -1.7, aces, srgb);
}

#[test]
fn the_flags_come_before_the_scene() {
    let folder = bright("exposure = 3\ntone = \"aces\"");
    agree(&folder, "--exposure -0.5 --tone reinhard", -0.5, reinhard, srgb);
    agree(&folder, "--exposure 0 --tone none", 0.0, clamp, srgb);
}

#[test]
fn exposure_and_tone_never_change_the_radiance_of_an_exr() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml -o plain.exr").good();
    folder.run("render scene.toml --exposure 3 --tone aces -o a.png -o other.exr").good();
    folder.run("diff plain.exr other.exr").good();
}

#[test]
fn an_exr_names_what_determines_its_png() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml --exposure 1.5 --tone aces -o a.png -o a.exr").good();
    let text = String::from_utf8_lossy(&folder.read("a.exr")).into_owned();
    assert!(text.contains("png_exposure: 1.5\npng_tone: aces\npng_transfer: srgb"));
}

#[test]
fn the_greatest_exposure_leaves_black_black() {
    let folder = Folder::with(&SPHERE.replace("background = \"#203040\"\n", ""));
    folder.run("render scene.toml --exposure 1e300 -o a.png").good();
    let (_, bytes) = pixels(&folder.read("a.png"));
    assert!(bytes[..3] == [0; 3] && bytes.iter().all(|&b| b == 0 || b == 255));
    assert!(bytes.contains(&255));
}
