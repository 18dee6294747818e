use std::cmp::Ordering::{self, Equal, Greater, Less};

use proptest::prelude::*;

use super::*;
use crate::geometry::dyadic::{self, Dyadic, vector, zip};

/// A sphere and a ray.
#[derive(Clone, Copy, Debug)]
struct Case {
    center: DVec3,
    radius: f64,
    origin: DVec3,
    direction: DVec3,
    tmax: f64,
    inward: bool,
}

impl Case {
    fn new(center: DVec3, radius: f64, origin: DVec3, direction: DVec3) -> Self {
        Self { center, radius, origin, direction, tmax: f64::INFINITY, inward: false }
    }

    fn certified(&self) -> Option<f64> {
        let Self { center, radius, origin, direction, tmax, inward } = *self;
        first_root(center, radius, origin, direction, tmax, inward)
    }

    /// The first root by bisection with the sign of the exact quadratic.
    fn exact(&self) -> Option<f64> {
        let f = zip(&vector(self.origin), &vector(self.center), |o, c| o - c);
        let d = vector(self.direction);
        let r = Dyadic::new(self.radius);
        let a = dyadic::dot(&d, &d);
        let b = Dyadic::new(0.0) - dyadic::dot(&f, &d);
        let c = dyadic::dot(&f, &f) - r.clone() * r;
        let discriminant = b.clone() * b.clone() - a.clone() * c.clone();
        if discriminant.sign() == Less {
            return None;
        }
        let two_ahead = c.sign() == Greater && b.sign() == Greater;
        let one_ahead = c.sign() == Less || (c.sign() == Equal && b.sign() == Greater);
        if !two_ahead && !one_ahead {
            return None;
        }
        let far = one_ahead || self.inward;
        let root_beside = |x: &Dyadic| -> Ordering {
            let x = x.clone();
            let before_middle = (a.clone() * x.clone()).cmp(&b);
            let two = Dyadic::new(2.0);
            let g = (a.clone() * x.clone() - two * b.clone()) * x + c.clone();
            match (far, before_middle, g.sign()) {
                (_, Equal, Equal) | (true, Greater, Equal) | (false, Less, Equal) => Equal,
                (true, Less | Equal, _) | (true, _, Less) => Greater,
                (true, ..) => Less,
                (false, Less, Greater) => Greater,
                (false, ..) => Less,
            }
        };
        let below = self.tmax == f64::INFINITY || root_beside(&Dyadic::new(self.tmax)) == Less;
        (below && self.tmax > 0.0).then(|| dyadic::round(root_beside))
    }

    fn estimate(&self) -> Estimate {
        let inverse = inverse_length_squared(self.direction);
        estimate(self.center, self.radius, self.origin, self.direction, inverse)
    }

    /// Checks every stage against the exact answer.
    fn check(&self) {
        let exact = self.exact();
        assert_eq!(self.certified(), exact, "{self:?}");
        let unbounded = Self { tmax: f64::INFINITY, ..*self };
        let exact = unbounded.exact();
        let rounded = round(self.center, self.radius, self.origin, self.direction, self.inward);
        if rounded.is_certain {
            assert_eq!(Some(rounded.t), exact, "{self:?}");
        }
        if self.inward {
            return;
        }
        let estimate = self.estimate();
        match exact {
            None => assert!(estimate.error != 0.0 || estimate == Estimate::MISS, "{self:?}"),
            Some(_) => assert!(estimate != Estimate::MISS, "{self:?}"),
        }
        if estimate != Estimate::MISS && estimate.error < f64::INFINITY {
            let t = exact.unwrap_or_else(|| panic!("{estimate:?} is no hit: {self:?}"));
            assert!((t - estimate.t).abs() <= estimate.error, "{t} {estimate:?} {self:?}");
        }
    }
}

fn power(exponent: i32) -> f64 {
    2f64.powi(exponent)
}

#[test]
fn tangent_is_a_hit() {
    let case = Case::new(DVec3::new(3.0, 0.0, 5.0), 3.0, DVec3::ZERO, DVec3::Z);
    assert_eq!(case.certified(), Some(5.0));
}

#[test]
fn slanted_tangent_is_a_hit() {
    // The line y = 1 + 4x/3 through (0, 1) has the distance 3/5 from the origin.
    let case = Case::new(DVec3::X * 5.0, 3.0, DVec3::ZERO, DVec3::new(4.0, 3.0, 0.0));
    assert_eq!(case.certified(), Some(0.8));
    case.check();
}

#[test]
fn radius_one_ulp_below_a_tangent_misses() {
    let case = Case::new(DVec3::X * 5.0, 3f64.next_down(), DVec3::ZERO, DVec3::new(4., 3., 0.));
    assert_eq!(case.certified(), None);
}

#[test]
fn radius_one_ulp_above_a_tangent_is_hit_before_it() {
    let case = Case::new(DVec3::X * 5.0, 3f64.next_up(), DVec3::ZERO, DVec3::new(4., 3., 0.));
    assert!(case.certified().unwrap() < 0.8);
    case.check();
}

#[test]
fn origin_on_the_surface_hits_the_far_side_only() {
    let case = Case::new(DVec3::ZERO, 1.0, DVec3::X, DVec3::NEG_X);
    assert_eq!(case.certified(), Some(2.0));
    assert_eq!(Case { direction: DVec3::X, ..case }.certified(), None);
    assert_eq!(Case { direction: DVec3::Y, ..case }.certified(), None);
}

#[test]
fn subnormal_sphere_is_met() {
    let radius = f64::from_bits(3);
    let case = Case::new(DVec3::ZERO, radius, DVec3::X * 1e-310, DVec3::NEG_X * 1e-310);
    case.check();
    assert!(case.certified().is_some());
}

#[test]
fn sphere_of_no_radius_is_hit_at_its_centre() {
    let case = Case::new(DVec3::new(1.0, 2.0, 3.0), 0.0, DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(case.certified(), Some(1.0));
}

#[test]
fn distance_beyond_f64_is_reported_as_its_end() {
    let case = Case::new(DVec3::X * 1e300, 1.0, DVec3::ZERO, DVec3::X * 1e-300);
    assert_eq!(case.certified(), Some(f64::MAX));
    let case = Case::new(DVec3::X * 1e-300, 0.0, DVec3::ZERO, DVec3::X * 1e300);
    assert_eq!(case.certified(), Some(f64::from_bits(1)));
}

#[test]
fn root_beyond_f64_in_its_square_is_met() {
    let (origin, direction) = (DVec3::NEG_Z, DVec3::X * 2e-86);
    Case::new(DVec3::ZERO, 2e75, origin, direction).check();
}

#[test]
fn component_of_1e_minus_300_decides_beside_one() {
    let direction = |x| DVec3::new(x, 0.0, 1.0);
    let case = Case::new(DVec3::new(1.0, 0.0, 5.0), 1.0, DVec3::ZERO, DVec3::Z);
    assert!(Case { direction: direction(1e-300), ..case }.certified().is_some());
    assert!(Case { direction: direction(-1e-300), ..case }.certified().is_none());
}

#[test]
fn end_is_compared_with_the_exact_distance() {
    // t = √2 − 1 from outside: the nearest float is not the root itself.
    let origin = DVec3::new(-2.0, 0.0, 0.0);
    for radius in [1.0, 1.1, 1.3, 0.7] {
        let case = Case::new(DVec3::Y * 0.3, radius, origin, DVec3::X);
        let t = case.exact().unwrap();
        for tmax in [t.next_down(), t, t.next_up()] {
            Case { tmax, ..case }.check();
        }
    }
}

#[test]
fn ray_that_is_not_finite_hits_nothing() {
    let case = Case::new(DVec3::ZERO, 1.0, DVec3::X * 3.0, DVec3::NEG_X);
    assert_eq!(Case { direction: DVec3::ZERO, ..case }.certified(), None);
    assert_eq!(Case { direction: DVec3::NAN, ..case }.certified(), None);
    assert_eq!(Case { origin: DVec3::INFINITY, ..case }.certified(), None);
}

#[test]
fn estimate_decides_what_is_not_nearly_a_tangent() {
    let case = Case::new(DVec3::new(0.3, 0.1, 9.0), 1.0, DVec3::ZERO, DVec3::Z);
    // The bound is 8·32u(|f| + r), more or less.
    assert!(case.estimate().error < 1e-12);
    assert_eq!(Case { radius: 0.3, ..case }.estimate(), Estimate::MISS);
    assert_eq!(Case { direction: DVec3::NEG_Z, ..case }.estimate(), Estimate::MISS);
    assert!(Case { origin: case.center, ..case }.estimate().error < 1e-12);
}

#[test]
fn direction_of_a_square_beyond_f64_leaves_the_decision_open() {
    let direction = DVec3::Z * 1e160;
    let inverse = inverse_length_squared(direction);
    let line = QuadraticBound::new(DVec3::new(5.0, 0.0, 9.0), 1.0, DVec3::ZERO, direction, inverse);
    assert!(line.may_cross() && !line.certainly_crosses());
}

#[test]
fn round_is_certain_of_what_is_well_inside() {
    let case = Case::new(DVec3::new(0.3, 0.1, 9.0), 1.0, DVec3::ZERO, DVec3::Z);
    let Case { center, radius, origin, direction, .. } = case;
    assert!(round(center, radius, origin, direction, false).is_certain);
    assert!(round(center, radius, center, direction, false).is_certain);
    assert!(round(center, radius, origin, direction, true).is_certain);
}

fn unit() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-1.0..1.0f64)
        .prop_map(DVec3::from)
        .prop_filter("short", |v| v.length() > 0.1)
        .prop_map(DVec3::normalize)
}

/// The distance of the line from the centre in radii: 1 ± a few 2⁻ᵏ, or any number.
fn impact() -> impl Strategy<Value = f64> {
    prop_oneof![0.0..1.1f64, (20..60i32, -4.0..4.0f64).prop_map(|(k, x)| 1.0 + x * power(-k)),]
}

prop_compose! {
    /// A ray that comes within `impact` radii of the centre, from `far` radii away.
    fn aimed()(
        center in prop::array::uniform3(-10.0..10.0f64),
        radius_power in -20.0..20.0f64,
        far in prop_oneof![0.0..2.0f64, (0.0..33.0f64).prop_map(f64::exp2)],
        impact in impact(),
        toward in unit(),
        side in unit(),
        scale in -60..60i32,
        short in any::<bool>(),
        inward in any::<bool>(),
        away in any::<bool>(),
    ) -> Case {
        let center = DVec3::from(center);
        let radius = radius_power.exp2();
        let side = (side - toward * side.dot(toward)).normalize_or(toward.any_orthonormal_vector());
        let aim = center + side * (radius * impact);
        let origin = aim - toward * (radius * far);
        let direction = if away { -toward } else { toward } * power(scale);
        let mut case = Case { inward, ..Case::new(center, radius, origin, direction) };
        if short {
            case.tmax = case.exact().unwrap_or(1.0);
        }
        case
    }
}

/// A float from anywhere among the finite ones.
fn any_float() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |x| x.is_finite()),
        (-4i8..=4).prop_map(f64::from),
    ]
}

fn any_vector() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(any_float()).prop_map(DVec3::from)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn aimed_rays_agree_with_exact_arithmetic(case in aimed()) {
        case.check();
    }

    #[test]
    fn small_integers_agree_with_exact_arithmetic(
        center in prop::array::uniform3(-5i8..=5),
        radius in 1i8..=5,
        origin in prop::array::uniform3(-5i8..=5),
        direction in prop::array::uniform3(-3i8..=3),
        unit in -80..80i32,
        tmax in prop_oneof![Just(f64::INFINITY), (1i8..9).prop_map(f64::from)],
    ) {
        let vector = |v: [i8; 3]| DVec3::from(v.map(f64::from));
        prop_assume!(direction != [0; 3]);
        let (center, origin) = (vector(center) * power(unit), vector(origin) * power(unit));
        let radius = f64::from(radius) * power(unit);
        let case = Case::new(center, radius, origin, vector(direction));
        Case { tmax: tmax * power(unit), ..case }.check();
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn any_floats_agree_with_exact_arithmetic(
        center in any_vector(),
        radius in any_float(),
        origin in any_vector(),
        direction in any_vector(),
    ) {
        prop_assume!(direction != DVec3::ZERO);
        Case::new(center, radius.abs(), origin, direction).check();
    }
}
