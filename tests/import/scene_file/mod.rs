//! The scene file, through the door that everybody uses.

mod bad;
mod docs;
mod good;
mod models;
mod motion;
mod random;

use envers::{Error, Loaded, Location, Scene, load};
use std::path::{Path, PathBuf};

/// A camera in two lines, for scenes that are about something else.
const CAMERA: &str = "camera.position = [0, 0, 5]\ncamera.look_at = [0, 0, 0]\n";

/// A folder with a scene file in it.
struct File {
    folder: tempfile::TempDir,
}

impl File {
    fn new(bytes: impl AsRef<[u8]>) -> Self {
        let file = Self { folder: tempfile::tempdir().unwrap() };
        std::fs::write(file.path(), bytes).unwrap();
        file
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("scene.toml")
    }

    /// A file beside the scene.
    fn beside(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn load(&self) -> Result<Loaded, Error> {
        load(self.path())
    }
}

/// The scene that a text describes.
fn scene(text: &str) -> Scene {
    File::new(text).load().unwrap_or_else(|e| panic!("{e}\n{text}")).scene
}

/// Loads a text with the camera in front.
fn seen(text: &str) -> Scene {
    scene(&format!("{CAMERA}{text}"))
}

/// The error that a text gives; its line and column are those of the mark `¦` in it.
fn refused(marked: &str) -> Error {
    let at = marked.find('¦').expect("the text has a mark");
    let file = File::new(marked.replace('¦', ""));
    let error = file.load().expect_err("the text is refused");
    assert_eq!(error.path(), Some(&*file.path()), "{error}");
    let Some(Location::Text { line, column, quote, .. }) = error.location() else {
        panic!("no place: {error}");
    };
    let before = &marked[..at];
    let start = before.rfind('\n').map_or(0, |i| i + 1);
    let expected = (before.matches('\n').count() + 1, before[start..].chars().count() + 1);
    assert_eq!((*line, *column), expected, "{error}");
    let marked_line = marked[start..].lines().next().unwrap_or_default();
    assert_eq!(*quote, marked_line.replace('¦', ""), "{error}");
    error
}

/// Returns the error that a text gives after the camera.
fn refused_seen(marked: &str) -> Error {
    refused(&format!("{CAMERA}{marked}"))
}

/// The folder of the project's documents.
fn docs_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs")
}
