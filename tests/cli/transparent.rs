//! `--transparent`: alpha in the files that can have it, and refusals of those that cannot.

use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use image::{AnimationDecoder, ImageFormat};

use super::*;

/// A disc of radiance (0.5, 0.25, 1) in the middle, before a background.
const DISC: &str = r##"
[film]
size = [64, 48]
spp = 9
background = "#a0b0c0"

[camera]
position = [0, 0, 9]
look_at = [0, 0, 0]
ortho_height = 4

[[material]]
name = "lamp"
diffuse = 0
emission = [0.5, 0.25, 1]

[[sphere]]
name = "ball"
center = [0, 0, 0]
radius = 1.23
material = "lamp"
"##;

/// The RGBA bytes of a picture that has alpha.
#[track_caller]
fn rgba(folder: &Folder, name: &str, format: ImageFormat) -> Vec<[u8; 4]> {
    let image = image::load_from_memory_with_format(&folder.read(name), format).unwrap();
    assert!(image.color().has_alpha(), "{name}");
    image.into_rgba8().into_raw().as_chunks::<4>().0.to_vec()
}

/// The bytes of the lamp as a PNG shows it where nothing else is seen.
fn lamp() -> [u8; 3] {
    [188, 137, 255]
}

#[test]
fn png_and_webp_have_straight_alpha() {
    let folder = Folder::with(DISC);
    folder.run("render scene.toml -o a.png -o a.webp --transparent").good();
    let png = rgba(&folder, "a.png", ImageFormat::Png);
    assert_eq!(rgba(&folder, "a.webp", ImageFormat::WebP), png);
    assert_eq!((png[0], png[24 * 64 + 32]), ([0; 4], [188, 137, 255, 255]));
    assert!(png.iter().any(|p| p[3] > 0 && p[3] < 255), "an edge");
    assert!(png.iter().all(|&[r, g, b, a]| a == 0 || [r, g, b] == lamp()));
    assert!(png.iter().all(|&p| p[3] > 0 || p == [0; 4]));
}

#[test]
fn an_exr_has_premultiplied_alpha() {
    let folder = Folder::with(DISC);
    for flag in ["", "--half"] {
        folder.run(&format!("render scene.toml -o a.exr --transparent {flag}")).good();
        let image = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(folder.path("a.exr"))
            .unwrap();
        let list = &image.layer_data.channel_data.list;
        let names: Vec<String> = list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names, ["A", "B", "G", "R"]);
        assert_eq!(matches!(list[0].sample_data, FlatSamples::F16(_)), !flag.is_empty());
        let values = |i: usize| list[i].sample_data.values_as_f32().collect::<Vec<f32>>();
        let [alpha, blue, green, red] = [0, 1, 2, 3].map(values);
        assert!(alpha.iter().any(|&a| a > 0.0 && a < 1.0), "an edge");
        for (i, a) in alpha.iter().enumerate() {
            for (value, color) in [(red[i], 0.5), (green[i], 0.25), (blue[i], 1.0)] {
                assert!((value - a * color).abs() <= 1e-3 * color, "{value} at alpha {a}");
            }
        }
        let text = String::from_utf8_lossy(&folder.read("a.exr")).into_owned();
        assert!(text.contains("transparent: true"));
    }
}

#[test]
fn an_animated_png_has_the_alpha_of_its_frames() {
    let orbit = "object = \"ball\"\naround = [0.5, 0, 0]\naxis = [0, 0, 1]\nperiod = 2\n";
    let scene = format!("{DISC}\n[animation]\nframes = 4\nfps = 2\n[[animation.orbit]]\n{orbit}");
    let folder = Folder::with(&scene);
    folder.run("render scene.toml -o a.apng -o f#.png --transparent").good();
    let decoder = image::codecs::png::PngDecoder::new(std::io::Cursor::new(folder.read("a.apng")));
    let frames = decoder.unwrap().apng().unwrap().into_frames().collect_frames().unwrap();
    assert_eq!(frames.len(), 4);
    let mut before = Vec::new();
    for (i, frame) in (1..).zip(&frames) {
        let shown = frame.buffer().as_chunks::<4>().0.to_vec();
        assert_eq!(shown, rgba(&folder, &format!("f{i}.png"), ImageFormat::Png), "frame {i}");
        assert_ne!(shown, before, "frame {i} moves");
        before = shown;
    }
}

#[test]
fn the_scene_file_can_ask_for_it_too() {
    let folder = Folder::with(DISC);
    folder.run("render scene.toml -o flag.png --transparent").good();
    folder.write("key.toml", DISC.replace("spp = 9", "spp = 9\ntransparent = true"));
    folder.run("render key.toml -o key.png").good();
    assert_eq!(folder.read("flag.png"), folder.read("key.png"));
}

#[test]
fn without_it_a_picture_has_no_alpha() {
    let folder = Folder::with(DISC);
    folder.run("render scene.toml -o a.png").good();
    let image = image::load_from_memory(&folder.read("a.png")).unwrap();
    assert!(!image.color().has_alpha());
}

#[test]
fn a_jpeg_or_gif_of_a_transparent_picture_is_refused_before_it_is_rendered() {
    let orbit = "[animation]\nframes = 4\nfps = 2\n[[animation.orbit]]\nobject = \"ball\"\n\
                 around = [0.5, 0, 0]\nperiod = 2\n";
    let endless = DISC.replace("size = [64, 48]\nspp = 9", "size = [4096, 4096]\nspp = 65536");
    let folder = Folder::with(&format!("{endless}\n{orbit}"));
    folder.write("key.toml", endless.replace("[film]", "[film]\ntransparent = true"));
    for (arguments, format, instead) in [
        ("scene.toml --transparent -o b.png -o a.jpg", "a JPEG has no alpha", ".webp"),
        ("scene.toml --transparent -o a.gif", "a GIF has no alpha", ".apng"),
        ("key.toml -o a.jpeg", "a JPEG has no alpha", ".webp"),
    ] {
        let message = folder.run(&format!("render {arguments}")).refused();
        assert!(message.contains(format) && message.contains(instead), "{message}");
    }
    assert_eq!(folder.names(), ["key.toml", "scene.toml"]);
}

#[test]
fn a_debug_view_refuses_the_flag_and_ignores_the_key() {
    let folder = Folder::with(&DISC.replace("spp = 9", "spp = 9\ntransparent = true"));
    let message = folder.run("render scene.toml -o a.png --view normal --transparent").refused();
    assert!(message.contains("--transparent applies to the beauty view only"), "{message}");
    folder.run("render scene.toml -o a.png -o a.jpg --view normal").good();
    assert!(!image::load_from_memory(&folder.read("a.png")).unwrap().color().has_alpha());
}

#[test]
fn diff_compares_alpha_and_takes_a_picture_without_it_as_opaque() {
    let folder = Folder::with(DISC);
    folder.run("render scene.toml -o a.png -o a.webp -o a.exr --transparent").good();
    folder.run("diff a.png a.webp").good();
    folder.run("diff a.exr a.exr").good();
    // The same colours, and other alpha in one pixel.
    let mut image = image::load_from_memory(&folder.read("a.png")).unwrap().into_rgba8();
    image.get_pixel_mut(32, 24).0[3] = 204;
    image.save(folder.path("b.png")).unwrap();
    let run = folder.run("diff a.png b.png --json - --heatmap heat.png");
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    let json = run.json();
    assert_eq!(json["pixels_differing"], 1);
    assert!((json["max"].as_f64().unwrap() - 0.2).abs() < 1e-6, "{json}");
    assert!(json["flip"].as_f64().unwrap() > 0.0, "{json}");
    // A ball that covers the picture is as opaque as one without alpha.
    folder.write("near.toml", DISC.replace("radius = 1.23", "radius = 8"));
    folder.run("render near.toml -o near.png -o near.exr --transparent").good();
    folder.run("render near.toml -o opaque.png -o opaque.exr").good();
    folder.run("diff near.png opaque.png").good();
    folder.run("diff opaque.exr near.exr").good();
}

#[test]
#[cfg(feature = "embree")]
fn validate_compares_alpha_too() {
    let folder = Folder::with(&DISC.replace("spp = 9", "spp = 9\ntransparent = true"));
    let json = folder.run("validate scene.toml --precision certified --json -").good().json();
    assert_eq!((&json["passed"], &json["values_differing"]), (&true.into(), &0.into()));
}
