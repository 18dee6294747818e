//! The importer of glTF 2.0 files, text and binary.
//!
//! The `gltf` crate gives the types of the JSON. Indices, offsets and URIs are resolved here, with
//! checks, since the crate's own readers trust the file. docs/formats.md says what is read, and how
//! it maps to a scene.

mod accessor;
mod buffers;
mod compression;
mod container;
mod extensions;
mod import;
mod json;
mod validate;

use crate::error::Result;
use crate::load::diagnostics::Diagnostics;
use crate::load::limits::Limit;
use crate::load::sandbox::{OpenedFile, Sandbox};
use crate::load::{Loaded, ModelOptions};

/// Loads a `.gltf` or `.glb` file.
///
/// # Errors
/// When it cannot be read, is damaged, or requires an extension that isn't read; the error has a
/// JSON path. When it has no animation of the chosen name.
pub fn load(file: OpenedFile, sandbox: &Sandbox, options: &ModelOptions) -> Result<Loaded> {
    let path = file.path.clone();
    let bytes = file.read(sandbox)?;
    let load = || {
        let (json, bin) = container::split(&bytes)?;
        sandbox.check(Limit::Json, json::estimated_memory(json))?;
        let document = json::parse(json)?;
        let mut diagnostics = Diagnostics::default();
        match &document.value {
            Some(value) => validate::validate(value, bin.map(<[u8]>::len), &mut diagnostics),
            None => diagnostics.note("the JSON is too large to be held against the standard"),
        }
        extensions::check(&document.root, &mut diagnostics)?;
        import::import(&path, &document, bin, sandbox, options, diagnostics)
    };
    load().map_err(|e| e.at(&path))
}
