//! The models of the demo scenes and the gallery, in `assets/scenes/gallery/models/`, and the drawings
//! of the tutorial, `docs/tutorial/images/*.svg`: `cargo run -p xtask -- make-assets` writes them.
//!
//! These files are committed, so that nobody has to run it; a test of envers (`tests/docs/assets.rs`)
//! holds them to it byte by byte. It asks nothing of a platform's mathematics library but `sqrt`,
//! which is exact everywhere. PNG bytes are those of the `image` crate in Cargo.lock: after an update
//! that compresses otherwise, run it again.

mod drawing;
mod drawings_1_2;
mod drawings_3;
mod drawings_4;
mod drawings_5_6;
mod gallery;
mod paint;
mod room;
mod vase;

use std::path::Path;

/// The folder of the models, from the top of the checkout.
pub const MODELS: &str = "assets/scenes/gallery/models";
/// The folder of the drawings, among the tutorial's pictures.
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
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("ok: it is a folder of the checkout")
}
