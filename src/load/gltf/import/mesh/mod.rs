//! The meshes of primitives.

mod compact;
mod topology;

use std::sync::Arc;

use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::{self, validation::Checked};

use self::compact::{compact, retain_vertices};
use super::material::NeededAttributes;
use crate::error::Result;
use crate::load::diagnostics::Diagnostics;
use crate::load::gltf::accessor::Accessors;
use crate::load::gltf::compression::draco;
use crate::load::gltf::json::error_at;
use crate::load::mesh_repair::repair;
use crate::load::report::DropReason;
use crate::scene::animation::{Influences, MorphTarget};
use crate::scene::{FaceMap, Mesh};

/// The mesh of a primitive, with what can deform it.
#[derive(Clone)]
pub struct PrimitiveMesh {
    /// The mesh as it was modelled.
    pub mesh: Arc<Mesh>,
    /// Its morph targets.
    pub morph_targets: Arc<[MorphTarget]>,
    /// The joints that influence its vertices, if it can be skinned.
    pub influences: Option<Arc<Influences>>,
    /// The numbers of its triangles in the primitive, if they are recorded.
    pub faces: Arc<FaceMap>,
}

/// A primitive that is being read.
pub struct PrimitiveReader<'a> {
    /// The primitive.
    pub primitive: &'a Primitive,
    /// The accessors of the file, or of what is decompressed.
    pub accessors: &'a Accessors<'a>,
    /// Its JSON path.
    pub path: &'a str,
    /// The diagnostics of the load.
    pub diagnostics: &'a mut Diagnostics,
    /// True if the numbers of its triangles are recorded.
    pub records_faces: bool,
}

impl PrimitiveReader<'_> {
    /// Reads the mesh of the primitive, with the attributes that its material needs; `None` if it has
    /// no triangle.
    ///
    /// # Errors
    /// When its indices or a needed attribute cannot be read.
    pub fn read(self, needed: &NeededAttributes) -> Result<Option<PrimitiveMesh>> {
        let Self { primitive, accessors, path, .. } = self;
        let Checked::Valid(mode) = primitive.mode else {
            let error = error_at(format_args!("{path}.mode"), "this is no known mode");
            return Err(error.help("0 to 6; 4 is triangles"));
        };
        match draco::decompress(primitive, accessors, path) {
            // Strips are decompressed as triangles, too.
            Ok(Some((corners, attributes))) => {
                let accessors = &accessors.with_decompressed(attributes);
                let reader = PrimitiveReader { accessors, ..self };
                return reader.read_mesh(Mode::Triangles, Some(corners), needed);
            }
            Ok(None) => {}
            // Some files have the same without compression as well.
            Err(error) => {
                let positions = self.accessor(Semantic::Positions);
                if !positions.is_some_and(|index| accessors.has_view(index)) {
                    return Err(error);
                }
                let warning = format!("{error}; what is not compressed is read instead");
                self.diagnostics.note(warning);
            }
        }
        self.read_mesh(mode, None, needed)
    }

    /// Reads the mesh, from `corners` if they are decompressed.
    fn read_mesh(
        mut self,
        mode: Mode,
        corners: Option<Vec<u32>>,
        needed: &NeededAttributes,
    ) -> Result<Option<PrimitiveMesh>> {
        let Self { primitive, accessors, path, .. } = self;
        let to_string = || path.to_owned();
        // Only triangles can be drawn.
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.drop_all(mode, DropReason::UnsupportedMode);
            return Ok(None);
        }

        // Triangles.
        let Some(positions) = self.accessor(Semantic::Positions) else {
            // The standard allows it, for extensions that bring positions of their own.
            self.drop_all(mode, DropReason::NoPositions);
            return Ok(None);
        };
        let positions = accessors.floats(positions, &self.attribute_path(&Semantic::Positions))?;
        let count = positions.len();
        let corners = match (corners, primitive.indices) {
            (Some(corners), _) => corners,
            (None, Some(indices)) => {
                accessors.indices(indices.value(), &format!("{path}.indices"))?
            }
            (None, None) => (0..u32::try_from(count).unwrap_or(u32::MAX)).collect(),
        };
        // The faces that are incomplete are counted here, since none of them gets into the mesh.
        let triangles = topology::triangles(mode, &corners);
        let mut faces = FaceMap::Unrecorded;
        if self.records_faces {
            faces = topology::face_map(mode, &corners);
        }
        let mut mesh = Mesh { triangles, positions: positions.into(), ..Mesh::default() };
        let incomplete = u64::from(topology::is_incomplete(mode, corners.len()));
        self.diagnostics.read(incomplete);
        self.diagnostics.drop(DropReason::Incomplete, incomplete, to_string);

        // Attributes of vertices.
        mesh.normals = self.attribute(Semantic::Normals, count)?;
        if !needed.geometry_only {
            (mesh.colors, mesh.alphas) = self.colors(needed.alpha, count)?;
            mesh.uvs = self.uvs(needed.uv_sets.first(), count)?;
        }
        if let Some(second) = needed.uv_sets.get(1) {
            mesh.second_uvs = self.uvs(Some(second), count)?;
        }
        // Tangents mean nothing without the normals that they belong to.
        if needed.tangents && !mesh.normals.is_empty() {
            mesh.tangents = self.attribute(Semantic::Tangents, count)?;
        }
        let mut targets = self.morph_targets(count)?;
        let mut influences = self.influences(count)?;

        // Faces that are left are counted when the mesh is stored, which may be more than once.
        let before = mesh.triangles.len() as u64;
        repair(&mut mesh, &mut faces, self.diagnostics, path);
        self.diagnostics.read(before - mesh.triangles.len() as u64);

        // What deforms the mesh has values for the same vertices.
        if let Some(kept) = compact(&mut mesh) {
            for target in &mut targets {
                retain_vertices(&mut target.positions, &kept);
                retain_vertices(&mut target.normals, &kept);
            }
            if let Some(influences) = &mut influences {
                influences.retain_vertices(&kept);
            }
        }
        // A primitive without faces is not shown; its warnings have been given.
        if mesh.triangles.is_empty() {
            return Ok(None);
        }
        Ok(Some(PrimitiveMesh {
            mesh: Arc::new(mesh),
            morph_targets: targets.into(),
            influences: influences.map(Arc::new),
            faces: Arc::new(faces),
        }))
    }

    /// The index of an attribute's accessor.
    pub fn accessor(&self, semantic: Semantic) -> Option<usize> {
        self.primitive.attributes.get(&Checked::Valid(semantic)).map(json::Index::value)
    }

    fn attribute_path(&self, semantic: &Semantic) -> String {
        format!("{}.attributes.{}", self.path, semantic.to_string())
    }

    /// Counts all faces as read and dropped.
    fn drop_all(&mut self, mode: Mode, reason: DropReason) {
        let any = self.primitive.attributes.values().next();
        let corners = self.primitive.indices.or(any.copied());
        // Faces are counted from the indices or, without them, from any of the attributes.
        let corners = corners.map_or(0, |index| self.accessors.count(index.value()));
        let faces = topology::face_count(mode, corners);
        self.diagnostics.read(faces);
        self.diagnostics.drop(reason, faces, || self.path.to_owned());
    }

    /// The index of the accessor of an optional attribute, if it has a value for each vertex.
    fn fitting_accessor(&mut self, semantic: &Semantic, count: usize) -> Option<usize> {
        let index = self.accessor(semantic.clone())?;
        let found = self.accessors.count(index);
        if found == count as u64 {
            return Some(index);
        }
        let reason = "{} vertex attributes are ignored: they have more or fewer values than there \
                      are positions";
        let path = self.attribute_path(semantic);
        self.diagnostics.add(reason, 1, || format!("{path} ({found} for {count} vertices)"));
        None
    }

    /// Returns the values of an optional attribute; none if it is missing or has too few or many.
    fn attribute<const N: usize>(
        &mut self,
        semantic: Semantic,
        count: usize,
    ) -> Result<Vec<[f32; N]>> {
        match self.fitting_accessor(&semantic, count) {
            Some(index) => self.accessors.floats(index, &self.attribute_path(&semantic)),
            None => Ok(Vec::new()),
        }
    }

    /// Returns the colours and, if `alpha` counts and is not 1 everywhere, the alphas.
    fn colors(&mut self, alpha: bool, count: usize) -> Result<(Vec<[f32; 3]>, Vec<f32>)> {
        let semantic = Semantic::Colors(0);
        let Some(index) = self.fitting_accessor(&semantic, count) else {
            return Ok((Vec::new(), Vec::new()));
        };
        let path = self.attribute_path(&semantic);
        if self.accessors.width(index) != 4 {
            return Ok((self.accessors.normalized_floats(index, &path)?, Vec::new()));
        }
        // Alphas that are all 1 are not stored.
        let colors = self.accessors.normalized_floats::<4>(index, &path)?;
        let has_alpha = alpha && colors.iter().any(|color| color[3] != 1.0);
        let alphas =
            if has_alpha { colors.iter().map(|color| color[3]).collect() } else { Vec::new() };
        Ok((colors.into_iter().map(|[r, g, b, _]| [r, g, b]).collect(), alphas))
    }

    /// Returns the texture coordinates of a set; without a texture that needs one, those of the
    /// first, in case that another material is laid on the model.
    fn uvs(&mut self, set: Option<&u32>, count: usize) -> Result<Vec<[f32; 2]>> {
        let semantic = Semantic::TexCoords(set.copied().unwrap_or(0));
        if set.is_some() && self.accessor(semantic.clone()).is_none() {
            let reason = "{} primitives have a texture but lack its texture coordinates";
            let path = self.attribute_path(&semantic);
            self.diagnostics.add(reason, 1, || path);
        }
        self.attribute(semantic, count)
    }
}
