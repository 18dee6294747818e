//! The provenance of primitives: the places in a scene's files that they come from.
//!
//! Provenance is recorded if a load is asked for it, and follows the primitives through everything that a
//! load does to them: triangulation, faces that are dropped, copies that are removed, models that are
//! merged into a scene.
//!
//! ```no_run
//! use envers::scene::ModelElement;
//! use envers::{Bvh, Coherence, Intersector, LoadOptions, Precision, Ray, glam::DVec3};
//!
//! let scene = LoadOptions::default().provenance(true).load("model.obj")?.scene;
//! let bvh = Bvh::build(&scene, Precision::Fast);
//! let mut hits = [None];
//! bvh.closest(&[Ray::new(DVec3::Z * 5.0, DVec3::NEG_Z)], Coherence::Coherent, &mut hits);
//! let provenance = hits[0].and_then(|hit| scene.provenance_of(hit.id));
//! if let Some(ModelElement::Obj(face)) = provenance.and_then(|p| p.model).map(|m| m.element) {
//!     println!("face {} in line {}", face.face, face.line);
//! }
//! # Ok::<(), envers::Error>(())
//! ```

mod face_map;
mod obj_faces;
mod table;

use std::fmt;
use std::path::Path;

use serde::{Serialize, Serializer};

use crate::geometry::PrimitiveId;
use crate::scene::Scene;

pub(crate) use face_map::FaceMap;
pub(crate) use obj_faces::{ObjFaces, ObjLabels};
pub use table::ProvenanceTable;
pub(crate) use table::{FileContents, GltfNames, MeshProvenance, NodeProvenance, ObjectProvenance};

/// The place in a scene's files that a primitive comes from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Provenance<'a> {
    /// The table of the scene file; none where a model was loaded without a scene file.
    pub table: Option<TableProvenance<'a>>,
    /// The element of a model file; none for a sphere or a plane of the scene file itself.
    pub model: Option<ModelProvenance<'a>>,
}

/// A table of a scene file that makes primitives.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct TableProvenance<'a> {
    /// The kind of the table.
    pub kind: TableKind,
    /// Its index among the tables of its kind, from 0.
    pub index: usize,
    /// Its `name`, if it has one.
    pub name: Option<&'a str>,
}

/// The kind of a table of a scene file that makes primitives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum TableKind {
    /// A `[[model]]`.
    Model,
    /// A `[[sphere]]`.
    Sphere,
    /// A `[[plane]]`.
    Plane,
    /// A `[[light]]` that is visible.
    Light,
}

/// An element of a model file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct ModelProvenance<'a> {
    /// The path of the file.
    #[serde(serialize_with = "serialize_path")]
    pub file: &'a Path,
    /// The element.
    #[serde(flatten)]
    pub element: ModelElement<'a>,
}

/// An element of a model file, by the file's format.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum ModelElement<'a> {
    /// A face of an OBJ file.
    Obj(ObjFace<'a>),
    /// An object of a glTF file.
    Gltf(GltfElement<'a>),
}

/// A face of an OBJ file, as the statements before it determine it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct ObjFace<'a> {
    /// The name after the last `o`.
    pub object: Option<&'a str>,
    /// The names after the last `g`.
    pub groups: &'a [String],
    /// The name after the last `usemtl`.
    pub material: Option<&'a str>,
    /// The number of `f` lines before that of the face.
    pub face: u32,
    /// The number of its line, counted from 1.
    pub line: u32,
}

/// An object of a glTF file: a node that shows a triangle of a mesh, or an implicit shape.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct GltfElement<'a> {
    /// The index of the node.
    pub node: u32,
    /// The name of the node.
    pub node_name: Option<&'a str>,
    /// The index of the node's instance, if it has several (EXT_mesh_gpu_instancing).
    pub instance: Option<u32>,
    /// The triangle of a mesh; none for an implicit shape.
    pub triangle: Option<GltfTriangle<'a>>,
    /// The index of the material, if the file gives one: that of the variant that is shown.
    pub material: Option<u32>,
    /// The name of that material.
    pub material_name: Option<&'a str>,
}

/// A triangle of a primitive of a glTF mesh.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct GltfTriangle<'a> {
    /// The index of the mesh.
    pub mesh: u32,
    /// The name of the mesh.
    pub mesh_name: Option<&'a str>,
    /// The index of the primitive in the mesh.
    pub primitive: u32,
    /// The index of the triangle among those that the primitive's mode makes of its indices, or of its
    /// vertices if it has none; faces that are dropped count. Of a primitive that Draco compressed, the
    /// index among the decompressed triangles.
    pub triangle: u32,
}

impl Scene {
    /// The place in the files that a primitive comes from; none unless the load was asked to
    /// [record](crate::scene::Scene::provenance) it, and for what no file describes.
    ///
    /// The answer is right for the scene as it was loaded, at any time of its animation, and if objects were
    /// only added since.
    pub fn provenance_of(&self, id: PrimitiveId) -> Option<Provenance<'_>> {
        self.provenance.as_ref()?.find(id)
    }
}

fn serialize_path<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&path.display())
}

/// The parts with commas: ``[[model]] 1 `left`, a.obj, object `Cube`, face 12 in line 40``.
impl fmt::Display for Provenance<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let table = self.table.as_ref().map(ToString::to_string);
        let model = self.model.as_ref().map(|m| format!("{}, {}", m.file.display(), m.element));
        f.write_str(&table.into_iter().chain(model).collect::<Vec<_>>().join(", "))
    }
}

impl fmt::Display for TableProvenance<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.kind {
            TableKind::Model => "model",
            TableKind::Sphere => "sphere",
            TableKind::Plane => "plane",
            TableKind::Light => "light",
        };
        write!(f, "[[{kind}]] {}{}", self.index, quoted(self.name))
    }
}

impl fmt::Display for ModelElement<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Obj(face) => face.fmt(f),
            Self::Gltf(element) => element.fmt(f),
        }
    }
}

impl fmt::Display for ObjFace<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.object.is_some() {
            write!(f, "object{}, ", quoted(self.object))?;
        }
        for group in self.groups {
            write!(f, "group{}, ", quoted(Some(group)))?;
        }
        if self.material.is_some() {
            write!(f, "material{}, ", quoted(self.material))?;
        }
        write!(f, "face {} in line {}", self.face, self.line)
    }
}

impl fmt::Display for GltfElement<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "node {}{}", self.node, quoted(self.node_name))?;
        if let Some(instance) = self.instance {
            write!(f, ", instance {instance}")?;
        }
        if let Some(GltfTriangle { mesh, mesh_name, primitive, triangle }) = &self.triangle {
            let name = quoted(*mesh_name);
            write!(f, ", mesh {mesh}{name}, primitive {primitive}, triangle {triangle}")?;
        }
        match self.material {
            Some(material) => write!(f, ", material {material}{}", quoted(self.material_name)),
            None => Ok(()),
        }
    }
}

/// Returns a name in quotes with a space before it; nothing without a name. It is escaped: files may
/// have any character in their names.
fn quoted(name: Option<&str>) -> String {
    name.map_or(String::new(), |name| format!(" `{}`", name.escape_debug()))
}
