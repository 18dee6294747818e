//! The intersection of a ray with a triangle as exact arithmetic finds it.
//!
//! There are three stages, each of which passes on what it cannot decide: [`EdgeBounds`] bounds edge
//! functions and t in f64, `round` computes in double-double numbers, and `exact` with integers.
//!
//! **The tie rule.** The line crosses the triangle when its three edge functions have one sign.
//! Where one is exactly 0, the line touches the edge, and the sign is that for an origin moved by
//! (ε, ε², ε³), ε → 0⁺: the first of the components of d × (q − p) that is not 0. (Edelsbrunner
//! and Mücke, *Simulation of Simplicity*, ACM TOG 1990.) It is one displacement for all triangles,
//! so two that share an edge still see opposite signs, and a line through an edge or a vertex
//! crosses a closed mesh an even number of times. t is that of the line itself. A line parallel to
//! the triangle misses it, and a degenerate triangle is never hit.
//!
//! ```
//! use envers::internals::triangle::certified::crossing;
//! use glam::DVec3;
//!
//! // A ray through the edge that two triangles share hits one of them.
//! let (a, b, c, d) = (DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0));
//! let origin = DVec3::new(0.5, 0.5, 1.0);
//! let hits = [[a, b, c], [d, c, b]].map(|t| crossing(t, origin, -DVec3::Z, f64::INFINITY));
//! assert_eq!(hits.iter().flatten().count(), 1);
//! ```

mod edge_bounds;
mod exact;
mod round;
#[cfg(test)]
mod tests;

pub use edge_bounds::EdgeBounds;
pub use round::{RoundedHit, round};

use glam::DVec3;

use crate::geometry::Estimate;
use crate::geometry::triangle::TriangleHit;

/// The crossing of the line and the triangle, at t of either sign, in f64 with a bound on its error.
#[inline(always)]
pub fn estimate(triangle: [DVec3; 3], origin: DVec3, direction: DVec3) -> Estimate {
    EdgeBounds::new(triangle, origin, direction).estimate()
}

/// The crossing of the ray and the triangle, with 0 < t < `tmax`; t correctly rounded.
///
/// The arguments count as exact numbers, and the comparisons are those of the exact t; the result
/// is the f64 nearest to it (ties to even), but neither 0 nor infinite. The weights are within 4 ulp
/// of 1 of the exact ones and in \[0, 1\]. A ray without a direction, or one that is not finite,
/// misses.
pub fn crossing(
    triangle: [DVec3; 3],
    origin: DVec3,
    direction: DVec3,
    tmax: f64,
) -> Option<TriangleHit> {
    // Bounds in f64 decide nearly all misses.
    let edges = EdgeBounds::new(triangle, origin, direction);
    if !edges.may_cross() {
        return None;
    }
    let estimate = edges.estimate();
    if estimate.upper() <= 0.0 || estimate.lower() >= tmax {
        return None;
    }
    // Where they leave open whether the line crosses, integers decide that.
    let finite =
        triangle.iter().all(|p| p.is_finite()) && origin.is_finite() && direction.is_finite();
    if estimate.error == f64::INFINITY
        && !(finite && exact::crosses(triangle, origin, direction, edges.signs()))
    {
        return None;
    }
    // Double-double numbers round nearly all distances correctly. Where the rounded t is tmax
    // itself, the exact one may lie on either side.
    let rounded = round(triangle, origin, direction);
    if rounded.is_certain && rounded.t != tmax {
        let RoundedHit { t, u, v, .. } = rounded;
        return (t > 0.0 && t < tmax).then_some(TriangleHit { t, u, v });
    }
    // Integers round the rest.
    let hit = exact::crossing(triangle, origin, direction, tmax)?;
    // The weights must not depend on tmax.
    let (u, v) = if rounded.is_certain { (rounded.u, rounded.v) } else { (hit.u, hit.v) };
    Some(TriangleHit { t: hit.t, u, v })
}

/// The greater of two numbers, by a comparison that vectorises; not meaningful for NaN.
#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The largest absolute component of a vector.
#[inline(always)]
fn largest(v: DVec3) -> f64 {
    greater(v.x.abs(), greater(v.y.abs(), v.z.abs()))
}
