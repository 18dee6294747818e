//! The files that envers is tested with, and random numbers that are the same every time. It does not
//! depend on envers, so that nothing of envers is compiled for it.

pub mod compressed;
mod random;
pub mod whole;

use std::path::{Path, PathBuf};

use base64::Engine;
pub use random::Random;
use serde_json::{Value, json};

/// A folder of files that goes away with the test.
pub struct Folder(tempfile::TempDir);

impl Default for Folder {
    fn default() -> Self {
        Self::new()
    }
}

impl Folder {
    /// An empty folder.
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// The path of a file in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

/// A PNG of one pixel row.
pub fn png(pixels: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let flat = pixels.as_flattened();
    image::write_buffer_with_format(
        &mut bytes,
        flat,
        pixels.len() as u32,
        1,
        image::ExtendedColorType::Rgba8,
        image::ImageFormat::Png,
    )
    .unwrap();
    bytes.into_inner()
}

/// A data URI.
pub fn data_uri(bytes: &[u8]) -> String {
    let text = base64::engine::general_purpose::STANDARD.encode(bytes);
    format!("data:application/octet-stream;base64,{text}")
}

/// A glTF file being made: one scene, one node, one mesh, to begin with.
pub struct Model {
    /// The JSON of the file, without buffers, views and accessors.
    pub json: Value,
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Default for Model {
    fn default() -> Self {
        Self::new()
    }
}

impl Model {
    /// A file with one primitive that has no attributes yet.
    pub fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {}}]}],
        });
        Self { json, bin: Vec::new(), views: Vec::new(), accessors: Vec::new() }
    }

    /// A file with one triangle: (0, 0, 0), (1, 0, 0), (0, 1, 0).
    pub fn triangle() -> Self {
        let mut model = Self::new();
        let positions = model.floats("VEC3", &[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
        model.primitive()["attributes"]["POSITION"] = positions.into();
        model
    }

    /// A file with `count` vertices at (i, i², 0).
    pub fn parabola(count: usize) -> Self {
        let mut model = Self::new();
        let point = |i: usize| [i as f32, (i * i) as f32, 0.0];
        let values: Vec<f32> = (0..count).flat_map(point).collect();
        let positions = model.floats("VEC3", &values);
        model.primitive()["attributes"]["POSITION"] = positions.into();
        model
    }

    /// The first primitive of the first mesh.
    pub fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// Gives the first primitive a material.
    pub fn material(&mut self, material: Value) {
        self.json["materials"] = json!([material]);
        self.primitive()["material"] = 0.into();
    }

    /// Adds bytes and a view of them.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.views
            .push(json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()}));
        self.bin.extend_from_slice(bytes);
        self.views.len() - 1
    }

    /// Changes the view added last.
    pub fn last_view(&mut self) -> &mut Value {
        self.views.last_mut().unwrap()
    }

    /// Adds an accessor.
    pub fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Changes an accessor.
    pub fn accessor_mut(&mut self, index: usize) -> &mut Value {
        &mut self.accessors[index]
    }

    /// Adds an accessor of floats.
    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.typed(5126, kind, 4, &bytes)
    }

    /// Adds an accessor of 16-bit indices.
    pub fn shorts(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.typed(5123, "SCALAR", 2, &bytes)
    }

    /// Adds an accessor of numbers of `size` bytes.
    pub fn typed(&mut self, component: u32, kind: &str, size: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 4,
        };
        let count = bytes.len() / size / width;
        self.accessor(
            json!({"bufferView": view, "componentType": component, "type": kind, "count": count}),
        )
    }

    /// The whole JSON, with the buffer's URI or without one.
    pub fn to_json(&self, uri: Option<&str>) -> Value {
        let mut json = self.json.clone();
        if json.get("extensionsUsed").is_none() {
            let mut used: Vec<String> = json["extensionsRequired"].as_array().map_or(vec![], |r| {
                r.iter().filter_map(Value::as_str).map(str::to_owned).collect()
            });
            name_extensions(&json, &mut used);
            used.sort();
            used.dedup();
            if !used.is_empty() {
                json["extensionsUsed"] = used.into();
            }
        }
        if !self.bin.is_empty() {
            let mut buffer = json!({"byteLength": self.bin.len()});
            if let Some(uri) = uri {
                buffer["uri"] = uri.into();
            }
            json["buffers"] = json!([buffer]);
            json["bufferViews"] = self.views.clone().into();
        }
        if !self.accessors.is_empty() {
            json["accessors"] = self.accessors.clone().into();
        }
        json
    }

    /// The bytes of a GLB.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.to_json(None).to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut bin = self.bin.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let length = 12 + 8 + json.len() + 8 + bin.len();
        let word = |n: usize| (n as u32).to_le_bytes();
        [
            b"glTF",
            &word(2)[..],
            &word(length),
            &word(json.len()),
            b"JSON",
            &json,
            &word(bin.len()),
            b"BIN\0",
            &bin,
        ]
        .concat()
    }

    /// The buffer's bytes.
    pub fn bin(&self) -> &[u8] {
        &self.bin
    }
}

/// The extensions that objects have, anywhere in a value.
fn name_extensions(value: &Value, names: &mut Vec<String>) {
    if let Some(extensions) = value.get("extensions").and_then(Value::as_object) {
        names.extend(extensions.keys().cloned());
    }
    let objects = value.as_object().into_iter().flat_map(|o| o.values());
    let items = value.as_array().into_iter().flatten();
    objects.chain(items).for_each(|value| name_extensions(value, names));
}

/// The corpus of model files, or nothing (and a word about it) where there is none.
pub fn corpus() -> Option<PathBuf> {
    let corpus = std::env::var_os("ENVERS_CORPUS").map(PathBuf::from);
    if corpus.is_none() {
        println!("skipped: ENVERS_CORPUS does not name a corpus of model files");
    }
    corpus
}

/// Returns the files under a folder whose name ends in one of `extensions`, in order.
pub fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|e| extensions.iter().any(|x| e == *x)) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}
