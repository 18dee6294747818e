//! Ray and triangle, proven: the answer of exact arithmetic.
//!
//! Three stages, each passing on what it cannot decide: [`Edges`] bounds edge functions and t in
//! f64, [`round`] works in double-double numbers, and `exact` with integers.
//!
//! **The tie rule.** The line crosses the triangle when its three edge functions have one sign.
//! Where one is exactly 0, the line meets the edge, and the sign is that for an origin moved by
//! (ε, ε², ε³), ε → 0⁺: the first of the components of d × (q − p) that is not 0. (Edelsbrunner
//! and Mücke, *Simulation of Simplicity*, ACM TOG 1990.) It is one displacement for all triangles,
//! so two that share an edge still see opposite signs, and a line through an edge or a vertex
//! crosses a closed mesh an even number of times. t is that of the line itself. A line parallel to
//! the triangle misses it, and a degenerate triangle is never met.

mod edges;
mod exact;
mod round;
#[cfg(test)]
mod tests;

pub use edges::EdgeBounds;
pub use round::{RoundedHit, round};

use glam::DVec3;

use crate::geometry::Estimate;
use crate::geometry::triangle::TriangleHit;

/// Where the line crosses the triangle, as f64 arithmetic can bound it; behind the origin too.
#[inline(always)]
pub fn estimate(triangle: [DVec3; 3], origin: DVec3, direction: DVec3) -> Estimate {
    EdgeBounds::new(triangle, origin, direction).estimate()
}

/// Where the ray crosses the triangle with 0 < t < `tmax`, exactly; t correctly rounded.
///
/// The numbers given are taken as they stand and the comparisons are those of the exact t; what
/// is returned is the nearest f64 (ties to even), but neither 0 nor infinite. The weights are
/// within 4 ulp of 1 of the exact ones and in \[0, 1\]. A ray without a direction, or one that is
/// not finite, meets nothing.
pub fn crossing(
    triangle: [DVec3; 3],
    origin: DVec3,
    direction: DVec3,
    tmax: f64,
) -> Option<TriangleHit> {
    let edges = EdgeBounds::new(triangle, origin, direction);
    if !edges.may_cross() {
        return None;
    }
    let estimate = edges.estimate();
    if estimate.upper() <= 0.0 || estimate.lower() >= tmax {
        return None;
    }
    let finite =
        triangle.iter().all(|p| p.is_finite()) && origin.is_finite() && direction.is_finite();
    if estimate.error == f64::INFINITY
        && !(finite && exact::crosses(triangle, origin, direction, edges.signs()))
    {
        return None;
    }
    let rounded = round(triangle, origin, direction);
    // Where the rounded t is tmax itself, the exact one may lie on either side.
    if rounded.is_certain && rounded.t != tmax {
        let RoundedHit { t, u, v, .. } = rounded;
        return (t > 0.0 && t < tmax).then_some(TriangleHit { t, u, v });
    }
    let hit = exact::crossing(triangle, origin, direction, tmax)?;
    // The weights must not depend on tmax.
    let (u, v) = if rounded.is_certain { (rounded.u, rounded.v) } else { (hit.u, hit.v) };
    Some(TriangleHit { t: hit.t, u, v })
}
