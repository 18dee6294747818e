//! Makes the models of the demo scenes and the gallery: `cargo run --example make_assets` writes `assets/models/`.
//!
//! What it makes is committed, so that nobody has to run it; `tests/assets.rs` holds the committed
//! files to it byte by byte. It asks nothing of a platform's mathematics library but `sqrt`, which
//! is exact everywhere. PNG bytes are those of the `image` crate in Cargo.lock: after an update
//! that compresses otherwise, run it again.

#[path = "make_assets/gallery.rs"]
mod gallery;
#[path = "make_assets/glb.rs"]
mod glb;
#[path = "make_assets/paint.rs"]
mod paint;
#[path = "make_assets/room.rs"]
mod room;
#[path = "make_assets/shape.rs"]
mod shape;
#[path = "make_assets/vase.rs"]
mod vase;

use std::path::Path;

/// The files: their names within `assets/models/`, and their bytes.
pub fn files() -> Vec<(&'static str, Vec<u8>)> {
    let mut files = vec![("room.glb", room::glb())];
    files.extend(vase::files());
    files.extend(gallery::files());
    files
}

/// Where they belong.
pub fn folder() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/models")
}

#[allow(dead_code)] // The test that includes this file has a `main` of its own.
fn main() -> std::io::Result<()> {
    std::fs::create_dir_all(folder())?;
    for (name, bytes) in files() {
        std::fs::write(folder().join(name), &bytes)?;
        println!("assets/models/{name}: {} bytes", bytes.len());
    }
    Ok(())
}
