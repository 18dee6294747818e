//! The importer of Wavefront OBJ files with their MTL files; docs/formats.md says what is read, and how.
//!
//! The tobj crate parses both kinds of file. But it gives up at the first line that it does not expect,
//! without naming the line, and it misaligns normals where only some vertices of a mesh have them;
//! and files from all over the world are full of such lines. So tobj reads a normalized text, which
//! consists nearly everywhere of unchanged ranges of the file:
//!
//! 1. `lexer` decodes the bytes, and finds the lines and their statements.
//! 2. `normalize` splits the text into chunks, and finds the `state` at the start of each.
//! 3. `parse` sorts the lines of each chunk, in parallel, into vertices and the faces of groups: all
//!    faces of a group become one mesh, and have the same attributes. Lines that tobj reads right are
//!    passed on as ranges of the file (`pieces`); the others are rewritten (`vertex_data`, `indices`), with
//!    the colours of `polypaint`, or dropped, with a warning that names the line.
//! 4. `tobj_input` is the text that tobj reads while later chunks are still being parsed: first all
//!    vertices, then the faces, group by group. tobj unites the three indices of a corner.
//! 5. This module builds a mesh of each group, with `triangulate` and `smooth_normals`.
//! 6. `material_library` finds the MTL files. `mtl` normalizes them for tobj, too; `material` converts
//!    the materials, with `illumination`, `texture_map` and `textures`.

mod face_numbers;
mod file_lookup;
mod illumination;
mod indices;
mod lexer;
mod material;
mod material_library;
mod mtl;
mod normalize;
mod parse;
mod pieces;
mod polypaint;
mod smooth_normals;
mod state;
mod texture_map;
mod textures;
mod tobj_input;
mod triangulate;
mod vertex_data;

use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use self::face_numbers::FaceNumbers;
use self::material_library::MaterialLibrary;
use self::state::FaceGroup;
use crate::error::{Error, Result};
use crate::load::diagnostics::Diagnostics;
use crate::load::limits::Limit;
use crate::load::mesh_repair::repair;
use crate::load::report::DropReason;
use crate::load::sandbox::{OpenedFile, Sandbox};
use crate::load::{Loaded, ModelOptions};
use crate::scene::{
    FaceMap, FileContents, Instance, Mesh, MeshProvenance, ObjectProvenance, ProvenanceTable,
    Scene, Transfer,
};

/// Loads an `.obj` file.
///
/// # Errors
/// When it cannot be read, is no text, or a line of it cannot be parsed; the error names the
/// line.
pub fn load(file: OpenedFile, sandbox: &Sandbox, options: &ModelOptions) -> Result<Loaded> {
    let path = file.path.clone();
    let bytes = file.read(sandbox)?;
    import(&path, &bytes, sandbox, options).map_err(|e| e.at(&path))
}

fn import(path: &Path, bytes: &[u8], sandbox: &Sandbox, options: &ModelOptions) -> Result<Loaded> {
    let mut diagnostics = Diagnostics::default();
    // Vertices and faces, by tobj.
    let text = lexer::decode_text(bytes)?;
    let (info, read) = normalize::normalize(&text, &mut diagnostics, |input| {
        let options = tobj::LoadOptions { single_index: true, ..Default::default() };
        // No `mtllib` is left in the text.
        tobj::load_obj_buf(input, &options, |_| Err(tobj::LoadError::GenericFailure))
    })?;
    let (models, _) = read.map_err(|e| Error::input(format!("the file cannot be read: {e}")))?;
    // A mesh and an instance of each group.
    let mut library = MaterialLibrary::new(sandbox, options.shading);
    if !options.geometry_only {
        library.read(&info.libraries, path, &mut diagnostics);
        let names = info.groups.iter().map(FaceGroup::material_name);
        library.show_what_is_all_clear(names, &mut diagnostics);
    }
    let mut scene = Scene::default();
    if options.provenance {
        let faces = FileContents::Obj(face_numbers::read_faces(&text));
        scene.provenance = Some(Arc::new(ProvenanceTable::from_file(path.to_owned(), faces)));
    }
    let max_color_value = (!options.geometry_only).then(|| max_color_value(&models));
    for model in models {
        let index = model.name.parse().ok();
        let Some(index) = index.filter(|i: &usize| *i < info.groups.len()) else { continue };
        let group = &info.groups[index];
        let numbers = info.faces.get(index).filter(|_| options.provenance);
        let Some((mesh, faces)) =
            build_mesh(&model.mesh, group, numbers, max_color_value, &mut diagnostics)
        else {
            continue;
        };
        // Without materials all groups share that of no name.
        let name = if options.geometry_only { "" } else { group.material_name() };
        let material = library.material(name, &mut scene, &mut diagnostics);
        sandbox.consume(Limit::Vertices, mesh.positions.len() as u64)?;
        sandbox.consume(Limit::Triangles, mesh.triangles.len() as u64)?;
        sandbox.check(Limit::Instances, scene.instances.len() as u64 + 1)?;
        let mesh = scene.add_mesh(mesh);
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
        if let Some(table) = scene.provenance_mut() {
            table.meshes.push(MeshProvenance { primitive: None, faces: Arc::new(faces) });
            table.instances.push(ObjectProvenance::in_file(None));
        }
    }
    // The images of the materials in use.
    library.decode_images(options.needs_images, &mut scene, &mut diagnostics);
    if scene.instances.is_empty() {
        diagnostics.note("there is no face in the file");
    }
    let report = diagnostics.into_report(path, &scene);
    Ok(Loaded { scene, report })
}

/// Returns the greatest value that vertex colours can have: 1, or 255 where one is above 1.
fn max_color_value(models: &[tobj::Model]) -> f64 {
    let mut values = models.iter().flat_map(|model| &model.mesh.vertex_color);
    if values.any(|&x| x > 1.0) { 255.0 } else { 1.0 }
}

/// Builds the mesh of a group, if it has a triangle, and the map to its faces if their `numbers` are
/// given. Vertex colours are divided by `max_color_value`; without it the mesh has neither these nor texture
/// coordinates.
fn build_mesh(
    source: &tobj::Mesh,
    group: &FaceGroup,
    numbers: Option<&FaceNumbers>,
    max_color_value: Option<f64>,
    diagnostics: &mut Diagnostics,
) -> Option<(Mesh, FaceMap)> {
    let name = group.settings.name.as_deref();
    let place = name.unwrap_or("the object without a name");
    let positions = source.positions.as_chunks().0;
    let count = positions.len();
    // OBJ's v runs up the image, ours runs down.
    let flip = |[u, v]: [f32; 2]| [u, 1.0 - v];
    let narrow = |n: &[f64; 3]| n.map(|x| x as f32);
    // As on a screen: programs that write vertex colours mean them so.
    let linear =
        |c: &[f64; 3], greatest: f64| c.map(|x| Transfer::Srgb.decode((x / greatest) as f32));
    // Attributes and triangles, side by side.
    let attributes = || {
        let normals = source.normals.as_chunks().0.iter().map(narrow).collect();
        let mut mesh = Mesh {
            positions: positions.into(),
            normals: per_vertex(normals, count),
            ..Mesh::default()
        };
        if let Some(greatest) = max_color_value {
            let uvs = source.texcoords.as_chunks().0.iter();
            let uvs = uvs.map(|uv| flip(uv.map(|x| x as f32))).collect();
            mesh.uvs = per_vertex(uvs, count);
            let colors = source.vertex_color.as_chunks().0.iter();
            mesh.colors = per_vertex(colors.map(|c| linear(c, greatest)).collect(), count);
        }
        mesh
    };
    let (attributes, (triangles, mut faces)) =
        rayon::join(attributes, || triangles(source, numbers, positions, diagnostics, place));
    // Normals of the smoothing group, and all that makes the mesh valid.
    let name = name.unwrap_or_default().to_owned();
    let mut mesh = Mesh { name, triangles, ..attributes };
    if mesh.normals.is_empty() && group.settings.smoothing.is_some() {
        mesh.normals = smooth_normals::smooth_normals(&mesh);
    }
    repair(&mut mesh, &mut faces, diagnostics, place);
    (!mesh.triangles.is_empty()).then_some((mesh, faces))
}

/// Returns the values of an attribute if every vertex has one, or else none.
fn per_vertex<T>(values: Vec<T>, count: usize) -> Vec<T> {
    if values.len() == count { values } else { Vec::new() }
}

/// Returns the triangles of a mesh of polygons, and the map to these if their `numbers` are given.
fn triangles(
    source: &tobj::Mesh,
    numbers: Option<&FaceNumbers>,
    positions: &[[f64; 3]],
    diagnostics: &mut Diagnostics,
    place: &str,
) -> (Vec<[u32; 3]>, FaceMap) {
    // tobj leaves the arities out where all are 3.
    if source.face_arities.is_empty() {
        let faces = numbers.map(|numbers| FaceMap::from_numbers(numbers.iter().collect()));
        return (source.indices.as_chunks().0.to_vec(), faces.unwrap_or_default());
    }
    let arities = source.face_arities.iter();
    let expected: u64 = arities.map(|&arity| u64::from(arity.saturating_sub(2))).sum();
    let mut rest = source.indices.as_slice();
    let mut triangles = Vec::with_capacity(source.indices.len());
    let mut numbers = numbers.map(FaceNumbers::iter);
    let mut faces = numbers.is_some().then(Vec::new);
    for &arity in &source.face_arities {
        let Some((face, after)) = rest.split_at_checked(arity as usize) else { break };
        rest = after;
        let position = |&i: &u32| positions.get(i as usize).copied().unwrap_or_default().into();
        let corners: Vec<DVec3> = face.iter().map(position).collect();
        let made = triangulate::triangulate(&corners);
        if let (Some(faces), Some(numbers)) = (&mut faces, &mut numbers) {
            faces.extend(numbers.next().into_iter().flat_map(|n| vec![n; made.len()]));
        }
        let vertex = |i: usize| face.get(i).copied().unwrap_or(u32::MAX);
        triangles.extend(made.into_iter().map(|t| t.map(vertex)));
    }
    // A polygon with corners at one place is cut into fewer.
    let lost = expected.saturating_sub(triangles.len() as u64);
    diagnostics.drop(DropReason::Degenerate, lost, || place.to_owned());
    (triangles, faces.map(FaceMap::from_numbers).unwrap_or_default())
}
