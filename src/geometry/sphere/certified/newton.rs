//! The Newton step with a double-double residual, which rounds roots correctly without branches.
//!
//! Let g(t) = |f + t·d|² − r² and G = g(t₀), 2P = g'(t₀) = 2(f + t₀d)·d for a guess t₀. The roots
//! are t₀ + δ with |d|²δ² + 2Pδ + G = 0. Where x = |d|²|G|/P² is at most 1/4 there are two of them,
//! and the one on t₀'s side of their middle, the near one where P < 0, is
//!
//!   δ = −G/(2P) · 2/(1 + √(1 ∓ x)), whose last factor differs from 1 by less than x/2.
//!
//! So the step proves itself: whatever t₀ is, it shows that there is a root, which one, and how
//! far from it the step may have ended. The parts of the error, with p = f + t₀d,
//! M = |f|₁ + r + |t₀||d|₁ and ρ = r + |p|₁ + uM:
//!
//! - G: each component of p is off by 4u²M, which makes 8u²|p|₁M; the roundings of squares and
//!   sums are below 50u²ρ²; the last sum's is u|G|. Bounded by 256u²ρM + 2u|G|.
//! - P in f64: 4u|p|₁|d|₁, and 4u²M|d|₁ since p itself is off. Bounded by 16uρ|d|₁.
//!
//! With error(P) ≤ |P|/4 and x̂ ≤ 1/8, the true x is below 1/4, and δ is off by at most
//! (error(G) + |G|(error(P)/|P| + x̂ + 4u))/|P|, of which a third is to spare.

use glam::DVec3;

use crate::geometry::double_double::{DoubleDouble, U, difference, in_range};
use crate::geometry::sphere::certified::QuadraticBound;
use crate::geometry::sphere::inverse_length_squared;

/// The root that [`round`] finds, and whether it is proven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundedRoot {
    /// The distance, in units of |direction|.
    pub t: f64,
    /// True if `t` is proven: it is the first root of the ray, and the exact root rounds to `t`.
    /// Otherwise `t` means nothing.
    pub is_certain: bool,
}

/// The first root above 0, or with `inward` the far root; correctly rounded where `is_certain`.
///
/// It has no branches, for loops over the lanes of a packet. Where it is certain it agrees with
/// [`first_root`](super::first_root), which decides the other cases too.
#[inline(always)]
pub fn round(
    center: DVec3,
    radius: f64,
    origin: DVec3,
    direction: DVec3,
    inward: bool,
) -> RoundedRoot {
    let inverse = inverse_length_squared(direction);
    let quadratic = QuadraticBound::new(center, radius, origin, direction, inverse);
    newton_step(&quadratic, quadratic.initial_guess(inward), inward)
}

/// Takes up to three Newton steps, which lines that are nearly tangents need.
pub(super) fn round_with_retries(quadratic: &QuadraticBound, inward: bool) -> RoundedRoot {
    let mut rounded = newton_step(quadratic, quadratic.initial_guess(inward), inward);
    for _ in 0..2 {
        if rounded.is_certain || !rounded.t.is_finite() {
            break;
        }
        rounded = newton_step(quadratic, rounded.t, inward);
    }
    rounded
}

/// Takes one Newton step from `guess` and proves where it ends.
#[inline(always)]
fn newton_step(quadratic: &QuadraticBound, guess: f64, inward: bool) -> RoundedRoot {
    let (d, r) = (quadratic.direction, quadratic.radius);

    // G = |p|² − r² in double-double numbers. Component by component, since compilers do not
    // vectorise a caller's loop around a loop or a `map`.
    let f = difference(quadratic.origin, quadratic.center);
    let p = [point(f[0], guess, d.x), point(f[1], guess, d.y), point(f[2], guess, d.z)];
    let (x, y, z) = (square(p[0]), square(p[1]), square(p[2]));
    let r2 = DoubleDouble::product(r, r);
    let xy = DoubleDouble::sum(x.hi, y.hi);
    let xyz = DoubleDouble::sum(xy.hi, z.hi);
    let all = DoubleDouble::difference(xyz.hi, r2.hi);
    let low = ((x.lo + y.lo) + (z.lo - r2.lo)) + ((xy.lo + xyz.lo) + all.lo);
    let g = all.hi + low;

    // P, and the sizes that the error bounds need.
    let slope = p[0].hi * d.x + p[1].hi * d.y + p[2].hi * d.z;
    let p1 = p[0].hi.abs() + p[1].hi.abs() + p[2].hi.abs();
    let d1 = d.x.abs() + d.y.abs() + d.z.abs();
    let f1 = f[0].hi.abs() + f[1].hi.abs() + f[2].hi.abs();
    let r_abs = r.abs();
    let size = f1 + r_abs + guess.abs() * d1;
    let rho = r_abs + p1 + U * size;

    // The bounds of the errors of G, of P and of the step (see the head of this file).
    let inverse = 1.0 / slope.abs();
    let g_error = 256.0 * U * U * rho * size + 2.0 * U * g.abs();
    let g_most = g.abs() + g_error;
    let slope_error = 16.0 * U * rho * d1;
    let x = d.dot(d) * g_most * inverse * inverse;
    let relative = slope_error * inverse + x + 4.0 * U;
    let error = (g_error + g_most * relative) * inverse;

    // The step itself.
    let delta = -0.5 * g * inverse.copysign(slope);
    let t = DoubleDouble::sum(guess, delta);

    // The root counts if it is the first above 0: the near one, or the far one seen from inside.
    let f2 = quadratic.offset.dot(quadratic.offset);
    let inside = r * r - f2 > 8.0 * U * (f2 + r * r);
    let near = slope < 0.0;
    let first = if near { !inward } else { inward | inside };
    let is_certain = first
        & (t.hi > 0.0)
        & (slope_error * inverse <= 0.25)
        & (x <= 0.125)
        & t.rounds_to_hi(error)
        & in_range(r_abs)
        & in_range(d1)
        & in_range(size);
    RoundedRoot { t: t.hi, is_certain }
}

/// The coordinate f + t·d, off by less than 4u²(|f| + |t·d|).
#[inline(always)]
fn point(f: DoubleDouble, t: f64, d: f64) -> DoubleDouble {
    let along = DoubleDouble::product(t, d);
    let sum = DoubleDouble::sum(f.hi, along.hi);
    DoubleDouble::sum(sum.hi, sum.lo + (f.lo + along.lo))
}

/// The square p², off by less than 7u²p².
#[inline(always)]
fn square(p: DoubleDouble) -> DoubleDouble {
    let square = DoubleDouble::product(p.hi, p.hi);
    DoubleDouble { hi: square.hi, lo: square.lo + 2.0 * p.hi * p.lo }
}
