//! The command line of the generators, to be run from the top of the checkout:
//!
//! - `cargo run -p xtask -- make-assets` writes the committed models and drawings.
//! - `cargo run --release -p xtask -- make-reference [--triangles N] [DIR]` writes `s.toml`,
//!   `m.toml` and `m.glb` into DIR (`out/reference`). `--triangles` makes another M of about N
//!   triangles; it has 1,000,000.

use std::error::Error;
use std::path::{Path, PathBuf};

use xtask::assets;
use xtask::reference::{knot, spheres};

const USAGE: &str =
    "usage: cargo run -p xtask -- make-assets | make-reference [--triangles N] [DIR]";

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    match arguments.next().as_deref() {
        Some("make-assets") if arguments.next().is_none() => make_assets(),
        Some("make-reference") => make_reference(arguments),
        _ => Err(USAGE.into()),
    }
}

fn make_assets() -> Result<(), Box<dyn Error>> {
    for (name, bytes) in assets::files() {
        write(&assets::root().join(&name), &bytes)?;
    }
    Ok(())
}

fn make_reference(mut arguments: impl Iterator<Item = String>) -> Result<(), Box<dyn Error>> {
    let (mut folder, mut triangles) = (PathBuf::from("out/reference"), knot::TRIANGLES);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--triangles" => {
                triangles = arguments
                    .next()
                    .and_then(|n| n.parse().ok())
                    .filter(|n| (18..=100_000_000).contains(n))
                    .ok_or("--triangles wants a whole number from 18 to 100000000")?;
            }
            flag if flag.starts_with('-') => return Err(format!("there is no {flag}").into()),
            path => folder = path.into(),
        }
    }
    let mesh = knot::mesh(knot::resolution(triangles));
    write(&folder.join("s.toml"), spheres::toml().as_bytes())?;
    write(&folder.join("m.toml"), knot::TOML.as_bytes())?;
    write(&folder.join("m.glb"), &knot::glb(&mesh))?;
    println!("M has {} triangles", mesh.triangles.len());
    Ok(())
}

/// Writes a file into a folder that need not exist yet.
fn write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    std::fs::create_dir_all(path.parent().expect("ok: it has a folder"))?;
    std::fs::write(path, bytes)?;
    println!("{}: {} bytes", path.display(), bytes.len());
    Ok(())
}
