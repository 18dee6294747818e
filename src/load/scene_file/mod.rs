//! The scene file: TOML in, a [`Scene`](crate::scene::Scene) out.
//!
//! Three steps, each in its own files: `tables` and what it is made of say what may be written
//! (and give the JSON Schema); serde reads the text into them and `report` puts what it refuses
//! into words; `resolve` and its neighbours turn the tables into a scene, with an eye on what only
//! several keys together can get wrong.

mod animation;
mod animation_tables;
mod camera;
mod color;
mod film;
mod light;
mod model;
mod mover;
mod names;
mod pictures;
mod report;
mod resolve;
mod schema;
mod shown;
mod source;
mod spanned;
mod tables;
mod track;
mod values;

use crate::error::{Error, Place, Result};
use crate::load::sandbox::{OpenedFile, Sandbox};
use crate::load::{LoadOptions, Loaded};

pub use schema::schema;

/// Loads a scene file, with the models that it names.
///
/// # Errors
/// When a file cannot be read, or says something that it cannot mean; the error names the line and
/// the column in the scene file, or the place in the model at fault.
pub fn load(file: OpenedFile, guard: &Sandbox, options: &LoadOptions) -> Result<Loaded> {
    let path = &file.path.clone();
    let bytes = file.read(guard)?;
    let text = utf8(&bytes).map_err(|e| e.at(path))?;
    let source = source::Source::new(path, text);
    let tables = toml::from_str(text).map_err(|e| report::error(&source, e))?;
    resolve::scene(&source, tables, guard, options)
}

/// The text of a file, without the byte order mark that some editors put first.
fn utf8(bytes: &[u8]) -> Result<&str> {
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let at = e.valid_up_to();
        let shown = String::from_utf8_lossy(bytes);
        Error::input("the file is not UTF-8 text")
            .place(Place::in_text(&shown, at..at + 1))
            .help("save it as UTF-8")
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}
