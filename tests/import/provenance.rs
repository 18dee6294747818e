//! The provenance of primitives: each test one thing that happens to a face on its way into a scene.

use draco_core::GeometryAttributeType;
use envers::scene::{GltfElement, ModelElement, ObjFace, TableKind};
use envers::{Bvh, Coherence, Intersector, LoadOptions, Precision, PrimitiveId, Ray, Scene};
use envers_testing::compressed::compressed_model;
use envers_testing::{Folder, Model, data_uri};
use glam::DVec3;
use serde_json::json;

use super::loading::LoadFile;

/// Loads a file with provenance.
fn load(folder: &Folder, name: &str, bytes: impl AsRef<[u8]>) -> Scene {
    let path = folder.write(name, bytes);
    LoadOptions::default().provenance(true).load(path).unwrap_or_else(|e| panic!("{e}")).scene
}

fn load_obj(text: &str) -> Scene {
    load(&Folder::new(), "model.obj", text)
}

fn load_model(model: &Model) -> Scene {
    let text = model.to_json(Some(&data_uri(model.bin()))).to_string();
    load(&Folder::new(), "model.gltf", text)
}

/// The face that a primitive of an OBJ file comes from.
#[track_caller]
fn obj_face(scene: &Scene, id: PrimitiveId) -> ObjFace<'_> {
    match scene.provenance_of(id).and_then(|p| p.model).expect("it is of a model").element {
        ModelElement::Obj(face) => face,
        other => panic!("{other:?}"),
    }
}

/// The element that a primitive of a glTF file comes from.
#[track_caller]
fn gltf_element(scene: &Scene, id: PrimitiveId) -> GltfElement<'_> {
    match scene.provenance_of(id).and_then(|p| p.model).expect("it is of a model").element {
        ModelElement::Gltf(element) => element,
        other => panic!("{other:?}"),
    }
}

/// The ids of all triangles.
fn triangles(scene: &Scene) -> Vec<PrimitiveId> {
    let of_instance = |(i, instance): (usize, &envers::Instance)| {
        let mesh = instance.mesh.0;
        let count = scene.meshes[mesh as usize].triangles.len() as u32;
        (0..count).map(move |triangle| PrimitiveId::triangle(mesh, triangle, i as u32))
    };
    scene.instances.iter().enumerate().flat_map(of_instance).collect()
}

/// The numbers of the faces of an OBJ file that the triangles come from, mesh by mesh.
fn faces(text: &str) -> Vec<u32> {
    let scene = load_obj(text);
    triangles(&scene).into_iter().map(|id| obj_face(&scene, id).face).collect()
}

/// The numbers in their primitive that the triangles of a glTF file come from.
fn numbers(model: &Model) -> Vec<u32> {
    let scene = load_model(model);
    let number = |id| gltf_element(&scene, id).triangle.unwrap().triangle;
    triangles(&scene).into_iter().map(number).collect()
}

/// What a ray along −z hits.
#[track_caller]
fn hit(scene: &Scene, x: f64, y: f64) -> PrimitiveId {
    let bvh = Bvh::build(scene, Precision::Certified);
    let mut hits = [None];
    let ray = Ray::new(DVec3::new(x, y, 50.0), DVec3::NEG_Z);
    bvh.closest(&[ray], Coherence::Coherent, &mut hits);
    hits[0].expect("the ray hits").id
}

/// Vertices of an L, and a row of points to the right of it.
const L: &str = "v 0 0 0\nv 0 2 0\nv 1 2 0\nv 1 1 0\nv 2 1 0\nv 2 0 0\nv 3 0 0\nv 3 1 0\n";

// OBJ

#[test]
fn nothing_is_recorded_unless_it_is_asked_for() {
    let scene = Folder::new().load("model.obj", format!("{L}f 1 2 3")).unwrap().scene;
    assert!(scene.provenance.is_none());
    assert_eq!(scene.provenance_of(PrimitiveId::triangle(0, 0, 0)), None);
}

#[test]
fn triangles_of_quads_and_of_concave_polygons_come_from_their_face() {
    assert_eq!(faces(&format!("{L}f 6 7 8 5\nf 1 6 5\nf 2 3 4 5 6 1")), [0, 0, 1, 2, 2, 2, 2]);
}

#[test]
fn triangles_alone_come_from_their_face() {
    assert_eq!(faces(&format!("{L}f 6 7 8\nf 1 6 5\nf 1 2 3")), [0, 1, 2]);
}

#[test]
fn faces_that_are_dropped_count() {
    // Two corners, a vertex that is not there, two corners at one place, points and lines.
    let bad = "f 1 2\nf 1 2 99\nf 1 2 2\np 1\nl 1 2\n";
    assert_eq!(faces(&format!("{L}{bad}f 6 7 8 5\n{bad}f 1 6 5")), [3, 3, 7]);
}

#[test]
fn a_face_that_loses_a_triangle_keeps_its_number() {
    // The first is cut into fewer triangles than its corners make.
    assert_eq!(faces(&format!("{L}f 1 1 6 5\nf 6 7 8 5")), [0, 1, 1]);
}

#[test]
fn names_and_lines_are_those_of_the_face() {
    let text = format!(
        "{L}o box\ng left front\nusemtl red\nf 1 2 3\nf 1 3 4\nusemtl blue\n\nf 1 4 5\n\
         g right\no ball\nf 1 5 6\nf 5 6 7 \\\n 8\n"
    );
    let scene = load_obj(&text);
    let found: Vec<_> = triangles(&scene)
        .into_iter()
        .map(|id| obj_face(&scene, id))
        .map(|f| (f.face, f.line, f.object, f.groups.join(" "), f.material))
        .collect();
    let front = || "left front".to_owned();
    let right = || "right".to_owned();
    let expected = [
        (0, 12, Some("box"), front(), Some("red")),
        (1, 13, Some("box"), front(), Some("red")),
        (2, 16, Some("box"), front(), Some("blue")),
        (3, 19, Some("ball"), right(), Some("blue")),
        (4, 20, Some("ball"), right(), Some("blue")),
        (4, 20, Some("ball"), right(), Some("blue")),
    ];
    assert_eq!(found, expected);
}

#[test]
fn faces_of_a_group_that_comes_again_keep_their_numbers() {
    let text = format!("{L}g a\nf 1 2 3\ng b\nf 1 3 4\ng a\nf 1 4 5\nf 5 6 7 8\n");
    let scene = load_obj(&text);
    let found = |id| (obj_face(&scene, id).groups[0].clone(), obj_face(&scene, id).face);
    let found: Vec<_> = triangles(&scene).into_iter().map(found).collect();
    let expected = [("a", 0), ("a", 2), ("a", 3), ("a", 3), ("b", 1)];
    assert_eq!(found, expected.map(|(group, face)| (group.to_owned(), face)));
}

#[test]
fn faces_with_and_without_texture_coordinates_keep_their_numbers() {
    let text = format!("{L}vt 0 0\nf 1/1 2/1 3/1\nf 1 3 4\nf 1/1 4/1 5/1\nf -3 -2 -1\n");
    assert_eq!(faces(&text), [0, 2, 1, 3]);
}

#[test]
fn painted_vertices_change_no_number() {
    let paint = format!("#MRGB {}\n", "ff102030".repeat(8));
    assert_eq!(faces(&format!("{L}{paint}f 1 2 3\nf 6 7 8 5")), [0, 1, 1]);
}

#[test]
fn faces_are_counted_through_all_chunks_of_a_large_file() {
    // Threads share the file in chunks of a megabyte.
    let mut text = L.to_owned();
    for _ in 0..60_000 {
        text += "f 1 2 3\nf 1 2\nf 6 7 8 5\n# a comment\n";
    }
    let text = format!("{text}o last\nf 1 4 5\n");
    assert!(text.len() > 2 << 20);
    let scene = load_obj(&text);
    let last = *triangles(&scene).last().unwrap();
    let face = obj_face(&scene, last);
    assert_eq!((face.face, face.line, face.object), (180_000, 8 + 240_000 + 2, Some("last")));
}

#[test]
fn copies_that_are_removed_change_no_number() {
    let text = format!("{L}{}f 1 4 5\n", "f 1 2 3\n".repeat(40));
    let expected: Vec<u32> = (0..32).chain([40]).collect();
    assert_eq!(faces(&text), expected);
}

#[test]
fn a_hit_leads_to_its_face() {
    let scene = load_obj(&format!("{L}o foot\nf 6 7 8 5\no shaft\nf 1 6 5 4 3 2\n"));
    let object = |x, y| obj_face(&scene, hit(&scene, x, y)).object;
    assert_eq!([object(2.5, 0.6), object(0.5, 1.6)], [Some("foot"), Some("shaft")]);
}

// glTF

#[test]
fn indices_and_names_of_node_mesh_primitive_and_material() {
    let mut model = Model::triangle();
    let primitive = model.primitive().clone();
    let mut second = primitive.clone();
    second["material"] = 1.into();
    model.json["materials"] = json!([{}, {"name": "brass"}]);
    model.json["meshes"] = json!([{"primitives": [primitive]},
        {"name": "gear", "primitives": [primitive, second]}]);
    model.json["nodes"] = json!([{"children": [1, 2]}, {"mesh": 1, "name": "left"},
        {"mesh": 1, "translation": [5, 0, 0]}]);
    let scene = load_model(&model);
    let found: Vec<_> = triangles(&scene)
        .into_iter()
        .map(|id| gltf_element(&scene, id))
        .map(|e| {
            let triangle = e.triangle.unwrap();
            let mesh = (triangle.mesh, triangle.mesh_name, triangle.primitive, triangle.triangle);
            (e.node, e.node_name, e.instance, mesh, e.material, e.material_name)
        })
        .collect();
    let [first, second] = [0, 1].map(|primitive| (1, Some("gear"), primitive, 0));
    let expected = [
        (1, Some("left"), None, first, None, None),
        (1, Some("left"), None, second, Some(1), Some("brass")),
        (2, None, None, first, None, None),
        (2, None, None, second, Some(1), Some("brass")),
    ];
    assert_eq!(found, expected);
}

#[test]
fn triangles_of_strips_and_fans_keep_their_numbers() {
    let mut strip = Model::parabola(6);
    strip.primitive()["mode"] = 5.into();
    // The strip goes on elsewhere by naming vertices twice.
    strip.primitive()["indices"] = strip.shorts(&[0, 1, 2, 2, 3, 3, 4, 5]).into();
    assert_eq!(numbers(&strip), [0, 5]);
    let mut fan = Model::parabola(5);
    fan.primitive()["mode"] = 6.into();
    // Its second triangle has two corners at one place.
    fan.primitive()["indices"] = fan.shorts(&[0, 1, 2, 2, 3, 4]).into();
    assert_eq!(numbers(&fan), [0, 2, 3]);
}

#[test]
fn triangles_that_are_dropped_count() {
    let mut model = Model::parabola(4);
    model.primitive()["indices"] = model.shorts(&[0, 0, 1, 0, 1, 2, 1, 2, 9, 1, 2, 3]).into();
    assert_eq!(numbers(&model), [1, 3]);
}

#[test]
fn triangles_of_draco_are_those_that_were_decompressed() {
    let square = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.];
    let model = compressed_model(
        &[("POSITION", GeometryAttributeType::Position, 3, &square)],
        &[[0, 1, 2], [0, 2, 3]],
    );
    assert_eq!(numbers(&model), [0, 1]);
}

#[test]
fn instances_of_a_node_are_told_apart() {
    let mut model = Model::triangle();
    let places = model.floats("VEC3", &[0., 0., 0., 5., 0., 0.]);
    let extension = json!({"attributes": {"TRANSLATION": places}});
    model.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": extension});
    let scene = load_model(&model);
    let instance = |x| gltf_element(&scene, hit(&scene, x, 0.2)).instance;
    assert_eq!([instance(0.2), instance(5.2)], [Some(0), Some(1)]);
}

#[test]
fn a_mesh_that_is_morphed_keeps_the_numbers_of_its_triangles() {
    let mut model = Model::parabola(4);
    model.primitive()["indices"] = model.shorts(&[0, 0, 1, 0, 1, 2, 1, 2, 3]).into();
    let target = model.floats("VEC3", &[0.1; 12]);
    model.primitive()["targets"] = json!([{"POSITION": target}]);
    model.json["meshes"][0]["weights"] = json!([0.5]);
    assert_eq!(numbers(&model), [1, 2]);
}

#[test]
fn implicit_shapes_come_from_their_node() {
    let mut model = Model::triangle();
    let shape = |shape: u32| json!({"KHR_implicit_shapes": {"shape": shape, "material": 0}});
    model.json["extensions"] = json!({"KHR_implicit_shapes": {"shapes": [
        {"type": "sphere", "sphere": {"radius": 1.0}}, {"type": "plane"}, {"type": "box"}]}});
    model.json["materials"] = json!([{"name": "clay"}]);
    model.json["scenes"][0]["nodes"] = json!([1, 2, 3]);
    for (i, name) in ["ball", "ground", "crate"].into_iter().enumerate() {
        let node = json!({"name": name, "extensions": shape(i as u32)});
        model.json["nodes"].as_array_mut().unwrap().push(node);
    }
    let scene = load_model(&model);
    let ids = [PrimitiveId::sphere(0), PrimitiveId::plane(0), PrimitiveId::triangle(0, 3, 0)];
    for (id, name) in ids.into_iter().zip(["ball", "ground", "crate"]) {
        let found = gltf_element(&scene, id);
        assert_eq!((found.node_name, found.material_name), (Some(name), Some("clay")));
        assert_eq!(found.triangle, None);
    }
}

// Scene files

/// A scene of a sphere, two models of one file, a plane, and a model of another file.
const SCENE: &str = r#"
[[sphere]]
name = "moon"
center = [-50, 0, 0]
radius = 1
[[plane]]
point = [0, 0, -9]
normal = [0, 0, 1]
[[model]]
file = "l.obj"
[[model]]
file = "l.obj"
name = "right"
translate = [10, 0, 0]
[[model]]
file = "t.gltf"
translate = [30, 0, 0]
"#;

fn scene_of_models(scene: &str) -> (Folder, Scene) {
    let folder = Folder::new();
    folder.write("l.obj", format!("{L}f 1 1 2\no l\nf 1 6 5 4 3 2\n"));
    let model = Model::triangle();
    folder.write("t.gltf", model.to_json(Some(&data_uri(model.bin()))).to_string());
    let scene = load(&folder, "scene.toml", scene);
    (folder, scene)
}

#[test]
fn objects_of_a_scene_file_come_from_their_tables() {
    let (folder, scene) = scene_of_models(SCENE);
    let found = |x: f64| {
        let provenance = scene.provenance_of(hit(&scene, x, 0.2)).unwrap();
        let table = provenance.table.unwrap();
        let file = provenance.model.map(|model| model.file.to_owned());
        (table.kind, table.index, table.name.map(str::to_owned), file)
    };
    let l = Some(folder.path("l.obj"));
    assert_eq!(found(-50.0), (TableKind::Sphere, 0, Some("moon".to_owned()), None));
    assert_eq!(found(-20.0), (TableKind::Plane, 0, None, None));
    assert_eq!(found(0.5), (TableKind::Model, 0, None, l.clone()));
    assert_eq!(found(10.5), (TableKind::Model, 1, Some("right".to_owned()), l));
    assert_eq!(found(30.2), (TableKind::Model, 2, None, Some(folder.path("t.gltf"))));
}

#[test]
fn the_shapes_of_lights_come_from_their_tables() {
    let lights = "[[light]]\nkind = \"sphere\"\nposition = [-80, 0, 0]\nradius = 1\n\
                  [[light]]\nname = \"panel\"\nkind = \"rectangle\"\nposition = [-90, 0, 0]\n\
                  direction = [0, 0, 1]\nsize = [2, 2]\n";
    let (_folder, scene) = scene_of_models(&format!("{SCENE}{lights}"));
    let found = |x: f64| {
        let table = scene.provenance_of(hit(&scene, x, 0.2)).unwrap().table.unwrap();
        (table.kind, table.index, table.name.map(str::to_owned))
    };
    assert_eq!(found(-80.0), (TableKind::Light, 0, None));
    assert_eq!(found(-90.0), (TableKind::Light, 1, Some("panel".to_owned())));
}

#[test]
fn elements_of_models_in_a_scene_file_are_those_of_their_files() {
    let (_folder, scene) = scene_of_models(SCENE);
    for x in [0.5, 10.5] {
        let face = obj_face(&scene, hit(&scene, x, 0.2));
        assert_eq!((face.face, face.object), (1, Some("l")));
    }
    assert_eq!(gltf_element(&scene, hit(&scene, 30.2, 0.2)).node, 0);
}

#[test]
fn copies_of_objects_that_are_removed_leave_the_others_their_provenance() {
    let sphere = "[[sphere]]\ncenter = [-30, 0, 0]\nradius = 1\n".repeat(40);
    let plane = "[[plane]]\npoint = [0, 0, -9.5]\nnormal = [0, 0, 1]\n".repeat(40);
    let model = "[[model]]\nfile = \"l.obj\"\ntranslate = [20, 0, 0]\n".repeat(40);
    let (_folder, scene) = scene_of_models(&format!("{sphere}{plane}{model}{SCENE}"));
    assert_eq!((scene.spheres.len(), scene.planes.len(), scene.instances.len()), (33, 33, 35));
    let table = |x: f64| scene.provenance_of(hit(&scene, x, 0.2)).unwrap().table.unwrap().index;
    assert_eq!([-50.0, 10.5, 30.2].map(table), [40, 41, 42]);
    let last = scene.provenance_of(PrimitiveId::plane(32)).unwrap().table.unwrap().index;
    assert_eq!(last, 40);
}

#[test]
fn a_model_that_the_animation_squeezes_flat_leaves_the_others_their_provenance() {
    let squeezed = "[animation]\nframes = 3\nfps = 1\n\
        [[model]]\nfile = \"l.obj\"\nname = \"squeezed\"\n\
        [[animation.track]]\nobject = \"squeezed\"\ntimes = [0, 2]\n\
        scale = [[1, 1, 1], [-1, 1, 1]]\n";
    let (_folder, scene) = scene_of_models(&format!("{squeezed}{SCENE}"));
    for time in [0.0, 1.0] {
        let scene = scene.at_time(time).unwrap();
        let provenance = scene.provenance_of(hit(&scene, 10.5, 0.2)).unwrap();
        assert_eq!(provenance.table.unwrap().index, 2, "at {time} s");
    }
}

#[test]
fn what_is_added_to_a_loaded_scene_has_no_provenance() {
    let (_folder, mut scene) = scene_of_models(SCENE);
    let sphere = scene.spheres[0];
    scene.spheres.push(sphere);
    assert_eq!(scene.provenance_of(PrimitiveId::sphere(1)), None);
}
