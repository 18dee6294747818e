//! The crossing of a line and the plane of a triangle in double-double numbers, with bounds.
//!
//! With the sides e₁ = v₁ − v₀, e₂ = v₂ − v₀ and a = v₀ − o, all exact, n = e₁ × e₂ and q = a × d:
//! t = n·a / n·d, u = q·e₂ / n·d and v = −q·e₁ / n·d (Möller and Trumbore, *Fast, Minimum Storage
//! Ray/Triangle Intersection*, 1997).
//!
//! Each operation has the relative error ω = 8u². A determinant of three vectors with the largest
//! components α, β, γ: a product is off by ωαβ, a component of the vector product, at most 2αβ in
//! size, by 4ωαβ, a term of the sum by 6ωαβγ, and the sum of three with two roundings by 28ωαβγ.
//! The bound is 32ωαβγ. Where it is at most u|n·d| for weights and divisor, a weight carries this
//! twice and four roundings: 6u, or 3 ulp of the numbers just below 1.

use glam::DVec3;

use crate::geometry::double_double::{DoubleDouble, OMEGA, U, cross, difference, dot, in_range};
use crate::geometry::triangle::certified::{greater, largest};

/// The crossing that [`round`] finds, and whether it is proven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundedHit {
    /// The distance, in units of |direction|; of either sign.
    pub t: f64,
    /// The barycentric weight of the second vertex.
    pub u: f64,
    /// The barycentric weight of the third vertex.
    pub v: f64,
    /// True if the exact distance rounds to `t`, and the weights are those of
    /// [`crossing`](super::crossing).
    pub is_certain: bool,
}

/// The crossing of a line that crosses the triangle; t correctly rounded where `is_certain`.
///
/// It has no branches, for loops over the lanes of a packet, and does not test whether the line
/// crosses: where it does not, t is that of the plane and the weights are clamped.
#[inline(always)]
pub fn round(triangle: [DVec3; 3], origin: DVec3, direction: DVec3) -> RoundedHit {
    let first = difference(triangle[1], triangle[0]);
    let second = difference(triangle[2], triangle[0]);
    let a = difference(triangle[0], origin);
    let d = direction.to_array();
    let normal = cross(first, second);
    let moment = cross(a, d);

    // The largest components of the vectors, for the bounds above.
    let (size, direction_size) = (largest_hi(a), largest(direction));
    let (width, height) = (largest_hi(first), largest_hi(second));
    let bound = 32.0 * OMEGA * width * height;

    // t, and the weights where the bounds are tight enough.
    let divisor = dot(normal, d);
    let divisor_error = bound * direction_size;
    let (t, error) = dot(normal, a).quotient(bound * size, divisor, divisor_error);
    let inverse = 1.0 / divisor.hi;
    let weight_error =
        greater(32.0 * OMEGA * size * greater(width, height) * direction_size, divisor_error);
    let is_certain = (weight_error <= U * divisor.hi.abs())
        & t.rounds_to_hi(error)
        & in_range(size)
        & in_range(direction_size)
        & in_range(width)
        & in_range(height);
    RoundedHit {
        t: t.hi,
        u: clamp(dot(moment, second).hi * inverse),
        v: clamp(-dot(moment, first).hi * inverse),
        is_certain,
    }
}

/// The largest absolute component of a vector of double-doubles.
#[inline(always)]
fn largest_hi(v: [DoubleDouble; 3]) -> f64 {
    largest(DVec3::new(v[0].hi, v[1].hi, v[2].hi))
}

/// Clamps a weight to \[0, 1\]; −0 becomes 0.
#[inline(always)]
fn clamp(x: f64) -> f64 {
    let above = if x > 0.0 { x } else { 0.0 };
    if above < 1.0 { above } else { 1.0 }
}
