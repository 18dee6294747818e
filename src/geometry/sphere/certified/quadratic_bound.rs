//! The quadratic equation of a line and a sphere in f64, with bounds on the error of its roots.
//!
//! Notation: u = 2⁻⁵³; f from the centre to the origin; m = −f·d/|d|²; l = f + m·d, the foot of
//! the perpendicular from the centre. A hat marks what is computed.
//!
//! **The foot.** f̂ is off by u|f|, f̂·d by 4u|f||d|, 1/|d|² by a relative 4u (13u where |d|² is
//! subnormal), so m̂·d by 9u|f| (18u|f|), and the two last roundings add 2u|f|:
//! |l̂ − l| ≤ η = 21u|f|.
//!
//! **The decision.** Suppose |l| ≤ r. Then |l̂|² ≤ (r + η)² = r² + 2rη + η², and 2rη ≤ μr² + η²/μ
//! for any μ > 0. Suppose |l| > r. Then |l̂|² > r² − μr² − η²/μ likewise if η < r. So the sign of
//! |l̂|² − r² is right where its size exceeds μr² + (1 + 1/μ)η². In the first case
//! |f|² = |l|² + m²|d|² is at most r² + m²|d|², in the second 4r² + m²|d|². (If η ≥ r, then m²|d|²
//! is nearly |f|², and E below exceeds r²: nothing is certain.) With λ = 2⁻²⁰ and μ = λ/2
//!
//!   E = λr² + 2048u²/λ · m²|d|² ≥ μr² + (1 + 1/μ)η²,
//!
//! since (1 + 2/λ)·441u² is below 900u²/λ, whose part with r² is far below the other half of λ; the
//! roundings of |l̂|², r² and E, a relative 5u, are too. E costs little because (f·d)·m = −m²|d|² has
//! both its factors at hand. One ray in a million or so that comes near the sphere is left
//! undecided, up to distances of 10⁶ r. What underflows moves the foot by less than 10⁻¹⁶⁸ and a
//! square by 10⁻³²², for which [`TINY`] stands in E; what overflows is never certain.
//!
//! **The roots** are m ∓ h with h² = (r² − l²)/|d|², taken as in `Quadratic::roots`: one as
//! q = m ± h, the other as its quotient p/q with p = (f² − r²)/|d|². Write F, R for bounds of
//! |f|/|d| and r/|d|: |f|₁, r times |d|₁/|d|². With η' = 32u(F + R), which bounds the errors of m,
//! of l/|d| and of the last sum together, h² is off by 2Rη' + η'², h by that over ĥ, and q by
//! η'(4R + η')/ĥ since ĥ ≤ R. The numerator f² − r² is off by 8u(f² + r²), and the quotient by
//! twice (t·error(q) + error(p))/|q| where error(q) ≤ |q|/2.

use glam::DVec3;

use crate::geometry::Estimate;
use crate::geometry::double_double::U;

/// The share λ of r² within which the squared distance of the line from the centre decides nothing.
const LAMBDA: f64 = 1.0 / (1u64 << 20) as f64;

/// The factor of m²|d|² in E: 2048u²/λ = 2⁻⁷⁵.
const KAPPA: f64 = f64::from_bits((1023 - 75) << 52);

/// A bound below any squared distance that decides something, and above all that underflows.
const TINY: f64 = 1e-290;

/// A bound below any r²/|d|² whose share of 2⁻¹⁰⁰, the smallest part of an error bound, still has all
/// its digits.
const SMALLEST: f64 = 1e-270;

/// The quadratic equation of a line and a sphere, with bounds on what f64 arithmetic computes of it.
///
/// Like the plain [`Quadratic`](crate::geometry::sphere::Quadratic) it needs no square root to tell a
/// miss, so that a packet can stop early when all of its rays certainly miss.
#[derive(Clone, Copy)]
pub struct QuadraticBound {
    /// f, from the centre to the origin, rounded.
    pub(super) offset: DVec3,
    pub(super) origin: DVec3,
    pub(super) center: DVec3,
    pub(super) direction: DVec3,
    pub(super) radius: f64,
    inverse: f64,
    middle: f64,
    r2: f64,
    foot2: f64,
    /// The two parts of E above: that of the sphere, and that of the line.
    slack: [f64; 2],
}

impl QuadraticBound {
    /// Builds the equation of the line `origin + t·direction` and the sphere.
    /// `inverse_length_squared` comes from
    /// [`sphere::inverse_length_squared`](crate::geometry::sphere::inverse_length_squared), whose NaN
    /// makes nothing certain where |direction|² is beyond f64.
    #[inline(always)]
    pub fn new(
        center: DVec3,
        radius: f64,
        origin: DVec3,
        direction: DVec3,
        inverse_length_squared: f64,
    ) -> Self {
        let offset = origin - center;
        let half_b = -offset.dot(direction);
        let middle = half_b * inverse_length_squared;
        let foot = offset + direction * middle;
        let r2 = radius * radius;
        Self {
            offset,
            origin,
            center,
            direction,
            radius,
            inverse: inverse_length_squared,
            middle,
            r2,
            foot2: foot.dot(foot),
            slack: [LAMBDA * r2 + TINY, KAPPA * (half_b * middle)],
        }
    }

    /// True if the line may cross the sphere: false only where it certainly misses.
    #[inline(always)]
    pub fn may_cross(&self) -> bool {
        let [sphere, line] = self.slack;
        let misses = self.foot2 > (self.r2 + sphere) + line;
        !misses
    }

    /// True if the line certainly crosses the sphere.
    #[inline(always)]
    pub fn certainly_crosses(&self) -> bool {
        let [sphere, line] = self.slack;
        self.foot2 < (self.r2 - sphere) - line
    }

    /// The two roots in f64 by the formulas of `Quadratic::roots`, and the greater part of their
    /// error bounds.
    #[inline(always)]
    fn roots(&self) -> Roots {
        let half_chord = ((self.r2 - self.foot2) * self.inverse).sqrt();
        let f2 = self.offset.dot(self.offset);
        let far = self.middle + half_chord.copysign(self.middle);
        Roots {
            half_chord,
            near: (f2 - self.r2) * self.inverse / far,
            far,
            power: f2 - self.r2,
            power_error: 8.0 * U * (f2 + self.r2),
        }
    }

    /// The first root above 0, with a bound on its error.
    #[inline(always)]
    pub fn estimate(&self) -> Estimate {
        // Both roots, and the bounds of their errors (see "The roots" above).
        let Roots { half_chord, near, far, power, power_error } = self.roots();
        let scale = l1(self.direction) * self.inverse;
        let radius = self.radius * scale;
        let eta = 32.0 * U * (l1(self.offset) * scale + radius);
        let far_error = eta * (4.0 * radius + eta) / half_chord;
        let near_error = 2.0 * (far_error * near.abs() + power_error * self.inverse) / far.abs();

        // The far root counts for an origin inside, the near one for an origin outside.
        let outside = power > power_error;
        let inside = power < -power_error;
        let ahead = far > 0.0;
        let takes_far = inside & ahead;
        let t = if takes_far { far } else { near };
        let error = if takes_far { far_error } else { near_error };

        // Where r²/|d|² is so small that what is smaller yet underflows, nothing is certain.
        let decided = (self.r2 * self.inverse > SMALLEST) & (self.inverse < 1.0 / TINY);
        let sure = self.certainly_crosses()
            & decided
            & (outside | inside)
            & (2.0 * far_error <= far.abs())
            & (far.abs() < f64::INFINITY)
            & (error < f64::INFINITY);
        let misses = !self.may_cross() | (sure & outside & !ahead);
        Estimate::select(misses, sure, t, error)
    }

    /// The first root above 0, or with `inward` the far one, in f64 without a bound.
    #[inline(always)]
    pub(super) fn initial_guess(&self, inward: bool) -> f64 {
        let Roots { near, far, power, .. } = self.roots();
        let takes_far = inward | (power < 0.0);
        let greater = if far > near { far } else { near };
        let lesser = if far > near { near } else { far };
        if takes_far { greater } else { lesser }
    }
}

/// The roots of a [`QuadraticBound`] in f64.
struct Roots {
    /// h, half the distance between the roots.
    half_chord: f64,
    /// The root nearer to 0, p/q.
    near: f64,
    /// The root farther from 0, q.
    far: f64,
    /// The power of the origin, |f|² − r².
    power: f64,
    /// The bound of the error of `power`.
    power_error: f64,
}

#[inline(always)]
fn l1(v: DVec3) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}
