//! The loading of test files, and assertions on errors and warnings.

use envers::error::{Place, Result};
use envers::scene::Scene;
use envers_testing::{Folder, Model, data_uri};

/// A folder whose files can be loaded.
pub trait LoadFile {
    /// Writes a file and loads it.
    fn load(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<Scene>;
}

impl LoadFile for Folder {
    fn load(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<Scene> {
        envers::load::load(&self.write(name, bytes))
    }
}

/// A model that can be loaded.
pub trait LoadModel {
    /// Writes the file, its buffer in a data URI, and loads it.
    fn load(&self) -> Result<Scene>;

    /// Writes the file in a folder and loads it.
    fn load_in(&self, folder: &Folder) -> Result<Scene>;
}

impl LoadModel for Model {
    fn load(&self) -> Result<Scene> {
        self.load_in(&Folder::new())
    }

    fn load_in(&self, folder: &Folder) -> Result<Scene> {
        folder.load("model.gltf", self.to_json(Some(&data_uri(self.bin()))).to_string())
    }
}

/// The JSON path of an error, and its whole text.
#[track_caller]
pub fn json_place(result: Result<Scene>) -> (String, String) {
    let error = result.map(|s| s.triangle_count()).unwrap_err();
    match error.place_in_file() {
        Some(Place::Json(path)) => (path.clone(), error.to_string()),
        other => panic!("{other:?} in {error}"),
    }
}

/// Asserts that a scene warns once, with `part` in it.
#[track_caller]
pub fn assert_warns(scene: &Scene, part: &str) {
    let found = scene.warnings.iter().filter(|w| w.contains(part)).count();
    assert_eq!(found, 1, "`{part}` in {:?}", scene.warnings);
}
