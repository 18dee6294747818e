//! glTF 2.0 files, text and binary.
//!
//! The `gltf` crate gives the types of the JSON; whatever follows an index, an offset or a URI is
//! done here, checked, since the crate's own readers trust the file. What is read, and how it maps
//! to a scene, stands in docs/formats.md.

mod accessor;
mod animation;
mod buffers;
mod compact;
mod container;
mod deform;
mod document;
mod draco;
mod extensions;
mod importer;
mod indices;
mod instancing;
mod lights;
mod material;
mod meshopt;
mod nodes;
mod number;
mod optics;
mod packed;
mod primitive;
mod rows;
mod shapes;
mod slot;
mod texture;
mod topology;
mod validation;
mod variants;

use std::collections::HashMap;
use std::path::Path;

use gltf::json::Value;

use self::accessor::Accessors;
use self::animation::Clip;
use self::buffers::Buffers;
use self::importer::Importer;
use self::material::Materials;
use self::nodes::Placed;
use self::texture::Textures;
use self::variants::Variants;
use crate::error::Result;
use crate::load::diagnostics::Diagnostics;
use crate::load::limits::Limit;
use crate::load::sandbox::{OpenedFile, Sandbox};
use crate::load::{Choice, Loaded};
use crate::scene::Scene;

/// Loads a `.gltf` or `.glb` file.
///
/// # Errors
/// When it cannot be read, is damaged, or requires an extension that isn't read; the error names
/// the place in the JSON. When there is no such animation.
pub fn load(file: OpenedFile, guard: &Sandbox, choice: &Choice) -> Result<Loaded> {
    let path = file.path.clone();
    let bytes = file.read(guard)?;
    import(&path, &bytes, guard, choice).map_err(|e| e.at(&path))
}

fn import(path: &Path, bytes: &[u8], guard: &Sandbox, choice: &Choice) -> Result<Loaded> {
    let (json, bin) = container::split(bytes)?;
    guard.check(Limit::Json, document::memory(json))?;
    let (root, value) = document::parse(json)?;
    let mut tally = Diagnostics::default();
    match value {
        Value::Null => tally.say("the JSON is too large to be held against the standard"),
        _ => validation::validate(&value, bin.map(<[u8]>::len), &mut tally),
    }
    extensions::check(&root, &mut tally)?;
    let buffers = Buffers::new(&root, guard, path, bin);
    let accessors = Accessors::new(&root, guard, &buffers);
    let mut clip = Clip::read(&root, guard, &accessors, choice.animation, &mut tally)?;
    let nodes = nodes::walk(&root, guard, &mut clip, &mut tally)?;
    let order: Vec<usize> = nodes.iter().filter(|n| n.is_shown).map(|n| n.index).collect();
    let by_index: HashMap<usize, Placed> = nodes.into_iter().map(|n| (n.index, n)).collect();
    let mut importer = Importer {
        root: &root,
        guard,
        json: &value,
        accessors,
        materials: Materials::new(&root, Textures::new(&root, guard, &buffers, choice.pictures)),
        variants: Variants::read(&root, choice.variant),
        meshes: HashMap::new(),
        nodes: &by_index,
        joints: HashMap::new(),
        scene: Scene::default(),
        clip,
        tally,
    };
    for index in order {
        importer.node(&by_index[&index])?;
    }
    Ok(importer.finish(path))
}
