//! JPEG and WebP beside PNG: written, limited and compared.

use image::ImageFormat;

use super::*;

/// The RGB bytes of a picture of 64 × 48 pixels.
#[track_caller]
fn decoded(folder: &Folder, name: &str, format: ImageFormat) -> Vec<u8> {
    let image = image::load_from_memory_with_format(&folder.read(name), format).unwrap();
    assert_eq!((image.width(), image.height()), (64, 48));
    image.into_rgb8().into_raw()
}

/// The largest and the root-mean-square difference of bytes.
fn difference(a: &[u8], b: &[u8]) -> (u8, f64) {
    assert_eq!(a.len(), b.len());
    let differences = || a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
    let squares: f64 = differences().map(|d| f64::from(d).powi(2)).sum();
    (differences().max().unwrap(), (squares / a.len() as f64).sqrt())
}

#[test]
fn a_webp_has_the_pixels_of_the_png() {
    let folder = Folder::with_everything();
    for view in ["beauty", "normal", "depth", "id"] {
        let render = "render scene.toml --size 64x48 -o a.png -o a.webp";
        folder.run(&format!("{render} --view {view}")).good();
        let webp = decoded(&folder, "a.webp", ImageFormat::WebP);
        assert_eq!(webp, decoded(&folder, "a.png", ImageFormat::Png), "{view}");
    }
}

/// At quality 100 the coefficients of a block's cosine transform are rounded to whole numbers. They are
/// then off by at most 1/2 each, and a pixel, which is a sum of 64 of them with weights whose squares add
/// up to 1, by at most 4. The rounding to Y, Cb and Cr before and after adds 1/2 each. Blue is
/// Y + 1.772 Cb: at most 5 · 2.772 < 14. As independent errors of 1/√12 each, the three roundings make
/// 1/2 in each component, and √(1 + 1.772²)/2 < 1.02 in blue; with the rounding of blue itself 1.06.
#[test]
fn a_jpeg_of_quality_100_has_nearly_the_pixels_of_the_png() {
    let folder = Folder::with_everything();
    for view in ["beauty", "normal", "depth", "id"] {
        let render = "render scene.toml --size 64x48 -o a.png -o a.jpg --quality 100";
        folder.run(&format!("{render} --view {view}")).good();
        let [png, jpeg] = [("a.png", ImageFormat::Png), ("a.jpg", ImageFormat::Jpeg)]
            .map(|(name, format)| decoded(&folder, name, format));
        let (max, rms) = difference(&png, &jpeg);
        assert!(max <= 14 && rms <= 1.06, "{view}: at most {max}, root mean square {rms}");
    }
}

#[test]
fn a_lower_quality_makes_a_smaller_jpeg_that_is_farther_from_the_pixels() {
    let folder = Folder::with_everything();
    let render = "render scene.toml --size 64x48";
    folder.run(&format!("{render} -o a.png -o default.jpeg")).good();
    let png = decoded(&folder, "a.png", ImageFormat::Png);
    let of_quality = |quality: u32| {
        folder.run(&format!("{render} -o a.jpg --quality {quality}")).good();
        let (_, rms) = difference(&png, &decoded(&folder, "a.jpg", ImageFormat::Jpeg));
        (folder.read("a.jpg").len(), rms)
    };
    let [low, middle, high] = [20, 90, 100].map(of_quality);
    assert!(low.0 < middle.0 && middle.0 < high.0, "{low:?} {middle:?} {high:?}");
    assert!(low.1 > middle.1 && middle.1 > high.1, "{low:?} {middle:?} {high:?}");
    of_quality(90);
    assert_eq!(folder.read("default.jpeg"), folder.read("a.jpg"));
}

#[test]
fn frames_are_jpegs_and_webps_too() {
    let folder = Folder::with(&moving());
    folder.run("render scene.toml --frames 9-10 -o f##.jpg -o f##.webp").good();
    let expected = ["f09.jpg", "f09.webp", "f10.jpg", "f10.webp", "scene.toml"];
    assert_eq!(folder.names(), expected);
    decoded(&folder, "f10.jpg", ImageFormat::Jpeg);
    decoded(&folder, "f10.webp", ImageFormat::WebP);
}

#[test]
fn a_quality_out_of_range_is_refused() {
    let folder = Folder::with(&endless());
    for bad in ["0", "101", "-1", "high"] {
        folder.run(&format!("render scene.toml -o a.jpg --quality {bad}")).refused();
    }
}

#[test]
fn a_picture_too_large_for_its_format_is_refused_before_it_is_rendered() {
    let folder = Folder::with(&endless());
    let refused = |arguments: &str| folder.run(&format!("render scene.toml {arguments}")).refused();
    let message = refused("--size 16384x16 -o a.webp");
    assert!(message.contains("16384x16") && message.contains("16383"), "{message}");
    let message = refused("--size 16x65536 -o a.png -o a.jpg");
    assert!(message.contains("16x65536") && message.contains("65535"), "{message}");
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
fn the_largest_sides_of_jpeg_and_webp_are_written() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml --size 65535x1 -o a.jpg --threads 1").good();
    folder.run("render scene.toml --size 16383x1 -o a.webp --threads 1").good();
    let width = |name, format| {
        image::load_from_memory_with_format(&folder.read(name), format).unwrap().width()
    };
    assert_eq!(width("a.jpg", ImageFormat::Jpeg), 65535);
    assert_eq!(width("a.webp", ImageFormat::WebP), 16383);
}

#[test]
fn diff_compares_png_jpeg_and_webp_with_each_other() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml -o a.png -o a.webp -o a.jpg -o a.exr --quality 60").good();
    folder.run("diff a.png a.webp").good();
    let run = folder.run("diff a.jpg a.webp --json -");
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    let json = run.json();
    let (_, rms) = difference(
        &decoded(&folder, "a.jpg", ImageFormat::Jpeg),
        &decoded(&folder, "a.webp", ImageFormat::WebP),
    );
    let rmse = json["rmse"].as_f64().unwrap();
    assert!((rmse * 255.0 - rms).abs() < 1e-4, "{rmse} and {rms}");
    assert!(json["flip"].is_f64());
    for pair in ["a.exr a.webp", "a.jpg a.exr"] {
        let message = folder.run(&format!("diff {pair}")).refused();
        assert!(message.contains("an EXR can be compared with an EXR only"), "{message}");
    }
}

#[test]
fn a_damaged_jpeg_or_webp_is_an_error_in_the_input() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml -o a.webp -o a.jpg").good();
    for name in ["a.webp", "a.jpg"] {
        folder.write(name, &folder.read(name)[..99]);
        let message = folder.run(&format!("diff {name} {name}")).refused();
        assert!(message.contains(name), "{message}");
    }
}
