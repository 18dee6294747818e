//! Input that is wrong: exit status 2, one message that names file, place and the way out.

use super::*;

/// The message about `scene.toml`; the old picture is left as it was.
#[track_caller]
fn refused(scene: &str) -> String {
    refused_with(scene, "")
}

/// The same with further flags.
#[track_caller]
fn refused_with(scene: &str, flags: &str) -> String {
    refused_run(&Folder::with(scene), &format!("render scene.toml {flags} -o old.png"))
}

#[track_caller]
fn refused_run(folder: &Folder, arguments: &str) -> String {
    folder.write("old.png", "the old picture");
    let before = folder.names();
    let message = folder.run(arguments).refused();
    assert_eq!(folder.read("old.png"), b"the old picture");
    assert_eq!(folder.names(), before);
    message
}

/// Changes one line of the scene, and asserts that the message points at the mark `¦` in it and
/// says `part`.
#[track_caller]
fn points(old: &str, marked: &str, part: &str) {
    assert!(SPHERE.contains(old), "{old}");
    let with_mark = endless().replacen(old, marked, 1);
    let at = with_mark.find('¦').unwrap();
    let start = with_mark[..at].rfind('\n').unwrap() + 1;
    let line = with_mark[..at].matches('\n').count() + 1;
    let column = with_mark[start..at].chars().count() + 1;
    let quote = with_mark[start..].lines().next().unwrap().replace('¦', "");
    let message = refused(&with_mark.replace('¦', ""));
    assert!(message.starts_with(&format!("error: scene.toml:{line}:{column}: ")), "{message}");
    assert!(message.contains(&format!("\n{line} | {quote}\n")), "no quote: {message}");
    assert!(message.contains(part), "`{part}` in {message}");
}

// The scene file

#[test]
fn centre_is_center() {
    points("center = [0", "¦centre = [0", "did you mean `center`?");
}

#[test]
fn colour_is_color() {
    let light = "[[light]]\nkind";
    points(light, "[[light]]\n¦colour = \"#fff\"\nkind", "did you mean `color`?");
}

#[test]
fn fov_is_fov_y() {
    points("look_at =", "¦fov = 50\nlook_at =", "fov_y");
}

#[test]
fn lookat_is_look_at() {
    points("look_at = [0", "¦lookat = [0", "did you mean `look_at`?");
}

#[test]
fn an_unknown_key_is_pointed_at() {
    points("radius = 0.5", "radius = 0.5\n¦wavelength = 3", "its keys are `name`, `center`");
}

#[test]
fn an_unknown_table_is_pointed_at() {
    points("[[sphere]]", "[[¦spheres]]", "sphere");
}

#[test]
fn a_material_that_is_not_there_is_pointed_at() {
    points("material = \"red\"", "material = ¦\"rod\"", "did you mean `red`?");
}

#[test]
fn nan_is_pointed_at() {
    points("radius = 0.5", "radius = ¦nan", "radius");
    points("center = [0, 0.5", "center = [0, ¦nan", "nan");
}

#[test]
fn infinity_is_pointed_at() {
    points("radius = 0.5", "radius = ¦inf", "radius");
    points("position = [0, 1", "position = [¦-inf, 1", "inf");
}

#[test]
fn a_radius_of_0_or_less_is_pointed_at() {
    points("radius = 0.5", "radius = ¦0", "radius");
    points("radius = 0.5", "radius = ¦-2.5", "-2.5");
}

/// The place in a film that has this size.
#[track_caller]
fn size_is_pointed_at(marked: &str, part: &str) {
    let film = format!("[film]\nsize = {}\n", marked.replace('¦', ""));
    let column = "size = ".len() + marked.find('¦').unwrap() + 1;
    let message = refused(&(film + "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\n"));
    assert!(message.starts_with(&format!("error: scene.toml:2:{column}: ")), "{message}");
    assert!(message.contains(part), "{message}");
}

#[test]
fn a_size_of_0_is_pointed_at() {
    size_is_pointed_at("¦[0, 480]", "0");
}

#[test]
fn a_size_of_a_million_by_a_million_is_pointed_at() {
    size_is_pointed_at("¦[1000000, 1000000]", "1000000x1000000");
}

#[test]
fn text_that_is_no_toml_is_pointed_at() {
    points("radius = 0.5", "radius = ¦= 0.5", "extra `=`");
}

#[test]
fn a_scene_file_that_is_not_utf8_is_pointed_at() {
    let folder = Folder::new();
    folder.write("scene.toml", b"# caf\xe9\n");
    let message = refused_run(&folder, "render scene.toml -o old.png");
    assert!(message.starts_with("error: scene.toml:1:6: "), "{message}");
}

#[test]
fn an_empty_scene_file_is_told_what_it_needs() {
    let message = refused("");
    assert!(message.contains("[camera]") && message.contains("[[model]]"), "{message}");
}

#[test]
fn a_model_that_is_not_there_is_named_where_the_scene_names_it() {
    let message = refused("[[model]]\nfile = \"none.glb\"\n");
    assert!(message.starts_with("error: scene.toml:2:8: "), "{message}");
    assert!(message.contains("none.glb"), "{message}");
}

#[test]
fn a_fault_in_a_model_is_named_with_both_files() {
    let folder = Folder::with("[[model]]\nfile = \"bad.obj\"\n");
    folder.write("bad.obj", "v 0 0 0\nv 1 0 x\n");
    let message = refused_run(&folder, "render scene.toml -o old.png");
    assert!(message.contains("bad.obj:2"), "{message}");
}

// Other files

#[test]
fn a_file_that_is_not_there_is_named() {
    for command in ["render", "info", "validate"] {
        let message = Folder::new().run(&format!("{command} none.toml")).refused();
        assert!(message.starts_with("error: none.toml: there is no such file"), "{message}");
    }
}

#[test]
#[cfg(unix)]
fn a_file_that_cannot_be_read_is_named() {
    use std::os::unix::fs::PermissionsExt;
    if is_root() {
        return;
    }
    let folder = Folder::with(&endless());
    let secret = std::fs::Permissions::from_mode(0o000);
    std::fs::set_permissions(folder.path("scene.toml"), secret).unwrap();
    assert!(refused_run(&folder, "render scene.toml").starts_with("error: scene.toml: "));
}

#[test]
fn a_folder_as_the_scene_is_refused() {
    let folder = Folder::new();
    for name in ["deep", "deep.toml", "deep.glb"] {
        std::fs::create_dir(folder.path(name)).unwrap();
        let message = refused_run(&folder, &format!("render {name}"));
        assert!(message.starts_with(&format!("error: {name}: this is a folder")), "{message}");
    }
}

#[test]
#[cfg(unix)]
fn a_pipe_as_the_scene_does_not_keep_us_waiting() {
    let folder = Folder::new();
    for name in ["pipe.toml", "pipe.gltf", "pipe.glb", "pipe.obj"] {
        make_pipe(&folder, name);
        let message = refused_run(&folder, &format!("info {name}"));
        assert!(message.starts_with(&format!("error: {name}: this is a pipe")), "{message}");
    }
}

#[test]
#[cfg(unix)]
fn a_pipe_as_a_picture_to_compare_does_not_keep_us_waiting() {
    let folder = Folder::new();
    for name in ["pipe.png", "pipe.exr"] {
        make_pipe(&folder, name);
        let message = refused_run(&folder, &format!("diff {name} {name}"));
        assert!(message.starts_with(&format!("error: {name}: this is a pipe")), "{message}");
    }
}

#[test]
#[cfg(unix)]
fn a_pipe_as_a_material_library_does_not_keep_us_waiting() {
    let folder = Folder::new();
    make_pipe(&folder, "pipe.mtl");
    folder.write("a.obj", format!("mtllib pipe.mtl\n{TETRAHEDRON}"));
    let run = folder.run("info a.obj");
    assert_eq!(run.status, Some(0));
    assert!(
        run.stderr.starts_with("warning: ") && run.stderr.contains("pipe.mtl"),
        "{}",
        run.stderr
    );
}

#[cfg(unix)]
fn make_pipe(folder: &Folder, name: &str) {
    let made = std::process::Command::new("mkfifo").arg(folder.path(name)).status();
    assert!(made.unwrap().success());
}

#[test]
fn an_extension_that_is_not_read_is_refused_with_those_that_are() {
    let folder = Folder::new();
    for name in ["model.fbx", "model", "model.png"] {
        folder.write(name, "?");
        let message = refused_run(&folder, &format!("render {name} -o old.png"));
        for part in [name, ".toml", ".gltf", ".glb", ".obj"] {
            assert!(message.contains(part), "{message}");
        }
    }
}

#[test]
fn a_truncated_glb_is_named() {
    let folder = Folder::new();
    let glb = envers_testing::Model::triangle().glb();
    for length in [0, 11, 12, 19, 40, glb.len() - 1] {
        folder.write("a.glb", &glb[..length]);
        let message = refused_run(&folder, "render a.glb -o old.png");
        assert!(message.starts_with("error: a.glb:"), "{length} bytes: {message}");
    }
}

#[test]
fn broken_json_is_named_with_its_line() {
    let folder = Folder::new();
    folder.write("a.gltf", "{\n  \"asset\": {\"version\": \"2.0\",}\n}");
    let message = refused_run(&folder, "render a.gltf -o old.png");
    assert!(message.starts_with("error: a.gltf:2:"), "{message}");
}

// Flags

#[test]
fn a_size_that_cannot_be_is_refused() {
    for bad in ["0x480", "640x0", "1000000x1000000", "0", "640x", "-3x4", "1e3x4", "nanx4"] {
        let message = refused_with(&endless(), &format!("--size={bad}"));
        assert!(message.contains("--size") && message.contains(bad), "{message}");
    }
}

#[test]
fn samples_that_cannot_be_are_refused() {
    for bad in ["0", "65537", "-1", "1.5", "many"] {
        let message = refused_with(&endless(), &format!("--spp={bad}"));
        assert!(message.contains("--spp") && message.contains(bad), "{message}");
    }
}

#[test]
fn threads_that_cannot_be_are_refused() {
    for bad in ["0", "-1", "1025", "all"] {
        let message = refused_with(&endless(), &format!("--threads={bad}"));
        assert!(message.contains("--threads") && message.contains(bad), "{message}");
    }
}

#[test]
fn a_number_below_0_is_the_value_of_its_flag_and_refused() {
    for flag in ["--spp", "--max-depth", "--threads", "--frames"] {
        let message = refused_with(&endless(), &format!("{flag} -1"));
        assert!(message.contains(&format!("invalid value '-1' for '{flag} ")), "{message}");
    }
}

#[test]
fn a_camera_that_is_not_there_is_refused_with_those_that_are() {
    for bad in ["back", "1", "-1"] {
        let message = refused_with(&endless(), &format!("--camera={bad}"));
        assert!(message.contains(bad) && message.contains("0 `front`"), "{message}");
    }
}

#[test]
fn a_camera_without_a_name_is_told_by_its_index() {
    let scene = endless().replace("name = \"front\"\n", "");
    let message = refused_with(&scene, "--camera back");
    assert!(message.contains("back") && !message.contains("``"), "{message}");
}

#[test]
fn a_view_or_a_backend_that_is_not_there_is_refused_with_those_that_are() {
    let message = refused_with(&endless(), "--view normals");
    assert!(message.contains("normal, depth, id"), "{message}");
    let message = refused_with(&endless(), "--backend gpu");
    assert!(message.contains("embree, rust"), "{message}");
}

#[test]
fn a_second_scene_is_refused() {
    assert!(refused_with(&endless(), "other.toml").contains("other.toml"));
}
