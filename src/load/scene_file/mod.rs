//! The importer of scene files: TOML in, a [`Scene`](crate::scene::Scene) out.
//!
//! 1. `schema` holds the tables and values that may be written, and gives the JSON Schema of them.
//! 2. serde reads the text into these tables; `errors` rewords its errors.
//! 3. `build` turns the tables into a scene, and checks the keys that depend on one another.

mod build;
mod errors;
mod schema;
mod source;

use crate::error::{Error, Location, Result};
use crate::load::limits::Limit;
use crate::load::sandbox::{OpenedFile, Sandbox};
use crate::load::{LoadOptions, Loaded};

pub use schema::json_schema::schema;
use schema::tables::{DefaultLights, SceneTable};

/// Loads a scene file, with the models that it names. Returns also whether it needs default lights: it has a
/// model, no light, and does not say that there be none.
///
/// # Errors
/// When a file cannot be read, or its contents are not valid; the error names the line and
/// the column in the scene file, or the place in the model at fault.
pub fn load(file: OpenedFile, sandbox: &Sandbox, options: &LoadOptions) -> Result<(Loaded, bool)> {
    let path = &file.path.clone();
    // The size alone can be too much, before anything is read.
    sandbox.check(Limit::Json, source::least_memory(file.length())).map_err(|e| e.at(path))?;
    let bytes = file.read(sandbox)?;
    let text = decode_utf8(&bytes).map_err(|e| e.at(path))?;
    let source = source::Source { path, text };
    if let Some((at, found)) = source::control_character(text) {
        let message = format!("the control character U+{:04X} cannot stand here", found as u32);
        return Err(source
            .error(&(at..at + 1), message)
            .help("a scene file is TOML, which is text"));
    }
    let memory = source::estimated_memory(text);
    sandbox.check(Limit::Json, memory).map_err(|e| e.at(path))?;
    let tables: SceneTable = toml::from_str(text).map_err(|e| errors::reword(&source, e))?;
    let loaded = build::build_scene(&source, &tables, sandbox, options)?;
    let needs_lights = !tables.model.0.is_empty()
        && loaded.scene.lights.is_empty()
        && tables.lights != Some(DefaultLights::None);
    Ok((loaded, needs_lights))
}

/// Returns the text of a file, without the byte order mark that some editors put first.
fn decode_utf8(bytes: &[u8]) -> Result<&str> {
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let at = e.valid_up_to();
        // Only what precedes the place, and a little more, is shown.
        let shown = String::from_utf8_lossy(&bytes[..bytes.len().min(at + 200)]);
        Error::input("the file is not UTF-8 text")
            .with_location(Location::in_text(&shown, at..at + 1))
            .help("save it as UTF-8")
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}
