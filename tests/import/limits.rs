//! Each limit allows what is as much, and refuses one more.

use std::path::PathBuf;

use envers::{Limit, Limits, LoadOptions};
use envers_testing::{Folder, Model, data_uri, png};
use serde_json::json;

/// A file that needs as much of something as is said.
struct Demand {
    limit: Limit,
    exactly: u64,
    folder: Folder,
    file: &'static str,
}

impl Demand {
    fn new(limit: Limit, exactly: u64, file: &'static str, bytes: impl AsRef<[u8]>) -> Self {
        let folder = Folder::new();
        folder.write(file, bytes);
        Self { limit, exactly, folder, file }
    }

    fn of_model(limit: Limit, exactly: u64, model: &Model) -> Self {
        let json = model.to_json(Some(&data_uri(model.bin())));
        Self::new(limit, exactly, "model.gltf", json.to_string())
    }

    fn beside(self, file: &str, bytes: impl AsRef<[u8]>) -> Self {
        self.folder.write(file, bytes);
        self
    }

    fn path(&self) -> PathBuf {
        self.folder.path(self.file)
    }

    /// Loads it under a limit; returns the warnings or the error where it does not load whole.
    fn loads(&self, most: u64) -> Result<(), String> {
        let limits = Limits::default().with_limit(self.limit, most);
        match LoadOptions::default().limits(limits).load(self.path()) {
            Ok(scene) if scene.report.warnings.is_empty() => Ok(()),
            Ok(scene) => Err(scene.report.warnings.join("\n")),
            Err(error) => Err(error.to_string()),
        }
    }

    #[track_caller]
    fn check(self) {
        assert_eq!(self.loads(self.exactly), Ok(()), "{}", self.limit.name());
        self.check_one_less();
    }

    #[track_caller]
    fn check_one_less(self) {
        let said = self.loads(self.exactly - 1).unwrap_err();
        let advice = format!("raise the limit `{}` to ", self.limit.name());
        assert!(said.contains(&advice), "{said}");
    }
}

/// A triangle that shows pictures, each by a part of its own.
fn pictured(uris: &[String]) -> Model {
    let mut model = Model::triangle();
    let uvs = model.floats("VEC2", &[0.0; 6]);
    model.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    let part = model.primitive().clone();
    let count = uris.len();
    let of = |make: &dyn Fn(usize) -> serde_json::Value| (0..count).map(make).collect::<Vec<_>>();
    model.json["images"] = of(&|i| json!({"uri": uris[i]})).into();
    model.json["textures"] = of(&|i| json!({"source": i})).into();
    model.json["materials"] =
        of(&|i| json!({"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": i}}}))
            .into();
    model.json["meshes"][0]["primitives"] = of(&|i| {
        let mut part = part.clone();
        part["material"] = i.into();
        part
    })
    .into();
    model
}

#[test]
fn bytes_of_all_files() {
    let model = Model::triangle();
    let json = model.to_json(Some("model.bin")).to_string();
    let bytes = (json.len() + model.bin().len()) as u64;
    Demand::new(Limit::Bytes, bytes, "model.gltf", json).beside("model.bin", model.bin()).check();
}

#[test]
fn bytes_of_a_file_named_twice_count_once() {
    let text = "[[model]]\nfile = \"a.obj\"\n[[model]]\nfile = \"./a.obj\"\n";
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let bytes = (text.len() + obj.len()) as u64;
    Demand::new(Limit::Bytes, bytes, "scene.toml", text).beside("a.obj", obj).check();
}

#[test]
fn bytes_of_packed_views() {
    let mut model = Model::triangle();
    // Three times (0, 0, 1): no differences from the element at the end.
    let mut stream = vec![0xa0];
    stream.extend([0; 12 + 32 - 4]);
    stream.extend(1f32.to_le_bytes());
    let packed = model.view(&stream);
    let view = model.last_view();
    view["extensions"] = json!({"EXT_meshopt_compression": {
        "buffer": 0, "byteOffset": view["byteOffset"], "byteLength": stream.len(),
        "byteStride": 12, "count": 3, "mode": "ATTRIBUTES"}});
    (view["byteLength"], view["byteStride"]) = (36.into(), 12.into());
    let normals = model
        .accessor(json!({"bufferView": packed, "componentType": 5126, "type": "VEC3", "count": 3}));
    model.primitive()["attributes"]["NORMAL"] = normals.into();
    model.json["extensionsUsed"] = json!(["EXT_meshopt_compression"]);
    let glb = model.glb();
    Demand::new(Limit::Bytes, glb.len() as u64 + 36, "model.glb", glb).check();
}

#[test]
fn json_by_what_it_takes() {
    let model = Model::triangle();
    let text = model.to_json(Some(&data_uri(model.bin()))).to_string();
    // Strings do not count: the data URI has a comma.
    let count = |c| text.matches(c).count() as u64 - if c == ',' { 1 } else { 0 };
    let bytes = 640 * count('{') + 128 * count('[') + 32 * count(',');
    Demand::new(Limit::Json, bytes, "model.gltf", text).check();
}

#[test]
fn nodes() {
    let mut model = Model::triangle();
    model.json["nodes"] = json!([{"mesh": 0}, {}, {}, {}, {}]);
    Demand::of_model(Limit::Nodes, 5, &model).check();
}

#[test]
fn nodes_of_all_models() {
    let text = "[[model]]\nfile = \"a.glb\"\n[[model]]\nfile = \"b.glb\"\n";
    let glb = Model::triangle().glb();
    let scene = Demand::new(Limit::Nodes, 2, "scene.toml", text);
    scene.beside("a.glb", &glb).beside("b.glb", &glb).check();
}

#[test]
fn depth_of_nodes() {
    let mut model = Model::triangle();
    model.json["nodes"] = json!([{"children": [1]}, {"children": [2, 3]}, {"mesh": 0}, {}]);
    Demand::of_model(Limit::Depth, 3, &model).check();
}

#[test]
fn instances_of_a_model() {
    let mut model = Model::triangle();
    model.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0}, {"mesh": 0}]);
    model.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    Demand::of_model(Limit::Instances, 3, &model).check();
}

#[test]
fn instances_of_a_scene() {
    let text = "[[model]]\nfile = \"a.glb\"\n".repeat(4);
    let scene = Demand::new(Limit::Instances, 4, "scene.toml", text);
    scene.beside("a.glb", Model::triangle().glb()).check();
}

#[test]
fn vertices_of_a_gltf() {
    Demand::of_model(Limit::Vertices, 3, &Model::triangle()).check();
}

#[test]
fn vertices_of_an_obj() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\n";
    Demand::new(Limit::Vertices, 4, "model.obj", obj).check();
}

#[test]
fn triangles_of_a_gltf() {
    let mut model = Model::parabola(5);
    model.primitive()["mode"] = 5.into();
    Demand::of_model(Limit::Triangles, 3, &model).check();
}

#[test]
fn vertices_of_morphed_copies() {
    let mut model = Model::triangle();
    let up = model.floats("VEC3", &[0., 0., 1., 0., 0., 1., 0., 0., 1.]);
    model.primitive()["targets"] = json!([{"POSITION": up}]);
    model.json["nodes"] = vec![json!({"mesh": 0, "weights": [0.5]}); 4].into();
    model.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    Demand::of_model(Limit::Deformed, 4 * 3, &model).check();
}

#[test]
fn instances_of_one_node() {
    let mut model = Model::triangle();
    let moves = model.floats("VEC3", &[0., 0., 1., 0., 0., 2., 0., 0., 3.]);
    model.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    model.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": moves}}});
    Demand::of_model(Limit::Instances, 3, &model).check();
}

#[test]
fn triangles_of_an_obj() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\no a\nf 1 2 4 3\no b\nf 1 2 3\n";
    Demand::new(Limit::Triangles, 3, "model.obj", obj).check();
}

#[test]
fn elements_that_several_accessors_read_from_the_same_bytes() {
    let mut model = Model::triangle();
    let part = model.primitive().clone();
    model.json["meshes"][0]["primitives"] = vec![part; 20].into();
    // Three each, 36 of which its bytes make up for.
    Demand::of_model(Limit::Elements, 60 - 36, &model).check();
}

#[test]
fn elements_without_a_view() {
    let mut model = Model::triangle();
    let zeros = json!({"componentType": 5126, "type": "VEC3", "count": 99});
    let zeros = model.accessor(zeros);
    model.json["meshes"][0]["primitives"] =
        json!([{"attributes": {"POSITION": 0}}, {"attributes": {"POSITION": zeros}}]);
    Demand::of_model(Limit::Elements, 102 - 36, &model).check();
}

#[test]
fn keys_of_all_channels() {
    let mut model = Model::triangle();
    let times = model.floats("SCALAR", &[0.0, 1.0]);
    let values = model.floats("VEC3", &[1.0; 6]);
    let channel = |path: &str| json!({"sampler": 0, "target": {"node": 0, "path": path}});
    model.json["animations"] = json!([{
        "channels": [channel("translation"), channel("scale")],
        "samplers": [{"input": times, "output": values}]}]);
    Demand::of_model(Limit::Keys, 4, &model).check();
}

#[test]
fn keys_of_each_morph_target() {
    let mut model = Model::triangle();
    let up = model.floats("VEC3", &[0., 0., 1., 0., 0., 1., 0., 0., 1.]);
    let times = model.floats("SCALAR", &[0.0, 1.0]);
    let weights = model.floats("SCALAR", &[0.5; 6]);
    model.primitive()["targets"] = vec![json!({"POSITION": up}); 3].into();
    model.json["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
        "samplers": [{"input": times, "output": weights}]}]);
    Demand::of_model(Limit::Keys, 3 * 2, &model).check();
}

#[test]
fn pictures() {
    let uris = [0, 1, 2].map(|i| data_uri(&png(&[[i; 4]])));
    Demand::of_model(Limit::Pictures, 3, &pictured(&uris)).check();
}

#[test]
fn pixels_beyond_what_the_bytes_make_up_for() {
    let row = png(&vec![[7, 7, 7, 255]; 9000]);
    let beyond = 9000 - 16 * row.len() as u64;
    let uris = [data_uri(&row), data_uri(&[&row[..], b" "].concat())];
    Demand::of_model(Limit::Pixels, 2 * beyond - 16, &pictured(&uris)).check();
}

#[test]
fn a_limit_that_is_raised_lets_more_through() {
    let mut model = Model::triangle();
    let depth = Limit::Depth.default();
    let mut nodes: Vec<_> = (1..=depth).map(|i| json!({"children": [i]})).collect();
    nodes.push(json!({"mesh": 0}));
    model.json["nodes"] = nodes.into();
    let needs = Demand::of_model(Limit::Depth, depth + 1, &model);
    assert!(needs.loads(depth).is_err());
    assert_eq!(needs.loads(u64::MAX), Ok(()));
}
