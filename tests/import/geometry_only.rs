//! Loads for ray queries alone: geometry as in a full load, and no other file opened.

use envers::{
    Bvh, Coherence, Hit, Intersector, LoadOptions, Loaded, Material, Precision, Ray, Scene,
};
use envers_testing::{Folder, Model, Random, png};
use glam::DVec3;
use serde_json::json;

/// A tetrahedron whose faces have two materials, texture coordinates, and colours in part.
const OBJ: &str = "mtllib m.mtl\n\
v -1 0 1 1 0 0\nv 1 0 1\nv 0 0 -1 0 0.5 1\nv 0 1.5 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
usemtl shiny\nf 1/1 2/2 4/3\nf 2/1 3/2 4/3\nusemtl dull\nf 3 1 4\nf 1 3 2\n";

/// The tetrahedron, a triangle, a sphere and a plane, of materials with images.
const SCENE: &str = r#"
camera.position = [0, 1, 9]
camera.look_at = [0, 0, 0]
[[light]]
kind = "point"
position = [0, 9, 0]
[[material]]
name = "painted"
diffuse_map = "map.png"
[[sphere]]
center = [2, 0, 0]
radius = 0.9
material = "painted"
[[plane]]
point = [0, -1, 0]
normal = [0, 1, 0]
checker = { colors = [0.2, 0.7] }
[[model]]
file = "a.obj"
[[model]]
file = "t.gltf"
translate = [-3, 0, 0]
scale = 2
material = "painted"
[[model]]
file = "t.gltf"
translate = [-5, 0, 0]
"#;

/// A triangle with an image, its buffer in a file.
fn model() -> Model {
    let mut model = Model::triangle();
    let uvs = model.floats("VEC2", &[0., 0., 1., 0., 0., 1.]);
    let colors = model.floats("VEC3", &[0.5; 9]);
    model.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    model.primitive()["attributes"]["COLOR_0"] = colors.into();
    model.json["images"] = json!([{"uri": "map.png"}]);
    model.json["textures"] = json!([{"source": 0}]);
    model.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    model
}

/// A folder with all of it.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    folder.write("a.obj", OBJ);
    folder.write("m.mtl", "newmtl shiny\nmap_Kd map.png\nnewmtl dull\nKd 0 1 0\n");
    folder.write("map.png", png(&[[255, 0, 0, 255], [0, 0, 255, 255]]));
    folder.write("t.gltf", model().to_json(Some("t.bin")).to_string());
    folder.write("t.bin", model().bin());
    folder
}

/// A folder with what geometry there is.
fn folder_without_materials() -> Folder {
    let folder = folder();
    for name in ["m.mtl", "map.png"] {
        std::fs::remove_file(folder.path(name)).unwrap();
    }
    folder
}

fn load_geometry(folder: &Folder, name: &str) -> Loaded {
    let options = LoadOptions::default().geometry_only(true);
    options.load(folder.path(name)).unwrap_or_else(|e| panic!("{e}"))
}

/// The closest hits of many rays through the middle of a scene.
fn hits(scene: &Scene) -> Vec<Option<Hit>> {
    let mut random = Random(7);
    let mut ray = || {
        let (from, to) = (random.cube(12.0), random.cube(3.0));
        Ray::new(from, to - from)
    };
    let rays: Vec<Ray> = (0..3000).map(|_| ray()).collect();
    let mut hits = vec![None; rays.len()];
    Bvh::build(scene, Precision::Certified).closest(&rays, Coherence::Incoherent, &mut hits);
    hits
}

#[test]
fn hits_are_those_of_a_full_load() {
    let (full, bare) = (folder(), folder_without_materials());
    for name in ["scene.toml", "a.obj", "t.gltf"] {
        let scene = envers::load(full.path(name)).unwrap().scene;
        let expected = hits(&scene);
        assert!(expected.iter().flatten().count() > 10, "{name}");
        assert_eq!(hits(&load_geometry(&bare, name).scene), expected, "{name}");
    }
}

#[test]
fn what_is_missing_beside_the_geometry_is_no_warning() {
    let folder = folder_without_materials();
    assert!(envers::load(folder.path("scene.toml")).is_err());
    for (name, files) in [("scene.toml", 4), ("a.obj", 1), ("t.gltf", 2)] {
        let report = load_geometry(&folder, name).report;
        assert_eq!((report.warnings.as_slice(), report.is_clean()), (&[][..], true), "{name}");
        assert_eq!(report.files.len(), files, "{name}");
    }
}

#[test]
fn files_that_are_there_are_not_read_either() {
    let folder = folder();
    for (name, all, geometry) in [("scene.toml", 6, 4), ("a.obj", 3, 1), ("t.gltf", 3, 2)] {
        assert_eq!(envers::load(folder.path(name)).unwrap().report.files.len(), all, "{name}");
        assert_eq!(load_geometry(&folder, name).report.files.len(), geometry, "{name}");
    }
}

#[test]
fn bytes_are_those_of_the_files_that_were_read() {
    let folder = folder();
    let size = |name: &str| std::fs::metadata(folder.path(name)).unwrap().len();
    assert_eq!(load_geometry(&folder, "t.gltf").report.bytes, size("t.gltf") + size("t.bin"));
}

#[test]
fn all_objects_have_the_default_material_and_nothing_is_added() {
    let folder = folder();
    for name in ["scene.toml", "a.obj", "t.gltf"] {
        let scene = load_geometry(&folder, name).scene;
        assert_eq!(scene.materials, [Material::default()], "{name}");
        let used = scene.instances.iter().map(|i| i.material);
        let used = used.chain(scene.spheres.iter().map(|s| s.material));
        assert!(used.chain(scene.planes.iter().map(|p| p.material)).all(|id| id.0 == 0));
        let is_bare = |mesh: &envers::Mesh| mesh.uvs.is_empty() && mesh.colors.is_empty();
        assert!(scene.meshes.iter().all(|mesh| is_bare(mesh)), "{name}");
        assert!(scene.textures.is_empty() && scene.planes.iter().all(|p| p.checker.is_none()));
        let own = usize::from(name == "scene.toml");
        assert_eq!((scene.cameras.len(), scene.lights.len()), (own, own), "{name}");
    }
}

#[test]
fn a_mask_cuts_nothing_out() {
    let folder = Folder::new();
    let mut model = model();
    model.json["materials"][0]["alphaMode"] = "MASK".into();
    folder.write("map.png", png(&[[0; 4]]));
    folder.write("t.glb", model.glb());
    let is_hit = |scene: &Scene| {
        let mut hits = [None];
        let ray = Ray::new(DVec3::new(0.2, 0.2, 1.0), DVec3::NEG_Z);
        Bvh::build(scene, Precision::Fast).closest(&[ray], Coherence::Coherent, &mut hits);
        hits[0].is_some()
    };
    assert!(!is_hit(&envers::load(folder.path("t.glb")).unwrap().scene));
    assert!(is_hit(&load_geometry(&folder, "t.glb").scene));
}

#[test]
fn a_buffer_that_is_missing_is_still_an_error() {
    let folder = folder();
    std::fs::remove_file(folder.path("t.bin")).unwrap();
    let options = LoadOptions::default().geometry_only(true);
    for name in ["scene.toml", "t.gltf"] {
        assert!(options.load(folder.path(name)).is_err(), "{name}");
    }
}

#[test]
fn a_material_that_no_table_has_is_still_an_error() {
    let folder = folder();
    folder.write(
        "bad.toml",
        SCENE.replace("material = \"painted\"\n[[plane]]", "material = \"x\"\n[[plane]]"),
    );
    let options = LoadOptions::default().geometry_only(true);
    let error = options.load(folder.path("bad.toml")).map(|l| l.report).unwrap_err();
    assert!(error.to_string().contains("there is no material `x`"), "{error}");
}

#[test]
fn provenance_still_names_the_materials() {
    let folder = folder_without_materials();
    let options = LoadOptions::default().geometry_only(true).provenance(true);
    let scene = options.load(folder.path("scene.toml")).unwrap().scene;
    let names: Vec<String> = hits(&scene)
        .into_iter()
        .flatten()
        .map(|hit| scene.provenance_of(hit.id).unwrap().to_string())
        .collect();
    for part in ["material `shiny`", "material `dull`", "material 0", "[[sphere]] 0"] {
        assert!(names.iter().any(|name| name.contains(part)), "{part}");
    }
}
