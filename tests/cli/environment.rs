//! `--environment`, `[environment]`, `--ao` and `--shading`: what they change, and what they refuse.

use image::{ImageFormat, Rgb32FImage};

use super::*;

/// A mirror ball, seen by a camera before a grey background.
const BALL: &str = r##"
[film]
size = [32, 24]
background = 0.25

[camera]
position = [0, 0, 5]
look_at = [0, 0, 0]

[[material]]
name = "mirror"
diffuse = 0
reflect = 1

[[sphere]]
center = [0, 0, 0]
radius = 1
material = "mirror"
"##;

/// The bytes of a map of one radiance, red in its left half and green in the other.
fn map(format: ImageFormat, radiance: f32) -> Vec<u8> {
    let map = Rgb32FImage::from_fn(64, 32, |x, _| {
        image::Rgb(if x < 32 { [radiance, 0.0, 0.0] } else { [0.0, radiance, 0.0] })
    });
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::DynamicImage::ImageRgb32F(map).write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// The pixels of a PNG, row by row.
fn png_pixels(folder: &Folder, name: &str) -> Vec<[u8; 3]> {
    let png = image::load_from_memory(&folder.read(name)).unwrap().into_rgb8();
    png.into_raw().as_chunks::<3>().0.to_vec()
}

#[test]
fn a_map_in_hdr_or_exr_is_seen_by_camera_rays_and_in_mirrors() {
    let folder = Folder::with(BALL);
    for (name, format) in [("a.hdr", ImageFormat::Hdr), ("a.exr", ImageFormat::OpenExr)] {
        folder.write(name, map(format, 0.5));
        folder.run(&format!("render scene.toml -o a.png --environment {name} -q")).good();
        let seen = png_pixels(&folder, "a.png");
        // Straight ahead is −z, a quarter from the left; +z behind the camera is in the other half.
        assert_eq!((seen[0], seen[12 * 32 + 16]), ([188, 0, 0], [0, 188, 0]), "{name}");
    }
}

#[test]
fn a_scene_file_names_its_environment() {
    let with = |table: &str| format!("{BALL}\n[environment]\n{table}\n");
    let folder = Folder::with(&with("file = \"a.hdr\"\nintensity = 0.5\nvisible = false"));
    folder.write("a.hdr", map(ImageFormat::Hdr, 1.0));
    folder.run("render scene.toml -o a.png -q").good();
    let seen = png_pixels(&folder, "a.png");
    // 0.25 is 137 in sRGB, and 0.5 is 188.
    assert_eq!((seen[0], seen[12 * 32 + 16]), ([137; 3], [0, 188, 0]));
    // Turned by half, the mirror shows the other half.
    folder.write("scene.toml", with("file = \"a.hdr\"\nintensity = 0.5\nrotation = 180"));
    folder.run("render scene.toml -o a.png -q").good();
    let seen = png_pixels(&folder, "a.png");
    assert_eq!((seen[0], seen[12 * 32 + 16]), ([0, 188, 0], [188, 0, 0]));
    // The flag comes before the file's own.
    folder.run("render scene.toml -o a.png --environment none -q").good();
    assert_eq!(png_pixels(&folder, "a.png")[0], [137; 3]);
}

#[test]
fn a_built_in_environment_lights_what_a_scene_has() {
    for built_in in ["studio", "sky"] {
        let scene = BALL.replace("reflect = 1", "").replace("diffuse = 0", "diffuse = 0.8");
        let folder = Folder::with(&scene);
        folder.run(&format!("render scene.toml -o a.png --environment {built_in} -q")).good();
        let lit = png_pixels(&folder, "a.png");
        assert!(lit[12 * 32 + 16].iter().all(|x| *x > 60), "{built_in}: {:?}", lit[12 * 32 + 16]);
        folder.write("scene.toml", format!("{scene}\n[environment]\nbuilt_in = \"{built_in}\"\n"));
        folder.run("render scene.toml -o b.png -q").good();
        // Its own environment is visible; a studio that the flag asks for is not.
        assert_eq!(png_pixels(&folder, "b.png")[12 * 32 + 16], lit[12 * 32 + 16], "{built_in}");
    }
}

#[test]
fn a_map_that_cannot_be_read_is_an_error_that_names_it() {
    let folder = Folder::with(BALL);
    assert!(
        folder.run("render scene.toml -o a.png --environment b.hdr").refused().contains("b.hdr")
    );
    for (name, format) in [("a.hdr", ImageFormat::Hdr), ("a.exr", ImageFormat::OpenExr)] {
        let whole = map(format, 1.0);
        folder.write(name, &whole[..whole.len() * 2 / 3]);
        let run = folder.run(&format!("render scene.toml -o a.png --environment {name}"));
        assert!(run.refused().contains(name));
    }
    folder.write("a.hdr", b"#?RADIANCE\n");
    assert!(
        folder.run("render scene.toml -o a.png --environment a.hdr").refused().contains("a.hdr")
    );
    assert!(!folder.path("a.png").exists());
}

#[test]
fn values_of_a_map_that_are_no_radiance_become_0_with_a_warning() {
    let folder = Folder::with(BALL);
    let map = |value: f32| {
        let map = Rgb32FImage::from_fn(8, 4, |x, _| {
            image::Rgb(if x == 0 { [f32::NAN; 3] } else { [value; 3] })
        });
        let mut bytes = std::io::Cursor::new(Vec::new());
        let map = image::DynamicImage::ImageRgb32F(map);
        map.write_to(&mut bytes, ImageFormat::OpenExr).unwrap();
        bytes.into_inner()
    };
    folder.write("a.exr", map(1.0));
    let run = folder.run("render scene.toml -o a.png --environment a.exr");
    let warning = "12 values of the environment map are negative or not finite and become 0";
    assert!(run.status == Some(0) && run.stderr.contains(warning), "{}", run.stderr);
    folder.write("a.exr", map(f32::INFINITY));
    let run = folder.run("render scene.toml -o a.png --environment a.exr");
    assert!(run.refused().contains("no pixel of the environment map is a finite radiance"));
}

#[test]
fn a_rough_floor_under_a_ball_is_darker_with_ambient_occlusion() {
    let scene = format!(
        "{BALL}\n[[plane]]\npoint = [0, -1, 0]\nnormal = [0, 1, 0]\n[environment]\ncolor = 1\n"
    );
    let folder = Folder::with(&scene);
    let darkest = |flags: &str| {
        folder.run(&format!("render scene.toml -o a.png -q {flags}")).good();
        png_pixels(&folder, "a.png").iter().map(|p| p[1]).min().unwrap()
    };
    let (open, occluded) = (darkest(""), darkest("--ao 16"));
    assert!(occluded + 20 < open, "{occluded} {open}");
    assert!(folder.run("render scene.toml --ao 1025").refused().contains("1025"));
}

#[test]
fn a_model_is_shaded_by_phong_if_that_is_asked_for() {
    let folder = Folder::with(BALL);
    folder.write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    folder.write("m.mtl", "newmtl a\nKd 0.8 0.8 0.8\nPr 0.3\nPm 1\n");
    let render = |flags: &str| {
        folder.run(&format!("render m.obj -o a.png -q --size 32 {flags}")).good();
        folder.read("a.png")
    };
    assert_ne!(render(""), render("--shading phong"));
    assert_eq!(render(""), render("--shading pbr"));
    assert!(folder.run("render m.obj --shading toon").refused().contains("toon"));
}
