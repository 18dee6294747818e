//! KHR_materials_variants.

use super::*;
use envers::{LoadOptions, Loaded};

/// The extension of a primitive, from pairs of a material and the variants that have it.
fn mapped(mappings: &[(usize, &[usize])]) -> serde_json::Value {
    let mapping = |&(material, variants): &(usize, &[usize])| json!({"material": material, "variants": variants});
    let mappings: Vec<_> = mappings.iter().map(mapping).collect();
    json!({"KHR_materials_variants": {"mappings": mappings}})
}

/// A triangle, black by default, red by day and at noon, green by night.
fn model() -> Model {
    let mut model = Model::triangle();
    let plain = |r, g| json!({"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [r, g, 0, 1]}});
    model.json["materials"] = json!([plain(0, 0), plain(1, 0), plain(0, 1)]);
    let names = ["day", "noon", "night", "dusk"].map(|name| json!({"name": name}));
    model.json["extensions"] = json!({"KHR_materials_variants": {"variants": names}});
    model.primitive()["material"] = 0.into();
    model.primitive()["extensions"] = mapped(&[(1, &[0, 1]), (2, &[2])]);
    model
}

fn load(folder: &Folder, file: &str, variant: Option<&str>) -> envers::Result<Loaded> {
    let options = LoadOptions::default();
    let options = if let Some(name) = variant { options.variant(name) } else { options };
    options.load(folder.path(file))
}

/// The diffuse colour of the only material in use.
fn shown(loaded: &Loaded) -> [f32; 3] {
    let Loaded { scene, report, .. } = loaded;
    assert_eq!(report.warnings, [""; 0]);
    assert_eq!(scene.materials.len(), 1);
    material(scene).diffuse.to_array()
}

/// The diffuse colours of what stands in the scene.
fn colors(scene: &Scene) -> Vec<[f32; 3]> {
    let of = |material: usize| scene.materials[material].diffuse.to_array();
    scene.instances.iter().map(|instance| of(instance.material.0 as usize)).collect()
}

fn refused(folder: &Folder, file: &str, variant: Option<&str>) -> String {
    let error = load(folder, file, variant).unwrap_err();
    format!("{error}\n{}", error.advice().unwrap_or_default())
}

fn in_folder(model: &Model) -> Folder {
    let folder = Folder::new();
    folder.write("a.glb", model.glb());
    folder
}

#[test]
fn each_variant_has_its_colour() {
    let folder = in_folder(&model());
    let color = |variant| shown(&load(&folder, "a.glb", variant).unwrap());
    assert_eq!(color(None), [0.0; 3]);
    assert_eq!(color(Some("day")), [1.0, 0.0, 0.0]);
    assert_eq!(color(Some("noon")), [1.0, 0.0, 0.0]);
    assert_eq!(color(Some("night")), [0.0, 1.0, 0.0]);
}

#[test]
fn a_primitive_without_the_variant_keeps_its_default() {
    let folder = in_folder(&model());
    assert_eq!(shown(&load(&folder, "a.glb", Some("dusk")).unwrap()), [0.0; 3]);
}

#[test]
fn the_report_names_the_variants() {
    let Loaded { report, .. } = load(&in_folder(&model()), "a.glb", None).unwrap();
    let names: Vec<&str> = report.variants.iter().map(String::as_str).collect();
    assert_eq!(names, ["day", "dusk", "night", "noon"]);
}

#[test]
fn a_variant_that_is_not_there_is_refused_with_those_that_are() {
    let said = refused(&in_folder(&model()), "a.glb", Some("nigth"));
    assert!(said.contains("there is no variant `nigth`"), "{said}");
    assert!(said.contains("did you mean `night`?"), "{said}");
    assert!(said.contains("The variants are `day`, `dusk`, `night` and `noon`"), "{said}");
}

#[test]
fn a_variant_of_a_file_without_any_is_refused() {
    let folder = in_folder(&Model::triangle());
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for file in ["a.glb", "a.obj"] {
        let said = refused(&folder, file, Some("day"));
        assert!(said.contains("no model has variants of its materials"), "{said}");
    }
}

#[test]
fn a_material_that_is_not_there_is_an_error_where_its_variant_is_shown() {
    let mut model = model();
    model.primitive()["extensions"] = mapped(&[(1, &[0]), (9, &[2])]);
    let folder = in_folder(&model);
    assert!(load(&folder, "a.glb", Some("day")).is_ok());
    let said = refused(&folder, "a.glb", Some("night"));
    let place = "meshes[0].primitives[0].extensions.KHR_materials_variants.mappings[1].material";
    assert!(said.contains(&format!("{place}: there is no material 9")), "{said}");
}

#[test]
fn pictures_of_other_variants_are_not_opened() {
    let mut model = model();
    let uvs = model.floats("VEC2", &[0.0; 6]);
    model.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    model.json["images"] =
        json!([{"uri": data_uri(&png(&[[0, 0, 255, 255]]))}, {"uri": "gone.png"}]);
    model.json["textures"] = json!([{"source": 0}, {"source": 1}]);
    for (material, texture) in [(1, 0), (2, 1)] {
        model.json["materials"][material]["pbrMetallicRoughness"]["baseColorTexture"] =
            json!({"index": texture});
    }
    let folder = in_folder(&model);
    let warnings = |variant| load(&folder, "a.glb", variant).unwrap().report.warnings;
    assert_eq!(warnings(Some("day")), [""; 0]);
    assert_eq!(warnings(None), [""; 0]);
    let said = warnings(Some("night"));
    assert!(said.len() == 1 && said[0].contains("gone.png"), "{said:?}");
}

#[test]
fn a_model_of_a_scene_file_shows_its_own_variant() {
    let folder = in_folder(&model());
    let text = "[[model]]\nfile = \"a.glb\"\nvariant = \"day\"\n\
                [[model]]\nfile = \"a.glb\"\n[[model]]\nfile = \"a.glb\"\nvariant = \"night\"\n";
    folder.write("s.toml", text);
    let scene = load(&folder, "s.toml", None).unwrap().scene;
    assert_eq!(colors(&scene), [[1.0, 0.0, 0.0], [0.0; 3], [0.0, 1.0, 0.0]]);
}

#[test]
fn the_loads_variant_is_that_of_models_that_name_none() {
    let folder = in_folder(&model());
    folder.write("plain.glb", Model::triangle().glb());
    let text = "[[model]]\nfile = \"a.glb\"\nvariant = \"day\"\n\
                [[model]]\nfile = \"a.glb\"\n[[model]]\nfile = \"plain.glb\"\n";
    folder.write("s.toml", text);
    let scene = load(&folder, "s.toml", Some("night")).unwrap().scene;
    assert_eq!(colors(&scene), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.8; 3]]);
}

#[test]
fn a_scene_file_is_told_where_it_names_a_variant_that_is_not_there() {
    let folder = in_folder(&model());
    folder.write("s.toml", "[[model]]\nfile = \"a.glb\"\nvariant = \"nite\"\n");
    let said = refused(&folder, "s.toml", None);
    assert!(said.contains("s.toml:3:11") && said.contains("there is no variant `nite`"), "{said}");
}

#[test]
fn a_variant_that_no_model_of_a_scene_file_has_is_refused() {
    let folder = in_folder(&model());
    folder.write("s.toml", "[[model]]\nfile = \"a.glb\"\n");
    let said = refused(&folder, "s.toml", Some("winter"));
    assert!(said.contains("there is no variant `winter`"), "{said}");
}
