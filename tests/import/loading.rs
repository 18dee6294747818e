//! The loading of test files, and assertions on errors and warnings.

use envers::{LoadOptions, Loaded, Location, Result};
use envers_testing::{Folder, Model, data_uri};

/// A folder whose files can be loaded.
pub trait LoadFile {
    /// Writes a file and loads it.
    fn load(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<Loaded>;
}

impl LoadFile for Folder {
    fn load(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<Loaded> {
        envers::load(self.write(name, bytes))
    }
}

/// A model that can be loaded.
pub trait LoadModel {
    /// Writes the file, its buffer in a data URI, and loads it.
    fn load(&self) -> Result<Loaded>;

    /// Writes the file in a folder and loads it.
    fn load_in(&self, folder: &Folder) -> Result<Loaded>;

    /// Writes the file, its buffer in a data URI, and loads it with these options.
    fn load_with(&self, options: &LoadOptions) -> Result<Loaded>;
}

impl LoadModel for Model {
    fn load(&self) -> Result<Loaded> {
        self.load_in(&Folder::new())
    }

    fn load_in(&self, folder: &Folder) -> Result<Loaded> {
        folder.load("model.gltf", self.to_json(Some(&data_uri(self.bin()))).to_string())
    }

    fn load_with(&self, options: &LoadOptions) -> Result<Loaded> {
        let folder = Folder::new();
        let json = self.to_json(Some(&data_uri(self.bin()))).to_string();
        options.load(folder.write("model.gltf", json))
    }
}

/// The JSON path of an error, and its whole text.
#[track_caller]
pub fn json_place(result: Result<Loaded>) -> (String, String) {
    let error = result.map(|loaded| loaded.scene.triangle_count()).unwrap_err();
    match error.location() {
        Some(Location::Json(path)) => (path.clone(), error.to_string()),
        other => panic!("{other:?} in {error}"),
    }
}

/// Asserts that a load warns once, with `part` in it.
#[track_caller]
pub fn assert_warns(loaded: &Loaded, part: &str) {
    let found = loaded.report.warnings.iter().filter(|w| w.contains(part)).count();
    assert_eq!(found, 1, "`{part}` in {:?}", loaded.report.warnings);
}
