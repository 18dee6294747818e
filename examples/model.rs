//! A model file as it is: loaded, framed, lit, and written as an HDR picture.
//!
//! `cargo run --release --example model -- model.glb out.exr`

use envers::internals::{Settings, write};
use envers::{Error, Loaded, Renderer, Result};
use std::path::PathBuf;

fn main() -> Result<()> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let (Some(model), Some(output)) = (arguments.next(), arguments.next()) else {
        return Err(Error::input("two files are needed").help("model MODEL OUTPUT"));
    };
    let Loaded { scene, report, .. } = envers::load(&model)?;
    report.warnings.iter().for_each(|warning| eprintln!("{warning}"));
    let rendering = Renderer::new(&scene).render()?;
    write(&rendering.film, &output, &Settings { half: true, ..Settings::from_film(&scene.film) })?;
    println!("{}: {} rays", output.display(), rendering.statistics.counts.rays.total());
    Ok(())
}
