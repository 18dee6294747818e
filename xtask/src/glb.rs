//! Writing binary glTF 2.0.

use glam::{DQuat, DVec3};
use serde_json::{Value, json};

use crate::shape::Shape;

/// A glTF file while it is made.
#[derive(Default)]
pub struct Glb {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    images: Vec<Value>,
    materials: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
    lights: Vec<Value>,
    cameras: Vec<Value>,
    roots: Vec<usize>,
}

/// The place of a node in its parent.
pub fn at(x: f64, y: f64, z: f64) -> Value {
    json!({ "translation": [x, y, z] })
}

/// The place of a node that is turned from looking along `from` to looking along `to`.
pub fn turned(position: [f64; 3], from: DVec3, to: DVec3) -> Value {
    let round = |x: f64| (x * 1e7).round() / 1e7;
    let rotation = DQuat::from_rotation_arc(from.normalize(), to.normalize()).to_array().map(round);
    json!({ "translation": position, "rotation": rotation })
}

impl Glb {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len(),
        }));
        self.bin.extend(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn accessor(&mut self, bytes: &[u8], mut accessor: Value) -> usize {
        accessor["bufferView"] = self.view(bytes).into();
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn vectors<const N: usize>(&mut self, vectors: &[[f32; N]], bounds: bool) -> usize {
        let bytes: Vec<u8> = vectors.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let mut accessor =
            json!({ "componentType": 5126, "type": format!("VEC{N}"), "count": vectors.len() });
        if bounds {
            let pick = |i: usize, f: fn(f32, f32) -> f32| vectors.iter().map(|v| v[i]).reduce(f);
            accessor["min"] = (0..N).map(|i| json!(pick(i, f32::min))).collect();
            accessor["max"] = (0..N).map(|i| json!(pick(i, f32::max))).collect();
        }
        self.accessor(&bytes, accessor)
    }

    /// A picture from a PNG file; its number is also its texture's.
    pub fn picture(&mut self, name: &str, png: &[u8]) -> usize {
        let view = self.view(png);
        self.images.push(json!({ "name": name, "bufferView": view, "mimeType": "image/png" }));
        self.images.len() - 1
    }

    /// A material: linear base colour, metalness, roughness.
    pub fn material(&mut self, name: &str, color: [f64; 3], metal: f64, rough: f64) -> usize {
        let [r, g, b] = color;
        self.materials.push(json!({
            "name": name,
            "pbrMetallicRoughness": {
                "baseColorFactor": [r, g, b, 1.0], "metallicFactor": metal, "roughnessFactor": rough,
            },
        }));
        self.materials.len() - 1
    }

    /// A material that is seen from both sides.
    pub fn double_sided(&mut self, name: &str, color: [f64; 3], metal: f64, rough: f64) -> usize {
        let id = self.material(name, color, metal, rough);
        self.materials[id]["doubleSided"] = true.into();
        id
    }

    /// A material with a picture.
    pub fn textured(&mut self, name: &str, texture: usize, rough: f64) -> usize {
        let id = self.material(name, [1.0; 3], 0.0, rough);
        self.materials[id]["pbrMetallicRoughness"]["baseColorTexture"] =
            json!({ "index": texture });
        id
    }

    /// A material that shines by itself.
    pub fn glowing(&mut self, name: &str, color: [f64; 3]) -> usize {
        let id = self.material(name, [0.0; 3], 0.0, 1.0);
        self.materials[id]["emissiveFactor"] = json!(color);
        id
    }

    /// A mesh of one shape for each material.
    pub fn mesh(&mut self, name: &str, parts: &[(&Shape, usize)]) -> usize {
        let primitives: Vec<Value> = parts.iter().map(|(s, m)| self.primitive(s, *m)).collect();
        self.meshes.push(json!({ "name": name, "primitives": primitives }));
        self.meshes.len() - 1
    }

    /// A mesh of triangles over one set of vertices, flat, without a material.
    #[allow(dead_code)] // The reference scenes have such meshes, the demo models none.
    pub fn triangles(
        &mut self,
        name: &str,
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
    ) -> usize {
        let positions = self.vectors(positions, true);
        let bytes: Vec<u8> = triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect();
        let count = 3 * triangles.len();
        let accessor = json!({ "componentType": 5125, "type": "SCALAR", "count": count });
        let indices = self.accessor(&bytes, accessor);
        let primitive = json!({ "attributes": { "POSITION": positions }, "indices": indices });
        self.meshes.push(json!({ "name": name, "primitives": [primitive] }));
        self.meshes.len() - 1
    }

    fn primitive(&mut self, shape: &Shape, material: usize) -> Value {
        let vec3 = |v: &[DVec3]| v.iter().map(|p| p.as_vec3().to_array()).collect::<Vec<_>>();
        let mut attributes = json!({
            "POSITION": self.vectors(&vec3(&shape.positions), true),
            "NORMAL": self.vectors(&vec3(&shape.normals), false),
        });
        let is_textured =
            !self.materials[material]["pbrMetallicRoughness"]["baseColorTexture"].is_null();
        if is_textured {
            let uvs: Vec<_> = shape.uvs.iter().map(|uv| uv.as_vec2().to_array()).collect();
            attributes["TEXCOORD_0"] = self.vectors(&uvs, false).into();
        }
        let indices: Vec<u16> = shape
            .faces
            .iter()
            .flat_map(|f| f[1..].windows(2).flat_map(|w| [f[0], w[0], w[1]]))
            .map(|i| u16::try_from(i).expect("shapes have fewer than 65536 corners"))
            .collect();
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let accessor = json!({ "componentType": 5123, "type": "SCALAR", "count": indices.len() });
        let indices = self.accessor(&bytes, accessor);
        json!({ "attributes": attributes, "indices": indices, "material": material })
    }

    /// A node within `parent`, or at the top; `place` is what [`at`] or [`turned`] gives.
    pub fn node(&mut self, name: &str, parent: Option<usize>, mut place: Value) -> usize {
        place["name"] = name.into();
        let id = self.nodes.len();
        self.nodes.push(place);
        match parent {
            None => self.roots.push(id),
            Some(parent) => {
                let parent = &mut self.nodes[parent];
                if parent["children"].is_null() {
                    parent["children"] = json!([]);
                }
                parent["children"].as_array_mut().expect("ok: set above").push(id.into());
            }
        }
        id
    }

    /// A node with a mesh.
    pub fn add_node(
        &mut self,
        name: &str,
        parent: Option<usize>,
        mesh: usize,
        place: Value,
    ) -> usize {
        let id = self.node(name, parent, place);
        self.nodes[id]["mesh"] = mesh.into();
        id
    }

    /// Gives a node a light: a KHR_lights_punctual object.
    pub fn light(&mut self, node: usize, light: Value) {
        let id = self.lights.len();
        self.nodes[node]["extensions"] = json!({ "KHR_lights_punctual": { "light": id } });
        self.lights.push(light);
    }

    /// Gives a node a camera: a glTF camera object.
    pub fn camera(&mut self, node: usize, camera: Value) {
        self.nodes[node]["camera"] = self.cameras.len().into();
        self.cameras.push(camera);
    }

    /// The file; it says that `generator` made it.
    pub fn finish(self, generator: &str) -> Vec<u8> {
        let textures: Vec<Value> = (0..self.images.len()).map(|i| json!({ "source": i })).collect();
        let mut root = json!({
            "asset": { "version": "2.0", "generator": generator },
            "extensionsUsed": ["KHR_lights_punctual"],
            "extensions": { "KHR_lights_punctual": { "lights": self.lights } },
            "scene": 0,
            "scenes": [{ "nodes": self.roots }],
            "nodes": self.nodes,
            "cameras": self.cameras,
            "meshes": self.meshes,
            "materials": self.materials,
            "textures": textures,
            "images": self.images,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{ "byteLength": self.bin.len() }],
        });
        let root_keys = root.as_object_mut().expect("ok: made above");
        if self.lights.is_empty() {
            root_keys.retain(|key, _| !key.starts_with("extensions"));
        }
        // glTF allows no empty list.
        root_keys.retain(|_, value| value != &json!([]));
        let mut json = root.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + json.len() + 8 + self.bin.len();
        let mut file = b"glTF".to_vec();
        file.extend([2, length as u32].iter().flat_map(|x| x.to_le_bytes()));
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &self.bin)] {
            file.extend((chunk.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(chunk);
        }
        file
    }
}
