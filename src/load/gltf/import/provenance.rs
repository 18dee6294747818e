//! The provenance of what is imported: the nodes, meshes and materials of the file.

use std::path::Path;
use std::sync::Arc;

use gltf::json;

use super::nodes::SceneNode;
use super::{ImportedPrimitive, Importer};
use crate::scene::{
    FileContents, GltfNames, MeshProvenance, NodeProvenance, ObjectProvenance, ProvenanceTable,
    Scene,
};

/// Returns the table of provenance of a file, without any object.
pub fn new_table(path: &Path, root: &json::Root) -> Arc<ProvenanceTable> {
    let names = GltfNames {
        nodes: root.nodes.iter().map(|node| node.name.clone()).collect(),
        meshes: root.meshes.iter().map(|mesh| mesh.name.clone()).collect(),
        materials: root.materials.iter().map(|material| material.name.clone()).collect(),
    };
    Arc::new(ProvenanceTable::from_file(path.to_owned(), FileContents::Gltf(names)))
}

/// Returns the provenance of an object that a node shows in the material of an index.
pub fn of_node(
    node: &SceneNode,
    instance: Option<u32>,
    material: Option<usize>,
) -> ObjectProvenance {
    let material = material.map(|material| material as u32);
    ObjectProvenance::in_file(Some(NodeProvenance { node: node.index as u32, instance, material }))
}

/// Records the provenance of the mesh that was added last to a scene, if that is asked for.
pub fn record_mesh(scene: &mut Scene, primitive: &ImportedPrimitive) {
    if let Some(table) = scene.provenance_mut() {
        let (primitive, faces) = (primitive.indices, primitive.mesh.faces.clone());
        table.meshes.push(MeshProvenance { primitive, faces });
    }
}

impl Importer<'_> {
    /// Records the provenance of the instance that was added last, if that is asked for; `instance` is
    /// its index among those of the node.
    pub(super) fn record_instance(
        &mut self,
        primitive: &ImportedPrimitive,
        node: &SceneNode,
        instance: Option<u32>,
    ) {
        if let Some(table) = self.scene.provenance_mut() {
            table.instances.push(of_node(node, instance, primitive.material_index));
        }
    }
}
