//! `envers render` of many frames.

use image::AnimationDecoder;

use super::*;

/// The delays in milliseconds and the pictures of a GIF.
fn gif(bytes: Vec<u8>) -> Vec<(u32, Vec<u8>)> {
    let decoder = image::codecs::gif::GifDecoder::new(std::io::Cursor::new(bytes)).unwrap();
    let frames = decoder.into_frames().collect_frames().unwrap();
    let read = |frame: image::Frame| {
        let (numerator, denominator) = frame.delay().numer_denom_ms();
        assert_eq!(numerator % denominator, 0);
        (numerator / denominator, frame.into_buffer().into_raw())
    };
    frames.into_iter().map(read).collect()
}

#[test]
fn a_plain_render_is_the_first_frame() {
    let folder = Folder::with(&moving());
    folder.run("render scene.toml -o plain.png").good();
    folder.run("render scene.toml --frames 1 -o first.png").good();
    folder.run("render scene.toml --frames 2 -o second.png").good();
    assert_eq!(folder.read("plain.png"), folder.read("first.png"));
    assert_ne!(folder.read("plain.png"), folder.read("second.png"));
}

#[test]
fn frames_are_files_with_their_numbers() {
    let folder = Folder::with(&moving());
    let run = folder.run("render scene.toml --frames 1-9x4 -o f-###.png").good();
    assert_eq!(folder.names(), ["f-001.png", "f-005.png", "f-009.png", "scene.toml"]);
    assert!(run.stdout.starts_with("f-###.png: 3 frames ("), "{}", run.stdout);
}

#[test]
fn a_name_with_a_number_has_all_frames() {
    let folder = Folder::with(&moving());
    folder.run("render scene.toml -o f#.png -o f#.exr").good();
    assert!(folder.has("f1.png") && folder.has("f10.png") && folder.has("f10.exr"));
    assert_eq!(folder.names().len(), 21);
}

#[test]
fn many_frames_without_an_output_are_numbered() {
    let folder = Folder::with(&moving());
    folder.run("render scene.toml --frames 9-10").good();
    assert_eq!(folder.names(), ["scene-0009.png", "scene-0010.png", "scene.toml"]);
}

#[test]
fn a_number_in_the_name_of_a_still_picture_is_a_sign_like_any_other() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml -o C#.png").good();
    assert!(folder.has("C#.png"));
}

#[test]
fn a_gif_has_all_frames_at_their_speed() {
    let folder = Folder::with(&moving());
    folder.run("render scene.toml -o a.gif").good();
    let frames = gif(folder.read("a.gif"));
    assert_eq!(frames.iter().map(|(delay, _)| *delay).collect::<Vec<_>>(), [200; 10]);
    assert_ne!(frames[0].1, frames[5].1);
}

#[test]
fn a_gif_of_every_second_frame_is_as_long() {
    let folder = Folder::with(&moving());
    folder.run("render scene.toml --frames 1-10x2 -o a.gif").good();
    let delays: Vec<u32> = gif(folder.read("a.gif")).iter().map(|(delay, _)| *delay).collect();
    assert_eq!(delays, [400; 5]);
}

#[test]
fn an_animated_png_has_the_pixels_of_its_frames() {
    let folder = Folder::with(&moving());
    folder.run("render scene.toml -o a.apng -o f##.png").good();
    let decoder = image::codecs::png::PngDecoder::new(std::io::Cursor::new(folder.read("a.apng")));
    let frames = decoder.unwrap().apng().unwrap().into_frames().collect_frames().unwrap();
    assert_eq!(frames.len(), 10);
    for (i, frame) in (1..).zip(frames) {
        assert_eq!(frame.delay().numer_denom_ms(), (200, 1));
        let rgb = image::DynamicImage::ImageRgba8(frame.into_buffer()).into_rgb8().into_raw();
        assert_eq!(rgb, pixels(&folder.read(format!("f{i:02}.png"))).1, "frame {i}");
    }
}

#[test]
fn what_is_there_is_skipped() {
    let folder = Folder::with(&moving());
    folder.write("f2.png", "old");
    let run = folder.run("render scene.toml --frames 1-3 -o f#.png --skip-existing").good();
    assert_eq!(folder.read("f2.png"), b"old");
    assert!(folder.has("f1.png") && folder.has("f3.png"));
    assert!(run.stdout.ends_with("1 frame existed already\n"), "{}", run.stdout);
    let run = folder.run("render scene.toml --frames 1-3 -o f#.png --skip-existing").good();
    assert_eq!(run.stdout, "3 frames existed already\n");
}

#[test]
fn what_is_there_of_a_frame_is_left_alone_when_the_rest_is_made() {
    let folder = Folder::with(&moving());
    folder.write("f1.png", "old");
    folder.run("render scene.toml --frames 1 -o f#.png -o f#.exr --skip-existing").good();
    assert!(folder.has("f1.exr"));
    assert_eq!(folder.read("f1.png"), b"old");
}

#[test]
fn a_moment_between_frames_can_be_asked_for() {
    let folder = Folder::with(&moving());
    folder.run("render scene.toml --time 0.2 -o time.png").good();
    folder.run("render scene.toml --frames 2 -o frame.png").good();
    assert_eq!(folder.read("time.png"), folder.read("frame.png"));
}

#[test]
fn the_time_of_a_frame_stands_in_its_exr() {
    let folder = Folder::with(&moving());
    folder.run("render scene.toml --frames 2 -o f.exr").good();
    let text = folder.read("f.exr");
    assert!(text.windows(12).any(|bytes| bytes == b"\ntime: 0.2 s"));
}

#[test]
fn stats_are_those_of_all_frames() {
    let folder = Folder::with(&moving());
    let stats = folder.run("render scene.toml -o f#.png --stats -").good().json();
    assert_eq!((&stats["frames"], &stats["rays"]["primary"]), (&10.into(), &30720.into()));
}

#[test]
fn stats_say_that_a_mesh_was_built_once() {
    let folder = Folder::with(&moving());
    let scene = moving() + "[[model]]\nfile = \"tetrahedron.obj\"\n";
    folder.write("scene.toml", scene);
    folder.write("tetrahedron.obj", TETRAHEDRON);
    let stats = folder.run("render scene.toml -o f#.png --stats -").good().json();
    assert_eq!((&stats["build"]["meshes"], &stats["build"]["reused"]), (&1.into(), &9.into()));
}

#[test]
#[cfg(feature = "embree")]
fn stats_say_what_was_placed_again() {
    let folder = Folder::with(&moving());
    let scene = moving() + "[[model]]\nfile = \"tetrahedron.obj\"\nscale = 20\n";
    folder.write("scene.toml", scene);
    folder.write("tetrahedron.obj", TETRAHEDRON);
    let stats = folder.run("render scene.toml -o f#.png --stats -").good().json();
    let expected = serde_json::json!({
        "meshes": 1, "reused": 9, "bvh": "medium",
        "top_levels_built": 1, "top_levels_kept": 9,
        "instances_placed": 1, "instances_moved": 0, "spheres_moved": 9,
    });
    assert_eq!(stats["build"], expected);
}

#[test]
fn info_says_how_long_it_is_and_what_moves() {
    let folder = Folder::with(&moving());
    let said = folder.run("info scene.toml").good().stdout;
    let line = "animation  10 frames at 5 fps (2.000 s), moving: 1 sphere\n";
    assert!(said.contains(line), "{said}");
    let json = folder.run("info scene.toml --json -").good().json();
    assert_eq!(json["animation"]["frames"], 10);
}

#[test]
#[cfg(feature = "embree")]
fn validate_takes_one_moment() {
    let folder = Folder::with(&moving());
    folder.run("validate scene.toml").good();
    folder.run("validate scene.toml --time 0.7").good();
}

#[test]
fn several_frames_in_one_file_are_refused() {
    let folder = Folder::with(&moving());
    let said = folder.run("render scene.toml --frames 1-3 -o a.png").refused();
    assert!(
        said.contains("3 frames cannot all be written to this file") && said.contains("####"),
        "{said}"
    );
    let said = folder.run("render scene.toml -o f#.png -o f##.png").refused();
    assert!(said.contains("would have the same name"), "{said}");
}

/// The message of an animation that is refused before its first frame is written.
#[track_caller]
fn refused_before_the_first_frame(folder: &Folder, ended: fn(Run) -> String) -> String {
    let before = folder.names();
    let message = ended(folder.run("render scene.toml -o f##.png"));
    assert_eq!(folder.names(), before, "{message}");
    message
}

#[test]
fn a_folder_in_the_place_of_the_last_frame_is_refused() {
    let folder = Folder::with(&moving());
    std::fs::create_dir(folder.path("f10.png")).unwrap();
    let message = refused_before_the_first_frame(&folder, Run::refused);
    assert!(message.contains("f10.png: the output is a folder"), "{message}");
}

#[test]
fn a_later_frame_that_is_read_only_fails() {
    let folder = Folder::with(&moving());
    folder.write("f07.png", "old");
    let mut rights = std::fs::metadata(folder.path("f07.png")).unwrap().permissions();
    rights.set_readonly(true);
    std::fs::set_permissions(folder.path("f07.png"), rights).unwrap();
    let message = refused_before_the_first_frame(&folder, Run::failed);
    assert!(message.contains("f07.png: the output is there already and is read-only"), "{message}");
}

#[test]
#[cfg(unix)]
fn links_in_the_places_of_later_frames_are_checked() {
    let folder = Folder::with(&moving());
    let refused = |target: &str, expected: &str| {
        std::os::unix::fs::symlink(target, folder.path("f09.png")).unwrap();
        let message = refused_before_the_first_frame(&folder, Run::refused);
        assert!(message.contains(expected), "{message}");
        std::fs::remove_file(folder.path("f09.png")).unwrap();
    };
    refused("/dev/null", "f09.png: the output is a pipe or a device");
    refused("scene.toml", "f09.png: this output is an input file");
    refused("none/f.png", "the output's folder none does not exist");
    refused("f03.png", "f09.png: two outputs are this file");
    refused("f09.png", "f09.png: the output is a symbolic link that leads to itself");
}

#[test]
fn a_texture_in_the_place_of_a_later_frame_is_refused() {
    let folder = Folder::with(&moving());
    folder.write("f05.png", envers_testing::png(&[[1, 2, 3, 255]]));
    folder.write("m.mtl", "newmtl a\nmap_Kd f05.png\n");
    folder.write("m.obj", format!("mtllib m.mtl\nusemtl a\n{TETRAHEDRON}"));
    folder.write("scene.toml", moving() + "[[model]]\nfile = \"m.obj\"\n");
    let message = refused_before_the_first_frame(&folder, Run::refused);
    assert!(message.contains("f05.png: this output is an input file"), "{message}");
}

#[test]
fn frames_beyond_the_animation_are_refused() {
    let folder = Folder::with(&moving());
    let said = folder.run("render scene.toml --frames 5-11 -o f#.png").refused();
    assert!(said.contains("there is no frame 11") && said.contains("has 10"), "{said}");
}

#[test]
fn what_is_no_range_of_frames_is_refused() {
    let folder = Folder::with(&moving());
    for bad in ["0", "3-1", "1-5x0", "a", "1-"] {
        folder.run(&format!("render scene.toml --frames {bad} -o f#.png")).refused();
    }
}

#[test]
fn a_scene_in_which_nothing_moves_has_no_frames() {
    let folder = Folder::with(SPHERE);
    for arguments in ["--frames 1 -o a.png", "-o a.gif", "-o a.apng", "--time 1 -o a.png"] {
        let said = folder.run(&format!("render scene.toml {arguments}")).refused();
        assert!(said.contains("no animation"), "{said}");
    }
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
fn one_moment_is_no_animation() {
    let folder = Folder::with(&moving());
    folder.run("render scene.toml --time 1 --frames 2 -o a.png").refused();
    let said = folder.run("render scene.toml --time 1 -o a.gif").refused();
    assert!(said.contains("--time selects a single image"), "{said}");
}

#[test]
fn an_animated_picture_skips_no_frame() {
    let folder = Folder::with(&moving());
    let said = folder.run("render scene.toml -o a.gif --skip-existing").refused();
    assert!(said.contains("needs every frame"), "{said}");
}

#[test]
fn a_failure_leaves_the_old_picture_and_no_other_file() {
    let folder = Folder::with(&moving());
    folder.write("a.gif", "old");
    // The camera comes to stand where it looks, in the last frame.
    let track = "object = \"front\"\ntimes = [0, 1.8]\nposition = [[0, 1, 5], [0, 0.5, 0]]\n";
    folder.write("scene.toml", moving() + "[[animation.track]]\n" + track);
    let said = folder.run("render scene.toml -o a.gif").refused();
    assert!(said.contains("scene.toml") && said.contains("at 1.800 s"), "{said}");
    assert_eq!(folder.read("a.gif"), b"old");
    assert_eq!(folder.names(), ["a.gif", "scene.toml"]);
}

#[test]
fn a_gif_too_large_for_its_format_is_refused() {
    let folder = Folder::with(&moving());
    let said = folder.run("render scene.toml --size 70000x1 -o a.gif").refused();
    assert!(said.contains("65535"), "{said}");
}

#[test]
fn a_bare_models_animation_has_frames() {
    let mut model = envers_testing::Model::triangle();
    let input = model.floats("SCALAR", &[0.0, 0.25]);
    let output = model.floats("VEC3", &[0., 0., 0., 1., 0., 0.]);
    model.json["animations"] = serde_json::json!([{
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        "samplers": [{"input": input, "output": output}],
    }]);
    let folder = Folder::new();
    folder.write("a.glb", model.glb());
    folder.run("render a.glb --size 32x24 --spp 1 -o a.gif").good();
    assert_eq!(gif(folder.read("a.gif")).len(), 6);
}
