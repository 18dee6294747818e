//! Wavefront OBJ files with their MTL.
use std::path::Path;

use crate::error::{Error, Result};
use crate::scene::Scene;

/// Loads an `.obj` file.
pub fn load(path: &Path) -> Result<Scene> {
    Err(Error::input("OBJ is not read yet").at(path))
}
