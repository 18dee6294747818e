//! The table of the provenance of all primitives of a scene.

use std::path::PathBuf;
use std::sync::Arc;

use super::{
    FaceMap, GltfElement, GltfTriangle, ModelElement, ModelProvenance, ObjFaces, Provenance,
    TableKind, TableProvenance,
};
use crate::geometry::{Geometry, PrimitiveId};

/// The table of the provenance of all primitives of a scene; see
/// [`Scene::provenance_of`](crate::scene::Scene::provenance_of).
#[derive(Clone, Debug, Default)]
pub struct ProvenanceTable {
    files: Vec<Arc<ModelFile>>,
    /// The kind, the index and the name of the tables of a scene file.
    tables: Vec<(TableKind, usize, Option<String>)>,
    // The objects, by their indices in the scene.
    pub(crate) spheres: Vec<ObjectProvenance>,
    pub(crate) planes: Vec<ObjectProvenance>,
    pub(crate) instances: Vec<ObjectProvenance>,
    pub(crate) meshes: Vec<MeshProvenance>,
}

/// A model file.
#[derive(Debug)]
struct ModelFile {
    path: PathBuf,
    contents: FileContents,
}

/// The names of a model file's elements.
#[derive(Debug)]
pub enum FileContents {
    /// The faces of an OBJ file.
    Obj(ObjFaces),
    /// The names in a glTF file.
    Gltf(GltfNames),
}

/// The names in a glTF file, by the indices of what has them.
#[derive(Debug, Default)]
pub struct GltfNames {
    /// The names of the nodes.
    pub nodes: Vec<Option<String>>,
    /// The names of the meshes.
    pub meshes: Vec<Option<String>>,
    /// The names of the materials.
    pub materials: Vec<Option<String>>,
}

/// The provenance of a sphere, a plane or an instance.
#[derive(Clone, Copy, Debug, Default)]
pub struct ObjectProvenance {
    /// The index of the model file.
    file: Option<u32>,
    /// The index of the table of the scene file.
    table: Option<u32>,
    /// The node, in a glTF file.
    node: Option<NodeProvenance>,
}

/// A node of a glTF file, as it shows an object.
#[derive(Clone, Copy, Debug)]
pub struct NodeProvenance {
    /// The index of the node.
    pub node: u32,
    /// The index of the instance, if the node has several.
    pub instance: Option<u32>,
    /// The index of the material.
    pub material: Option<u32>,
}

/// The provenance of a mesh.
#[derive(Clone, Debug, Default)]
pub struct MeshProvenance {
    /// The indices of the mesh and of its primitive, in a glTF file; none for an implicit shape.
    pub primitive: Option<[u32; 2]>,
    /// The faces of the triangles: those of the file, or of the primitive.
    pub faces: Arc<FaceMap>,
}

impl ProvenanceTable {
    /// Returns the table of a model file, without any object.
    pub(crate) fn from_file(path: PathBuf, contents: FileContents) -> Self {
        Self { files: vec![Arc::new(ModelFile { path, contents })], ..Self::default() }
    }

    /// Adds a table of a scene file, and returns the provenance of an object that it describes.
    pub(crate) fn add_table(
        &mut self,
        kind: TableKind,
        index: usize,
        name: Option<String>,
    ) -> ObjectProvenance {
        self.tables.push((kind, index, name));
        ObjectProvenance { table: Some(self.tables.len() as u32 - 1), ..Default::default() }
    }

    /// Moves the files and meshes of a model's table to the end of those of this one. The objects of the
    /// model are added whenever it is [instantiated](Self::instantiate).
    pub(crate) fn merge(&mut self, model: &mut Self) {
        let first_file = self.files.len() as u32;
        let Self { spheres, planes, instances, .. } = model;
        for object in spheres.iter_mut().chain(planes).chain(instances) {
            object.file = object.file.map(|file| file + first_file);
        }
        self.files.append(&mut model.files);
        self.meshes.append(&mut model.meshes);
    }

    /// Adds the objects of a model that was merged, as the `table` of the scene file makes them.
    pub(crate) fn instantiate(&mut self, model: &Self, table: ObjectProvenance) {
        let placed = |object: &ObjectProvenance| ObjectProvenance { table: table.table, ..*object };
        self.spheres.extend(model.spheres.iter().map(placed));
        self.planes.extend(model.planes.iter().map(placed));
        self.instances.extend(model.instances.iter().map(placed));
    }

    /// Returns the provenance of a primitive.
    pub(super) fn find(&self, id: PrimitiveId) -> Option<Provenance<'_>> {
        let object = match id.geometry {
            Geometry::Spheres => self.spheres.get(id.primitive as usize),
            Geometry::Planes => self.planes.get(id.primitive as usize),
            Geometry::Mesh(_) => self.instances.get(id.instance as usize),
        }?;
        let table = object.table.and_then(|table| self.tables.get(table as usize));
        let table = table.map(|(kind, index, name)| TableProvenance {
            kind: *kind,
            index: *index,
            name: name.as_deref(),
        });
        let file = object.file.and_then(|file| self.files.get(file as usize));
        let model = file.and_then(|file| {
            let element = match &file.contents {
                FileContents::Obj(faces) => {
                    let (mesh, triangle) = self.mesh(id)?;
                    ModelElement::Obj(faces.face(mesh.faces.face(triangle)?)?)
                }
                FileContents::Gltf(names) => {
                    ModelElement::Gltf(self.gltf_element(names, object.node?, id))
                }
            };
            Some(ModelProvenance { file: &file.path, element })
        });
        (table.is_some() || model.is_some()).then_some(Provenance { table, model })
    }

    /// Returns the mesh of a triangle, and its index in that.
    fn mesh(&self, id: PrimitiveId) -> Option<(&MeshProvenance, u32)> {
        let Geometry::Mesh(mesh) = id.geometry else { return None };
        Some((self.meshes.get(mesh as usize)?, id.primitive))
    }

    fn gltf_element<'a>(
        &'a self,
        names: &'a GltfNames,
        node: NodeProvenance,
        id: PrimitiveId,
    ) -> GltfElement<'a> {
        let name = |names: &'a [Option<String>], index: u32| names.get(index as usize)?.as_deref();
        let triangle = self.mesh(id).and_then(|(found, triangle)| {
            let [mesh, primitive] = found.primitive?;
            let triangle = found.faces.face(triangle)?;
            let mesh_name = name(&names.meshes, mesh);
            Some(GltfTriangle { mesh, mesh_name, primitive, triangle })
        });
        let NodeProvenance { node, instance, material } = node;
        GltfElement {
            node,
            node_name: name(&names.nodes, node),
            instance,
            triangle,
            material,
            material_name: material.and_then(|material| name(&names.materials, material)),
        }
    }
}

impl ObjectProvenance {
    /// The provenance of an object of the only file of a table.
    pub const fn in_file(node: Option<NodeProvenance>) -> Self {
        Self { file: Some(0), table: None, node }
    }
}
