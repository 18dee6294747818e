//! Mrays/s of the intersectors beside bare Embree, on one thread.
//!
//! `cargo bench --bench intersect` runs criterion over every case and then prints the ratios to
//! the ceiling: medians of runs taken in turn, ours and the bare loop's. `-- ratios` prints the
//! ratios only.

mod bare;
mod scenes;

use std::hint::black_box;
use std::time::Instant;

use bare::{Bare, Packet, packets};
use criterion::{Criterion, Throughput};
use envers::geometry::{Hit, Ray};
use envers::intersect::{Bvh, Coherence, Embree, Intersector, Precision};
use envers::scene::{Arrival, Scene};
use envers::surface::Surface;
use glam::{DVec3, Vec3};

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
        let light = DVec3::new(3.0, 5.0, 4.0);
        let mut shadow: Vec<Ray> = primary
            .iter()
            .zip(&hits)
            .filter_map(|(ray, hit)| {
                let surface = Surface::new(&scene, ray, hit.as_ref()?);
                let toward = light - surface.position;
                let lit = surface.normal.dot(toward) > 0.0;
                let arrival = Arrival { toward, bounded: true, intensity: Vec3::ONE };
                lit.then(|| surface.shadow_ray(&arrival))
            })
            .collect();
        shadow.truncate(shadow.len() / 16 * 16);
        println!("{name}: {} primary rays, {} shadow rays", primary.len(), shadow.len());
        Self { name, scene, primary, shadow }
    }
}

/// How the renderer calls an intersector: a tile at a time.
const TILE: usize = 1024;

fn closest(intersector: &dyn Intersector, rays: &[Ray], hits: &mut [Option<Hit>]) {
    for (rays, hits) in rays.chunks(TILE).zip(hits.chunks_mut(TILE)) {
        intersector.closest(rays, Coherence::Coherent, hits);
    }
}

fn occluded(intersector: &dyn Intersector, rays: &[Ray], blocked: &mut [bool]) {
    for (rays, blocked) in rays.chunks(TILE).zip(blocked.chunks_mut(TILE)) {
        intersector.occluded(rays, Coherence::Coherent, blocked);
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
        let mut hits = vec![None; case.primary.len()];
        group.bench_function(name, |b| b.iter(|| closest(intersector, &case.primary, &mut hits)));
        group.finish();
        let mut group = c.benchmark_group(format!("{} shadow", case.name));
        group.throughput(Throughput::Elements(case.shadow.len() as u64));
        let mut blocked = vec![false; case.shadow.len()];
        group.bench_function(name, |b| {
            b.iter(|| occluded(intersector, &case.shadow, &mut blocked));
        });
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
    group.bench_function(&name, |b| b.iter(|| black_box(bare.closest(&primary))));
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
    let mut hits = vec![None; case.primary.len()];
    let mut blocked = vec![false; case.shadow.len()];
    report(
        &format!("{} primary", case.name),
        W,
        case.primary.len(),
        || closest(&embree, &case.primary, &mut hits),
        || _ = black_box(bare.closest(&primary)),
    );
    report(
        &format!("{} shadow", case.name),
        W,
        case.shadow.len(),
        || occluded(&embree, &case.shadow, &mut blocked),
        || _ = black_box(bare.occluded(&shadow)),
    );
    let found = hits.iter().flatten().count();
    let blocked = blocked.iter().filter(|&&b| b).count();
    println!(
        "  hits: ours {found}, bare {}; blocked: ours {blocked}, bare {}",
        bare.closest(&primary),
        bare.occluded(&shadow)
    );
}

fn report(name: &str, width: usize, rays: usize, mut ours: impl FnMut(), mut bare: impl FnMut()) {
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
        "{name:<12} envers {:7.2} Mrays/s, bare {width:>2} {:7.2} Mrays/s, ratio {ratio:.2}",
        rate(a),
        rate(b)
    );
}

fn main() {
    let cases = [Case::new("M", scenes::knot(2000, 250)), Case::new("S", scenes::spheres())];
    let ratios_only = std::env::args().any(|a| a == "ratios");
    // `cargo test --benches` runs this too: it must not take long, and measures nothing.
    if std::env::args().any(|a| a == "--test") {
        return;
    }
    if !ratios_only {
        let mut c = Criterion::default().sample_size(20).configure_from_args();
        cases.iter().for_each(|case| criterion(&mut c, case));
        c.final_summary();
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
