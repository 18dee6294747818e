//! Makes the models of the demo scenes and the gallery, and the drawings of the tutorial:
//! `cargo run --example make_assets` writes `assets/scenes/gallery/models/` and `docs/tutorial/images/*.svg`.
//!
//! What it makes is committed, so that nobody has to run it; `tests/assets.rs` holds the committed
//! files to it byte by byte. It asks nothing of a platform's mathematics library but `sqrt`, which
//! is exact everywhere. PNG bytes are those of the `image` crate in Cargo.lock: after an update
//! that compresses otherwise, run it again.

#[path = "make_assets/drawing.rs"]
mod drawing;
#[path = "make_assets/drawings_1_2.rs"]
mod drawings_1_2;
#[path = "make_assets/drawings_3.rs"]
mod drawings_3;
#[path = "make_assets/drawings_4.rs"]
mod drawings_4;
#[path = "make_assets/drawings_5_6.rs"]
mod drawings_5_6;
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

/// Where the models are, from the top of the checkout.
pub const MODELS: &str = "assets/scenes/gallery/models";
/// Where the drawings are, among the tutorial's pictures.
pub const DRAWINGS: &str = "docs/tutorial/images";

/// The files: their paths from the top of the checkout, and their bytes.
pub fn files() -> Vec<(String, Vec<u8>)> {
    let mut files = vec![(format!("{MODELS}/room.glb"), room::glb())];
    let models = vase::files().into_iter().chain(gallery::files());
    files.extend(models.map(|(name, file)| (format!("{MODELS}/{name}"), file)));
    // A scene file can name what is below its folder, and not what is beside it.
    let vase = vase::files().into_iter().find(|(name, _)| *name == "vase.png");
    files.extend(vase.map(|(_, file)| ("assets/scenes/tutorial/vase.png".to_owned(), file)));
    let drawings = [drawings_1_2::all(), drawings_3::all(), drawings_4::all(), drawings_5_6::all()];
    for (name, drawing) in drawings.into_iter().flatten() {
        files.push((format!("{DRAWINGS}/{name}.svg"), drawing.finish()));
    }
    files
}

/// The top of the checkout.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[allow(dead_code)] // The test that includes this file has a `main` of its own.
fn main() -> std::io::Result<()> {
    for (name, bytes) in files() {
        let path = root().join(&name);
        std::fs::create_dir_all(path.parent().expect("ok: it has a folder"))?;
        std::fs::write(path, &bytes)?;
        println!("{name}: {} bytes", bytes.len());
    }
    Ok(())
}
