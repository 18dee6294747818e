//! Wavefront OBJ files with their MTL.
//!
//! [`rewrite`] checks a file and puts it in the form that tobj takes, tobj makes vertices of its
//! separate indices, and this module makes meshes of them. What is read, and how, stands in
//! docs/formats.md.

mod corners;
mod files;
mod illumination;
mod library;
mod lines;
mod map;
mod material;
mod mtl;
mod plain;
mod polygon;
mod rewrite;
mod segments;
mod setting;
mod smooth;
mod sorter;
mod stream;
mod textures;
mod vertices;

use std::path::Path;

use glam::{DAffine3, DVec3};

use self::library::Library;
use self::setting::Part;
use crate::error::{Error, Result};
use crate::load::Loaded;
use crate::load::diagnostics::Diagnostics;
use crate::load::limits::Limit;
use crate::load::mesh_repair::repair;
use crate::load::report::DropReason;
use crate::load::sandbox::{OpenedFile, Sandbox};
use crate::scene::{Instance, Mesh, Scene, Transfer};

/// Loads an `.obj` file; its pictures are read where they are `wanted`.
///
/// # Errors
/// When it cannot be read, is no text, or a line of it cannot be understood; the error names the
/// line.
pub fn load(file: OpenedFile, guard: &Sandbox, wanted: bool) -> Result<Loaded> {
    let path = file.path.clone();
    let bytes = file.read(guard)?;
    import(&path, &bytes, guard, wanted).map_err(|e| e.at(&path))
}

fn import(path: &Path, bytes: &[u8], guard: &Sandbox, wanted: bool) -> Result<Loaded> {
    let mut tally = Diagnostics::default();
    let text = lines::decode(bytes)?;
    let (made, read) = rewrite::rewrite(&text, &mut tally, |made| {
        let options = tobj::LoadOptions { single_index: true, ..Default::default() };
        // No `mtllib` is left in the text.
        tobj::load_obj_buf(made, &options, |_| Err(tobj::LoadError::GenericFailure))
    })?;
    let (models, _) = read.map_err(|e| Error::input(format!("the file cannot be read: {e}")))?;
    let mut library = Library::read(&made.libraries, path, guard, &mut tally);
    let mut scene = Scene::default();
    let unit = unit_of_colors(&models);
    for model in models {
        let Some(part) = model.name.parse().ok().and_then(|i: usize| made.parts.get(i)) else {
            continue;
        };
        let Some(mesh) = mesh(&model.mesh, part, unit, &mut tally) else { continue };
        let name = part.setting.material.as_deref().unwrap_or_default();
        let material = library.get(name, &mut scene, &mut tally);
        guard.take(Limit::Vertices, mesh.positions.len() as u64)?;
        guard.take(Limit::Triangles, mesh.triangles.len() as u64)?;
        guard.check(Limit::Instances, scene.instances.len() as u64 + 1)?;
        let mesh = scene.add_mesh(mesh);
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
    }
    library.decode(wanted, &mut scene, &mut tally);
    if scene.instances.is_empty() {
        tally.say("there is no face in the file");
    }
    let report = tally.finish(path, &scene);
    Ok(Loaded { scene, report })
}

/// What stands for a full vertex colour: 1, or 255 where a value is above 1.
fn unit_of_colors(models: &[tobj::Model]) -> f32 {
    let mut values = models.iter().flat_map(|model| &model.mesh.vertex_color);
    if values.any(|&x| x > 1.0) { 255.0 } else { 1.0 }
}

/// The mesh of a part; nothing where it has no triangle. Its vertices' colours go up to `unit`.
fn mesh(source: &tobj::Mesh, part: &Part, unit: f32, tally: &mut Diagnostics) -> Option<Mesh> {
    let name = part.setting.name.as_deref();
    let place = name.unwrap_or("the object without a name");
    let positions: Vec<[f32; 3]> = source.positions.as_chunks().0.to_vec();
    let count = positions.len();
    // OBJ's v runs up the picture, ours runs down.
    let flip = |[u, v]: [f32; 2]| [u, 1.0 - v];
    // As on a screen: programs that write vertex colours mean them so.
    let linear = |c: &[f32; 3]| c.map(|x| Transfer::Srgb.decode(x / unit));
    let attributes = || {
        let uvs = source.texcoords.as_chunks().0.iter().copied().map(flip).collect();
        let colors = source.vertex_color.as_chunks().0.iter().map(linear).collect();
        Mesh {
            normals: per_vertex(source.normals.as_chunks().0.to_vec(), count),
            uvs: per_vertex(uvs, count),
            colors: per_vertex(colors, count),
            ..Mesh::default()
        }
    };
    let (attributes, triangles) =
        rayon::join(attributes, || triangles(source, &positions, tally, place));
    let name = name.unwrap_or_default().to_owned();
    let mut mesh = Mesh { name, positions, triangles, ..attributes };
    if mesh.normals.is_empty() && part.setting.smoothing.is_some() {
        mesh.normals = smooth::normals(&mesh);
    }
    repair(&mut mesh, tally, place);
    (!mesh.triangles.is_empty()).then_some(mesh)
}

/// An attribute, if every vertex has it.
fn per_vertex<T>(values: Vec<T>, count: usize) -> Vec<T> {
    if values.len() == count { values } else { Vec::new() }
}

fn triangles(
    source: &tobj::Mesh,
    positions: &[[f32; 3]],
    tally: &mut Diagnostics,
    place: &str,
) -> Vec<[u32; 3]> {
    // tobj leaves the arities out where all are 3.
    if source.face_arities.is_empty() {
        return source.indices.as_chunks().0.to_vec();
    }
    let arities = source.face_arities.iter();
    let expected: u64 = arities.map(|&arity| u64::from(arity.saturating_sub(2))).sum();
    let mut rest = source.indices.as_slice();
    let mut triangles = Vec::with_capacity(source.indices.len());
    for &arity in &source.face_arities {
        let Some((face, after)) = rest.split_at_checked(arity as usize) else { break };
        rest = after;
        let corners: Vec<DVec3> = face.iter().map(|&i| position(positions, i)).collect();
        let made = polygon::triangulate(&corners);
        let vertex = |i: usize| face.get(i).copied().unwrap_or(u32::MAX);
        triangles.extend(made.into_iter().map(|t| t.map(vertex)));
    }
    // A polygon with corners at one place is cut into fewer.
    let lost = expected.saturating_sub(triangles.len() as u64);
    tally.drop(DropReason::Degenerate, lost, || place.to_owned());
    triangles
}

fn position(positions: &[[f32; 3]], index: u32) -> DVec3 {
    DVec3::from(positions.get(index as usize).copied().unwrap_or_default().map(f64::from))
}
