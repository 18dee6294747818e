//! Every demo scene, through both intersectors: no hit that nothing explains.

use std::path::Path;

use envers::measure::validate;
use envers::{LoadOptions, Precision};

fn passes(name: &str, size: [u32; 2]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes").join(name);
    let mut scene = LoadOptions::default().size(size).load(&path).unwrap().scene;
    scene.film.spp = 1;
    for precision in [Precision::Fast, Precision::Certified] {
        let found = validate(&scene, precision, 0, 0).unwrap();
        assert!(found.passed && found.unexplained_mismatches == 0, "{found}");
        assert!(found.rays_compared > found.pixels, "no shadow ray was compared: {found}");
    }
}

#[test]
fn room_passes() {
    passes("room.toml", [640, 360]);
}

#[test]
fn vase_passes() {
    passes("vase.toml", [640, 360]);
}

#[test]
fn lambert_passes() {
    passes("tutorial/3-2-lambert.toml", [1000, 500]);
}

#[test]
fn phong_passes() {
    passes("tutorial/3-3-phong.toml", [1000, 500]);
}
