//! The exact oracle: ray intersections in integers of any size.
//!
//! A float is an integer times a power of two. So hit or miss is the sign of an integer and needs no
//! tolerance, and a distance is a quotient or the root of a quadratic equation, which can be computed
//! to any number of bits. The oracle shares no arithmetic with `geometry`, so that each can check the
//! other.
//!
//! All arguments must be finite; the functions panic otherwise.

mod ends;
mod exact_number;
mod integers;
mod intersector;

use std::cmp::Ordering;

use dashu_int::ops::UnsignedAbs;
use dashu_int::{IBig, Sign};
use glam::DVec3;

use crate::geometry::Ray;

pub use exact_number::ExactNumber;
pub use intersector::Oracle;

use integers::{IntegerVector, common_scale, cross, decode, dot, sub};

/// The point at which a ray crosses a triangle.
#[derive(Clone, Debug)]
pub struct Crossing {
    /// The distance, in units of the ray's |direction|.
    pub t: ExactNumber,
    /// The weight of the second vertex, correctly rounded, in \[0, 1\].
    pub u: f64,
    /// The weight of the third vertex, correctly rounded, in \[0, 1\].
    pub v: f64,
}

/// Returns the first t with 0 < t < `ray.tmax` at which the ray hits the sphere; a tangent
/// hits it.
///
/// `leaving_inward` skips the near root. The far root is not tried when the near one lies beyond
/// `ray.tmax`. The ray's departure is ignored.
pub fn sphere(center: DVec3, radius: f64, ray: &Ray, leaving_inward: bool) -> Option<ExactNumber> {
    let equation = Quadratic::new(center, radius, ray)?;
    let near = equation.root(Sign::Negative);
    if !leaving_inward && near.compare(0.0) == Ordering::Greater {
        return within(near, ray.tmax);
    }
    within(equation.root(Sign::Positive), ray.tmax)
}

/// Returns the signed distance of the ray's point at `t` from the sphere, in radii: 0 on it,
/// negative inside.
///
/// The point is exact; the distance is rounded to about 15 digits.
pub fn signed_distance(center: DVec3, radius: f64, ray: &Ray, t: f64) -> f64 {
    // The point's way from the ray's origin: t times the direction.
    let ([center, origin], scale) = common_scale([center, ray.origin]);
    let ([direction], direction_scale) = common_scale([ray.direction]);
    let (t, t_scale) = decode(t);
    let (r, r_scale) = decode(radius);
    let way = direction.map(|x| x * IBig::from(t));
    let way_scale = direction_scale + t_scale;
    // The point relative to the centre, and the radius, in the same units.
    let low = scale.min(way_scale).min(r_scale);
    let lift = |x: &IBig, from: i64| x << (from - low) as usize;
    let from_center: IntegerVector =
        std::array::from_fn(|i| lift(&(&origin[i] - &center[i]), scale) + lift(&way[i], way_scale));
    let r = lift(&IBig::from(r), r_scale);
    let r2 = &r * &r;
    // |p|² / r² − 1, and from it |p| / r − 1 without cancellation.
    let excess = dot(&from_center, &from_center) - &r2;
    let sign = if excess.sign() == Sign::Negative { -1.0 } else { 1.0 };
    let quotient = (excess.unsigned_abs() << 200usize) / r2.unsigned_abs();
    let x = sign * exact_number::truncate(&quotient, -200);
    x / (1.0 + (1.0 + x).sqrt())
}

/// Returns where the ray hits the plane through `point` with a `normal` of any length, at
/// 0 < t < `ray.tmax`; a ray parallel to the plane does not hit it.
pub fn plane(point: DVec3, normal: DVec3, ray: &Ray) -> Option<ExactNumber> {
    let ([point, origin], scale) = common_scale([point, ray.origin]);
    let ([normal], _) = common_scale([normal]);
    let ([direction], direction_scale) = common_scale([ray.direction]);
    let toward = dot(&normal, &direction);
    if toward.is_zero() {
        return None;
    }
    let away = dot(&normal, &sub(&point, &origin));
    within(ExactNumber::quotient(away, toward, scale - direction_scale), ray.tmax)
}

/// Returns where the ray hits the plane of a triangle, at 0 < t < `ray.tmax`; none also for a
/// degenerate triangle.
pub fn triangle_plane(corners: [DVec3; 3], ray: &Ray) -> Option<ExactNumber> {
    RayTriangle::new(corners, ray).t(ray.tmax)
}

/// Returns where the ray crosses the triangle at 0 < t < `ray.tmax`.
///
/// A line along the triangle's plane does not cross it, and nothing crosses a degenerate one. A
/// line through an edge or a vertex is decided by one rule for all triangles: the origin counts as
/// moved by (ε, ε², ε³) with an infinitesimal ε > 0 (simulation of simplicity), so that of the
/// triangles at an edge or a vertex exactly one of each sheet is crossed.
pub fn triangle(corners: [DVec3; 3], ray: &Ray) -> Option<Crossing> {
    let facet = RayTriangle::new(corners, ray);
    let t = facet.t(ray.tmax)?;
    let [a, b, c] = &facet.corners;
    let edges = [(b, c), (c, a), (a, b)].map(|(p, q)| Edge::new(p, q, &facet));
    if edges[0].side != edges[1].side || edges[1].side != edges[2].side {
        return None;
    }
    // The edge functions add up to d·n.
    let weight = |edge: &Edge| {
        if edge.function.is_zero() {
            return 0.0;
        }
        ExactNumber::quotient(edge.function.clone(), facet.toward.clone(), 0).to_f64()
    };
    Some(Crossing { t, u: weight(&edges[1]), v: weight(&edges[2]) })
}

/// A ray and the corners of a triangle, in integers.
struct RayTriangle {
    corners: [IntegerVector; 3],
    origin: IntegerVector,
    direction: IntegerVector,
    /// d·n, with n the normal of the triangle's plane.
    toward: IBig,
    /// n·(a − o): the distance is this over d·n.
    away: IBig,
    exponent: i64,
}

impl RayTriangle {
    fn new([a, b, c]: [DVec3; 3], ray: &Ray) -> Self {
        let ([a, b, c, origin], scale) = common_scale([a, b, c, ray.origin]);
        let ([direction], direction_scale) = common_scale([ray.direction]);
        let normal = cross(&sub(&b, &a), &sub(&c, &a));
        let (toward, away) = (dot(&direction, &normal), dot(&normal, &sub(&a, &origin)));
        let exponent = scale - direction_scale;
        Self { corners: [a, b, c], origin, direction, toward, away, exponent }
    }

    /// Returns the distance of the triangle's plane.
    fn t(&self, tmax: f64) -> Option<ExactNumber> {
        if self.toward.is_zero() {
            return None;
        }
        within(ExactNumber::quotient(self.away.clone(), self.toward.clone(), self.exponent), tmax)
    }
}

/// The side on which a line passes an edge.
struct Edge {
    /// det(d, p − o, q − o).
    function: IBig,
    /// Its sign for the moved origin.
    side: Sign,
}

impl Edge {
    fn new(p: &IntegerVector, q: &IntegerVector, facet: &RayTriangle) -> Self {
        let RayTriangle { origin, direction, .. } = facet;
        let function = dot(direction, &cross(&sub(p, origin), &sub(q, origin)));
        // Moving the origin by δ adds δ · (d × (q − p)); a lower power of ε outweighs a higher one.
        let shift = cross(direction, &sub(q, p));
        let mut powers = std::iter::once(&function).chain(&shift);
        let side = powers.find(|x| !x.is_zero()).map_or(Sign::Positive, IBig::sign);
        Self { function, side }
    }
}

/// The quadratic equation a t² − 2 h t + c = 0 of a ray and a sphere.
struct Quadratic {
    a: IBig,
    h: IBig,
    /// h² − a c, not negative.
    discriminant: IBig,
    /// The exponent of the power of two by which a root of the integers is multiplied.
    exponent: i64,
}

impl Quadratic {
    /// Sets up the equation; none if the line misses the sphere.
    fn new(center: DVec3, radius: f64, ray: &Ray) -> Option<Self> {
        let ([center, origin, [radius, ..]], scale) =
            common_scale([center, ray.origin, DVec3::splat(radius)]);
        let ([direction], direction_scale) = common_scale([ray.direction]);
        let to_center = sub(&center, &origin);
        let a = dot(&direction, &direction);
        let h = dot(&to_center, &direction);
        let c = dot(&to_center, &to_center) - &radius * &radius;
        let discriminant = &h * &h - &a * c;
        let crosses = !a.is_zero() && discriminant.sign() == Sign::Positive;
        crosses.then(|| Self { a, h, discriminant, exponent: scale - direction_scale })
    }

    fn root(&self, root: Sign) -> ExactNumber {
        let (rational, denominator) = (self.h.clone(), self.a.clone());
        let radicand = self.discriminant.clone().unsigned_abs();
        ExactNumber { rational, root, radicand, denominator, exponent: self.exponent }
    }
}

/// Returns the distance if it lies within 0 < t < `tmax`.
fn within(t: ExactNumber, tmax: f64) -> Option<ExactNumber> {
    let inside = t.compare(0.0) == Ordering::Greater && t.compare(tmax) == Ordering::Less;
    inside.then_some(t)
}
