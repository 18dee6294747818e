//! The cost of certainty: ns per ray of the certified intersections beside the plain f64 ones.
//!
//! `cargo bench --bench precision` runs criterion over every kernel and then prints the ratios:
//! medians of runs taken in turn. `-- ratios` prints the ratios only. Packet kernels take 16 rays
//! and one primitive, as a packet tracer's callback does, for the instruction sets that the
//! processor has; scalar kernels take one ray.

// To call what is compiled for an instruction set.
#![allow(unsafe_code)]

#[allow(dead_code, reason = "each bench uses its own part")]
mod support {
    pub mod arguments;
}

use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, Throughput};
use envers::internals::sphere::certified as sure_sphere;
use envers::internals::triangle::certified as sure_triangle;
use envers::internals::{sphere, triangle};
use glam::DVec3;
use support::arguments::Arguments;

/// Origin, direction and 1 / |direction|².
type Line = (DVec3, DVec3, f64);

struct Sphere {
    center: DVec3,
    radius: f64,
}

type Triangle = [DVec3; 3];

// The kernels: what one lane computes, and whether any lane needs more. Results are folded into
// one number, so that none is dropped; what is not certain is NaN.

#[inline(always)]
fn plain_line(s: &Sphere, (o, d, inverse): Line) -> sphere::Quadratic {
    sphere::Quadratic::new(s.center, s.radius, o, d, inverse)
}

#[inline(always)]
fn sure_line(s: &Sphere, (o, d, inverse): Line) -> sure_sphere::QuadraticBound {
    sure_sphere::QuadraticBound::new(s.center, s.radius, o, d, inverse)
}

/// Any: whether a root must be computed.
#[inline(always)]
fn sphere_crosses(s: &Sphere, line: Line, any: &mut bool) -> bool {
    let crosses = plain_line(s, line).crosses();
    *any |= crosses;
    crosses
}

/// Any: whether a root must be computed.
#[inline(always)]
fn sphere_may_cross(s: &Sphere, line: Line, any: &mut bool) -> bool {
    let may = sure_line(s, line).may_cross();
    *any |= may;
    may
}

/// Any: whether integers must decide.
#[inline(always)]
fn sphere_decision(s: &Sphere, line: Line, any: &mut bool) -> bool {
    let line = sure_line(s, line);
    *any |= line.may_cross() & !line.certainly_crosses();
    line.may_cross()
}

#[inline(always)]
fn sphere_plain(s: &Sphere, line: Line, _: &mut bool) -> f64 {
    let line = plain_line(s, line);
    let (near, far) = line.roots();
    let t = if near > 0.0 { near } else { far };
    if line.crosses() & (t > 0.0) { t } else { f64::INFINITY }
}

#[inline(always)]
fn sphere_estimate(s: &Sphere, line: Line, _: &mut bool) -> f64 {
    sure_line(s, line).estimate().lower()
}

#[inline(always)]
fn sphere_round(s: &Sphere, (o, d, _): Line, _: &mut bool) -> f64 {
    let rounded = sure_sphere::round(s.center, s.radius, o, d, false);
    if rounded.is_certain { rounded.t } else { f64::NAN }
}

#[inline(always)]
fn sphere_first_root(s: &Sphere, (o, d, _): Line, _: &mut bool) -> f64 {
    sure_sphere::first_root(s.center, s.radius, o, d, f64::INFINITY, false).unwrap_or(f64::INFINITY)
}

#[inline(always)]
fn triangle_crosses(triangle: &Triangle, (o, d, _): Line, any: &mut bool) -> bool {
    let crosses = triangle::EdgeFunctions::new(*triangle, o, d).crosses();
    *any |= crosses;
    crosses
}

#[inline(always)]
fn triangle_may_cross(triangle: &Triangle, (o, d, _): Line, any: &mut bool) -> bool {
    let may = sure_triangle::EdgeBounds::new(*triangle, o, d).may_cross();
    *any |= may;
    may
}

#[inline(always)]
fn triangle_plain(triangle: &Triangle, (o, d, _): Line, _: &mut bool) -> f64 {
    let edges = triangle::EdgeFunctions::new(*triangle, o, d);
    let (u, v) = edges.weights();
    if edges.crosses() { edges.t + u + v } else { f64::INFINITY }
}

#[inline(always)]
fn triangle_estimate(triangle: &Triangle, (o, d, _): Line, _: &mut bool) -> f64 {
    sure_triangle::estimate(*triangle, o, d).lower()
}

#[inline(always)]
fn triangle_round(triangle: &Triangle, (o, d, _): Line, _: &mut bool) -> f64 {
    let rounded = sure_triangle::round(*triangle, o, d);
    if rounded.is_certain { rounded.t + rounded.u + rounded.v } else { f64::NAN }
}

#[inline(always)]
fn triangle_crossing(triangle: &Triangle, (o, d, _): Line, _: &mut bool) -> f64 {
    sure_triangle::crossing(*triangle, o, d, f64::INFINITY)
        .map_or(f64::INFINITY, |hit| hit.t + hit.u + hit.v)
}

/// Sixteen rays side by side.
#[repr(C, align(64))]
struct Packet {
    origin: [[f64; 16]; 3],
    direction: [[f64; 16]; 3],
    inverse: [f64; 16],
    /// The same, one after the other.
    lines: [Line; 16],
}

impl Packet {
    fn new(lines: &[Line]) -> Self {
        let field = |of: &dyn Fn(&Line) -> f64| std::array::from_fn(|i| of(&lines[i]));
        Self {
            origin: [0, 1, 2].map(|axis| field(&|l| l.0[axis])),
            direction: [0, 1, 2].map(|axis| field(&|l| l.1[axis])),
            inverse: field(&|l| l.2),
            lines: std::array::from_fn(|i| lines[i]),
        }
    }

    #[inline(always)]
    fn line(&self, i: usize) -> Line {
        let at = |v: &[[f64; 16]; 3]| DVec3::new(v[0][i], v[1][i], v[2][i]);
        (at(&self.origin), at(&self.direction), self.inverse[i])
    }
}

/// Runs a kernel over all packets, by a function that is called once per packet.
type Run<P, T> = fn(&[Packet], &P, &mut [T; 16]);

/// A function that runs a kernel on packets of primitives `$p`, compiled for an instruction set.
macro_rules! run {
    ($kernel:ident, $p:ty, $t:ty $(, $features:literal)?) => {{
        #[inline(never)]
        $(#[target_feature(enable = $features)])?
        fn one(packet: &Packet, primitive: &$p, out: &mut [$t; 16]) -> bool {
            let mut any = false;
            for i in 0..16 {
                out[i] = $kernel(primitive, packet.line(i), &mut any);
            }
            any
        }
        |packets: &[Packet], primitive: &$p, out: &mut [$t; 16]| {
            for packet in packets {
                // SAFETY: `kernel` asked the processor for the features.
                #[allow(unused_unsafe)]
                unsafe {
                    black_box(one(packet, primitive, out));
                }
            }
        }
    }};
}

/// A kernel for the instruction sets that the processor has, and for single rays.
macro_rules! kernel {
    ($kernel:ident, $p:ty, $t:ty) => {{
        let mut sets: Vec<(&str, Run<$p, $t>)> = vec![("baseline", run!($kernel, $p, $t))];
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            sets.push(("avx2", run!($kernel, $p, $t, "avx2,fma")));
        }
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx512dq") && is_x86_feature_detected!("avx512vl") {
            sets.push(("avx512", run!($kernel, $p, $t, "avx512f,avx512vl,avx512dq")));
        }
        sets.push(("scalar", |packets, primitive, out| {
            #[inline(never)]
            fn one(primitive: &$p, line: &Line) -> ($t, bool) {
                let mut any = false;
                ($kernel(primitive, *line, &mut any), any)
            }
            for packet in packets {
                for i in 0..16 {
                    let (result, any) = black_box(one(primitive, &packet.lines[i]));
                    out[i] = result;
                    black_box(any);
                }
            }
        }));
        sets
    }};
}

/// A generator of numbers in \[0, 1) that is the same every time (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ z >> 31) as f64 / 2f64.powi(64)
    }

    fn signed(&mut self) -> f64 {
        2.0 * self.next() - 1.0
    }
}

/// The number of rays of a run: 28 KiB of packets, which stay in the first cache.
const RAYS: usize = 512;

/// Rays from near the origin toward a square of half-side `spread` at z = 10.
fn toward_square(spread: f64) -> Vec<Packet> {
    let mut random = Random(7);
    packets(|| {
        let origin = DVec3::new(random.signed(), random.signed(), random.signed()) * 0.01;
        let aim = DVec3::new(random.signed() * spread, random.signed() * spread, 10.0);
        (origin, aim - origin)
    })
}

/// Rays from grid points that touch [`TANGENT`] and cross an edge of [`GRID`]: discriminants and
/// edge functions that are exactly 0.
fn along_edges() -> Vec<Packet> {
    let mut random = Random(7);
    packets(|| {
        let z = 1.0 + (random.next() * 6400.0).floor() / 100.0;
        (DVec3::Z * z, DVec3::NEG_Z)
    })
}

fn packets(mut ray: impl FnMut() -> (DVec3, DVec3)) -> Vec<Packet> {
    let line = |(o, d)| (o, d, sphere::inverse_length_squared(d));
    let lines: Vec<Line> = (0..RAYS).map(|_| line(ray())).collect();
    lines.chunks(16).map(Packet::new).collect()
}

/// The repetitions in a timed run: it takes some 100 µs at least.
const REPEAT: usize = 40;

/// Two kernels in turn; medians and the median ratio.
fn compare<P, A: Default + Copy, B: Default + Copy>(
    name: &str,
    packets: &[Packet],
    primitive: &P,
    plain: &[(&str, Run<P, A>)],
    certified: &[(&str, Run<P, B>)],
) {
    let time = |work: &mut dyn FnMut()| {
        let start = Instant::now();
        for _ in 0..REPEAT {
            work();
        }
        start.elapsed().as_secs_f64() * 1e9 / (REPEAT * RAYS) as f64
    };
    for ((set, plain), (_, certified)) in plain.iter().zip(certified) {
        let (mut a, mut b) = ([A::default(); 16], [B::default(); 16]);
        let (mut x, mut y, mut ratio) = (Vec::new(), Vec::new(), Vec::new());
        for round in 0..205 {
            let p =
                time(&mut || plain(black_box(packets), black_box(primitive), black_box(&mut a)));
            let c = time(&mut || {
                certified(black_box(packets), black_box(primitive), black_box(&mut b))
            });
            // The first rounds warm the caches up.
            if round >= 4 {
                x.push(p);
                y.push(c);
                ratio.push(c / p);
            }
        }
        let [p, c, r] = [x, y, ratio].map(|mut list| {
            list.sort_by(f64::total_cmp);
            list[list.len() / 2]
        });
        println!("{name:<44} {set:<9} plain {p:6.2} ns, certified {c:6.2} ns, ratio {r:.2}");
    }
}

const SPHERE: Sphere = Sphere { center: DVec3::new(0.0, 0.0, 10.0), radius: 1.0 };

const TRIANGLE: Triangle =
    [DVec3::new(-1.0, -1.0, 10.0), DVec3::new(1.0, -1.0, 9.0), DVec3::new(0.0, 1.2, 11.0)];

const TANGENT: Sphere = Sphere { center: DVec3::new(0.0, 2.0, -3.0), radius: 2.0 };

const GRID: Triangle =
    [DVec3::new(-1.0, 0.0, 0.0), DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 0.0)];

/// Half-sides of the square aimed at, by the share of hits that comes of it.
const SPREADS: [(&str, f64); 3] = [("hits", 0.4), ("half", 1.25), ("misses", 8.0)];

fn ratios() {
    println!("medians of 201 runs in turn, {RAYS} rays in packets of 16, ns per ray");
    for (share, spread) in SPREADS {
        let packets = toward_square(spread);
        let name = |what: &str| format!("{what}, {share}");
        let plain = kernel!(sphere_crosses, Sphere, bool);
        let sure = kernel!(sphere_may_cross, Sphere, bool);
        compare(&name("sphere: may cross"), &packets, &SPHERE, &plain, &sure);
        let sure = kernel!(sphere_decision, Sphere, bool);
        compare(&name("sphere: decision"), &packets, &SPHERE, &plain, &sure);
        let plain = kernel!(sphere_plain, Sphere, f64);
        let sure = kernel!(sphere_estimate, Sphere, f64);
        compare(&name("sphere: t, bounded"), &packets, &SPHERE, &plain, &sure);
        let exact = kernel!(sphere_first_root, Sphere, f64);
        compare(&name("sphere: t, exact"), &packets, &SPHERE, scalar(&plain), scalar(&exact));

        let plain = kernel!(triangle_crosses, Triangle, bool);
        let sure = kernel!(triangle_may_cross, Triangle, bool);
        compare(&name("triangle: may cross"), &packets, &TRIANGLE, &plain, &sure);
        let plain = kernel!(triangle_plain, Triangle, f64);
        let sure = kernel!(triangle_estimate, Triangle, f64);
        compare(&name("triangle: t, bounded"), &packets, &TRIANGLE, &plain, &sure);
        let exact = kernel!(triangle_crossing, Triangle, f64);
        compare(&name("triangle: t, exact"), &packets, &TRIANGLE, scalar(&plain), scalar(&exact));
    }
    let (sphere, triangle) =
        (kernel!(sphere_plain, Sphere, f64), kernel!(triangle_plain, Triangle, f64));
    let packets = toward_square(SPREADS[0].1);
    let sure = kernel!(sphere_round, Sphere, f64);
    compare("sphere: t, rounded", &packets, &SPHERE, &sphere, &sure);
    let sure = kernel!(triangle_round, Triangle, f64);
    compare("triangle: t, rounded", &packets, &TRIANGLE, &triangle, &sure);
    let packets = along_edges();
    let exact = kernel!(sphere_first_root, Sphere, f64);
    compare("sphere: t, exact, tangents", &packets, &TANGENT, scalar(&sphere), scalar(&exact));
    let exact = kernel!(triangle_crossing, Triangle, f64);
    compare("triangle: t, exact, edges", &packets, &GRID, scalar(&triangle), scalar(&exact));
}

/// The last of a kernel's sets: what branches gains nothing by packets.
fn scalar<'k, P, T>(sets: &'k [(&'k str, Run<P, T>)]) -> &'k [(&'k str, Run<P, T>)] {
    &sets[sets.len() - 1..]
}

/// One kernel for every instruction set, by criterion.
fn bench<P, T: Default + Copy>(c: &mut Criterion, name: &str, p: &P, sets: &[(&str, Run<P, T>)]) {
    let packets = toward_square(SPREADS[1].1);
    let mut group = c.benchmark_group(name);
    group.throughput(Throughput::Elements(RAYS as u64));
    for (set, run) in sets {
        let mut out = [T::default(); 16];
        group.bench_function(*set, |b| {
            b.iter(|| run(black_box(&packets), black_box(p), black_box(&mut out)));
        });
    }
    group.finish();
}

fn criterion(c: &mut Criterion) {
    bench(c, "sphere plain decision", &SPHERE, &kernel!(sphere_crosses, Sphere, bool));
    bench(c, "sphere certified decision", &SPHERE, &kernel!(sphere_decision, Sphere, bool));
    bench(c, "sphere plain t", &SPHERE, &kernel!(sphere_plain, Sphere, f64));
    bench(c, "sphere bounded t", &SPHERE, &kernel!(sphere_estimate, Sphere, f64));
    bench(c, "sphere rounded t", &SPHERE, &kernel!(sphere_round, Sphere, f64));
    bench(c, "triangle plain t", &TRIANGLE, &kernel!(triangle_plain, Triangle, f64));
    bench(c, "triangle bounded t", &TRIANGLE, &kernel!(triangle_estimate, Triangle, f64));
    bench(c, "triangle rounded t", &TRIANGLE, &kernel!(triangle_round, Triangle, f64));
}

fn main() {
    let Some(mut arguments) = Arguments::of_bench("precision [-- ratios]") else { return };
    if !arguments.flag("ratios") {
        let mut c = Criterion::default().sample_size(20).configure_from_args();
        criterion(&mut c);
        c.final_summary();
    }
    ratios();
}
