//! The whole command beside the least that its work can take by the bare library: reading the file's
//! bytes, building Embree's trees of numbers that lie ready, tracing the very same rays, and
//! encoding the very same PNG.
//!
//! `cargo bench --bench process -- SCENE MODEL [--rounds N]`, where MODEL is the file of which most
//! of the scene is made. Both use all threads, take turns in one run, and are timed by the clock on
//! the wall; what is printed are medians, and the median of the rounds' ratios.

#[allow(dead_code, reason = "each bench uses its own part")]
mod support {
    pub mod arguments;
    pub mod bare;
    pub mod clock;
    pub mod record;
}

use std::ffi::CStr;
use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use embree4_sys::RTCBuildQuality;
use envers::internals::IntersectorBuilder;
use envers::{Precision, RenderOptions, Renderer};
use image::ImageEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use rayon::prelude::*;
use support::arguments::Arguments;
use support::bare::{Bare, Packet, Shapes, packets};
use support::clock::median;
use support::record::{Batch, Recorder};

/// The width of the packets: native on nearly every processor whose times matter.
const WIDTH: usize = 16;

/// The parts of the bare work, in seconds.
#[derive(Clone, Copy)]
struct Parts {
    read: f64,
    build: f64,
    trace: f64,
    encode: f64,
}

impl Parts {
    fn sum(&self) -> f64 {
        self.read + self.build + self.trace + self.encode
    }
}

fn main() {
    let Some(mut arguments) = Arguments::of_bench("process -- SCENE MODEL [--rounds N]") else {
        return;
    };
    let rounds = arguments.value("--rounds").unwrap_or(15);
    let files = arguments.rest(2);
    let (scene, model) = (&files[0], &files[1]);
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.png");
    let ours = || {
        let start = Instant::now();
        let mut command = Command::new(env!("CARGO_BIN_EXE_envers"));
        let status = command.args(["render", scene, "-q", "-o"]).arg(&out).status().unwrap();
        assert!(status.success());
        start.elapsed().as_secs_f64()
    };
    ours();
    let picture = image::open(&out).unwrap().to_rgb8();
    let told = Command::new(env!("CARGO_BIN_EXE_envers"))
        .args(["render", scene, "-q", "--stats", "-", "-o"])
        .arg(&out)
        .output()
        .unwrap();
    let statistics: serde_json::Value = serde_json::from_slice(&told.stdout).unwrap();
    let quality = match statistics["build"]["bvh"].as_str() {
        Some("low") => RTCBuildQuality::LOW,
        _ => RTCBuildQuality::MEDIUM,
    };
    let bare = bare_work(Path::new(scene), Path::new(model), quality, &picture);
    let times: Vec<(f64, Parts)> = (0..rounds).map(|_| (ours(), bare())).collect();
    let ms = |of: &dyn Fn(&(f64, Parts)) -> f64| 1e3 * median(times.iter().map(of));
    println!("{scene}, {} threads, medians of {rounds} rounds", rayon::current_num_threads());
    println!("  the command {:.0} ms", ms(&|t| t.0));
    println!(
        "  bare {:.0} ms: read {:.0}, build {:.0}, trace {:.0}, encode {:.0}",
        ms(&|t| t.1.sum()),
        ms(&|t| t.1.read),
        ms(&|t| t.1.build),
        ms(&|t| t.1.trace),
        ms(&|t| t.1.encode),
    );
    println!("  ratio {:.2}", median(times.iter().map(|(ours, bare)| ours / bare.sum())));
}

/// Returns a function that does the work of a picture with the bare library; all else lies ready for it.
fn bare_work(
    scene: &Path,
    model: &Path,
    quality: RTCBuildQuality,
    picture: &image::RgbImage,
) -> impl Fn() -> Parts {
    let scene = envers::load(scene).unwrap().scene;
    let options = RenderOptions::default();
    let intersector =
        IntersectorBuilder::new(Default::default(), Precision::Fast, 0).build(&scene).unwrap();
    let recorder = Recorder::new(&*intersector);
    Renderer::new(&scene).options(options.clone()).render_with(&recorder);
    let center = scene.bounds().center();
    let rays = |batch| packets::<WIDTH>(&recorder.take(batch), center);
    let (coherent, shadow, incoherent) =
        (rays(Batch::Coherent), rays(Batch::Shadow), rays(Batch::Incoherent));
    drop(recorder);
    let shapes = Shapes::from_scene(&scene);
    let (model, picture) = (model.to_owned(), picture.clone());
    const ALL_THREADS: &CStr = c"threads=0";
    move || {
        let (_, read) = timed(|| std::fs::read(&model).unwrap());
        let (bare, build) = timed(|| shapes.build(WIDTH, ALL_THREADS, quality));
        let ((), trace) = timed(|| {
            each(&coherent, |packets| bare.closest(packets, true));
            each(&shadow, |packets| bare.occluded(packets));
            each(&incoherent, |packets| bare.closest(packets, false));
        });
        let (_, encode) = timed(|| {
            let mut bytes = Vec::new();
            PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Paeth)
                .write_image(
                    &picture,
                    picture.width(),
                    picture.height(),
                    image::ColorType::Rgb8.into(),
                )
                .unwrap();
            bytes
        });
        drop::<Bare>(bare);
        Parts { read, build, trace, encode }
    }
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = black_box(work());
    (result, start.elapsed().as_secs_f64())
}

fn each(packets: &[Packet<WIDTH>], trace: impl Fn(&[Packet<WIDTH>]) -> usize + Sync) {
    packets.par_chunks(256).for_each(|packets| {
        black_box(trace(packets));
    });
}
