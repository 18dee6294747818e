//! Mrays/s of the intersectors beside bare Embree, on one thread.
//!
//! `cargo bench --bench intersect` runs criterion over every case and then prints the ratios to
//! the ceiling: medians of runs taken in turn, ours and the bare loop's. `-- ratios` prints the
//! ratios only, `-- certified` what precision `certified` costs beside `fast`, rays and frames.

#[allow(dead_code, reason = "each bench uses its own part")]
mod support {
    pub mod arguments;
    pub mod bare;
    pub mod batches;
    pub mod scenes;
}

use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, Throughput};
use envers::internals::{IncidentLight, Traced};
use envers::{
    Bvh, Coherence, Embree, Intersector, Precision, Ray, RenderOptions, Renderer, Scene, Surface,
};
use glam::Vec3;
use support::arguments::Arguments;
use support::bare::{Bare, Packet, packets};
use support::batches::Batches;
use support::scenes;

struct Case {
    name: &'static str,
    scene: Scene,
    primary: Vec<Ray>,
    shadow: Vec<Ray>,
}

impl Case {
    fn new(name: &'static str, scene: Scene) -> Self {
        let primary = scenes::primary(&scene);
        let mut hits = vec![None; primary.len()];
        Bvh::build(&scene, Precision::Fast).closest(&primary, Coherence::Coherent, &mut hits);
        let mut shadow: Vec<Ray> = primary
            .iter()
            .zip(&hits)
            .filter_map(|(ray, hit)| {
                let surface = Surface::new(&scene, ray, hit.as_ref()?);
                let toward = scenes::LIGHT - surface.position;
                let lit = surface.normal.dot(toward) > 0.0;
                let arrival = IncidentLight { toward, is_bounded: true, intensity: Vec3::ONE };
                lit.then(|| surface.shadow_ray(ray.direction, &arrival))
            })
            .collect();
        shadow.truncate(shadow.len() / 16 * 16);
        println!("{name}: {} primary rays, {} shadow rays", primary.len(), shadow.len());
        Self { name, scene, primary, shadow }
    }
}

fn criterion(c: &mut Criterion, case: &Case) {
    let (embree, bvh) = (
        Embree::build(&case.scene, Precision::Fast, 1).unwrap(),
        Bvh::build(&case.scene, Precision::Fast),
    );
    let single = Embree::build_single(&case.scene, Precision::Fast, 1).unwrap();
    let intersectors: [(&str, &dyn Intersector); 3] =
        [("embree packets", &embree), ("embree single", &single), ("bvh", &bvh)];
    for (name, intersector) in intersectors {
        let mut group = c.benchmark_group(format!("{} primary", case.name));
        group.throughput(Throughput::Elements(case.primary.len() as u64));
        let mut rays = Batches::new(&case.primary);
        group.bench_function(name, |b| {
            b.iter(|| black_box(rays.closest(intersector, Coherence::Coherent)));
        });
        group.finish();
        let mut group = c.benchmark_group(format!("{} shadow", case.name));
        group.throughput(Throughput::Elements(case.shadow.len() as u64));
        let mut rays = Batches::new(&case.shadow);
        group.bench_function(name, |b| b.iter(|| black_box(rays.occluded(intersector))));
        group.finish();
    }
    bare_criterion::<16>(c, case);
    bare_criterion::<8>(c, case);
    bare_criterion::<4>(c, case);
    bare_criterion::<1>(c, case);
}

fn bare_criterion<const W: usize>(c: &mut Criterion, case: &Case) {
    let bare = Bare::build(&case.scene, W);
    if !bare.has(W) {
        return;
    }
    let center = case.scene.bounds().center();
    let name = format!("bare {W}");
    let (primary, shadow) =
        (packets::<W>(&case.primary, center), packets::<W>(&case.shadow, center));
    let mut group = c.benchmark_group(format!("{} primary", case.name));
    group.throughput(Throughput::Elements(case.primary.len() as u64));
    group.bench_function(&name, |b| b.iter(|| black_box(bare.closest(&primary, true))));
    group.finish();
    let mut group = c.benchmark_group(format!("{} shadow", case.name));
    group.throughput(Throughput::Elements(case.shadow.len() as u64));
    group.bench_function(&name, |b| b.iter(|| black_box(bare.occluded(&shadow))));
    group.finish();
}

/// Ours and the bare loop of the same width in turn; the medians and their ratio.
fn ratios<const W: usize>(case: &Case) {
    let bare = Bare::build(&case.scene, W);
    let embree = Embree::build(&case.scene, Precision::Fast, 1).unwrap();
    let center = case.scene.bounds().center();
    let primary: Vec<Packet<W>> = packets(&case.primary, center);
    let shadow: Vec<Packet<W>> = packets(&case.shadow, center);
    let (mut seen, mut lit) = (Batches::new(&case.primary), Batches::new(&case.shadow));
    report(
        &format!("{} primary", case.name),
        W,
        case.primary.len(),
        || _ = black_box(seen.closest(&embree, Coherence::Coherent)),
        || _ = black_box(bare.closest(&primary, true)),
    );
    report(
        &format!("{} shadow", case.name),
        W,
        case.shadow.len(),
        || _ = black_box(lit.occluded(&embree)),
        || _ = black_box(bare.occluded(&shadow)),
    );
    let (found, blocked) = (seen.closest(&embree, Coherence::Coherent), lit.occluded(&embree));
    println!(
        "  hits: ours {found}, bare {}; blocked: ours {blocked}, bare {}",
        bare.closest(&primary, true),
        bare.occluded(&shadow)
    );
}

/// Measures the cost of `certified`: its rays and whole frames beside those of `fast`, in turn.
fn price(case: &Case) {
    let build = |precision| Embree::build(&case.scene, precision, 1).unwrap();
    let single = |precision| Embree::build_single(&case.scene, precision, 1).unwrap();
    let (fast, certified) = (build(Precision::Fast), build(Precision::Certified));
    let singles = (single(Precision::Fast), single(Precision::Certified));
    let mut seen = [Batches::new(&case.primary), Batches::new(&case.primary)];
    let mut lit = [Batches::new(&case.shadow), Batches::new(&case.shadow)];
    for (kind, fast, certified) in
        [("packets", &fast, &certified), ("single", &singles.0, &singles.1)]
    {
        let [a, b] = &mut seen;
        beside(
            &format!("{} primary, {kind}", case.name),
            ["certified", "fast"],
            case.primary.len(),
            || _ = black_box(a.closest(certified, Coherence::Coherent)),
            || _ = black_box(b.closest(fast, Coherence::Coherent)),
        );
        let [a, b] = &mut lit;
        beside(
            &format!("{} shadow, {kind}", case.name),
            ["certified", "fast"],
            case.shadow.len(),
            || _ = black_box(a.occluded(certified)),
            || _ = black_box(b.occluded(fast)),
        );
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let options = RenderOptions::default();
    let frame = |intersector: &Embree<'_>| {
        pool.install(|| {
            black_box(Renderer::new(&case.scene).options(options.clone()).render_with(intersector));
        });
    };
    let Traced { counts, .. } =
        pool.install(|| Renderer::new(&case.scene).options(options.clone()).render_with(&fast));
    beside(
        &format!("{} frame", case.name),
        ["certified", "fast"],
        counts.rays.total() as usize,
        || frame(&certified),
        || frame(&fast),
    );
}

fn report(name: &str, width: usize, rays: usize, ours: impl FnMut(), bare: impl FnMut()) {
    beside(name, ["envers", &format!("bare {width:>2}")], rays, ours, bare);
}

/// Times two in turn; prints the medians of their rates, and the median of their ratio.
fn beside(
    name: &str,
    [first, second]: [&str; 2],
    rays: usize,
    mut ours: impl FnMut(),
    mut bare: impl FnMut(),
) {
    let time = |work: &mut dyn FnMut()| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    let (mut a, mut b) = (Vec::new(), Vec::new());
    for round in 0..41 {
        let (x, y) = (time(&mut ours), time(&mut bare));
        // The first rounds warm the caches up.
        if round >= 4 {
            a.push(x);
            b.push(y);
        }
    }
    let mut each: Vec<f64> = a.iter().zip(&b).map(|(ours, bare)| bare / ours).collect();
    for list in [&mut a, &mut b, &mut each] {
        list.sort_by(f64::total_cmp);
    }
    let (a, b, ratio) = (a[a.len() / 2], b[b.len() / 2], each[each.len() / 2]);
    let rate = |seconds: f64| rays as f64 / seconds * 1e-6;
    println!(
        "{name:<20} {first} {:7.2} Mrays/s, {second} {:7.2} Mrays/s, ratio {ratio:.2} (1/{:.2})",
        rate(a),
        rate(b),
        1.0 / ratio
    );
}

fn main() {
    let Some(mut arguments) = Arguments::of_bench("intersect [-- ratios | certified]") else {
        return;
    };
    let (only_ratios, only_price) = (arguments.flag("ratios"), arguments.flag("certified"));
    let cases = [Case::new("M", scenes::knot([2000, 250])), Case::new("S", scenes::spheres())];
    if !(only_ratios || only_price) {
        let mut c = Criterion::default().sample_size(20).configure_from_args();
        cases.iter().for_each(|case| criterion(&mut c, case));
        c.final_summary();
    }
    if only_price {
        println!("what certified costs, one thread, medians of 37 in turn");
        cases.iter().for_each(price);
        return;
    }
    println!("ratio to the bare loop of the native width, one thread, medians of 37 in turn");
    for case in &cases {
        let bare = Bare::build(&case.scene, 1);
        match [16, 8, 4].into_iter().find(|&w| bare.has(w)) {
            Some(16) => ratios::<16>(case),
            Some(8) => ratios::<8>(case),
            Some(4) => ratios::<4>(case),
            _ => ratios::<1>(case),
        }
    }
}
