//! The counters of the work for each scene feature: exactly 0 where nothing needs it.

use super::*;
use envers::scene::Feature;

/// A triangle that needs none of the work that is counted.
const BARE: &str = r##"
[film]
size = [40, 30]

[camera]
position = [0, 0, 3]
look_at = [0, 0, 0]

[[material]]
name = "unused"
diffuse_map = "wood.png"

[[material]]
name = "chosen"
#chosen

[[model]]
file = "triangle.obj"
material = "chosen"

[[light]]
kind = "directional"
direction = [0, 0.2, -1]
shadow = false
"##;

const TRIANGLE: &str = "\
v -1 -1 0\nv 1 -1 0\nv 0 1 0\n\
vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n\
f 1/1 2/2 3/3\n";

const PLANE: &str = "[[plane]]\npoint = [0, -2, 0]\nnormal = [0, 1, 0]\n";

fn bare() -> Folder {
    let folder = Folder::with(BARE);
    folder.write("triangle.obj", TRIANGLE);
    image::RgbImage::from_pixel(2, 2, image::Rgb([150, 100, 50]))
        .save(folder.path("wood.png"))
        .unwrap();
    folder
}

/// The bare scene and something more.
fn bare_and(more: &str) -> Folder {
    let folder = bare();
    folder.write("scene.toml", BARE.to_owned() + more);
    folder
}

/// The bare scene of a chosen material.
fn made_of(chosen: &str) -> Folder {
    let folder = bare();
    folder.write("scene.toml", BARE.replace("#chosen", chosen));
    folder
}

/// The bare scene with another triangle in its file.
fn shaped(from: &str, to: &str) -> Folder {
    let folder = bare();
    folder.write("triangle.obj", TRIANGLE.replace(from, to));
    folder
}

/// Returns the counters of the work of a rendering.
fn work(folder: &Folder, flags: &str) -> Value {
    let run = folder.run(&format!("render scene.toml -o work.png --stats - {flags}")).good();
    run.json()["work"].clone()
}

/// Asserts which kinds of work were done at all, and that of all others exactly nothing was.
#[track_caller]
fn assert_done(folder: &Folder, expected: &[&str]) {
    let mut flags = vec!["--backend rust"];
    if cfg!(feature = "embree") {
        flags.extend(["--precision fast", "--precision certified"]);
    }
    for flags in flags {
        let work = work(folder, flags);
        let counts = Feature::ALL.map(|work| work.name());
        // The BVH always has a level of instances.
        let counted = |name: &&str| !(*name == "instances" && flags == "--backend rust");
        let done = counts.into_iter().filter(counted).filter(|&name| {
            work[name].as_u64().unwrap_or_else(|| panic!("{name} is not counted")) > 0
        });
        let expected: Vec<_> = expected.iter().copied().filter(counted).collect();
        assert_eq!(done.collect::<Vec<_>>(), expected, "{flags}: {work}");
    }
}

#[test]
fn a_bare_scene_needs_none_of_it() {
    assert_done(&bare(), &[]);
}

#[test]
fn spheres_are_there_for_spheres_alone() {
    assert_done(&bare_and("[[sphere]]\ncenter = [0, 1, 0]\nradius = 0.5"), &["spheres"]);
}

#[test]
fn instances_are_there_for_meshes_that_stand_twice() {
    let second = "[[model]]\nfile = \"triangle.obj\"\ntranslate = [0, 0, -1]";
    assert_done(&bare_and(second), &["instances"]);
}

#[test]
fn planes_are_tried_where_there_are_planes() {
    assert_done(&bare_and(PLANE), &["planes"]);
}

#[test]
fn pictures_and_texture_coordinates_are_there_for_textures() {
    assert_done(&made_of("diffuse_map = \"wood.png\""), &["pictures", "uv"]);
}

#[test]
fn checkers_are_looked_up_where_a_plane_has_one() {
    let checker = PLANE.to_owned() + "checker = { colors = [0.2, 0.7], size = 0.5 }";
    assert_done(&bare_and(&checker), &["planes", "checkers"]);
}

#[test]
fn vertex_colors_are_mixed_where_a_mesh_has_them() {
    let colored = shaped(
        "v -1 -1 0\nv 1 -1 0\nv 0 1 0\n",
        "v -1 -1 0 1 0 0\nv 1 -1 0 0 1 0\nv 0 1 0 0 0 1\n",
    );
    assert_done(&colored, &["vertex-colors"]);
}

#[test]
fn normals_are_interpolated_where_a_mesh_has_them() {
    assert_done(&shaped("f 1/1 2/2 3/3", "f 1/1/1 2/2/1 3/3/1"), &["smooth-normals"]);
}

#[test]
fn highlights_are_worked_out_where_a_material_has_one() {
    assert_done(&made_of("specular = 0.5"), &["highlights"]);
}

#[test]
fn shadow_rays_go_out_to_lights_that_cast_shadows() {
    let folder = bare();
    folder.write("scene.toml", BARE.replace("shadow = false", ""));
    assert_done(&folder, &["shadows"]);
}

#[test]
fn rays_are_reflected_where_a_material_is_a_mirror() {
    assert_done(&made_of("reflect = 0.5"), &["reflection"]);
}

#[test]
fn rays_are_refracted_where_a_material_is_glass() {
    assert_done(&made_of("transmit = 0.5\nthin = true"), &["reflection", "refraction"]);
}

#[test]
fn a_mirror_is_followed_unless_its_share_is_exactly_nothing() {
    // 1e-44 is about the least that f32 holds.
    for (share, followed) in [("1e-44", true), ("0.0", false)] {
        let folder = made_of(&format!("reflect = {share}"));
        assert_eq!(work(&folder, "")["reflection"].as_u64().unwrap() > 0, followed, "{share}");
    }
}

#[test]
fn shadow_rays_look_for_glass_where_there_is_some() {
    let lit = BARE.replace("shadow = false", "");
    let folder = bare();
    folder.write("scene.toml", &lit);
    assert_eq!(work(&folder, "")["glass-in-shadows"], 0);
    let glass = "transmit = 0.5\nthin = true";
    folder.write("scene.toml", lit.replace("#chosen", glass));
    assert!(work(&folder, "")["glass-in-shadows"].as_u64().unwrap() > 0);
}

#[test]
#[cfg(feature = "embree")]
fn filters_look_at_hits_of_rays_that_left_a_surface_in_fast() {
    assert_eq!(work(&bare(), "")["filters"], 0);
    let mirror = made_of("reflect = 0.5");
    assert!(work(&mirror, "")["filters"].as_u64().unwrap() > 0);
    assert_eq!(work(&mirror, "--precision certified")["filters"], 0);
}

#[test]
fn each_picture_that_is_asked_for_is_encoded_and_no_other() {
    assert_eq!(work(&bare(), "")["layers"], 1);
    assert_eq!(work(&bare(), "-o more.exr")["layers"], 2);
}

#[test]
fn a_debug_view_shades_nothing() {
    let folder = made_of("specular = 0.5\ndiffuse_map = \"wood.png\"");
    let work = work(&folder, "--view normal");
    for kind in ["uv", "highlights", "shadows"] {
        assert_eq!(work[kind], 0, "{kind}");
    }
}

#[test]
fn counts_do_not_depend_on_the_number_of_threads() {
    let folder = Folder::with_everything();
    assert_eq!(work(&folder, "--threads 1"), work(&folder, "--threads 3"));
}
