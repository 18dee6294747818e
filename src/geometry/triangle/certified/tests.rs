use std::cmp::Ordering::{self, Equal, Less};

use proptest::prelude::*;

use super::*;
use crate::geometry::dyadic::{self, Dyadic, Vector, determinant, vector, zip};

/// A triangle and a ray.
#[derive(Clone, Copy, Debug)]
struct Case {
    triangle: [DVec3; 3],
    origin: DVec3,
    direction: DVec3,
    tmax: f64,
}

fn minus(a: &Vector, b: &Vector) -> Vector {
    zip(a, b, |x, y| x - y)
}

impl Case {
    fn new(triangle: [DVec3; 3], origin: DVec3, direction: DVec3) -> Self {
        Self { triangle, origin, direction, tmax: f64::INFINITY }
    }

    fn certified(&self) -> Option<TriangleHit> {
        crossing(self.triangle, self.origin, self.direction, self.tmax)
    }

    /// True if the line crosses the triangle when moved by (ε, ε², ε³) with ε = 2⁻⁸⁰⁰⁰: as in the tie
    /// rule, and by less than any edge function of floats that is not 0.
    fn moved_line_crosses(&self) -> bool {
        let step = |k: i64| Dyadic::power_of_two(-8000 * k);
        let origin = zip(&vector(self.origin), &[step(1), step(2), step(3)], |o, x| o + x);
        let [a, b, c] = self.triangle.map(|p| minus(&vector(p), &origin));
        let d = vector(self.direction);
        let edges = [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| determinant(&d, p, q).sign());
        edges[0] != Equal && edges[0] == edges[1] && edges[1] == edges[2]
    }

    /// The crossing in exact arithmetic: quotients of dyadic numbers, rounded by bisection.
    fn exact(&self) -> Option<TriangleHit> {
        let [a, b, c] = self.triangle.map(vector);
        let (first, second) = (minus(&b, &a), minus(&c, &a));
        let (d, from) = (vector(self.direction), minus(&a, &vector(self.origin)));
        let divisor = determinant(&d, &first, &second);
        let numerator = determinant(&from, &first, &second);
        if divisor.sign() == Equal || !self.moved_line_crosses() {
            return None;
        }
        if numerator.sign() != divisor.sign() {
            return None;
        }
        let quotient = |x: &Dyadic| compare_quotient(&numerator, &divisor, x);
        let below = self.tmax == f64::INFINITY || quotient(&Dyadic::new(self.tmax)) == Less;
        let weight = |x: Dyadic| match x.sign() {
            Equal => 0.0,
            _ => dyadic::round(|y| compare_quotient(&x, &divisor, y)),
        };
        (self.tmax > 0.0 && below).then(|| TriangleHit {
            t: dyadic::round(quotient),
            u: weight(determinant(&d, &second, &from)),
            v: weight(determinant(&d, &from, &first)),
        })
    }

    /// Checks every stage of the intersection against the exact answer.
    fn check(&self) {
        let exact = self.exact();
        let found = self.certified();
        assert_eq!(found.map(|f| f.t), exact.map(|e| e.t), "{self:?}");
        if let (Some(found), Some(exact)) = (found, exact) {
            let off = (found.u - exact.u).abs().max((found.v - exact.v).abs());
            assert!(off <= 4.0 * f64::EPSILON, "{off} {found:?} {exact:?} {self:?}");
            let rounded = round(self.triangle, self.origin, self.direction);
            if rounded.is_certain {
                let RoundedHit { t, u, v, .. } = rounded;
                assert_eq!(TriangleHit { t, u, v }, found, "{self:?}");
            }
        }
        let estimate = estimate(self.triangle, self.origin, self.direction);
        let unbounded = Self { tmax: f64::INFINITY, ..*self };
        match unbounded.exact() {
            Some(TriangleHit { t, .. }) => {
                assert_ne!(estimate, Estimate::MISS, "{self:?}");
                let distance = (t - estimate.t).abs();
                assert!(distance <= estimate.error, "{t} {estimate:?} {self:?}");
            }
            None => assert!(estimate.lower() <= 0.0 || estimate == Estimate::MISS, "{self:?}"),
        }
    }
}

/// Compares the quotient n/d with x, for n and d of one sign.
fn compare_quotient(n: &Dyadic, d: &Dyadic, x: &Dyadic) -> Ordering {
    let order = n.cmp(&(d.clone() * x.clone()));
    if d.sign() == Less { order.reverse() } else { order }
}

/// Returns 1 if the ray hits the triangle, otherwise 0.
fn hit_count(triangle: [DVec3; 3], origin: DVec3, direction: DVec3) -> usize {
    usize::from(crossing(triangle, origin, direction, f64::INFINITY).is_some())
}

const UNIT: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

#[test]
fn weights_belong_to_the_second_and_third_vertex() {
    let hit = crossing(UNIT, DVec3::new(0.25, 0.5, 3.0), -DVec3::Z, f64::INFINITY).unwrap();
    assert_eq!((hit.t, hit.u, hit.v), (3.0, 0.25, 0.5));
}

#[test]
fn winding_does_not_matter() {
    let case = Case::new([UNIT[0], UNIT[2], UNIT[1]], DVec3::new(0.25, 0.5, 3.0), -DVec3::Z);
    assert_eq!(case.certified(), Some(TriangleHit { t: 3.0, u: 0.5, v: 0.25 }));
}

#[test]
fn both_ends_of_the_ray_are_left_out() {
    let inside = DVec3::new(0.25, 0.25, 0.0);
    assert_eq!(crossing(UNIT, inside, DVec3::Z, f64::INFINITY), None);
    assert_eq!(crossing(UNIT, inside - DVec3::Z, DVec3::Z, 1.0), None);
    assert!(crossing(UNIT, inside - DVec3::Z, DVec3::Z, 1f64.next_up()).is_some());
}

#[test]
fn parallel_line_and_degenerate_triangle_miss() {
    assert_eq!(hit_count(UNIT, DVec3::new(-1.0, 0.25, 0.0), DVec3::X), 0);
    assert_eq!(hit_count(UNIT, DVec3::new(-1.0, 0.0, 0.0), DVec3::X), 0);
    assert_eq!(
        hit_count([DVec3::ZERO, DVec3::X, DVec3::X * 2.0], DVec3::X + DVec3::Z, -DVec3::Z),
        0
    );
    assert_eq!(hit_count([DVec3::X; 3], DVec3::X + DVec3::Z, -DVec3::Z), 0);
}

#[test]
fn estimate_decides_what_is_not_nearly_an_edge() {
    let at = |x: f64, direction: DVec3| estimate(UNIT, DVec3::new(x, 0.25, 1.0), direction);
    assert!((at(0.25, -DVec3::Z).t - 1.0).abs() < 1e-14 && at(0.25, -DVec3::Z).error < 1e-13);
    assert!(at(0.25, DVec3::Z).upper() < 0.0);
    assert_eq!(at(0.76, -DVec3::Z), Estimate::MISS);
    assert_eq!(at(-0.01, -DVec3::Z), Estimate::MISS);
}

#[test]
fn round_is_certain_of_what_is_not_edge_on() {
    assert!(round(UNIT, DVec3::new(0.3, 0.1, 0.7), DVec3::new(0.1, 0.2, -0.3)).is_certain);
}

#[test]
fn ray_that_is_not_finite_hits_nothing() {
    let origin = DVec3::new(0.25, 0.25, 1.0);
    assert_eq!(hit_count(UNIT, origin, DVec3::ZERO), 0);
    assert_eq!(hit_count(UNIT, origin, DVec3::NAN), 0);
    assert_eq!(hit_count(UNIT, origin, DVec3::NEG_INFINITY), 0);
}

#[test]
fn negative_zero_is_zero() {
    let [a, b, c] = UNIT;
    let origin = DVec3::new(0.0, 0.25, 1.0);
    let direction = DVec3::new(-0.0, -0.0, -1.0);
    let mirrored = [DVec3::new(-0.0, 0.0, -0.0), c, -b];
    assert_eq!(hit_count([a, b, c], origin, direction) + hit_count(mirrored, origin, direction), 1);
}

#[test]
fn distance_beyond_f64_is_reported_as_its_end() {
    let triangle = UNIT.map(|p| p * 1e300 - DVec3::new(1.0, 1.0, 0.0) * 1e299 + DVec3::Z * 1e300);
    let hit = crossing(triangle, DVec3::ZERO, DVec3::Z * 1e-300, f64::INFINITY).unwrap();
    assert_eq!(hit.t, f64::MAX);
}

/// The triangles around `hub`, each with two successive points of the rim.
fn fan(hub: DVec3, rim: &[DVec3]) -> Vec<[DVec3; 3]> {
    (0..rim.len()).map(|i| [hub, rim[i], rim[(i + 1) % rim.len()]]).collect()
}

/// The twelve triangles of a cube, two for each face.
fn cube(side: f64, corner: DVec3) -> Vec<[DVec3; 3]> {
    let at =
        |i: usize| corner + DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64) * side;
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .map(|t| t.map(at))
        .collect()
}

#[test]
fn ray_through_the_hub_of_a_fan_hits_one_triangle() {
    for spokes in 3..20 {
        let rim: Vec<DVec3> = (0..spokes)
            .map(|i| f64::from(i) / f64::from(spokes) * std::f64::consts::TAU)
            .map(|angle| DVec3::new(angle.cos(), angle.sin(), 0.3 * (5.0 * angle).sin()))
            .collect();
        let hub = DVec3::new(0.1, -0.05, 0.2);
        for origin in [hub + DVec3::Z * 3.0, hub + DVec3::new(0.25, 0.125, 4.0)] {
            let direction = hub - origin;
            let hits: usize = fan(hub, &rim).iter().map(|&t| hit_count(t, origin, direction)).sum();
            assert_eq!(hits, 1, "{spokes} {origin}");
        }
    }
}

#[test]
fn ray_along_an_edge_of_a_cube_crosses_it_an_even_number_of_times() {
    let mut seen = [0; 3];
    for corner in [DVec3::ZERO, DVec3::new(-0.5, 0.25, 7.0), DVec3::splat(1e6)] {
        let cube = cube(1.0, corner);
        for axis in DVec3::AXES {
            for (i, j) in (0..5).flat_map(|i| (0..5).map(move |j| (i, j))) {
                let (u, v) = (f64::from(i - 1) * 0.5, f64::from(j - 1) * 0.5);
                let offset = DVec3::new(axis.y + axis.z, axis.x, 0.0) * u
                    + DVec3::new(0.0, axis.z, axis.x + axis.y) * v;
                for direction in [axis, -axis] {
                    let origin = corner + offset + axis * 0.5 - direction * 3.5;
                    let hits: usize = cube.iter().map(|&t| hit_count(t, origin, direction)).sum();
                    assert!(hits == 0 || hits == 2, "{hits} {origin} {direction}");
                    seen[hits] += 1;
                }
            }
        }
    }
    assert!(seen[0] > 0 && seen[2] > 0);
}

fn near_unit() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from)
}

fn power(exponent: i32) -> f64 {
    2f64.powi(exponent)
}

prop_compose! {
    /// A ray aimed at, near or beside an edge or a vertex of a triangle that may be thin and far.
    fn aimed()(
        corners in prop::array::uniform3(near_unit()),
        thin in 0..34i32,
        offset in near_unit(),
        far in 0..24i32,
        weights in prop_oneof![
            (0.0..1.0f64, 0.0..1.0f64),
            (Just(0.0), 0.0..1.0f64),
            (Just(0.0), Just(1.0)),
            (0.0..1.0f64).prop_map(|u| (u, 1.0 - u)),
            (-1e-15..1e-15f64, 0.0..1.0f64),
        ],
        from in near_unit(),
        distance in -3..24i32,
        graze in prop_oneof![Just(1.0), (0..40i32).prop_map(|k| power(-k))],
        scale in -60..60i32,
        short in any::<bool>(),
    ) -> Case {
        let [a, b, c] = corners;
        let base = offset * power(far);
        let triangle = [base + a, base + b, base + b.lerp(c, power(-thin))];
        let (u, v) = weights;
        let aim = super::super::point(triangle, u, v);
        let normal = super::super::area_normal(triangle).normalize_or_zero();
        let from = from - normal * (from.dot(normal) * (1.0 - graze));
        let origin = aim + from * power(distance);
        let mut case = Case::new(triangle, origin, (aim - origin) * power(scale));
        if short && case.direction != DVec3::ZERO {
            case.tmax = case.exact().map_or(1.0, |hit| hit.t);
        }
        case
    }
}

fn any_float() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |x| x.is_finite()),
        (-4i8..=4).prop_map(f64::from),
    ]
}

fn any_vector() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(any_float()).prop_map(DVec3::from)
}

/// A point of a small grid.
fn grid() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-3i8..=3).prop_map(|v| DVec3::from(v.map(f64::from)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3_000))]

    #[test]
    fn aimed_rays_agree_with_exact_arithmetic(case in aimed()) {
        case.check();
    }

    #[test]
    fn grids_agree_with_exact_arithmetic(
        triangle in prop::array::uniform3(grid()),
        origin in grid(),
        direction in grid(),
        unit in prop_oneof![Just(0), -150..150i32, Just(-1074)],
    ) {
        let scale = |v: DVec3| v * power(unit / 2) * power(unit - unit / 2);
        Case::new(triangle.map(scale), scale(origin), direction).check();
    }

    #[test]
    fn ray_at_the_hub_of_a_fan_hits_one_triangle(
        heights in prop::array::uniform7(-0.5..0.5f64),
        hub in prop::array::uniform2(-0.2..0.2f64),
        origin in prop::array::uniform2(-0.5..0.5f64),
        offset in near_unit(),
        far in 0..20i32,
        spoke in 0..8usize,
        share in 0.0..0.9f64,
    ) {
        let base = offset * power(far);
        let rim: Vec<DVec3> = (0..7)
            .map(|i| (i as f64 / 7.0 * std::f64::consts::TAU, heights[i]))
            .map(|(angle, z)| base + DVec3::new(angle.cos(), angle.sin(), z))
            .collect();
        let hub = base + DVec3::new(hub[0], hub[1], 0.1);
        // At the hub itself, or at a point of one of the spokes, more or less.
        let aim = if spoke < 7 { hub.lerp(rim[spoke], share) } else { hub };
        let origin = base + DVec3::new(origin[0], origin[1], 9.0);
        let hits: usize = fan(hub, &rim).iter().map(|&t| hit_count(t, origin, aim - origin)).sum();
        prop_assert_eq!(hits, 1);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_floats_agree_with_exact_arithmetic(
        triangle in prop::array::uniform3(any_vector()),
        origin in any_vector(),
        direction in any_vector(),
    ) {
        prop_assume!(direction != DVec3::ZERO);
        Case::new(triangle, origin, direction).check();
    }
}
