//! `envers render`: the pictures.

use super::*;
use envers::measure::Picture;

/// The bytes of a picture of a scene, made with these flags.
#[track_caller]
fn made(folder: &Folder, flags: &str, name: &str) -> Vec<u8> {
    folder.run(&format!("render scene.toml {flags} -o {name}")).good();
    folder.read(name)
}

#[test]
fn one_run_writes_every_output_that_is_named() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml -o a.png -o b.exr -o c.PNG").good();
    assert_eq!(folder.names(), ["a.png", "b.exr", "c.PNG", "scene.toml"]);
    assert_eq!(&folder.read("a.png")[1..4], b"PNG");
    assert_eq!(folder.read("b.exr")[..4], [0x76, 0x2f, 0x31, 0x01]);
    assert_eq!(folder.read("a.png"), folder.read("c.PNG"));
}

#[test]
fn each_output_is_named_on_a_line_of_stdout() {
    let stdout = Folder::with(SPHERE).run("render scene.toml -o a.png -o b.exr").good().stdout;
    let names: Vec<&str> = stdout.lines().filter_map(|l| l.split_once(' ')).map(|l| l.0).collect();
    assert_eq!(names, ["a.png", "b.exr"]);
}

#[test]
fn without_an_output_the_picture_stands_in_the_working_folder() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("deep")).unwrap();
    folder.write("deep/room.v2.toml", SPHERE);
    let stdout = folder.run("render deep/room.v2.toml").good().stdout;
    assert!(stdout.starts_with("room.v2.png ("), "{stdout}");
    assert_eq!(folder.names(), ["deep", "room.v2.png"]);
}

#[test]
fn the_picture_has_the_size_of_the_scene() {
    assert_eq!(pixels(&made(&Folder::with(SPHERE), "", "a.png")).0, (64, 48));
}

#[test]
fn size_comes_before_the_scenes() {
    assert_eq!(pixels(&made(&Folder::with(SPHERE), "--size 37x21", "a.png")).0, (37, 21));
}

#[test]
fn background_is_the_hex_colour_that_the_scene_names() {
    assert_eq!(pixels(&made(&Folder::with(SPHERE), "", "a.png")).1[..3], [0x20, 0x30, 0x40]);
}

#[test]
fn a_bare_model_is_framed_and_lit() {
    for (name, bytes) in [
        ("model.glb", envers_testing::Model::triangle().glb()),
        ("model.obj", TETRAHEDRON.as_bytes().to_vec()),
    ] {
        let folder = Folder::new();
        folder.write(name, bytes);
        folder.run(&format!("render {name} --size 40x30")).good();
        let pixels = pixels(&folder.read("model.png")).1;
        assert!(pixels.chunks(3).any(|p| p[0] > 50), "{name} is dark");
    }
}

#[test]
fn more_samples_smooth_the_edges() {
    let folder = Folder::with(SPHERE);
    assert_ne!(made(&folder, "", "one.png"), made(&folder, "--spp 9", "nine.png"));
    let stats = folder.run("render scene.toml -o a.png --spp 9 --stats -").good().json();
    assert_eq!((&stats["spp"], &stats["rays"]["primary"]), (&9.into(), &(64 * 48 * 9).into()));
}

#[test]
#[cfg(feature = "embree")]
fn a_certified_exr_is_the_same_bytes_at_any_bvh_quality() {
    let folder = Folder::with_everything();
    let [auto, low, medium] = ["auto", "low", "medium"]
        .map(|bvh| made(&folder, &format!("--precision certified --bvh {bvh}"), "a.exr"));
    assert!(low == medium && auto == medium);
}

/// Returns the quality that a run says it built with.
#[track_caller]
fn bvh(folder: &Folder, flags: &str) -> Value {
    folder.run(&format!("render scene.toml {flags} --stats -")).good().json()["build"]["bvh"]
        .clone()
}

#[test]
#[cfg(feature = "embree")]
fn statistics_say_which_bvh_quality_was_asked_for() {
    let folder = Folder::with_everything();
    assert_eq!([bvh(&folder, "--bvh low"), bvh(&folder, "--bvh medium")], ["low", "medium"]);
}

#[test]
#[cfg(feature = "embree")]
fn the_bvh_is_of_low_quality_where_few_rays_come() {
    let folder = Folder::with_everything();
    let [few, many] = ["--size 2x2", "--size 200x200"].map(|size| bvh(&folder, size));
    assert_eq!([few, many], ["low", "medium"]);
}

#[test]
fn the_rust_bvh_has_no_quality() {
    assert_eq!(bvh(&Folder::with(SPHERE), "--backend rust --bvh low"), Value::Null);
}

/// The bytes with 1, 2 and 8 threads are the same.
#[track_caller]
fn same_for_any_number_of_threads(name: &str, flags: &str) {
    let folder = Folder::with_everything();
    let one = made(&folder, &format!("{flags} --threads 1"), name);
    for threads in [2, 8] {
        let several = made(&folder, &format!("{flags} --threads {threads}"), name);
        assert!(one == several, "{threads} threads make other bytes");
    }
}

#[test]
#[cfg(feature = "embree")]
fn embree_makes_the_same_png_with_any_number_of_threads() {
    same_for_any_number_of_threads("a.png", "--backend embree");
}

#[test]
#[cfg(feature = "embree")]
fn embree_makes_the_same_exr_with_any_number_of_threads() {
    same_for_any_number_of_threads("a.exr", "--backend embree");
}

#[test]
fn rust_makes_the_same_png_with_any_number_of_threads() {
    same_for_any_number_of_threads("a.png", "--backend rust");
}

#[test]
fn rust_makes_the_same_exr_with_any_number_of_threads() {
    same_for_any_number_of_threads("a.exr", "--backend rust");
}

#[test]
#[cfg(feature = "embree")]
fn both_backends_make_the_same_picture() {
    let folder = Folder::with_everything();
    let (_, a) = pixels(&made(&folder, "--backend embree", "a.png"));
    let (_, b) = pixels(&made(&folder, "--backend rust", "b.png"));
    assert!(a.iter().zip(&b).all(|(x, y)| x.abs_diff(*y) <= 1));
}

#[test]
#[cfg(not(feature = "embree"))]
fn a_build_without_embree_says_so_when_it_is_asked_for() {
    let message = Folder::with(&endless()).run("render scene.toml --backend embree").refused();
    assert!(message.contains("built without Embree"), "{message}");
}

/// The scene, with two mirror balls that see each other.
fn mirrors() -> String {
    let ball =
        |x: f64| format!("[[sphere]]\ncenter = [{x}, 1, 2]\nradius = 0.6\nmaterial = \"mirror\"\n");
    let mirror = "[[material]]\nname = \"mirror\"\nreflect = 1\n";
    format!("{SPHERE}\n{mirror}{}{}", ball(-0.7), ball(0.7))
}

fn reflections(flags: &str) -> u64 {
    let folder = Folder::with(&mirrors());
    folder.run(&format!("render scene.toml -o a.png --stats stats.json {flags}")).good();
    let stats: serde_json::Value = serde_json::from_slice(&folder.read("stats.json")).unwrap();
    stats["rays"]["reflection"].as_u64().unwrap()
}

#[test]
fn max_depth_says_how_often_light_is_followed() {
    assert_eq!(reflections("--max-depth 0"), 0);
    assert!(reflections("--max-depth 1") < reflections(""));
}

#[test]
fn a_depth_of_ten_thousand_ends_in_little_memory() {
    let folder = Folder::with(&mirrors());
    let command = "render scene.toml -o a.png --max-depth 10000 --stats stats.json";
    folder.run(command).good();
    let stats: serde_json::Value = serde_json::from_slice(&folder.read("stats.json")).unwrap();
    // Not every system tells; that a depth needs no memory is what the loop is made for.
    assert!(stats["peak_memory_bytes"].as_u64().unwrap_or(0) < 200 << 20, "{stats}");
}

#[test]
fn a_depth_beyond_what_is_supported_is_refused() {
    Folder::with(SPHERE).run("render scene.toml --max-depth 65537").refused();
}

#[test]
fn a_camera_is_chosen_by_name() {
    let folder = Folder::with_everything();
    assert_ne!(made(&folder, "", "front.png"), made(&folder, "--camera above", "above.png"));
}

#[test]
fn a_camera_is_chosen_by_index() {
    let folder = Folder::with_everything();
    assert_eq!(made(&folder, "--camera 1", "1.png"), made(&folder, "--camera above", "above.png"));
}

/// The channels and the values of the centre of a view, which shows the sphere's front.
#[track_caller]
fn centre(view: &str) -> (Vec<String>, Vec<f32>) {
    let scene = SPHERE.replace("position = [0, 1, 5]", "position = [0, 0.5, 5]");
    let folder = Folder::with(&scene.replace("[64, 48]", "[65, 49]"));
    folder.run(&format!("render scene.toml -o a.exr --view {view}")).good();
    let picture = Picture::read(&folder.path("a.exr")).unwrap();
    let n = picture.channels.len();
    let middle = (24 * 65 + 32) * n;
    (picture.channels, picture.values[middle..middle + n].to_vec())
}

#[test]
fn view_depth_is_the_distance_in_an_exr() {
    assert_eq!(centre("depth"), (vec!["Z".to_owned()], vec![4.5]));
}

#[test]
fn view_normal_is_the_unit_normal_in_an_exr() {
    let (channels, values) = centre("normal");
    let z = channels.iter().position(|c| c.ends_with('Z') || c == "B").unwrap();
    assert!((values[z] - 1.0).abs() < 1e-6, "{channels:?} {values:?}");
    assert!(values.iter().map(|x| x * x).sum::<f32>() - 1.0 < 1e-6);
}

#[test]
fn view_id_tells_objects_apart() {
    let (_, pixels) = pixels(&made(&Folder::with_everything(), "--view id", "id.png"));
    let colors: std::collections::HashSet<&[u8]> = pixels.chunks(3).collect();
    // Two spheres, the plane, three models, and nothing.
    assert_eq!(colors.len(), 7);
}

#[test]
fn half_stores_the_same_radiance_in_16_bits() {
    let folder = Folder::with(SPHERE);
    let (full, half) = (made(&folder, "", "full.exr"), made(&folder, "--half", "half.exr"));
    assert!(half.len() < full.len(), "{} and {} bytes", half.len(), full.len());
    folder.run("diff full.exr half.exr --tolerance 0.001").good();
}

#[test]
fn quiet_prints_nothing() {
    let folder =
        Folder::with(&SPHERE.replace("[[light]]\nkind = \"point\"\nposition = [3, 5, 4]", ""));
    let run = folder.run("render scene.toml -o a.png --quiet").good();
    assert_eq!(run.stdout, "");
    assert!(folder.has("a.png"));
}

#[test]
fn progress_is_not_shown_on_a_pipe() {
    assert_eq!(Folder::with_everything().run("render scene.toml --spp 16").good().stderr, "");
}

#[test]
#[cfg(feature = "embree")]
fn statistics_tell_the_memory_that_embree_takes_for_a_mesh() {
    let folder = Folder::with_everything();
    let stats = folder.run("render scene.toml --stats -").good().json();
    let [embree, all] =
        ["embree_peak_memory_bytes", "peak_memory_bytes"].map(|k| stats[k].as_u64());
    // The 32 bytes of at least one box for each of the 4 triangles.
    assert!(embree.unwrap() > 128);
    assert!(all.is_none_or(|all| all > embree.unwrap()));
}

#[test]
fn model_in_a_scene_file_without_light_is_lit_unless_the_scene_says_none() {
    let folder = Folder::new();
    folder.write("model.obj", TETRAHEDRON);
    let brightest = |lights: &str| {
        folder.write("scene.toml", format!("{lights}\n[[model]]\nfile = \"model.obj\"\n"));
        let run = folder.run("render scene.toml --size 32x24 -o out.png");
        assert_eq!(run.status, Some(0), "{}", run.stderr);
        pixels(&folder.read("out.png")).1.into_iter().max().unwrap()
    };
    assert!(brightest("") > 100);
    assert_eq!(brightest("lights = \"none\""), 0);
}

/// Progress is shown on terminals only, and `script` is one.
#[test]
#[cfg(target_os = "linux")]
fn progress_begins_with_loading() {
    let folder = Folder::with(SPHERE);
    let run = |flags: &str| {
        let command = format!("{} render scene.toml {flags}", env!("CARGO_BIN_EXE_envers"));
        let output = assert_cmd::Command::new("script")
            .args(["-q", "-e", "-c", &command, "typescript"])
            .current_dir(folder.path("."))
            .output()
            .unwrap();
        assert!(output.status.success());
        String::from_utf8(folder.read("typescript")).unwrap()
    };
    assert!(run("").contains("loading"));
    assert!(!run("--quiet").contains("loading"));
}
