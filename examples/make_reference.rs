//! Makes the reference scenes of benches and comparisons:
//! `cargo run --release --example make_reference -- [--triangles N] [DIR]` writes `s.toml`,
//! `m.toml` and `m.glb` into DIR (`out/reference`). `--triangles` makes another M of about so many
//! triangles; it has 1,000,000.

#[path = "reference/mod.rs"]
mod reference;

use std::error::Error;
use std::path::PathBuf;

use reference::{knot, spheres};

fn main() -> Result<(), Box<dyn Error>> {
    let (mut folder, mut triangles) = (PathBuf::from("out/reference"), knot::TRIANGLES);
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--triangles" => {
                triangles = args
                    .next()
                    .and_then(|n| n.parse().ok())
                    .filter(|n| (18..=100_000_000).contains(n))
                    .ok_or("--triangles wants a whole number from 18 to 100000000")?;
            }
            flag if flag.starts_with('-') => return Err(format!("there is no {flag}").into()),
            dir => folder = dir.into(),
        }
    }
    let mesh = knot::mesh(knot::resolution(triangles));
    std::fs::create_dir_all(&folder)?;
    let (s, m) = (spheres::toml().into_bytes(), knot::TOML.as_bytes().to_vec());
    for (name, bytes) in [("s.toml", s), ("m.toml", m), ("m.glb", knot::glb(&mesh))] {
        let path = folder.join(name);
        std::fs::write(&path, &bytes)?;
        println!("{}: {} bytes", path.display(), bytes.len());
    }
    println!("M has {} triangles", mesh.triangles.len());
    Ok(())
}
