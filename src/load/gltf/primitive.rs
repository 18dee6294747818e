//! From a primitive to a mesh.

use std::sync::Arc;

use gltf::json;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessor::Accessors;
use super::compact::{compact, keep};
use super::deform;
use super::draco::{self, Unpacked};
use super::material::Asks;
use super::topology;
use crate::error::{Error, Place, Result};
use crate::load::diagnostics::Diagnostics;
use crate::load::mesh_repair::repair;
use crate::load::report::DropReason;
use crate::scene::Mesh;
use crate::scene::animation::{Influences, MorphTarget};

/// A primitive, read.
#[derive(Clone)]
pub struct Part {
    /// The mesh as it was modelled.
    pub mesh: Arc<Mesh>,
    /// What it can be morphed to.
    pub morphs: Arc<[MorphTarget]>,
    /// How it hangs on joints, if it does.
    pub influences: Option<Arc<Influences>>,
}

/// Reads a primitive, with what its material asks for; nothing where there is no triangle in it.
pub fn read(
    primitive: &Primitive,
    accessors: &Accessors,
    asks: &Asks,
    tally: &mut Diagnostics,
    at: &str,
) -> Result<Option<Part>> {
    let mode = mode(primitive, at)?;
    match draco::of(primitive).map(|packed| draco::unpack(primitive, packed, accessors, at)) {
        Some(Ok(Unpacked { corners, attributes })) => {
            // Strips are unpacked as triangles, too.
            let (mode, accessors) = (Mode::Triangles, accessors.with(attributes));
            return assemble(primitive, mode, &accessors, Some(corners), asks, tally, at);
        }
        Some(Err(error)) if !has_positions(primitive, accessors) => return Err(error),
        Some(Err(error)) => tally.say(format!("{error}; what is not packed is read instead")),
        None => {}
    }
    assemble(primitive, mode, accessors, None, asks, tally, at)
}

/// Makes a mesh of what the accessors give; of these corners where they are known already.
fn assemble(
    primitive: &Primitive,
    mode: Mode,
    accessors: &Accessors,
    corners: Option<Vec<u32>>,
    asks: &Asks,
    tally: &mut Diagnostics,
    at: &str,
) -> Result<Option<Part>> {
    let reader = Reader { primitive, accessors, at };
    let place = || at.to_owned();
    if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        reader.drop_all(mode, DropReason::UnsupportedMode, tally);
        return Ok(None);
    }
    let Some(positions) = reader.index(Semantic::Positions) else {
        // The standard allows it, for extensions that bring positions of their own.
        reader.drop_all(mode, DropReason::NoPositions, tally);
        return Ok(None);
    };
    let positions: Vec<[f32; 3]> =
        accessors.floats(positions, &reader.place(&Semantic::Positions))?;
    let vertices = match (corners, primitive.indices) {
        (Some(corners), _) => corners,
        (None, Some(indices)) => accessors.indices(indices.value(), &format!("{at}.indices"))?,
        (None, None) => (0..u32::try_from(positions.len()).unwrap_or(u32::MAX)).collect(),
    };
    let mut mesh =
        Mesh { triangles: topology::triangles(mode, &vertices), positions, ..Mesh::default() };
    let incomplete = topology::is_incomplete(mode, vertices.len());
    tally.read(u64::from(incomplete));
    tally.drop(DropReason::Incomplete, u64::from(incomplete), place);
    mesh.normals = reader.normals(mesh.positions.len(), tally)?;
    (mesh.colors, mesh.alphas) = reader.colors(asks.alpha, mesh.positions.len(), tally)?;
    mesh.uvs = reader.uvs(asks.sets.first(), mesh.positions.len(), tally)?;
    if let Some(second) = asks.sets.get(1) {
        mesh.second_uvs = reader.uvs(Some(second), mesh.positions.len(), tally)?;
    }
    if asks.tangents && !mesh.normals.is_empty() {
        mesh.tangents = reader.tangents(mesh.positions.len(), tally)?;
    }
    let count = mesh.positions.len();
    let before = mesh.triangles.len() as u64;
    let mut morphs = deform::morphs(primitive, accessors, count, tally, at)?;
    let mut influences = deform::influences(primitive, accessors, count, tally, at)?;
    repair(&mut mesh, tally, at);
    // Those that are left are counted when the mesh is stored, which it may be more than once.
    tally.read(before - mesh.triangles.len() as u64);
    if let Some(kept) = compact(&mut mesh) {
        for morph in &mut morphs {
            keep(&mut morph.positions, &kept);
            keep(&mut morph.normals, &kept);
        }
        if let Some(influences) = &mut influences {
            influences.retain_vertices(&kept);
        }
    }
    let influences = influences.map(Arc::new);
    let part = Part { mesh: Arc::new(mesh), morphs: morphs.into(), influences };
    Ok((!part.mesh.triangles.is_empty()).then_some(part))
}

fn mode(primitive: &Primitive, at: &str) -> Result<Mode> {
    match primitive.mode {
        Checked::Valid(mode) => Ok(mode),
        Checked::Invalid => Err(Error::input("this is no known mode")
            .place(Place::Json(format!("{at}.mode")))
            .help("0 to 6; 4 is triangles")),
    }
}

/// Whether a primitive has positions that are not packed.
fn has_positions(primitive: &Primitive, accessors: &Accessors) -> bool {
    let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
    positions.is_some_and(|index| accessors.has_view(index.value()))
}

struct Reader<'a> {
    primitive: &'a Primitive,
    accessors: &'a Accessors<'a>,
    at: &'a str,
}

impl Reader<'_> {
    fn index(&self, semantic: Semantic) -> Option<usize> {
        self.primitive.attributes.get(&Checked::Valid(semantic)).map(json::Index::value)
    }

    /// Counts all faces as read and dropped.
    fn drop_all(&self, mode: Mode, reason: DropReason, tally: &mut Diagnostics) {
        let any = self.primitive.attributes.values().next();
        let corners = self.primitive.indices.or(any.copied());
        let corners = corners.map_or(0, |index| self.accessors.count(index.value()));
        let faces = topology::faces(mode, corners);
        tally.read(faces);
        tally.drop(reason, faces, || self.at.to_owned());
    }

    fn place(&self, semantic: &Semantic) -> String {
        format!("{}.attributes.{}", self.at, semantic.to_string())
    }

    /// The accessor of an attribute that a mesh can do without, when it fits the positions.
    fn fitting(&self, semantic: &Semantic, count: usize, tally: &mut Diagnostics) -> Option<usize> {
        let index = self.index(semantic.clone())?;
        let found = self.accessors.count(index);
        if found == count as u64 {
            return Some(index);
        }
        let reason = "{} vertex attributes are ignored: they have more or fewer values than there \
                      are positions";
        tally.add(reason, 1, || format!("{} ({found} for {count} vertices)", self.place(semantic)));
        None
    }

    fn normals(&self, count: usize, tally: &mut Diagnostics) -> Result<Vec<[f32; 3]>> {
        let semantic = Semantic::Normals;
        match self.fitting(&semantic, count, tally) {
            Some(index) => self.accessors.floats(index, &self.place(&semantic)),
            None => Ok(Vec::new()),
        }
    }

    fn tangents(&self, count: usize, tally: &mut Diagnostics) -> Result<Vec<[f32; 4]>> {
        let semantic = Semantic::Tangents;
        match self.fitting(&semantic, count, tally) {
            Some(index) => self.accessors.floats(index, &self.place(&semantic)),
            None => Ok(Vec::new()),
        }
    }

    /// The colours, and, where `alpha` counts and is not 1 everywhere, the alphas.
    fn colors(
        &self,
        alpha: bool,
        count: usize,
        tally: &mut Diagnostics,
    ) -> Result<(Vec<[f32; 3]>, Vec<f32>)> {
        let semantic = Semantic::Colors(0);
        let Some(index) = self.fitting(&semantic, count, tally) else {
            return Ok(Default::default());
        };
        let place = self.place(&semantic);
        if self.accessors.width(index) != 4 {
            return Ok((self.accessors.colors(index, &place)?, Vec::new()));
        }
        let colors = self.accessors.colors::<4>(index, &place)?;
        let alphas = match alpha && colors.iter().any(|color| color[3] != 1.0) {
            true => colors.iter().map(|color| color[3]).collect(),
            false => Vec::new(),
        };
        Ok((colors.into_iter().map(|[r, g, b, _]| [r, g, b]).collect(), alphas))
    }

    /// Without a texture that asks for them the first set is kept, for who lays another material
    /// on the model.
    fn uvs(
        &self,
        set: Option<&u32>,
        count: usize,
        tally: &mut Diagnostics,
    ) -> Result<Vec<[f32; 2]>> {
        let semantic = Semantic::TexCoords(set.copied().unwrap_or(0));
        match self.fitting(&semantic, count, tally) {
            Some(index) => self.accessors.floats(index, &self.place(&semantic)),
            None => {
                if set.is_some() && self.index(semantic.clone()).is_none() {
                    let reason = "{} primitives have a texture but lack its texture coordinates";
                    tally.add(reason, 1, || self.place(&semantic));
                }
                Ok(Vec::new())
            }
        }
    }
}
