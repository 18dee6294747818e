//! A feature that the picture does not need, of something out of sight, changes no byte of it; a
//! feature that the scene does not have costs nothing.

use super::*;
use envers::scene::Feature;

/// A mesh that stands once, and a material with a picture that nothing is made of.
const PLAIN: &str = r##"
[film]
size = [60, 40]

[camera]
position = [2, 2, 3]
look_at = [0.3, 0.3, 0.3]

[[material]]
name = "unused"
diffuse_map = "wood.png"

[[model]]
file = "tetrahedron.obj"
rotate = [0, 20, 0]

[[light]]
kind = "directional"
direction = [-1, -2, -1]
"##;

fn plain() -> Folder {
    let folder = Folder::with(PLAIN);
    folder.write("tetrahedron.obj", TETRAHEDRON);
    write_picture(&folder);
    folder
}

fn write_picture(folder: &Folder) {
    image::RgbImage::from_pixel(2, 2, image::Rgb([150, 100, 50]))
        .save(folder.path("wood.png"))
        .unwrap();
}

fn backends() -> &'static [&'static str] {
    if cfg!(feature = "embree") { &["embree", "rust"] } else { &["rust"] }
}

/// The counts of work of a rendering.
fn work(folder: &Folder, flags: &str) -> Value {
    let run = folder.run(&format!("render scene.toml -o work.png --stats - {flags}")).good();
    run.json()["work"].clone()
}

/// A place that neither the camera nor any other ray of a scene sees, and a plane behind it.
struct OutOfSight {
    /// A point; nothing is seen for 1 about it.
    point: [f64; 3],
    /// A point of the plane.
    plane: [f64; 3],
    normal: [f64; 3],
}

impl OutOfSight {
    /// The place under an opaque ground at y = 0.
    const UNDERGROUND: Self =
        Self { point: [0.0, -5.0, 0.0], plane: [0.0, -9.0, 0.0], normal: [0.0, 1.0, 0.0] };

    /// The place behind the camera of [`PLAIN`].
    const BEHIND_PLAIN: Self =
        Self { point: [7.0, 5.0, 10.0], plane: [8.0, 8.0, 12.0], normal: [1.7, 1.7, 2.7] };

    /// The place behind the camera of the tutorial's scenes, and a plane behind their light.
    const BEHIND_TUTORIAL: Self =
        Self { point: [0.0, 0.0, -8.0], plane: [0.0, 0.0, -40.0], normal: [0.0, 0.0, 1.0] };

    /// Returns tables of a scene file with something that needs a feature.
    fn tables(&self, work: Feature) -> String {
        let Self { point: at, plane, normal } = self;
        let material = |keys: &str| format!("[[material]]\nname = \"needless\"\n{keys}\n");
        let sphere = format!("[[sphere]]\ncenter = {at:?}\nradius = 0.5\n");
        let made_of = |keys: &str| material(keys) + &sphere + "material = \"needless\"\n";
        let model =
            |file: &str| format!("[[model]]\nfile = \"{file}\"\ntranslate = {at:?}\nscale = 0.5\n");
        // What reaches to infinity may keep the light from what is seen.
        let plane =
            format!("[[plane]]\npoint = {plane:?}\nnormal = {normal:?}\ncasts_shadow = false\n");
        match work {
            Feature::Spheres => sphere,
            // One across the other.
            Feature::Instances => {
                model("needless.obj") + &model("needless.obj") + "rotate = [50, 50, 0]\n"
            }
            Feature::Planes => plane,
            Feature::Pictures | Feature::Uv => made_of("diffuse_map = \"wood.png\""),
            Feature::Mipmaps => made_of("diffuse_map = \"wood.png\"\nfilter = \"mipmap\""),
            Feature::NormalMaps => made_of("normal_map = \"wood.png\""),
            Feature::AlphaTests => {
                material("diffuse_map = \"holes.png\"\nalpha_mode = \"mask\"")
                    + &model("needless.obj")
                    + "material = \"needless\"\n"
            }
            Feature::Checkers => plane + "checker = { colors = [0.2, 0.7], size = 0.5 }\n",
            Feature::VertexColors => model("colored.obj"),
            Feature::SmoothNormals => model("smooth.obj"),
            Feature::Highlights => made_of("specular = 0.5"),
            Feature::Shadows => {
                format!("[[light]]\nkind = \"point\"\nposition = {at:?}\nintensity = 0\n")
            }
            Feature::Reflection => made_of("reflect = 0.5"),
            Feature::Refraction => made_of("transmit = 0.5"),
            Feature::Culling => model("one-sided.glb"),
            Feature::AreaLights => format!(
                "[[light]]\nkind = \"sphere\"\nposition = {at:?}\nradius = 0.5\nintensity = 0\n\
                 visible = false\n"
            ),
            // In a ball that keeps its light.
            Feature::EmissiveLights => {
                made_of("emission = 1\nilluminates = true")
                    + &format!("[[sphere]]\ncenter = {at:?}\nradius = 0.7\n")
            }
            Feature::Pbr => made_of("roughness = 0.5"),
            Feature::Environment => "[environment]\ncolor = 0\nvisible = false\n".to_owned(),
        }
    }
}

/// Writes the files that [`OutOfSight::tables`] names.
fn write_needless_files(folder: &Folder) {
    let corners = ["v 0 0 0", "v 1 0 0", "v 0 1 0"];
    let triangle = corners.join("\n") + "\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nvn 0 1 1\nvn 1 0 1\n";
    let colored = corners.map(|corner| corner.to_owned() + " 1 0.5 0\n").concat();
    folder.write("needless.obj", triangle.clone() + "f 1/1 2/2 3/3\n");
    folder.write("smooth.obj", triangle + "f 1/1/1 2/2/2 3/3/3\n");
    folder.write("colored.obj", colored + "f 1 2 3\n");
    let mut one_sided = envers_testing::Model::triangle();
    one_sided.material(serde_json::json!({"doubleSided": false}));
    folder.write("one-sided.glb", one_sided.glb());
    folder.write("holes.png", envers_testing::png(&[[255, 255, 255, 255], [255, 255, 255, 0]]));
    write_picture(folder);
}

/// Asserts that the certified picture of `scene.toml` is the same bytes when something that needs a
/// feature is added out of sight, each in turn, and when all of them are.
#[track_caller]
fn assert_same(folder: &Folder, out_of_sight: &OutOfSight, flags: &str) {
    write_needless_files(folder);
    let scene = String::from_utf8(folder.read("scene.toml")).unwrap();
    for backend in backends() {
        let flags = format!("--precision certified --backend {backend} --spp 1 {flags}");
        folder.run(&format!("render scene.toml -o without.exr {flags}")).good();
        let tables = Feature::ALL.map(|work| (work.name(), out_of_sight.tables(work)));
        // One material is as good as another: the names must differ.
        let all = tables
            .iter()
            .enumerate()
            .map(|(i, (_, tables))| tables.replace("\"needless\"", &format!("\"needless {i}\"")));
        let all = all.collect::<String>();
        for (name, tables) in tables.iter().map(|(name, t)| (*name, t)).chain([("all", &all)]) {
            folder.write("more.toml", scene.clone() + "\n" + tables);
            folder.run(&format!("render more.toml -o with.exr {flags}")).good();
            assert!(folder.read("without.exr") == folder.read("with.exr"), "{name} on {backend}");
        }
    }
}

/// Asserts the same as [`assert_same`] of a small picture of a scene that comes with envers and names these files.
#[track_caller]
fn assert_same_of_asset(name: &str, files: &[&str], out_of_sight: &OutOfSight) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes").join(name);
    let folder = Folder::new();
    folder.write("scene.toml", std::fs::read(&path).unwrap());
    for file in files {
        std::fs::create_dir_all(folder.path(file).parent().unwrap()).unwrap();
        folder.write(file, std::fs::read(path.with_file_name(file)).unwrap());
    }
    assert_same(&folder, out_of_sight, "--size 72x48");
}

#[test]
fn the_picture_of_a_scene_that_needs_nothing_is_the_same_with_each_feature_out_of_sight() {
    assert_same(&plain(), &OutOfSight::BEHIND_PLAIN, "");
}

#[test]
fn the_picture_of_a_scene_with_everything_in_it_is_the_same_with_each_feature_out_of_sight() {
    assert_same(&Folder::with_everything(), &OutOfSight::UNDERGROUND, "");
}

#[test]
fn the_picture_of_the_room_is_the_same_with_each_feature_out_of_sight() {
    let files = ["gallery/models/room.glb"];
    assert_same_of_asset("room.toml", &files, &OutOfSight::UNDERGROUND);
}

#[test]
fn the_picture_of_gems_is_the_same_with_each_feature_out_of_sight() {
    let files = ["models/gem.obj", "models/sky.png"];
    assert_same_of_asset("gallery/gems.toml", &files, &OutOfSight::UNDERGROUND);
}

#[test]
fn the_picture_of_a_lit_sphere_is_the_same_with_each_feature_out_of_sight() {
    assert_same_of_asset("tutorial/3-2-lambert.toml", &[], &OutOfSight::BEHIND_TUTORIAL);
}

#[test]
fn each_feature_out_of_sight_is_one_that_the_scene_needs() {
    let folder = plain();
    write_needless_files(&folder);
    let plain = PLAIN.to_owned() + "shadow = false\n";
    for work in Feature::ALL {
        let needs = |scene: String| {
            folder.write("scene.toml", scene);
            let info = folder.run("info scene.toml --json -").good().json();
            let [needed, skipped] =
                ["needed", "skipped"].map(|key| !info[key][work.name()].is_null());
            assert_ne!(needed, skipped, "{}", work.name());
            needed
        };
        assert!(!needs(plain.clone()), "{}", work.name());
        let with = plain.clone() + &OutOfSight::BEHIND_PLAIN.tables(work);
        assert!(needs(with), "{}", work.name());
    }
}

/// The rest of the work is done at points that are seen.
#[test]
fn trees_planes_pictures_and_normals_are_made_for_features_out_of_sight() {
    let folder = plain();
    write_needless_files(&folder);
    let plain = PLAIN.to_owned() + "shadow = false\n";
    for backend in backends() {
        let done = |scene: &str, kind: Feature| {
            folder.write("scene.toml", scene);
            let count = &work(&folder, &format!("--backend {backend}"))[kind.name()];
            count.as_u64().unwrap_or_else(|| panic!("{} is not counted", kind.name())) > 0
        };
        for kind in Feature::ALL {
            let is_done_anyway = match kind {
                Feature::Spheres | Feature::Planes | Feature::Pictures => true,
                Feature::AlphaTests | Feature::SmoothNormals => true,
                // Its light is looked for wherever it may fall.
                Feature::EmissiveLights => true,
                // It is all around.
                Feature::Environment => true,
                // The BVH always has a level of instances.
                Feature::Instances if *backend == "rust" => continue,
                Feature::Instances => true,
                _ => false,
            };
            let with = plain.clone() + &OutOfSight::BEHIND_PLAIN.tables(kind);
            assert!(!done(&plain, kind), "{} on {backend}", kind.name());
            assert_eq!(done(&with, kind), is_done_anyway, "{} on {backend}", kind.name());
        }
    }
}

#[test]
#[cfg(feature = "embree")]
fn no_spheres_make_no_user_geometry() {
    let folder = plain();
    assert_eq!(work(&folder, "")["spheres"], 0);
    folder
        .write("scene.toml", PLAIN.to_owned() + &OutOfSight::BEHIND_PLAIN.tables(Feature::Spheres));
    assert_eq!(work(&folder, "")["spheres"], 1);
    assert_eq!(work(&Folder::with(SPHERE), "")["spheres"], 1);
}

#[test]
#[cfg(feature = "embree")]
fn meshes_that_stand_once_make_no_instances() {
    for precision in ["fast", "certified"] {
        let folder = plain();
        let flags = format!("--precision {precision}");
        assert_eq!(work(&folder, &flags)["instances"], 0, "{precision}");
        let again = "\n[[model]]\nfile = \"tetrahedron.obj\"\ntranslate = [7, 5, 10]\n";
        folder.write("scene.toml", PLAIN.to_owned() + again);
        assert_eq!(work(&folder, &flags)["instances"], 2, "{precision}");
    }
    assert_eq!(work(&Folder::with_everything(), "")["instances"], 2);
}

#[test]
fn pictures_that_nothing_shows_are_not_read() {
    let folder = plain();
    assert_eq!(work(&folder, "")["pictures"], 0);
    folder.write(
        "scene.toml",
        PLAIN.to_owned() + &OutOfSight::BEHIND_PLAIN.tables(Feature::Pictures),
    );
    assert_eq!(work(&folder, "")["pictures"], 1);
    folder.write("scene.toml", PLAIN.replace("rotate =", "material = \"unused\"\nrotate ="));
    assert_eq!(work(&folder, "")["pictures"], 1);
}

#[test]
fn a_picture_that_nothing_shows_may_be_damaged_and_is_not_overwritten() {
    let folder = plain();
    folder.write("wood.png", "no picture");
    folder.run("render scene.toml -o a.png").good();
    let said = folder.run("render scene.toml -o wood.png").refused();
    assert!(said.contains("this output is an input file"), "{said}");
    folder.write("scene.toml", PLAIN.replace("rotate =", "material = \"unused\"\nrotate ="));
    let said = folder.run("render scene.toml -o a.png").refused();
    assert!(said.contains("wood.png"), "{said}");
}

#[test]
fn lights_and_materials_that_are_not_there_cast_no_rays() {
    let folder = plain();
    folder.write("scene.toml", PLAIN.to_owned() + "shadow = false\n");
    let work = work(&folder, "");
    for none in ["shadows", "reflection", "refraction"] {
        assert_eq!(work[none], 0, "{none}");
    }
}

#[test]
#[cfg(feature = "embree")]
fn statistics_say_why_work_is_skipped() {
    let folder = plain();
    let stats = folder.run("render scene.toml -o a.png --stats -").good().json();
    assert_eq!(stats["skipped"]["spheres"], "there are no spheres");
    assert_eq!(stats["skipped"]["instances"], "0 of 1 meshes stand more than once");
    assert_eq!(stats["skipped"]["pictures"], "0 of 1 pictures are on a material in use");
    assert!(stats["skipped"]["shadows"].is_null());
    let again = "\n[[model]]\nfile = \"tetrahedron.obj\"\ntranslate = [7, 5, 10]\n";
    let sphere = OutOfSight::BEHIND_PLAIN.tables(Feature::Spheres);
    folder.write("scene.toml", PLAIN.to_owned() + again + &sphere);
    let stats = folder.run("render scene.toml -o a.png --stats -").good().json();
    assert!(stats["skipped"]["spheres"].is_null() && stats["skipped"]["instances"].is_null());
}

#[test]
fn no_flag_does_work_that_a_scene_does_not_need() {
    let said = plain().run("render scene.toml -o a.png --no-skip spheres").refused();
    assert!(said.contains("'--no-skip'"), "{said}");
}

#[test]
fn the_help_names_no_such_flag() {
    assert!(!plain().run("render --help").good().stdout.contains("no-skip"));
}

#[test]
fn info_says_what_is_needed_and_what_is_skipped_and_why() {
    let said = plain().run("info scene.toml --verbose").good().stdout;
    assert!(said.contains("\nneeds      shadows: 1 of 1 lights cast shadows\n"), "{said}");
    assert!(said.contains("\nskips      spheres: there are no spheres\n"), "{said}");
    let json = plain().run("info scene.toml --json -").good().json();
    assert_eq!(json["needed"]["shadows"], "1 of 1 lights cast shadows");
    assert_eq!(json["skipped"]["instances"], "0 of 1 meshes stand more than once");
}
