//! The committed models and drawings are what `xtask` makes, and the scenes that use them
//! load without a warning.

use envers::{LightKind, Loaded, load};
use std::path::Path;

use xtask::assets;

/// The largest file that is committed, in bytes.
const LIMIT: usize = 500_000;

/// Byte by byte on every platform: the generator asks its mathematics library for nothing but
/// square roots.
#[test]
fn committed_models_and_drawings_are_those_of_the_generator() {
    for (name, bytes) in assets::files() {
        assert!(bytes.len() < LIMIT, "{name} is {} bytes long", bytes.len());
        let committed = std::fs::read(assets::root().join(&name)).unwrap_or_default();
        assert!(
            committed == bytes,
            "{name} is not what the generator makes; run `cargo run -p xtask -- make-assets`, and \
             look at the scenes or chapters that use it"
        );
    }
}

/// Holds a folder's files with one of the endings to the generator.
fn made(folder: &str, endings: &[&str]) {
    let made: Vec<_> = assets::files().into_iter().map(|(name, _)| name).collect();
    for entry in std::fs::read_dir(assets::root().join(folder)).expect(folder) {
        let name = entry.expect("the folder can be read").file_name().display().to_string();
        if endings.iter().any(|ending| name.ends_with(ending)) {
            assert!(made.contains(&format!("{folder}/{name}")), "{name}");
        }
    }
}

#[test]
fn no_model_is_committed_that_the_generator_does_not_make() {
    made(assets::MODELS, &[""]);
}

#[test]
fn no_drawing_is_committed_that_the_generator_does_not_make() {
    made(assets::DRAWINGS, &[".svg"]);
}

#[test]
fn demo_scenes_and_models_load_without_a_warning() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    for name in [
        "scenes/room.toml",
        "scenes/vase.toml",
        "scenes/gallery/models/room.glb",
        "scenes/gallery/models/vase.obj",
    ] {
        let Loaded { report, .. } = load(&assets.join(name)).expect(name);
        assert_eq!(report.warnings, [""; 0], "{name}");
    }
}

/// The room has all that it is there to show: instances of one mesh, textures, lights and a camera of its own.
#[test]
fn room_uses_what_gltf_offers() {
    let scene = load(&assets::root().join("assets/scenes/gallery/models/room.glb"))
        .expect("the room loads")
        .scene;
    assert!(scene.instances.len() > 2 * scene.meshes.len(), "columns and bays are instanced");
    let own = scene.lights.iter().filter(|light| light.kind != LightKind::Ambient).count();
    assert_eq!((own, scene.textures.len()), (2, 3));
    assert_eq!(scene.cameras[0].name, "view");
}

/// The vase has all that it is there to show: two materials, one with a texture, on smooth polygons.
#[test]
fn vase_uses_what_obj_offers() {
    let scene = load(&assets::root().join("assets/scenes/gallery/models/vase.obj"))
        .expect("the vase loads")
        .scene;
    assert_eq!((scene.materials.len(), scene.textures.len()), (2, 1));
}
