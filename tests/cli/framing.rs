//! The flags that say how large a picture is, and from where a bare model is seen.

use super::*;

/// The size of the picture of a run in `folder`.
#[track_caller]
fn size_of(folder: &Folder, arguments: &str) -> (u32, u32) {
    folder.run(&format!("render {arguments} -q --spp 1 -o out.png")).good();
    pixels(&folder.read("out.png")).0
}

#[test]
fn width_alone_keeps_the_proportions() {
    let folder = Folder::with(SPHERE);
    assert_eq!(size_of(&folder, "scene.toml --size 32"), (32, 24));
    assert_eq!(size_of(&folder, "scene.toml --size 128"), (128, 96));
    assert_eq!(size_of(&folder, "scene.toml --size 1"), (1, 1));
    folder.write("model.obj", TETRAHEDRON);
    assert_eq!(size_of(&folder, "model.obj --size 32"), (32, 18), "16 to 9, as by default");
}

#[test]
fn sizes_that_are_none_are_refused_with_both_forms() {
    for size in ["0", "0x5", "x5", "5x", "-5", "5.5", "640 x", "a"] {
        let folder = Folder::with(&endless());
        let message = folder.run_with(["render", "scene.toml", "--size", size]).refused();
        assert!(message.contains("--size"), "{size}: {message}");
    }
    let folder = Folder::with(&endless());
    let message = folder.run("render scene.toml --size wide").refused();
    assert!(message.contains("1920x1080") && message.contains("such as 640"), "{message}");
}

#[test]
fn width_whose_height_is_too_great_is_refused() {
    let folder = Folder::with(&SPHERE.replace("size = [64, 48]", "size = [1, 4096]"));
    let message = folder.run("render scene.toml --size 4096").refused();
    assert!(message.contains("scene.toml"), "{message}");
}

/// A ball at the tip of each axis, the red one at +X, the green one at +Y, the blue one at +Z, each with a
/// picture of its own object in the id view.
const TRIPOD: &str = r##"{"asset": {"version": "2.0"}, "scene": 0,
"scenes": [{"nodes": [0, 1, 2]}],
"nodes": [
 {"translation": [1, 0, 0], "extensions": {"KHR_implicit_shapes": {"shape": 0, "material": 0}}},
 {"translation": [0, 1, 0], "extensions": {"KHR_implicit_shapes": {"shape": 0, "material": 1}}},
 {"translation": [0, 0, 1], "extensions": {"KHR_implicit_shapes": {"shape": 0, "material": 2}}}],
"materials": [
 {"emissiveFactor": [1, 0, 0], "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}},
 {"emissiveFactor": [0, 1, 0], "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}},
 {"emissiveFactor": [0, 0, 1], "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}}],
"extensionsUsed": ["KHR_implicit_shapes"],
"extensions": {"KHR_implicit_shapes": {"shapes": [{"type": "sphere", "sphere": {"radius": 0.2}}]}}}"##;

/// The middles of the red, green and blue ball in the picture, from 0 to 1 to the right and downwards.
#[track_caller]
fn balls(arguments: &str) -> [[f64; 2]; 3] {
    let folder = Folder::new();
    folder.write("tripod.gltf", TRIPOD);
    let run = format!("render tripod.gltf -q --size 90x90 --spp 1 -o out.png {arguments}");
    folder.run(&run).good();
    let ((width, height), bytes) = pixels(&folder.read("out.png"));
    std::array::from_fn(|color| {
        let (mut count, mut sum) = (0.0, [0.0; 2]);
        for (i, pixel) in bytes.chunks(3).enumerate() {
            let others = (0..3).filter(|&k| k != color).map(|k| pixel[k]);
            if pixel[color] == 255 && others.max() < Some(128) {
                let (x, y) = (i as u32 % width, i as u32 / width);
                count += 1.0;
                sum[0] += f64::from(x) / f64::from(width);
                sum[1] += f64::from(y) / f64::from(height);
            }
        }
        assert!(count > 0.0, "ball {color} is not seen: {arguments}");
        sum.map(|sum| sum / count)
    })
}

#[test]
fn axis_that_is_up_points_upward() {
    for (arguments, up) in [("", 1), ("--up y", 1), ("--up x", 0), ("--up z", 2)] {
        let balls = balls(arguments);
        let highest = (0..3).min_by(|&a, &b| balls[a][1].total_cmp(&balls[b][1])).unwrap();
        assert_eq!(highest, up, "{arguments}: {balls:?}");
    }
    for (arguments, down) in [("--up -y", 1), ("--up -x", 0), ("--up=-z", 2)] {
        let balls = balls(arguments);
        let lowest = (0..3).max_by(|&a, &b| balls[a][1].total_cmp(&balls[b][1])).unwrap();
        assert_eq!(lowest, down, "{arguments}: {balls:?}");
    }
}

#[test]
fn azimuth_turns_around_the_model_to_the_right() {
    // From the front x is to the right; from the right z is to the left; from behind x is to the left.
    let [red, _, blue] = balls("--azimuth 0 --elevation 20");
    assert!(red[0] > blue[0] + 0.2);
    let [red, _, blue] = balls("--azimuth 90 --elevation 20");
    assert!(blue[0] < red[0] - 0.2);
    let [red, _, blue] = balls("--azimuth 180 --elevation 20");
    assert!(red[0] < blue[0] - 0.2);
    assert_eq!(balls("--azimuth 450 --elevation 20"), balls("--azimuth 90 --elevation 20"));
}

#[test]
fn elevation_is_the_view_from_above() {
    // From above y points at the eye, x to the right, z downward; from below z points upward. The green ball is
    // nearer than the others, and so a little farther from the middle of the picture.
    let [red, green, blue] = balls("--azimuth 0 --elevation 90");
    assert!(red[0] > green[0] + 0.4 && (red[1] - green[1]).abs() < 0.15, "{red:?} {green:?}");
    assert!(blue[1] > green[1] + 0.4 && (blue[0] - green[0]).abs() < 0.15, "{blue:?} {green:?}");
    let [_, green, blue] = balls("--azimuth 10 --elevation -89");
    assert!(blue[1] < green[1] - 0.2, "{blue:?} {green:?}");
}

#[test]
fn angles_are_around_the_axis_that_is_up() {
    // With z up the front is -Y: from above x is to the right and y upward.
    let [red, green, blue] = balls("--up z --azimuth 0 --elevation 90");
    assert!(red[0] > blue[0] + 0.2 && green[1] < blue[1] - 0.2, "{red:?} {green:?} {blue:?}");
}

#[test]
fn angle_comes_before_the_files_own_camera() {
    let mut model = serde_json::from_str::<Value>(TRIPOD).unwrap();
    model["cameras"] =
        serde_json::json!([{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}]);
    model["nodes"][0]["camera"] = 0.into();
    let folder = Folder::new();
    folder.write("own.gltf", model.to_string());
    folder.write("tripod.gltf", TRIPOD);
    for file in ["own", "tripod"] {
        let flags = "-q --size 40x40 --azimuth 30 --spp 1";
        folder.run(&format!("render {file}.gltf {flags} -o {file}.png")).good();
    }
    assert_eq!(folder.read("own.png"), folder.read("tripod.png"));
}

#[test]
fn ground_is_under_the_model_where_up_is_another_axis() {
    let folder = Folder::new();
    folder.write("model.obj", TETRAHEDRON);
    let flags = "render model.obj -q --up z --ground --size 64x48 --view normal -o normal.png";
    folder.run(flags).good();
    let normals = pixels(&folder.read("normal.png")).1;
    // The colour of +Z, in the lowest row.
    let row = &normals[47 * 64 * 3..];
    assert!(row.chunks(3).all(|pixel| pixel == [128, 128, 255]), "{row:?}");
}

#[test]
fn framing_of_a_scene_file_is_refused() {
    for flags in ["--up z", "--azimuth 30", "--elevation 30"] {
        let message = Folder::with(&endless()).run(&format!("render scene.toml {flags}")).refused();
        assert!(message.contains("bare model") && message.contains("[camera]"), "{message}");
    }
}

#[test]
fn angles_that_are_none_are_refused() {
    let folder = Folder::new();
    folder.write("model.obj", TETRAHEDRON);
    for flags in ["--elevation 91", "--elevation -90.5", "--azimuth nan", "--up w", "--up z --up x"]
    {
        folder.run(&format!("render model.obj {flags}")).refused();
    }
    folder.run("render model.obj --azimuth 3 --camera 0").refused();
}
