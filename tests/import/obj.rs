//! The scenes that OBJ and MTL files become: each test one feature or one fault.

use envers::scene::{Positions, ShininessMap, Texels, Transfer, Wrap};
use envers::{AlphaMode, Error, Loaded, Location, Material};
use envers_testing::{Folder, png};
use glam::{Vec2, Vec3};

use super::loading::{LoadFile, assert_warns};

/// A triangle's vertices.
const VERTICES: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

fn load(text: impl AsRef<[u8]>) -> Loaded {
    Folder::new().load("model.obj", text).unwrap()
}

/// Loads a triangle of material `m` with an MTL file, and gives its material.
fn with_mtl(folder: &Folder, mtl: &str) -> (Loaded, Material) {
    folder.write("m.mtl", mtl);
    let text = format!("mtllib m.mtl\nusemtl m\n{VERTICES}f 1 2 3\n");
    let loaded = folder.load("model.obj", text).unwrap();
    let scene = &loaded.scene;
    let material = scene.materials[scene.instances[0].material.0 as usize].clone();
    (loaded, material)
}

fn fails(text: impl AsRef<[u8]>) -> Error {
    Folder::new().load("model.obj", text).map(|s| s.scene.triangle_count()).unwrap_err()
}

// Geometry

#[test]
fn triangle() {
    let loaded = load(format!("{VERTICES}f 1 2 3"));
    let scene = &loaded.scene;
    assert_eq!(scene.meshes[0].positions, [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    assert!(loaded.report.warnings.is_empty(), "{:?}", loaded.report.warnings);
}

#[test]
fn negative_indices_count_back_from_the_face() {
    let scene = load("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5").scene;
    assert_eq!(scene.meshes[0].positions, [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
}

#[test]
fn lines_of_an_old_mac() {
    assert_eq!(load(format!("{VERTICES}f 1 2 3").replace('\n', "\r")).scene.triangle_count(), 1);
}

#[test]
fn a_vertex_with_a_weight_is_divided_by_it() {
    let scene = load("v 0 0 0\nv 2 0 0 2\nv 0 1 0 1\nf 1 2 3").scene;
    assert_eq!(scene.meshes[0].positions.at(1).to_array(), [1., 0., 0.]);
}

#[test]
fn words_that_are_no_keywords_are_a_warning() {
    let loaded = load(format!("{VERTICES}foo 1\nlod 2\nf 1 2 3"));
    assert_warns(&loaded, "first word is none of Wavefront OBJ, at line 4 (`foo`)");
}

#[test]
fn faces_before_their_vertices() {
    assert_eq!(load(format!("f 1 2 3\n{VERTICES}")).scene.triangle_count(), 1);
}

#[test]
fn quad_is_two_triangles() {
    let scene = load("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4").scene;
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn concave_polygon_stays_within_its_outline() {
    // An L: a fan from its first corner would cover what lies outside.
    let scene = load("v 0 0 0\nv 0 2 0\nv 1 2 0\nv 1 1 0\nv 2 1 0\nv 2 0 0\nf 2 3 4 5 6 1").scene;
    let mesh = &scene.meshes[0];
    let area: f64 = mesh
        .triangles
        .iter()
        .map(|t| t.map(|i| mesh.positions.at(i as usize)))
        .map(|[a, b, c]| (b - a).cross(c - a).z / 2.0)
        .inspect(|area| assert!(*area <= 0.0, "wound the other way"))
        .sum();
    assert_eq!(area, -3.0);
}

#[test]
fn normals_and_flipped_texture_coordinates() {
    let scene =
        load(format!("{VERTICES}vt 0 0\nvt 1 0.25\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1")).scene;
    assert_eq!(scene.meshes[0].uvs, [[0., 1.], [1., 0.75], [0., 0.]]);
    assert_eq!(scene.meshes[0].normals, [[0., 0., 1.]; 3]);
}

#[test]
fn without_normals_a_mesh_is_flat() {
    assert!(load(format!("{VERTICES}f 1 2 3")).scene.meshes[0].normals.is_empty());
}

#[test]
fn smoothing_group_makes_normals() {
    // A roof: the normals at its ridge lie between those of its sides.
    let roof = "v 0 0 0\nv 0 0 2\nv 1 1 0\nv 1 1 2\nv 2 0 0\nv 2 0 2\n";
    let faces = "s 1\nf 1 2 4 3\nf 3 4 6 5";
    let mesh = &load(format!("{roof}{faces}")).scene.meshes[0];
    let ridge = mesh.positions.iter().position(|p| p.to_array() == [1., 1., 0.]).unwrap();
    assert!((Vec3::from(mesh.normals[ridge]) - Vec3::Y).length() < 1e-6, "{:?}", mesh.normals);
    assert!(load(format!("{roof}s off\n{faces}")).scene.meshes[0].normals.len() == 6);
    assert!(
        load(format!("{roof}{}", faces.replace("s 1", "s off"))).scene.meshes[0].normals.is_empty()
    );
}

#[test]
fn faces_with_and_without_normals_keep_what_they_have() {
    let scene =
        load(format!("{VERTICES}vn 0 0 1\nf 1//1 2//1 3//1\nf 3 2 1\nf 2//1 3//1 1//1")).scene;
    let lengths: Vec<_> =
        scene.meshes.iter().map(|m| (m.triangles.len(), m.normals.len())).collect();
    assert_eq!(lengths, [(2, 3), (1, 0)]);
}

#[test]
fn vertex_colours_are_decoded_and_white_where_missing() {
    let scene = load("v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 0 0 0\nf 1 2 3").scene;
    let colors = &scene.meshes[0].colors;
    assert_eq!((colors[1], colors[2]), ([1.; 3], [0.; 3]));
    assert!((colors[0][1] - 0.214_041).abs() < 1e-5, "{colors:?}");
}

#[test]
fn polypaint_colours_the_vertices_in_their_order() {
    let square = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";
    let painted = |lines: &str| load(format!("{square}{lines}f 1 2 3 4\n"));
    let [red, blue] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    for lines in [
        "#MRGB ffff0000ffff0000ff0000ffff0000ff\n",
        "#MRGB FFFF0000 FFFF0000 FF0000FF FF0000FF\r\n",
        "# Polypaint\n #MRGB 00ff0000ffff0000\n#MRGB ff0000ff000000ff\n# End of MRGB block\n",
    ] {
        let loaded = painted(lines);
        assert_eq!(loaded.scene.meshes[0].colors, [red, red, blue, blue], "{lines}");
        assert_eq!(loaded.report.warnings, [""; 0], "{lines}");
    }
    let loaded = painted("#MRGB ffff0000ff00\n");
    assert_eq!(loaded.scene.meshes[0].colors, [red, [1.0; 3], [1.0; 3], [1.0; 3]]);
    assert_warns(&loaded, "eight hexadecimal digits");
    assert_warns(&loaded, "1 vertices have a colour in comments (`#MRGB`), of 4");
}

#[test]
fn vertex_colours_above_1_go_up_to_255() {
    let scene = load("v 0 0 0 255 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 0\nf 1 2 3").scene;
    let colors = &scene.meshes[0].colors;
    assert_eq!(colors[0], [1.0, 0.0, 0.0]);
    assert!(colors[1][1] < 1e-3, "{colors:?}");
}

#[test]
fn objects_and_materials_are_meshes() {
    let scene = load(format!(
        "{VERTICES}o a\nusemtl x\nf 1 2 3\nusemtl y\nf 1 2 3\nusemtl x\nf 3 2 1\no b\nf 1 2 3"
    ))
    .scene;
    let parts: Vec<_> = scene
        .instances
        .iter()
        .map(|i| {
            let mesh = &scene.meshes[i.mesh.0 as usize];
            let material = &scene.materials[i.material.0 as usize];
            (mesh.name.as_str(), material.name.as_str(), mesh.triangles.len())
        })
        .collect();
    assert_eq!(parts, [("a", "x", 2), ("a", "y", 1), ("b", "x", 1)]);
    assert_eq!(scene.materials.len(), 2);
}

// The text

#[test]
fn comments_continuations_and_line_ends() {
    let scene = load("# a\r\nv 0 0 0 # b\r\nv 1 0 0# d e\r\nv 0 1 0\r\nf 1 \\\r\n2 3#c\r\n").scene;
    assert_eq!(scene.triangle_count(), 1);
}

#[test]
fn byte_order_mark_latin_1_and_utf_16() {
    let text = format!("o caf\u{e9}\n{VERTICES}f 1 2 3");
    let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
    let wide: Vec<u8> =
        [0xFEFF].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    for bytes in [format!("\u{feff}{text}").into_bytes(), latin, wide] {
        let scene = load(bytes).scene;
        assert_eq!(scene.meshes[0].name, "caf\u{e9}");
        assert_eq!(scene.meshes[0].positions.at(1).to_array(), [1., 0., 0.]);
    }
}

#[test]
fn empty_usemtl_means_no_material() {
    let scene = load(format!("usemtl\n{VERTICES}f 1 2 3")).scene;
    assert_eq!(scene.materials, [Material::default()]);
}

#[test]
fn lines_and_points_are_counted_and_not_drawn() {
    let loaded = load(format!("{VERTICES}l 1 2\np 1\nl 2 3 1\nf 1 2 3"));
    let scene = &loaded.scene;
    assert_eq!(scene.triangle_count(), 1);
    assert_warns(
        &loaded,
        "3 points, lines or curves are left out: only faces are drawn, first at line 4",
    );
}

#[test]
fn file_without_faces_is_a_warning() {
    assert_warns(&load(VERTICES), "no face");
}

// Faults

#[test]
fn number_that_is_none_names_its_line() {
    let error = fails("v 0 0 0\nv 1,5 0 0");
    assert_eq!(error.location(), Some(&Location::Line(2)));
    assert!(error.to_string().contains("1,5"), "{error}");
}

#[test]
fn face_that_is_none_names_its_line() {
    for face in ["f 1 2 x", "f 1/2/3/4 2 3", "f 1 2 /3", "f 1 2 3.5"] {
        let error = fails(format!("{VERTICES}{face}"));
        assert_eq!(error.location(), Some(&Location::Line(4)), "{face}");
    }
}

#[test]
fn vertex_cut_short_names_its_line() {
    assert_eq!(fails("v 0 0").location(), Some(&Location::Line(1)));
}

#[test]
fn compiled_object_file() {
    assert!(fails(b"\x4c\x01\x02\0\0\0").to_string().contains("binary"));
}

#[test]
fn face_of_vertices_that_are_not_there_is_dropped() {
    for bad in ["f 0 1 2", "f 1 2 4", "f -4 1 2", "f 1 2 99999999999999999999"] {
        let loaded = load(format!("{VERTICES}f 1 2 3\n{bad}"));
        let scene = &loaded.scene;
        assert_eq!(scene.triangle_count(), 1, "{bad}");
        assert_warns(&loaded, "faces are left out: they name vertices that are not there");
    }
}

#[test]
fn face_with_normals_that_are_not_there_does_without() {
    let loaded = load(format!("{VERTICES}vn 0 0 1\nf 1//1 2//1 3//7"));
    let scene = &loaded.scene;
    assert!(scene.meshes[0].normals.is_empty());
    assert_warns(&loaded, "faces do without");
}

#[test]
fn vertex_that_is_not_finite_drops_its_faces() {
    for bad in ["nan", "1e400", "-inf", "1.#QNAN", "3.1+e2"] {
        let loaded = load(format!("{VERTICES}v {bad} 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 3 4"));
        let scene = &loaded.scene;
        assert!(scene.triangle_count() >= 1, "{bad}");
        assert!(scene.meshes[0].positions.iter().all(|p| p.is_finite()));
        assert_warns(&loaded, "not finite or beyond 3.4e38, at line 4");
        assert_warns(&loaded, "a corner is not a finite number");
    }
}

#[test]
fn no_number_in_any_spelling_refuses_no_file() {
    for word in [
        "-nan(ind)",
        "nan(snan)",
        "1.#QNAN",
        "-1.#IND",
        "1.#J",
        "1.#inf",
        "inf",
        "-Infinity",
        "NaNQ",
    ] {
        let square =
            format!("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvn {word} {word} {word}\nvn 0 0 1\n");
        let loaded = load(format!("{square}f 1//1 2//2 3//2 4//2"));
        assert_eq!(loaded.scene.meshes[0].normals, [[0.0, 0.0, 1.0]; 4], "{word}");
        assert_warns(&loaded, "a number that is broken, not finite or beyond");
        let loaded = load(format!("{square}vt {word} 0\nvt 1 0\nf 1/1 2/2 3/2 4/2"));
        assert_eq!(loaded.scene.triangle_count(), 2, "{word}");
    }
}

#[test]
fn face_of_two_corners_is_dropped() {
    assert_warns(
        &load(format!("{VERTICES}f 1 2\nf 1 2 3")),
        "faces are left out: they have fewer than three",
    );
}

// Materials

#[test]
fn colours_and_shininess() {
    let (_, m) = with_mtl(&Folder::new(), "newmtl m\nKd .1 .2 .3\nKs .4 .5 .6\nNs 20\nKe 1 2 3");
    assert_eq!(m.diffuse, Vec3::new(0.1, 0.2, 0.3));
    assert_eq!(m.specular, Vec3::new(0.4, 0.5, 0.6));
    assert_eq!(m.shininess, 20.0);
    assert_eq!(m.emission, Vec3::new(1.0, 2.0, 3.0));
}

#[test]
fn what_a_material_does_not_say_is_a_matt_grey() {
    let (loaded, m) = with_mtl(&Folder::new(), "newmtl m");
    assert_eq!(m, Material { name: "m".into(), ..Material::default() });
    assert!(loaded.report.warnings.is_empty());
}

#[test]
fn illumination_models_without_highlight() {
    for (illum, specular) in [(0, 0.0), (1, 0.0), (2, 1.0)] {
        let mtl = format!("newmtl m\nKs 1 1 1\nillum {illum}");
        assert_eq!(with_mtl(&Folder::new(), &mtl).1.specular, Vec3::splat(specular));
    }
}

#[test]
fn shininess_below_one_is_brought_into_range() {
    assert_eq!(with_mtl(&Folder::new(), "newmtl m\nNs 0.5").1.shininess, 1.0);
}

#[test]
fn shininess_of_zero_is_no_highlight() {
    let (_, m) = with_mtl(&Folder::new(), "newmtl m\nKs 1 1 1\nNs 0");
    assert_eq!(m.specular, Vec3::ZERO);
}

#[test]
fn mirrors_keep_their_colour_where_the_shininess_is_zero() {
    let (_, m) = with_mtl(&Folder::new(), "newmtl m\nKs 1 0.5 0\nNs 0\nillum 3");
    assert_eq!((m.reflect, m.specular), (Vec3::new(1.0, 0.5, 0.0), Vec3::ZERO));
}

/// Returns the material `m` of an MTL file that loads without a warning.
fn transmission(mtl: &str) -> Material {
    let (loaded, m) = with_mtl(&Folder::new(), &format!("newmtl m\n{mtl}"));
    assert_eq!(loaded.report.warnings, [""; 0], "{mtl}");
    m
}

#[test]
fn opacity_below_1_is_a_thin_sheet_seen_straight_through() {
    for line in ["d 0.75", "Tr 0.25", "d -halo 0.75", "d 0.75\nTr 0.5", "d 0.75\nillum 9"] {
        let m = transmission(&format!("{line}\nNi 1.5\nTf 0.1 0.1 0.1"));
        assert_eq!((m.transmit, m.thin, m.ior), (Vec3::splat(0.25), true, 1.0), "{line}");
        assert_eq!(m.reflect, Vec3::ZERO, "{line}");
    }
}

#[test]
fn opacity_of_1_is_opaque_whatever_index_and_filter_say() {
    for illum in [2, 3, 8, 9] {
        let m = transmission(&format!("d 1\nNi 1.5\nTf 1 1 1\nillum {illum}"));
        assert_eq!(m.transmit, Vec3::ZERO, "{illum}");
    }
}

#[test]
fn opacity_of_0_is_a_warning() {
    let folder = Folder::new();
    folder.write("m.mtl", "newmtl m\nd 0");
    let text = format!("mtllib m.mtl\n{VERTICES}f 1 2 3\nusemtl m\nf 1 2 3\n");
    let loaded = folder.load("model.obj", text).unwrap();
    assert_eq!(loaded.scene.materials[1].transmit, Vec3::ONE);
    assert_warns(&loaded, "an opacity of 0");
}

#[test]
fn transparency_of_1_alone_is_opaque_with_a_warning() {
    let (loaded, m) = with_mtl(&Folder::new(), "newmtl m\nTr 1.000000\nillum 2");
    assert_eq!(m.transmit, Vec3::ZERO);
    assert_warns(&loaded, "`Tr 1` and no `d`");
}

#[test]
fn glass_may_have_a_transparency_of_1() {
    let (_, m) = with_mtl(&Folder::new(), "newmtl m\nTr 1\nillum 7");
    assert_eq!((m.transmit, m.thin), (Vec3::ONE, false));
}

#[test]
fn illumination_models_3_and_5_mirror_by_their_specular_colour() {
    for illum in [3, 5] {
        let m = transmission(&format!("Ks 0.5 0.25 2\nillum {illum}"));
        assert_eq!(m.reflect, Vec3::new(0.5, 0.25, 1.0), "{illum}");
        let m = transmission(&format!("Ks 0.5 0.5 1\nd 0.5\nillum {illum}"));
        assert_eq!(m.reflect, Vec3::new(0.25, 0.25, 0.5), "{illum}");
        assert_eq!(m.transmit, Vec3::splat(0.5), "{illum}");
    }
}

#[test]
fn other_illumination_models_have_no_mirror() {
    for illum in [0, 1, 2, 4, 6, 7, 8, 9, 10] {
        assert_eq!(
            transmission(&format!("Ks 1 1 1\nillum {illum}")).reflect,
            Vec3::ZERO,
            "{illum}"
        );
    }
}

#[test]
fn illumination_models_6_and_7_refract() {
    for illum in [6, 7] {
        let (_, m) =
            with_mtl(&Folder::new(), &format!("newmtl m\nTf 1 0.5 0\nNi 1.25\nillum {illum}"));
        assert_eq!((m.transmit, m.thin, m.ior), (Vec3::new(1.0, 0.5, 0.0), false, 1.25));
        let (_, m) = with_mtl(&Folder::new(), &format!("newmtl m\nd 0.25\nillum {illum}"));
        assert_eq!((m.transmit, m.thin, m.ior), (Vec3::splat(0.75), false, 1.5));
    }
}

#[test]
fn illumination_model_4_is_a_pane() {
    let m = transmission("Tf 1 1 0.5\nNi 1.25\nillum 4");
    assert_eq!((m.transmit, m.thin, m.ior), (Vec3::new(1.0, 1.0, 0.5), true, 1.25));
}

#[test]
fn a_white_filter_alone_makes_no_glass_that_nobody_sees() {
    for lines in [
        "illum 4\nTf 1.00 1.00 1.00\nNi 1.00",
        "illum 4\nTf 1 1 1\nNi 1.5",
        "illum 4\nTf 1\nd 1",
        "illum 4\nTf 1 1 1\nTr 0",
        "illum 6\nTf 1 1 1\nNi 1",
        "illum 7\nTf 1 1 1\nNi 1\nd 1",
        "illum 4\nTr 1\nTf 1 1 1\nNi 1",
    ] {
        let (loaded, m) = with_mtl(&Folder::new(), &format!("newmtl m\nKd 0.5 0 0\n{lines}"));
        assert_eq!((m.transmit, m.diffuse.x), (Vec3::ZERO, 0.5), "{lines}");
        assert_warns(&loaded, "drawn opaque, as the programs that write it mean them");
        assert!(loaded.report.is_clean());
    }
    // With an index or an opacity of its own it is glass as it says.
    for lines in ["illum 7\nTf 1 1 1", "illum 7\nTf 1 1 1\nNi 1.5\nd 1", "illum 4\nTf 1 1 1\nd 0.5"]
    {
        let (_, m) = with_mtl(&Folder::new(), &format!("newmtl m\n{lines}"));
        assert_ne!(m.transmit, Vec3::ZERO, "{lines}");
    }
}

#[test]
fn an_image_beside_a_black_colour_is_shown() {
    for kd in ["Kd 0 0 0", "Kd 0", "Kd 0 \nKa 0 "] {
        let (loaded, m) = imaged([255, 0, 0, 255], &format!("{kd}\nmap_Kd a.png"));
        assert_eq!(m.diffuse, Vec3::ONE, "{kd}");
        assert_warns(&loaded, "the image is shown as it is");
    }
    // Also where it is the base of a metal.
    let (_, m) = imaged([255, 0, 0, 255], "Kd 0 0 0\nPm 0.5\nmap_Kd a.png");
    assert_eq!(m.metallic.unwrap().factors.base_color, Vec3::ONE);
    // Without an image black is black.
    let (loaded, m) = with_mtl(&Folder::new(), "newmtl m\nKd 0 0 0");
    assert_eq!((m.diffuse, loaded.report.warnings.len()), (Vec3::ZERO, 0));
}

#[test]
fn images_of_highlights_and_emission_keep_their_black_factor_and_it_is_said() {
    let (loaded, m) = imaged([255; 4], "Ks 0 0 0\nmap_Ks a.png\nKe 0 0 0\nmap_Ke a.png");
    assert_eq!((m.specular, m.emission), (Vec3::ZERO, Vec3::ZERO));
    assert_warns(&loaded, "2 images of highlights or emission are multiplied by 0");
}

#[test]
fn opacity_of_0_in_all_materials_is_none() {
    let load = |mtl: &str| {
        let folder = Folder::new();
        folder.write("m.mtl", mtl);
        let text = format!("mtllib m.mtl\n{VERTICES}usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
        let loaded = folder.load("model.obj", text).unwrap();
        let clear = loaded.scene.materials.iter().map(|m| m.may_transmit()).collect::<Vec<_>>();
        (loaded, clear)
    };
    for mtl in [
        "newmtl a\nd 0\nillum 9\nnewmtl b\nd 0",
        "newmtl a\nd 0\nnewmtl b\nillum 4\nTf 1 1 1\nNi 1\nd 0",
    ] {
        let (loaded, clear) = load(mtl);
        assert_eq!(clear, [false, false]);
        assert_warns(&loaded, "they are drawn opaque, as other programs draw them");
    }
    // One that can be seen, and all of them are as they say.
    for other in ["d 0.5", "d 1", "illum 7\nNi 1.5\nd 0"] {
        let (_, clear) = load(&format!("newmtl a\nd 0\nnewmtl b\n{other}"));
        assert!(clear[0], "{other}");
    }
    let (loaded, clear) = load("newmtl a\nd 0\nnewmtl c\nd 0");
    assert_eq!(clear, [true, false]);
    assert_warns(&loaded, "an opacity of 0");
}

#[test]
fn opacity_of_0_beside_an_image_of_it_leaves_it_to_the_image() {
    let (loaded, m) = imaged([128, 128, 128, 255], "d 0\nmap_d a.png");
    assert_eq!(m.coverage.unwrap().alpha, 1.0);
    assert_warns(&loaded, "the image alone counts");
}

#[test]
fn glass_that_lets_nothing_through_is_none() {
    for illum in [4, 6, 7] {
        assert_eq!(
            transmission(&format!("Kd 1 1 1\nillum {illum}")).transmit,
            Vec3::ZERO,
            "{illum}"
        );
    }
}

#[test]
fn glass_of_a_mesh_that_is_not_closed_is_a_warning() {
    let (loaded, _) = with_mtl(&Folder::new(), "newmtl m\nTf 1 1 1\nillum 7");
    assert_warns(&loaded, "not closed at 3 edges");
}

#[test]
fn broken_lines_of_an_mtl_file_are_ignored_with_a_warning() {
    let (loaded, m) = with_mtl(&Folder::new(), "newmtl m\nKd 1\nKs a b c\nNs\nKe 1 2\nillum x");
    assert_eq!(m.diffuse, Vec3::ONE);
    for what in ["`Ks` wants three numbers", "`Ns` wants a number", "`Ke`", "`illum`"] {
        assert_warns(&loaded, what);
    }
    assert_warns(&loaded, "m.mtl:3 (`Ks a b c`)");
}

#[test]
fn missing_mtl_file_is_a_warning() {
    let loaded = load(format!("mtllib none.mtl\nusemtl m\n{VERTICES}f 1 2 3"));
    let scene = &loaded.scene;
    assert_eq!(scene.materials[0].diffuse, Material::default().diffuse);
    assert_warns(&loaded, "none.mtl");
}

#[test]
fn an_mtl_file_of_the_models_name_takes_the_place_of_a_missing_one() {
    let folder = Folder::new();
    folder.write("model.mtl", "newmtl m\nKd 1 0 0");
    let text = |line: &str| format!("{line}\nusemtl m\n{VERTICES}f 1 2 3");
    let loaded = folder.load("model.obj", text("mtllib none.mtl")).unwrap();
    let scene = &loaded.scene;
    assert_eq!(scene.materials[0].diffuse, Vec3::X);
    assert_warns(&loaded, "`none.mtl` are missing");
    let loaded = folder.load("model.obj", text("")).unwrap();
    assert_eq!((loaded.scene.materials[0].diffuse, loaded.report.warnings.len()), (Vec3::X, 0));
}

#[test]
fn files_are_found_in_any_case() {
    let folder = Folder::new();
    folder.write("Lib/M.mtl", "newmtl m\nmap_Kd TEX\\A.PNG");
    folder.write("Lib/Tex/a.Png", png(&[RED]));
    let text = format!("mtllib lib\\m.MTL\nusemtl m\n{VERTICES}f 1 2 3");
    let Loaded { scene, report, .. } = folder.load("model.obj", text).unwrap();
    assert_eq!(report.warnings, [""; 0]);
    assert_eq!(scene.textures[0].image.texels, Texels::Bytes(vec![RED]));
}

#[test]
fn a_colour_that_is_a_spectrum_is_a_warning_with_its_line() {
    let (loaded, _) = with_mtl(&Folder::new(), "newmtl m\nKd spectral a.rfl");
    assert_warns(&loaded, "m.mtl:2 (`Kd spectral a.rfl`)");
}

#[test]
fn libraries_of_several_names_and_names_with_spaces() {
    let folder = Folder::new();
    folder.write("a b.mtl", "newmtl x\nKd 1 0 0");
    folder.write("c.mtl", "newmtl y\nKd 0 1 0");
    for line in [
        "mtllib a b.mtl c.mtl",
        "mtllib a b.mtl\nmtllib c.mtl",
        "mtllib a\\ b.mtl c.mtl",
        "mtllib \"a b.mtl\"\nmtllib \"c.mtl\"",
    ] {
        let text = format!("{line}\n{VERTICES}usemtl x\nf 1 2 3\nusemtl y\nf 1 2 3");
        let scene = folder.load("model.obj", text).unwrap().scene;
        let colors: Vec<_> = scene.materials.iter().map(|m| m.diffuse).collect();
        assert_eq!(colors, [Vec3::X, Vec3::Y], "{line}");
    }
}

// Textures

const RED: [u8; 4] = [255, 0, 0, 255];

#[test]
fn texture_file_with_options_spaces_and_windows_paths() {
    for (value, file) in [
        ("a.png", "a.png"),
        ("-s 2 2 1 -bm .3 a b.png", "a b.png"),
        ("tex\\a b.png", "tex/a b.png"),
        ("C:\\else where\\a.png", "a.png"),
    ] {
        let folder = Folder::new();
        folder.write(file, png(&[RED]));
        let (Loaded { scene, .. }, m) = with_mtl(&folder, &format!("newmtl m\nmap_Kd {value}"));
        let map = &scene.textures[m.diffuse_map.unwrap().0 as usize];
        assert_eq!(map.image.texels, Texels::Bytes(vec![RED]), "{value}");
        assert_eq!(m.diffuse, Vec3::ONE);
    }
}

#[test]
fn texture_options_that_are_not_read_are_a_warning() {
    let folder = Folder::new();
    folder.write("a.png", png(&[RED]));
    for option in ["-mm 0.1 2", "-bm 0.5", "-imfchan z", "-imfchan r"] {
        let (loaded, _) = with_mtl(&folder, &format!("newmtl m\nmap_Kd {option} a.png"));
        assert_warns(&loaded, &format!("the option `{}", option.split(' ').next().unwrap()));
    }
}

/// Loads a triangle whose material has maps that show `a.png`, of which there is nothing to say.
fn imaged(pixel: [u8; 4], mtl: &str) -> (Loaded, Material) {
    let folder = Folder::new();
    folder.write("a.png", png(&[pixel]));
    with_mtl(&folder, &format!("newmtl m\n{mtl}"))
}

/// The same of one that loads without a warning.
fn mapped(pixel: [u8; 4], mtl: &str) -> (Loaded, Material) {
    let (loaded, m) = imaged(pixel, mtl);
    assert_eq!(loaded.report.warnings, [""; 0], "{mtl}");
    (loaded, m)
}

const GREY: [u8; 4] = [128, 128, 128, 255];

#[test]
fn texture_is_scaled_and_shifted_with_v_up() {
    let (Loaded { scene, .. }, _) = mapped(RED, "map_Kd -s 2 3 1 -o 0.25 0.5 a.png");
    // v runs down here: the picture's lower left corner, (0, 1), is where u and v are 0.
    let at = |u, v| scene.textures[0].transform.transform_point2(Vec2::new(u, v));
    assert_eq!(at(0.0, 1.0), Vec2::new(0.25, 0.5));
    assert_eq!(at(1.0, 0.0), Vec2::new(2.25, -2.5));
}

#[test]
fn picture_of_normals_is_a_normal_map() {
    for key in ["norm", "map_Kn"] {
        let (Loaded { scene, .. }, m) =
            mapped([128, 128, 255, 255], &format!("{key} -bm 0.5 a.png"));
        let map = m.normal_map.unwrap();
        assert_eq!(map.scale, 0.5, "{key}");
        assert_eq!(scene.textures[map.texture.0 as usize].transfer, Transfer::None);
    }
}

#[test]
fn bump_that_shows_normals_is_a_normal_map() {
    for key in ["bump", "map_bump", "map_Bump"] {
        let (_, m) = mapped([128, 128, 255, 255], &format!("{key} -bm 0.5 a.png"));
        assert_eq!(m.normal_map.unwrap().scale, 0.5, "{key}");
    }
}

#[test]
fn bump_that_shows_heights_is_a_warning() {
    let folder = Folder::new();
    folder.write("a.png", png(&[GREY]));
    let (loaded, m) = with_mtl(&folder, "newmtl m\nbump a.png");
    assert_eq!(m.normal_map, None);
    assert_warns(&loaded, "textures of heights (`bump`) are not read");
    assert_eq!(loaded.report.unsupported.len(), 1);
}

#[test]
fn picture_of_opacity_covers_by_its_grey_or_its_alpha() {
    for (pixel, options, channel) in
        [(GREY, "", 0), ([255, 255, 255, 9], "", 3), (GREY, "-imfchan g ", 1)]
    {
        let (_, m) = mapped(pixel, &format!("d 0.5\nmap_d {options}a.png"));
        let coverage = m.coverage.unwrap();
        assert_eq!((coverage.alpha, coverage.mode), (0.5, AlphaMode::Blend));
        assert_eq!(coverage.map.unwrap().channel, channel, "{pixel:?}");
        assert_eq!((m.transmit, m.thin, m.ior), (Vec3::ZERO, true, 1.0));
    }
}

#[test]
fn glass_with_a_picture_of_opacity_is_a_warning() {
    let folder = Folder::new();
    folder.write("a.png", png(&[GREY]));
    let (loaded, m) = with_mtl(&folder, "newmtl m\nillum 4\nTf 1 1 0.5\nmap_d a.png");
    assert_eq!((m.coverage, m.transmit), (None, Vec3::new(1.0, 1.0, 0.5)));
    assert_warns(&loaded, "their materials are glass");
}

#[test]
fn pictures_of_highlights_and_their_size() {
    let (Loaded { scene, .. }, m) = mapped(RED, "Ns 20\nmap_Ks a.png\nmap_Ns a.png");
    assert_eq!(m.specular, Vec3::ONE);
    assert_eq!(scene.textures[m.specular_map.unwrap().0 as usize].transfer, Transfer::Srgb);
    let Some(ShininessMap::Factor(map)) = m.shininess_map else { panic!("{m:?}") };
    assert_eq!((map.channel, m.shininess), (0, 20.0));
    assert_eq!(scene.textures[map.texture.0 as usize].transfer, Transfer::None);
}

#[test]
fn picture_of_emission() {
    let (_, m) = mapped(RED, "map_Ke a.png");
    assert_eq!((m.emission, m.emission_map.is_some()), (Vec3::ONE, true));
}

#[test]
fn roughness_and_metalness_are_gltfs() {
    let metal = transmission("Kd 1 0.5 0\nPr 0.5\nPm 1");
    assert_eq!((metal.diffuse, metal.specular), (Vec3::ZERO, Vec3::new(1.0, 0.5, 0.0)));
    assert!((metal.shininess - 30.0).abs() < 1e-3, "{}", metal.shininess);
    let plastic = transmission("Kd 1 0.5 0\nPr 0.5");
    assert_eq!(plastic.diffuse, Vec3::new(1.0, 0.5, 0.0));
    assert!(metal.is_pbr() && plastic.is_pbr() && !transmission("Kd 1 0.5 0").is_pbr());
    assert!((plastic.specular - 0.04).abs().max_element() < 1e-6, "{}", plastic.specular);
}

#[test]
fn sheen_clearcoat_and_anisotropy_are_gltfs() {
    let m = transmission("Pr 0.5\nPs 0.25\nPc 0.75\nPcr 0.125\naniso 0.5\nanisor 0.25");
    let factors = m.metallic.unwrap().factors;
    assert_eq!((factors.clearcoat, factors.clearcoat_roughness), (0.75, 0.125));
    assert_eq!((factors.sheen_color, factors.anisotropy), (Vec3::splat(0.25), 0.5));
    assert!((factors.anisotropy_rotation - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
}

#[test]
fn roughness_that_is_missing_is_that_of_the_shininess() {
    let m = transmission("Kd 1 1 1\nPm 1\nNs 30");
    assert!((m.metallic.unwrap().factors.roughness - 0.5).abs() < 1e-6);
}

#[test]
fn pictures_of_roughness_and_metalness_count_in_place_of_their_values() {
    let (Loaded { scene, .. }, m) =
        mapped(GREY, "Pr 0.1\nPm 0\nmap_Pr a.png\nmap_Pm -imfchan b a.png");
    let maps = m.metallic.unwrap();
    assert_eq!((maps.factors.roughness, maps.factors.metallic), (1.0, 1.0));
    assert_eq!((maps.roughness.unwrap().channel, maps.metallic.unwrap().channel), (0, 2));
    assert_eq!(scene.textures.len(), 1);
}

#[test]
fn metal_with_an_opacity_is_blended() {
    let m = transmission("Kd 1 1 1\nPm 1\nPr 0\nd 0.25");
    let coverage = m.coverage.unwrap();
    assert_eq!((coverage.alpha, coverage.mode), (0.25, AlphaMode::Blend));
    assert_eq!((m.reflect, m.transmit, m.thin), (Vec3::ONE, Vec3::ZERO, true));
}

#[test]
fn clamped_texture() {
    let folder = Folder::new();
    folder.write("a.png", png(&[RED]));
    let (Loaded { scene, .. }, _) = with_mtl(&folder, "newmtl m\nmap_Kd -clamp on a.png");
    assert_eq!(scene.textures[0].wrap, [Wrap::Clamp; 2]);
}

#[test]
fn missing_texture_is_a_warning_and_a_placeholder() {
    let (loaded, _) = with_mtl(&Folder::new(), "newmtl m\nmap_Kd none.png");
    let scene = &loaded.scene;
    assert!(scene.textures[0].image.name.contains("missing"));
    assert_warns(&loaded, "none.png");
}

#[test]
fn texture_of_two_materials_is_stored_once() {
    let folder = Folder::new();
    folder.write("a.png", png(&[RED]));
    folder.write("m.mtl", "newmtl x\nmap_Kd a.png\nnewmtl y\nmap_Kd a.png");
    let text = format!("mtllib m.mtl\n{VERTICES}usemtl x\nf 1 2 3\nusemtl y\nf 1 2 3");
    assert_eq!(folder.load("model.obj", text).unwrap().scene.textures.len(), 1);
}

#[test]
fn coordinates_are_the_f64_nearest_to_their_decimals() {
    let positions = |text: &str| load(format!("{text}f 1 2 3")).scene.meshes[0].positions.clone();
    let surveyed =
        "v 388096.123 5412345.75 12.5\nv 388097 5412345.75 12.5\nv 388097 5412346.001 12.5\n";
    let points =
        [[388096.123, 5412345.75, 12.5], [388097., 5412345.75, 12.5], [388097., 5412346.001, 12.5]];
    assert_eq!(positions(surveyed), points);
    // With colours and with weights lines are read in other ways.
    let colored = surveyed.replace("12.5\n", "12.5 1 0.5 0\n");
    assert_eq!(positions(&colored), points);
    let weighted = surveyed.replace("12.5\n", "12.5 1\n");
    assert_eq!(positions(&weighted), points);
}

#[test]
fn coordinates_that_f32_holds_take_its_memory() {
    let is_f32 = |text: &str| {
        let scene = load(format!("{text}f 1 2 3")).scene;
        matches!(scene.meshes[0].positions, Positions::F32(_))
    };
    assert!(is_f32("v 0 0.5 1e9\nv -1.25 0 0\nv 0 3 16777216\n"));
    assert!(!is_f32("v 0 0.5 1e9\nv -1.25 0 0\nv 0 3 16777217\n"));
}
