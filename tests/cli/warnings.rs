//! The warnings on stderr about input that is probably not meant, with the likely cause.

use super::*;

const LIGHT: &str = "[[light]]\nkind = \"point\"\nposition = [3, 5, 4]\n";

/// The one warning of a picture that is made all the same.
#[track_caller]
fn warned(scene: &str) -> String {
    let folder = Folder::with(scene);
    let run = folder.run("render scene.toml -o a.png");
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    assert!(run.stderr.starts_with("warning: "), "{}", run.stderr);
    assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    assert!(folder.has("a.png"));
    run.stderr
}

#[test]
fn a_scene_without_light_is_told_how_to_get_one() {
    let warning = warned(&SPHERE.replace(LIGHT, ""));
    assert!(warning.contains("no light") && warning.contains("[[light]]"), "{warning}");
}

#[test]
fn a_camera_that_looks_away_is_told_where_the_scene_is() {
    let turned = SPHERE
        .replace("[0, 1, 5]", "[0, 1, 50]")
        .replace("look_at = [0, 0.5, 0]", "look_at = [0, 99, 50.1]");
    let warning = warned(&turned);
    assert!(warning.contains("empty") && warning.contains("[0, 0.5, 0]"), "{warning}");
}

#[test]
fn the_camera_that_is_warned_of_is_the_one_that_was_asked_for() {
    let away = "[[camera]]\nname = \"away\"\nposition = [0, 77, 0]\nlook_at = [0, 99, 1]\n";
    let folder = Folder::with(&format!("{}{away}", SPHERE.replace("[camera]", "[[camera]]")));
    let run = folder.run("render scene.toml --camera away");
    assert!(run.stderr.contains("[0, 77, 0]"), "{}", run.stderr);
}

#[test]
fn a_camera_that_looks_away_from_a_plane_is_told_so() {
    let plane = "[[plane]]\npoint = [0, -1, 0]\nnormal = [0, 1, 0]\n";
    let camera = "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 1, 0.1]\n";
    let warning = warned(&format!("[film]\nsize = [8, 8]\n{camera}{plane}"));
    assert!(warning.ends_with("sees nothing of the scene\n"), "{warning}");
}

#[test]
fn a_black_picture_is_told_the_likely_cause() {
    let dark = SPHERE.replace("background = \"#203040\"\n", "");
    let warning = warned(&dark.replace("position = [3, 5, 4]", "position = [0, -5, 0]"));
    assert!(warning.contains("completely black") && warning.contains("behind"), "{warning}");
}

#[test]
fn warnings_stand_in_the_statistics_too() {
    let folder = Folder::with(&SPHERE.replace(LIGHT, ""));
    let run = folder.run("render scene.toml --stats -");
    let warnings = run.json()["warnings"].clone();
    assert_eq!(warnings.as_array().unwrap().len(), 1);
    assert_eq!(run.stderr, format!("warning: {}\n", warnings[0].as_str().unwrap()));
}

#[test]
fn a_missing_texture_is_a_warning() {
    let folder = Folder::new();
    folder.write("m.mtl", "newmtl a\nmap_Kd gone.png\n");
    folder.write("m.obj", format!("mtllib m.mtl\nusemtl a\n{TETRAHEDRON}"));
    let run = folder.run("render m.obj --size 20x20");
    assert_eq!(run.status, Some(0));
    assert!(
        run.stderr.starts_with("warning: ") && run.stderr.contains("gone.png"),
        "{}",
        run.stderr
    );
}

/// The scene with a highlight and a lamp whose product is beyond f32.
fn blinding() -> String {
    SPHERE
        .replace("specular = 0.5", "specular = 1e20")
        .replace(LIGHT, &format!("{LIGHT}intensity = 1e20\n"))
}

#[test]
fn samples_that_are_not_finite_are_told_with_their_cause() {
    let warning = warned(&blinding());
    assert!(
        warning.contains("samples were left out") && warning.contains("lower the intensity"),
        "{warning}"
    );
}

#[test]
fn samples_that_are_not_finite_stand_in_the_statistics_by_cause() {
    let stats = Folder::with(&blinding()).run("render scene.toml --stats - --quiet").json();
    let counts = &stats["not_finite"];
    assert_eq!((&counts["light"], &counts["surface"]), (&0.into(), &0.into()));
    assert!(counts["sum"].as_u64() > Some(0), "{counts}");
}

#[test]
fn samples_that_are_not_finite_reach_no_file() {
    let folder = Folder::with(&blinding());
    assert_eq!(folder.run("render scene.toml -o a.exr -o a.png --quiet").status, Some(0));
    let picture = envers::measure::Picture::read(&folder.path("a.exr")).unwrap();
    assert!(picture.values.iter().all(|x| x.is_finite()));
}

/// A mesh whose triangles are 1e-5 large, beside a ball at a distance of 1.
fn speck() -> Folder {
    let folder = Folder::with(
        "[camera]\nposition = [0, 0, 3]\nlook_at = [0, 0, 0]\n[[model]]\nfile = \"speck.obj\"\n\
         [[sphere]]\ncenter = [1, 0, 0]\nradius = 0.3\n\
         [[light]]\nkind = \"ambient\"\n",
    );
    folder.write("speck.obj", "o speck\nv 0 0 0\nv 1e-5 0 0\nv 0 1e-5 0\nf 1 2 3\n");
    folder
}

#[test]
fn detail_is_no_matter_in_any_precision_or_backend() {
    speck().run("render scene.toml --size 20x20").good();
    speck().run("render scene.toml --size 20x20 --precision certified").good();
    speck().run("render scene.toml --size 20x20 --backend rust").good();
}

#[test]
fn layers_beyond_the_limit_are_warned_of_once_with_their_rays() {
    let folder = Folder::new();
    let cards = |count: usize| {
        let corners = |i: usize| {
            let z = -0.01 * i as f64;
            format!("v -1 -1 {z}\nv 1 -1 {z}\nv 1 1 {z}\nv -1 1 {z}\nf -4 -3 -2 -1\n")
        };
        "mtllib c.mtl\nusemtl a\n".to_owned() + &(0..count).map(corners).collect::<String>()
    };
    folder.write("c.mtl", "newmtl a\nKd 0.5 0.5 0.5\nd 0.01\n");
    for (count, is_warned) in [(256, false), (257, true)] {
        folder.write("c.obj", cards(count));
        let run = folder.run("render c.obj -o a.png --size 8x8 --spp 1");
        assert_eq!(run.status, Some(0), "{}", run.stderr);
        let said = run.stderr.contains("black behind 256 transparent layers");
        assert_eq!(said, is_warned, "{}", run.stderr);
    }
}

#[test]
fn double_sided_shows_what_is_seen_from_behind() {
    let folder = Folder::new();
    let mut model = envers_testing::Model::triangle();
    model.material(serde_json::json!({"extensions": {"KHR_materials_unlit": {}}}));
    folder.write("a.glb", model.glb());
    let scene = "[film]\nsize = [9, 9]\n[camera]\nposition = [0.3, 0.3, -3]\nlook_at = [0.3, 0.3, 0]\n\
                 [[model]]\nfile = \"a.glb\"\n";
    folder.write("scene.toml", scene);
    let middle = |flags: &str| {
        let run = folder.run(&format!("render scene.toml -o a.png {flags}"));
        let picture = image::open(folder.path("a.png")).unwrap().into_rgb8();
        (picture.get_pixel(4, 4).0, run.stderr.contains("the image is empty"))
    };
    assert_eq!(middle("--double-sided"), ([255; 3], false));
    assert_eq!(middle(""), ([0; 3], true));
}

#[test]
fn picture_of_nothing_but_backs_names_the_flag_that_shows_them() {
    let mut model = envers_testing::Model::triangle();
    model.material(serde_json::json!({"doubleSided": false}));
    let folder = Folder::new();
    folder.write("model.glb", model.glb());
    let stderr = |azimuth: u32| {
        let flags = "--size 32x24 --spp 1 --elevation 0 --azimuth";
        folder.run(&format!("render model.glb {flags} {azimuth}")).stderr
    };
    assert_eq!(stderr(0), "");
    assert!(stderr(180).contains("`--double-sided`"), "{}", stderr(180));
}
