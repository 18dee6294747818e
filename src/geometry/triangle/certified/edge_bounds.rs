//! The edge functions of a line and a triangle in f64, with bounds on their errors.
//!
//! Notation: u = 2⁻⁵³; a, b, c the vertices relative to the origin, each rounded once; s and δ the
//! largest components of these and of the direction d.
//!
//! **Edge functions** d·(p × q): a product of two components is off by 3us², one of p × q by 8us²
//! and at most 2s² in size, so a term of the sum by 10uδs² and the sum of three, two roundings
//! included, by 40uδs². The bound is 48uδs².
//!
//! **Distance** N/D with the normal n = (v₁ − v₀) × (v₂ − v₀), N = n·a and D = n·d. With w the
//! product of the largest components of the two sides, a component of n is at most 2w in size and
//! off by 8uw; N is off by 46uws and D by 46uwδ, both bounded by 64u. Where that is at most half of
//! |D|, N/D is off by 2(error(N) + |t|·error(D))/|D|, in which its own rounding is contained.
//!
//! With s and δ within 2^±200 and uwδ above 2⁻⁷⁰⁰ nothing overflows, and what underflows, a few times
//! 2⁻¹⁰⁷⁴ in n or in a sum, is far below these bounds. Outside that nothing is certain.

use std::cmp::Ordering;

use glam::DVec3;

use crate::geometry::Estimate;
use crate::geometry::double_double::{U, in_range};
use crate::geometry::triangle::certified::{greater, largest};
use crate::geometry::triangle::edge_functions;

/// The edge functions of a line and a triangle, and the distance to its plane, with bounds.
///
/// [`EdgeBounds::may_cross`] needs no division, so that a packet can stop early when all of its rays
/// certainly miss.
#[derive(Clone, Copy, Debug)]
pub struct EdgeBounds {
    functions: [f64; 3],
    /// The bound of the error of each function; infinite where nothing is certain.
    error: f64,
    /// The change of each function for a unit by which the line is displaced.
    displacement: f64,
    numerator: f64,
    numerator_error: f64,
    denominator: f64,
    denominator_error: f64,
    /// The s and the w of the bounds.
    size: f64,
    area: f64,
}

impl EdgeBounds {
    /// Evaluates the edge functions and their bounds for the line `origin + t·direction`.
    #[inline(always)]
    pub fn new(triangle: [DVec3; 3], origin: DVec3, direction: DVec3) -> Self {
        let (a, b, c) = (triangle[0] - origin, triangle[1] - origin, triangle[2] - origin);
        let (first, second) = (triangle[1] - triangle[0], triangle[2] - triangle[0]);
        let normal = first.cross(second);
        // s, δ and w of the bounds above.
        let size = greater(largest(a), greater(largest(b), largest(c)));
        let direction_size = largest(direction);
        let area = largest(first) * largest(second);
        let ranges = in_range(size) & in_range(direction_size);
        Self {
            functions: edge_functions([a, b, c], direction),
            error: if ranges { 48.0 * U * direction_size * size * size } else { f64::INFINITY },
            displacement: 24.0 * direction_size * size,
            numerator: normal.dot(a),
            numerator_error: 64.0 * U * area * size,
            denominator: normal.dot(direction),
            denominator_error: 64.0 * U * area * direction_size,
            size,
            area,
        }
    }

    /// True if the line may cross the triangle: false only where it certainly misses.
    #[inline(always)]
    pub fn may_cross(&self) -> bool {
        self.may_pass_within(0.0)
    }

    /// True if the line may pass the triangle within a distance: false only where it certainly does not.
    ///
    /// A displacement of the line by η changes d·(p × q) by |d·(η × (q − p))|, at most 12 δ s |η| in
    /// largest components.
    #[inline(always)]
    pub fn may_pass_within(&self, distance: f64) -> bool {
        let [a, b, c] = self.functions;
        let error = self.error + self.displacement * distance;
        let above = (a > error) | (b > error) | (c > error);
        let below = (a < -error) | (b < -error) | (c < -error);
        !(above & below)
    }

    /// True if the line's origin may lie in the triangle's plane to within 2⁻⁴³ of the largest coordinate of
    /// the triangle and of `others`, which is at least that of the origin; false only where it certainly
    /// does not.
    #[inline(always)]
    pub fn may_start_in_plane(&self, others: f64) -> bool {
        // The vertices are at most s farther out than the origin, and the normal 2 √3 w long.
        let distance = 4096.0 * U * (others + self.size);
        // Negated for what is not a number.
        let apart = self.numerator.abs() > self.numerator_error + 4.0 * self.area * distance;
        !apart
    }

    /// The signs of the edge functions where they are certain, `Equal` where they are not.
    pub(super) fn signs(&self) -> [Ordering; 3] {
        self.functions.map(|f| (f > self.error).cmp(&(f < -self.error)))
    }

    /// The crossing of the line and the triangle, at t of either sign.
    #[inline(always)]
    pub fn estimate(&self) -> Estimate {
        let [a, b, c] = self.functions;
        let above = (a > self.error) & (b > self.error) & (c > self.error);
        let below = (a < -self.error) & (b < -self.error) & (c < -self.error);
        let inverse = 1.0 / self.denominator;
        let t = self.numerator * inverse;
        let error = 2.0 * (self.numerator_error + t.abs() * self.denominator_error) * inverse.abs();
        let sure = (above | below)
            & (self.denominator_error > SMALLEST)
            & (2.0 * self.denominator_error <= self.denominator.abs())
            & (error < f64::INFINITY);
        let misses = !self.may_cross();
        Estimate::select(misses, sure, t, error)
    }
}

/// The error of D below which the sides are so short that what their products lose to underflow would
/// count.
const SMALLEST: f64 = f64::from_bits((1023 - 700) << 52);
