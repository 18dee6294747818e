//! The scene file.
use std::path::Path;

use crate::error::{Error, Result};
use crate::scene::Scene;

/// Loads a scene file.
pub fn load(path: &Path) -> Result<Scene> {
    Err(Error::input("scene files are not read yet").at(path))
}

/// The JSON Schema of the scene file.
pub fn schema() -> schemars::Schema {
    schemars::Schema::default()
}
