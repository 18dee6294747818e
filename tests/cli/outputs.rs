//! Outputs that cannot be written: refused before the work begins, and nothing is lost.

use super::*;

/// The message of a run that is refused on a scene that would take days; no file is made or changed
/// by it.
#[track_caller]
fn refused_in(folder: &Folder, arguments: &str) -> String {
    ended_at_once(folder, arguments, Run::refused)
}

/// The message of a run that fails before the work begins.
#[track_caller]
fn failed_in(folder: &Folder, arguments: &str) -> String {
    ended_at_once(folder, arguments, Run::failed)
}

#[track_caller]
fn ended_at_once(folder: &Folder, arguments: &str, message: fn(Run) -> String) -> String {
    let before = folder.names();
    let message = message(folder.run(arguments));
    assert_eq!(folder.names(), before, "{message}");
    message
}

#[track_caller]
fn refused(arguments: &str) -> String {
    let folder = Folder::with(&endless());
    folder.write("old.png", "the old picture");
    let message = refused_in(&folder, arguments);
    assert_eq!(folder.read("old.png"), b"the old picture");
    assert_eq!(folder.read("scene.toml"), endless().as_bytes());
    message
}

#[test]
fn a_folder_that_does_not_exist_is_named() {
    let message = refused("render scene.toml -o none/a.png");
    assert!(message.contains("none/a.png") && message.contains("mkdir -p none"), "{message}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_folder_that_takes_no_files_is_named() {
    let message = failed_in(&Folder::with(&endless()), "render scene.toml -o /proc/a.png");
    assert!(message.contains("/proc/a.png") && !message.contains("mkdir"), "{message}");
}

#[test]
#[cfg(unix)]
fn a_folder_that_is_read_only_is_named() {
    use std::os::unix::fs::PermissionsExt;
    if is_root() {
        return;
    }
    let folder = Folder::with(&endless());
    std::fs::create_dir(folder.path("fixed")).unwrap();
    let rights = |mode| std::fs::Permissions::from_mode(mode);
    std::fs::set_permissions(folder.path("fixed"), rights(0o555)).unwrap();
    let message = failed_in(&folder, "render scene.toml -o fixed/a.png");
    std::fs::set_permissions(folder.path("fixed"), rights(0o755)).unwrap();
    assert!(message.contains("fixed/a.png"), "{message}");
}

#[test]
fn an_old_picture_that_is_read_only_stays() {
    let folder = Folder::with(&endless());
    folder.write("old.png", "the old picture");
    let mut rights = std::fs::metadata(folder.path("old.png")).unwrap().permissions();
    rights.set_readonly(true);
    std::fs::set_permissions(folder.path("old.png"), rights).unwrap();
    let message = failed_in(&folder, "render scene.toml -o old.png");
    assert!(message.contains("old.png: the output is there already and is read-only"), "{message}");
    assert_eq!(folder.read("old.png"), b"the old picture");
}

#[test]
#[cfg(unix)]
fn a_name_that_is_too_long_is_refused() {
    let name = "a".repeat(300);
    assert!(refused(&format!("render scene.toml -o {name}.png")).contains(&name));
    refused(&format!("render scene.toml --stats {name}.json"));
}

#[test]
fn a_folder_as_the_output_is_refused() {
    let folder = Folder::with(&endless());
    std::fs::create_dir(folder.path("out.png")).unwrap();
    let message = refused_in(&folder, "render scene.toml -o out.png");
    assert!(message.contains("out.png: the output is a folder"), "{message}");
}

#[test]
fn a_file_in_the_place_of_the_outputs_folder_is_refused() {
    let message = refused("render scene.toml -o old.png/a.png");
    assert!(message.contains("the output's folder old.png is a file"), "{message}");
    assert!(refused("bench scene.toml --out old.png/bench").contains("old.png"));
}

#[test]
#[cfg(unix)]
fn a_device_as_the_output_is_refused() {
    let folder = Folder::with(&endless());
    for device in ["null", "full"] {
        let link = folder.path(format!("{device}.png"));
        std::os::unix::fs::symlink(Path::new("/dev").join(device), link).unwrap();
        let message = refused_in(&folder, &format!("render scene.toml -o {device}.png"));
        let expected = format!("{device}.png: the output is a pipe or a device");
        assert!(message.contains(&expected), "{message}");
    }
}

#[test]
fn a_folder_named_after_a_device_does_not_exist() {
    refused("render scene.toml -o /dev/null/a.png");
}

#[test]
fn an_extension_that_is_not_written_is_refused_with_those_that_are() {
    for name in ["a.tiff", "a", "a.png.bak", "-"] {
        let message = refused(&format!("render scene.toml -o {name}"));
        assert!(message.contains(".png") && message.contains(".exr"), "{message}");
    }
}

#[test]
fn the_second_output_is_checked_as_the_first() {
    assert!(refused("render scene.toml -o old.png -o b.gif").contains("b.gif"));
}

#[test]
fn the_same_output_twice_is_refused() {
    assert!(refused("render scene.toml -o a.png -o a.png").contains("a.png"));
}

#[test]
fn the_same_output_under_two_names_is_refused() {
    refused("render scene.toml -o a.png -o ./a.png");
    refused("render scene.toml -o old.png -o .//old.png");
}

#[test]
fn statistics_in_a_folder_that_does_not_exist_are_refused() {
    assert!(refused("render scene.toml --stats none/s.json").contains("none/s.json"));
}

#[test]
fn statistics_in_the_place_of_the_scene_are_refused() {
    assert!(refused("render scene.toml --stats scene.toml").contains("scene.toml"));
}

#[test]
fn json_in_the_place_of_the_scene_is_refused() {
    refused("info scene.toml --json scene.toml");
    refused("validate scene.toml --json scene.toml");
}

#[test]
fn an_output_in_the_place_of_a_texture_is_refused() {
    let folder = Folder::new();
    let png = envers_testing::png(&[[1, 2, 3, 255]]);
    folder.write("cube.png", &png);
    folder.write("cube.mtl", "newmtl a\nmap_Kd cube.png\n");
    folder.write("cube.obj", format!("mtllib cube.mtl\nusemtl a\n{TETRAHEDRON}"));
    // Without -o the picture would be cube.png, too.
    for output in ["", "-o cube.png", "-o ./cube.png"] {
        let message = refused_in(&folder, &format!("render cube.obj {output}"));
        assert!(message.contains("cube.png: this output is an input file"), "{message}");
        assert_eq!(folder.read("cube.png"), png);
    }
}

/// Every name that an output may have, as a link to a file that was read.
#[test]
#[cfg(unix)]
fn a_link_to_an_input_file_is_refused_as_an_output() {
    let folder = Folder::with_everything();
    let inputs = ["scene.toml", "tetrahedron.obj", "triangle.glb"];
    let before = inputs.map(|name| folder.read(name));
    let commands = [
        ("a.png", "render scene.toml -o a.png"),
        ("s.json", "render scene.toml -o b.png --stats s.json"),
        ("s.json", "info scene.toml --json s.json"),
        ("s.json", "validate scene.toml --json s.json"),
        ("h.png", "validate scene.toml --heatmap h.png"),
        ("bench.csv", "bench scene.toml --out ."),
    ];
    for input in inputs {
        for (link, command) in commands {
            std::os::unix::fs::symlink(input, folder.path(link)).unwrap();
            let message = refused_in(&folder, command);
            assert!(message.contains("this output is an input file"), "{command}: {message}");
            std::fs::remove_file(folder.path(link)).unwrap();
        }
    }
    assert_eq!(inputs.map(|name| folder.read(name)), before);
}

#[test]
#[cfg(unix)]
fn a_report_that_is_a_link_to_a_picture_that_is_compared_is_refused() {
    let folder = Folder::new();
    let png = envers_testing::png(&[[1, 2, 3, 255]]);
    folder.write("a.png", &png);
    std::os::unix::fs::symlink("a.png", folder.path("s.json")).unwrap();
    refused_in(&folder, "diff a.png a.png --json s.json");
    assert_eq!(folder.read("a.png"), png);
}

#[test]
fn a_heat_map_in_the_place_of_a_picture_is_refused() {
    let folder = Folder::new();
    let png = envers_testing::png(&[[1, 2, 3, 255]]);
    folder.write("a.png", &png);
    folder.write("b.png", &png);
    for name in ["a.png", "./b.png"] {
        refused_in(&folder, &format!("diff a.png b.png --heatmap {name}"));
    }
    assert_eq!((folder.read("a.png"), folder.read("b.png")), (png.clone(), png));
}

#[test]
fn a_heat_map_that_is_no_png_is_refused() {
    assert!(refused("validate scene.toml --heatmap h.exr").contains("h.exr"));
    assert!(refused("diff old.png old.png --heatmap h.jpg").contains("h.jpg"));
}

#[test]
fn flags_without_an_output_that_they_are_about_are_refused() {
    assert!(refused("render scene.toml -o a.png --half").contains("--half"));
    assert!(refused("render scene.toml -o a.png --quality 80").contains("--quality"));
    assert!(refused("render scene.toml -o a.exr --exposure 1").contains("--exposure"));
    assert!(refused("render scene.toml -o a.exr --tone aces").contains("--tone"));
}

#[test]
fn flags_that_say_nothing_to_a_view_are_refused() {
    assert!(refused("render scene.toml -o a.png --view id --exposure 1").contains("--exposure"));
    assert!(refused("render scene.toml -o a.png --view id --tone none").contains("--tone"));
    assert!(refused("render scene.toml -o a.exr --view depth --half").contains("--half"));
    assert!(refused("render scene.toml -o a.exr --view depth --spp 4").contains("--spp"));
}

#[test]
fn an_exposure_that_is_no_number_is_refused() {
    for bad in ["nan", "inf", "much"] {
        assert!(refused(&format!("render scene.toml -o a.png --exposure {bad}")).contains(bad));
    }
}

#[test]
fn a_tone_curve_that_is_none_is_refused_with_those_that_there_are() {
    let message = refused("render scene.toml -o a.png --tone filmic");
    assert!(message.contains("filmic") && message.contains("none, reinhard, aces"), "{message}");
}

#[test]
fn an_old_picture_is_replaced_by_the_whole_new_one() {
    let folder = Folder::with(SPHERE);
    folder.write("a.png", vec![7; 1 << 20]);
    folder.run("render scene.toml -o a.png").good();
    assert_eq!(pixels(&folder.read("a.png")).0, (64, 48));
    assert_eq!(folder.names(), ["a.png", "scene.toml"]);
}

#[test]
fn an_old_picture_stays_when_the_scene_is_bad() {
    let folder = Folder::with("[camera]\nposition = 1\n");
    folder.write("scene.png", "the old picture");
    folder.run("render scene.toml").refused();
    assert_eq!(folder.read("scene.png"), b"the old picture");
}

#[test]
#[cfg(unix)]
fn a_link_stays_a_link_and_its_target_is_written() {
    let folder = Folder::with(SPHERE);
    std::fs::create_dir(folder.path("real")).unwrap();
    folder.write("real/a.png", "old");
    std::os::unix::fs::symlink("real/a.png", folder.path("link.png")).unwrap();
    folder.run("render scene.toml -o link.png").good();
    assert!(std::fs::symlink_metadata(folder.path("link.png")).unwrap().is_symlink());
    assert_eq!(pixels(&folder.read("real/a.png")).0, (64, 48));
}

#[test]
#[cfg(unix)]
fn a_link_to_a_file_that_is_not_there_yet_creates_it() {
    let folder = Folder::with(&moving());
    std::fs::create_dir(folder.path("real")).unwrap();
    let link = |target: &str, name: &str| {
        std::os::unix::fs::symlink(target, folder.path(name)).unwrap();
    };
    link("real/a.png", "a.png");
    // A chain of relative links, each from its own folder.
    link("real/second.gif", "first.gif");
    link("../third.gif", "real/second.gif");
    link("real/a.gif", "third.gif");
    link("real/s.json", "s.json");
    folder.run("render scene.toml --frames 1 -o a.png -o first.gif --stats s.json").good();
    for name in ["a.png", "first.gif", "real/second.gif", "third.gif", "s.json"] {
        assert!(std::fs::symlink_metadata(folder.path(name)).unwrap().is_symlink(), "{name}");
    }
    for name in ["real/a.png", "real/a.gif", "real/s.json"] {
        assert!(std::fs::symlink_metadata(folder.path(name)).unwrap().is_file(), "{name}");
    }
    assert_eq!(pixels(&folder.read("real/a.png")).0, (64, 48));
}

#[test]
#[cfg(unix)]
fn a_link_that_leads_nowhere_is_refused() {
    let folder = Folder::with(&endless());
    let link = |target: &str, name: &str| {
        std::os::unix::fs::symlink(target, folder.path(name)).unwrap();
    };
    link("none/a.png", "a.png");
    let message = refused_in(&folder, "render scene.toml -o a.png");
    assert!(message.contains("none does not exist"), "{message}");
    link("c.png", "b.png");
    link("b.png", "c.png");
    let message = refused_in(&folder, "render scene.toml -o b.png");
    assert!(
        message.contains("b.png: the output is a symbolic link that leads to itself"),
        "{message}"
    );
}

#[test]
#[cfg(unix)]
fn a_link_to_another_output_is_that_output() {
    let folder = Folder::with(&endless());
    std::os::unix::fs::symlink("a.png", folder.path("link.png")).unwrap();
    let message = refused_in(&folder, "render scene.toml -o a.png -o link.png");
    assert!(message.contains("link.png: two outputs are this file"), "{message}");
}

/// The permission bits of a file.
#[cfg(unix)]
fn mode(folder: &Folder, name: &str) -> u32 {
    use std::os::unix::fs::PermissionsExt;
    std::fs::metadata(folder.path(name)).unwrap().permissions().mode() & 0o7777
}

#[test]
#[cfg(unix)]
fn what_is_replaced_keeps_its_permissions() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::with(&moving());
    let modes = [("a.png", 0o600), ("a.exr", 0o646), ("a.gif", 0o755), ("s.json", 0o220)];
    for (name, mode) in modes {
        folder.write(name, "old");
        let permissions = std::fs::Permissions::from_mode(mode);
        std::fs::set_permissions(folder.path(name), permissions).unwrap();
    }
    let render = "render scene.toml --frames 1 -o a.png -o a.exr -o a.gif --stats s.json";
    folder.run_script(&format!("umask 027; envers {render}")).good();
    for (name, expected) in modes {
        assert_eq!(mode(&folder, name), expected, "{name}");
        assert_ne!(std::fs::metadata(folder.path(name)).unwrap().len(), 3, "{name} is new");
    }
}

#[test]
#[cfg(unix)]
fn what_is_new_has_the_permissions_of_the_umask() {
    let folder = Folder::with(&moving());
    let render = "render scene.toml --frames 1 -o a.png -o a.gif --stats s.json";
    folder.run_script(&format!("umask 027; envers {render}")).good();
    for name in ["a.png", "a.gif", "s.json"] {
        assert_eq!(mode(&folder, name), 0o640, "{name}");
    }
}

#[test]
fn a_name_that_ends_like_a_folder_is_refused() {
    assert!(refused("render scene.toml -o a.png/").contains("a folder"));
    assert!(refused("render scene.toml -o old.png/").contains("a folder"));
}

#[test]
#[cfg(target_os = "linux")]
fn names_need_not_be_utf8() {
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::new();
    let name = |bytes| OsStr::from_bytes(bytes);
    folder.write(name(b"sc\xe8ne.toml"), SPHERE);
    let arguments =
        [name(b"render"), name(b"sc\xe8ne.toml"), name(b"--stats"), name(b"s\xff.json")];
    folder.run_with(arguments).good();
    assert_eq!(pixels(&folder.read(name(b"sc\xe8ne.png"))).0, (64, 48));
    serde_json::from_slice::<Value>(&folder.read(name(b"s\xff.json"))).unwrap();
}
