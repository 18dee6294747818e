//! From a path to a [`Scene`]: the only parsers.
//!
//! A model file (`.gltf`, `.glb`, `.obj`) loads as a scene of its own; a scene file (`.toml`)
//! places such scenes within another one. What leaves this module is resolved and checked:
//! nothing downstream parses, guesses or repairs.

mod framing;
mod gltf;
mod obj;
mod picture;
mod place;
mod repair;
mod scene_file;
mod settle;
mod studio;
mod tally;
mod tangents;

use std::path::Path;

use crate::error::{Error, Result};
use crate::scene::{Scene, Skips, Work, closed};

pub use scene_file::schema;
pub use studio::add_ground;

/// Samples per pixel of a bare model file, which has no setting of its own.
pub const BARE_MODEL_SPP: u32 = 16;

/// Loads a scene file or a bare model file, by its extension.
///
/// A bare model gets a camera that frames it and lights where it has none of its own, a neutral
/// background, and [`BARE_MODEL_SPP`] samples per pixel; a scene file gets no lights that it does
/// not name.
///
/// # Errors
/// When a file cannot be read, or is not what it should be; the error names file and place.
pub fn load(path: &Path) -> Result<Scene> {
    load_with(path, None, Skips::default())
}

/// Loads as [`load`] does, for a picture of another size than the file asks for; a camera that
/// frames the scene is placed for that size.
///
/// # Errors
/// As [`load`].
pub fn load_for(path: &Path, size: Option<[u32; 2]>) -> Result<Scene> {
    load_with(path, size, Skips::default())
}

/// Loads as [`load_for`] does. Unless `skips` is without [`Work::Pictures`], pictures are only
/// named that no material in use shows.
///
/// # Errors
/// As [`load`].
pub fn load_with(path: &Path, size: Option<[u32; 2]>, skips: Skips) -> Result<Scene> {
    let all = !skips.has(Work::Pictures);
    let from_file = extension(path) == "toml";
    let mut scene = if from_file { scene_file::load(path, all)? } else { model(path, None, true)? };
    if let Some(size) = size {
        scene.film.size = size;
    }
    framing::frame(&mut scene);
    if !from_file {
        scene.film.spp = BARE_MODEL_SPP;
        studio::light(&mut scene);
    }
    settle::settle(&mut scene);
    scene.check().map_err(|e| e.at(path))?;
    let open = closed::open_bodies(&scene);
    scene.warnings.extend(open);
    Ok(scene)
}

/// Loads a model file as it is: with its own cameras and lights, or none, and with its animation of
/// that name, or the first. Its pictures are read where they are `wanted`.
fn model(path: &Path, animation: Option<&str>, wanted: bool) -> Result<Scene> {
    match extension(path).as_str() {
        "gltf" | "glb" => gltf::load(path, animation, wanted),
        "obj" if animation.is_some() => Err(Error::input("an OBJ file has no animations")
            .at(path)
            .help("leave `animation` out")),
        "obj" => obj::load(path, wanted),
        other => Err(Error::input(match other {
            "" => "the file has no extension that tells what it is".to_owned(),
            _ => format!("files that end in .{other} are not read"),
        })
        .at(path)
        .help("a scene file ends in .toml, a model in .gltf, .glb or .obj")),
    }
}

/// The extension in lower case, or nothing.
fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Reads a whole regular file.
///
/// # Errors
/// When it is missing, unreadable, or no regular file (a folder, a pipe, a device), which could
/// keep the program waiting for ever.
fn read(path: &Path) -> Result<Vec<u8>> {
    check_file(path)?;
    std::fs::read(path).map_err(|e| Error::io("read", path, &e))
}

/// Checks that a file is there, and a regular one.
///
/// # Errors
/// When it is not.
fn check_file(path: &Path) -> Result<()> {
    let metadata = std::fs::metadata(path).map_err(|e| Error::io("read", path, &e))?;
    if !metadata.is_file() {
        let what = if metadata.is_dir() { "a folder" } else { "a pipe or a device" };
        return Err(Error::input(format!("this is {what}, not a file")).at(path));
    }
    Ok(())
}
