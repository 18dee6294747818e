//! Whole frames beside the bare library: rays per second over the render phase, shading included,
//! against bare Embree calls for the very same rays, at whichever width they trace best.
//!
//! `cargo bench --bench frame -- SCENE... [--size WxH] [--threads N] [--rounds N]`. Each round
//! times our frame and the bare calls in turn; what is printed are medians, and the median of the
//! ratio. On one thread time is the thread's own, so that a busy machine matters less.

mod support {
    pub mod arguments;
    pub mod bare;
    pub mod clock;
    pub mod record;
}

use std::hint::black_box;

use envers::internals::{IntersectorBuilder, Tiling, Traced};
use envers::{LoadOptions, Precision, Ray, RenderOptions, Renderer, Scene};
use rayon::prelude::*;
use support::arguments::Arguments;
use support::bare::{Bare, Packet, packets};
use support::clock::{median, time};
use support::record::{Batch, Recorder};

struct Settings {
    scenes: Vec<String>,
    size: Option<[u32; 2]>,
    threads: usize,
    rounds: usize,
    tiling: Tiling,
    /// Only our frames, for a profiler.
    ours: Option<Precision>,
}

impl Settings {
    fn options(&self) -> RenderOptions {
        RenderOptions { tiling: self.tiling, ..RenderOptions::default() }
    }
}

/// Returns the settings of the command line; nothing unless `cargo bench` runs this.
fn settings() -> Option<Settings> {
    let usage = "frame -- SCENE... [--size WxH] [--threads N] [--rounds N]";
    let mut arguments = Arguments::of_bench(usage)?;
    let mut tiling = Tiling::default();
    if let Some([rows, columns]) = arguments.pair("--tile") {
        tiling = Tiling { rows, columns, ..tiling };
    }
    let fast = arguments.flag("--ours").then_some(Precision::Fast);
    let certified = arguments.flag("--ours-certified").then_some(Precision::Certified);
    Some(Settings {
        size: arguments.pair("--size"),
        threads: arguments.value("--threads").unwrap_or(1),
        rounds: arguments.value("--rounds").unwrap_or(15),
        tiling,
        ours: certified.or(fast),
        scenes: arguments.rest(1),
    })
}

/// The rays of one kind, in packets of every width.
struct Kind {
    name: &'static str,
    count: usize,
    best: usize,
    coherent: bool,
    shadow: bool,
    by_16: Vec<Packet<16>>,
    by_8: Vec<Packet<8>>,
    by_4: Vec<Packet<4>>,
    by_1: Vec<Packet<1>>,
}

impl Kind {
    fn new(name: &'static str, rays: &[Ray], coherent: bool, shadow: bool, scene: &Scene) -> Self {
        let center = scene.bounds().center();
        Self {
            name,
            count: rays.len(),
            best: 16,
            coherent,
            shadow,
            by_16: packets(rays, center),
            by_8: packets(rays, center),
            by_4: packets(rays, center),
            by_1: packets(rays, center),
        }
    }

    fn trace(&self, bare: &Bare, width: usize) {
        match width {
            16 => self.run(bare, &self.by_16),
            8 => self.run(bare, &self.by_8),
            4 => self.run(bare, &self.by_4),
            _ => self.run(bare, &self.by_1),
        }
    }

    fn run<const W: usize>(&self, bare: &Bare, packets: &[Packet<W>]) {
        packets.par_chunks(4096 / W).for_each(|packets| {
            black_box(match self.shadow {
                true => bare.occluded(packets),
                false => bare.closest(packets, self.coherent),
            });
        });
    }
}

fn main() {
    let Some(settings) = settings() else { return };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads).build().unwrap();
    for name in &settings.scenes {
        let mut options = LoadOptions::default();
        options.size = settings.size;
        let mut scene = options.load(name).unwrap().scene;
        if let Some(size) = settings.size {
            scene.film.size = size;
        }
        pool.install(|| measure(name, &scene, &settings));
    }
}

fn measure(name: &str, scene: &Scene, settings: &Settings) {
    let build = |precision| {
        IntersectorBuilder::new(Default::default(), precision, settings.threads)
            .build(scene)
            .unwrap()
    };
    if let Some(precision) = settings.ours {
        let (fast, options) = (build(precision), settings.options());
        for _ in 0..settings.rounds {
            black_box(Renderer::new(scene).options(options.clone()).render_with(&*fast));
        }
        return;
    }
    let (fast, certified) = (build(Precision::Fast), build(Precision::Certified));
    let options = settings.options();
    let recorder = Recorder::new(&*fast);
    let Traced { counts, .. } =
        Renderer::new(scene).options(options.clone()).render_with(&recorder);
    let [width, height] = scene.film.size;
    println!("{name} {width}x{height}, {} threads: {:?}", settings.threads, counts.rays);

    let kind = |name, batch, coherent, shadow| {
        Kind::new(name, &recorder.take(batch), coherent, shadow, scene)
    };
    let mut kinds = [
        kind("coherent", Batch::Coherent, true, false),
        kind("shadow", Batch::Shadow, true, true),
        kind("after a bounce", Batch::Incoherent, false, false),
    ];
    let bare: Vec<(usize, Bare)> = [16, 8, 4, 1].map(|w| (w, Bare::build(scene, w))).into();
    let of = |width: usize| &bare.iter().find(|(w, _)| *w == width).expect("one of four").1;
    for kind in &mut kinds {
        let at = |(width, bare): &(usize, Bare)| {
            let runs = (0..5).map(|_| time(settings.threads, || kind.trace(bare, *width)));
            (*width, median(runs))
        };
        let all: Vec<_> = bare.iter().filter(|(w, b)| b.has(*w)).map(at).collect();
        let best = all.iter().min_by(|a, b| a.1.total_cmp(&b.1)).expect("width 1 is always there");
        let rate = |seconds: f64| kind.count as f64 / seconds * 1e-6;
        let rates: Vec<_> =
            all.iter().map(|(w, seconds)| format!("{w}: {:.1}", rate(*seconds))).collect();
        println!(
            "  bare {} ({} rays), Mrays/s by width: {}",
            kind.name,
            kind.count,
            rates.join(", ")
        );
        kind.best = best.0;
    }

    let frame = |intersector: &dyn envers::Intersector| {
        time(settings.threads, || {
            black_box(Renderer::new(scene).options(options.clone()).render_with(intersector));
        })
    };
    let (mut ours, mut theirs, mut exact) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..settings.rounds {
        ours.push(frame(&*fast));
        theirs.push(time(settings.threads, || {
            kinds.iter().for_each(|kind| kind.trace(of(kind.best), kind.best));
        }));
        exact.push(frame(&*certified));
    }
    let ratio = |a: &[f64], b: &[f64]| median(a.iter().zip(b).map(|(a, b)| a / b));
    let rays = counts.rays.total() as f64;
    println!(
        "  fast {:.1} ms ({:.1} Mrays/s), bare {:.1} ms ({:.1} Mrays/s): {:.2} of bare",
        1e3 * median(ours.iter().copied()),
        1e-6 * rays / median(ours.iter().copied()),
        1e3 * median(theirs.iter().copied()),
        1e-6 * rays / median(theirs.iter().copied()),
        ratio(&theirs, &ours),
    );
    println!(
        "  certified {:.1} ms: {:.2} times fast",
        1e3 * median(exact.iter().copied()),
        ratio(&exact, &ours)
    );
}
