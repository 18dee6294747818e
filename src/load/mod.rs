//! From a path to a [`Scene`]: the only parsers.
//!
//! A model file (`.gltf`, `.glb`, `.obj`) loads as a scene of its own; a scene file (`.toml`)
//! places such scenes within another one. What leaves this module is resolved and checked:
//! nothing downstream parses, guesses or repairs.

mod defaults;
mod diagnostics;
mod gltf;
mod images;
mod limits;
mod merge;
mod mesh_repair;
mod obj;
mod sandbox;
mod scene_file;
mod spelling;
mod uri;

use std::path::Path;

use crate::error::{Error, Result};
use crate::scene::{LoadReport, Scene, watertight};

pub use defaults::ground::add_ground;
pub use limits::{Limit, Limits, NamedLimit};
use sandbox::{OpenedFile, Sandbox};
pub use scene_file::schema;

/// Samples per pixel of a bare model file, which has no setting of its own.
pub const BARE_MODEL_SPP: u32 = 16;

/// How to load a scene, where it is not the usual way.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The size of the picture in pixels, in place of the file's; a camera that frames the scene is
    /// placed for it.
    pub size: Option<[u32; 2]>,
    /// Which variant of its materials a glTF file shows (KHR_materials_variants), in place of the
    /// default ones; in a scene file, each model that has one of this name and names none itself.
    pub variant: Option<String>,
    /// Whether files may name others that are neither beside nor below the one that is loaded.
    pub allow_outside: bool,
    /// How much a load may make of what it reads.
    pub limits: Limits,
}

/// Loads a scene file or a bare model file, by its extension.
///
/// A bare model gets a camera that frames it and lights where it has none of its own, a neutral
/// background, and [`BARE_MODEL_SPP`] samples per pixel; a scene file gets no lights that it does
/// not name.
///
/// # Errors
/// When a file cannot be read, or is not what it should be; the error names file and place.
pub fn load(path: &Path) -> Result<Scene> {
    load_with(path, &Options::default())
}

/// Loads as [`load`] does, for a picture of another size than the file asks for; a camera that
/// frames the scene is placed for that size.
///
/// # Errors
/// As [`load`].
pub fn load_for(path: &Path, size: Option<[u32; 2]>) -> Result<Scene> {
    load_with(path, &Options { size, ..Options::default() })
}

/// Loads as [`load`] does, with options.
///
/// # Errors
/// As [`load`]; and when a file names another one outside, or more than a limit allows, unless
/// the options say otherwise; when no file has the variant that they name.
pub fn load_with(path: &Path, options: &Options) -> Result<Scene> {
    let guard = Sandbox::new(path, options.allow_outside, options.limits)?;
    let file = guard.open_named(path)?;
    let from_file = extension(path) == "toml";
    let mut scene = match from_file {
        true => scene_file::load(file, &guard, options)?,
        false => {
            let variant = options.variant.as_deref();
            model(file, &guard, &Choice { animation: None, variant, pictures: true })?
        }
    };
    if let Some(variant) = &options.variant {
        check_variant(variant, &scene.report).map_err(|e| e.at(path))?;
    }
    if let Some(size) = options.size {
        scene.film.size = size;
    }
    defaults::auto_camera::add_camera(&mut scene);
    if !from_file {
        scene.film.spp = BARE_MODEL_SPP;
        defaults::auto_lighting::add_lights(&mut scene);
    }
    defaults::complete(&mut scene);
    scene.check().map_err(|e| e.at(path))?;
    let open = watertight::warn_of_open_dielectrics(&scene);
    scene.warnings.extend(open);
    Ok(scene)
}

/// What of a model file is to be loaded.
struct Choice<'a> {
    /// Its animation of this name; or the first.
    animation: Option<&'a str>,
    /// Its variant of this name, where it has that; or its default materials.
    variant: Option<&'a str>,
    /// Whether its pictures are read, or only named.
    pictures: bool,
}

/// Loads a model file as it is: with its own cameras and lights, or none.
fn model(file: OpenedFile, guard: &Sandbox, choice: &Choice) -> Result<Scene> {
    match extension(&file.path).as_str() {
        "gltf" | "glb" | "vrm" => gltf::load(file, guard, choice),
        "obj" if choice.animation.is_some() => Err(Error::input("an OBJ file has no animations")
            .at(&file.path)
            .help("leave `animation` out")),
        "obj" => obj::load(file, guard, choice.pictures),
        other => Err(Error::input(match other {
            "" => "the file has no extension that tells what it is".to_owned(),
            _ => format!("files that end in .{other} are not read"),
        })
        .at(&file.path)
        .help("a scene file ends in .toml, a model in .gltf, .glb or .obj")),
    }
}

/// Checks that files have a variant of this name.
fn check_variant(name: &str, of: &LoadReport) -> Result<()> {
    if of.variants.contains(name) {
        return Ok(());
    }
    let names: Vec<&str> = of.variants.iter().map(String::as_str).collect();
    let help = match &names[..] {
        [] => "no model has variants of its materials: leave it out".to_owned(),
        names => spelling::choice(name, names, "variants"),
    };
    Err(Error::input(format!("there is no variant `{name}`")).help(help))
}

/// The extension in lower case, or nothing.
fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}
