//! The exact oracle: what a ray meets, in integers of any size.
//!
//! A float is an integer times a power of two, so that hit or miss is the sign of an integer and
//! needs no tolerance, and a distance is a quotient or the root of a quadratic equation, of which
//! any number of bits can be had. Nothing here is shared with `geometry`'s arithmetic: the two
//! can judge each other.
//!
//! All the numbers given must be finite; the functions panic otherwise.

mod exact;
mod integers;
mod intersector;

use std::cmp::Ordering;

use dashu_int::ops::UnsignedAbs;
use dashu_int::{IBig, Sign};
use glam::DVec3;

use crate::geometry::Ray;

pub use exact::ExactNumber;
pub use intersector::Oracle;

use integers::{Vector, common_scale, common_scale_of, cross, decode, dot, sub};

/// Where a ray crosses a triangle.
#[derive(Clone, Debug)]
pub struct Crossing {
    /// The distance, in units of the ray's |direction|.
    pub t: ExactNumber,
    /// Weight of the second vertex, correctly rounded, in \[0, 1\].
    pub u: f64,
    /// Weight of the third vertex, correctly rounded, in \[0, 1\].
    pub v: f64,
}

/// The first t with 0 < t < `ray.tmax` at which the ray meets the sphere; touching it counts.
///
/// `leaving_inward` leaves the near root out. The far root is not tried when the near one lies
/// beyond `ray.tmax`. What the ray left (`ray.from`) plays no part.
pub fn sphere(center: DVec3, radius: f64, ray: &Ray, leaving_inward: bool) -> Option<ExactNumber> {
    let line = Line::new(center, radius, ray)?;
    let near = line.root(Sign::Negative);
    if !leaving_inward && near.compare(0.0) == Ordering::Greater {
        return within(near, ray.tmax);
    }
    within(line.root(Sign::Positive), ray.tmax)
}

/// The distance of the ray's point at `t` from the sphere, in radii: 0 on it, negative inside.
///
/// The point is exact; the distance is rounded to about 15 digits.
pub fn height(center: DVec3, radius: f64, ray: &Ray, t: f64) -> f64 {
    let ([center, origin], scale) = common_scale_of([center, ray.origin]);
    let ([direction], direction_scale) = common_scale_of([ray.direction]);
    let (t, t_scale) = decode(t);
    let (r, r_scale) = decode(radius);
    let way = direction.map(|x| x * IBig::from(t));
    let way_scale = direction_scale + t_scale;
    let low = scale.min(way_scale).min(r_scale);
    let lift = |x: &IBig, from: i64| x << (from - low) as usize;
    let from_center: Vector =
        std::array::from_fn(|i| lift(&(&origin[i] - &center[i]), scale) + lift(&way[i], way_scale));
    let r = lift(&IBig::from(r), r_scale);
    let r2 = &r * &r;
    // |p|² / r² − 1, and from it |p| / r − 1 without cancellation.
    let excess = dot(&from_center, &from_center) - &r2;
    let sign = if excess.sign() == Sign::Negative { -1.0 } else { 1.0 };
    let quotient = (excess.unsigned_abs() << 200usize) / r2.unsigned_abs();
    let x = sign * exact::truncate(&quotient, -200);
    x / (1.0 + (1.0 + x).sqrt())
}

/// Where the ray meets the plane through `point` with normal `normal`, of any length, at
/// 0 < t < `ray.tmax`; a ray along the plane does not meet it.
pub fn plane(point: DVec3, normal: DVec3, ray: &Ray) -> Option<ExactNumber> {
    let ([point, origin], scale) = common_scale_of([point, ray.origin]);
    let ([normal], _) = common_scale_of([normal]);
    let ([direction], direction_scale) = common_scale_of([ray.direction]);
    let toward = dot(&normal, &direction);
    if toward.is_zero() {
        return None;
    }
    let away = dot(&normal, &sub(&point, &origin));
    within(ExactNumber::quotient(away, toward, scale - direction_scale), ray.tmax)
}

/// Where the ray meets the plane through three points, at 0 < t < `ray.tmax`; `None` also when the
/// points lie on a line.
pub fn plane_of(corners: [DVec3; 3], ray: &Ray) -> Option<ExactNumber> {
    Facet::new(corners, ray).t(ray.tmax)
}

/// Where the ray crosses the triangle at 0 < t < `ray.tmax`.
///
/// A line along the triangle's plane does not cross it, and nothing crosses a degenerate one. A
/// line through an edge or a vertex is decided by one rule for all triangles: the origin counts as
/// moved by (ε, ε², ε³) with ε > 0 and beyond all measure small, so that of the triangles at an
/// edge or a vertex exactly one of each sheet is crossed.
pub fn triangle(corners: [DVec3; 3], ray: &Ray) -> Option<Crossing> {
    let facet = Facet::new(corners, ray);
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

/// A ray and three points, in integers.
struct Facet {
    corners: [Vector; 3],
    origin: Vector,
    direction: Vector,
    /// d·n, with n across the plane of the points.
    toward: IBig,
    /// n·(a − o): the distance is this over d·n.
    away: IBig,
    exponent: i64,
}

impl Facet {
    fn new([a, b, c]: [DVec3; 3], ray: &Ray) -> Self {
        let ([a, b, c, origin], scale) = common_scale_of([a, b, c, ray.origin]);
        let ([direction], direction_scale) = common_scale_of([ray.direction]);
        let normal = cross(&sub(&b, &a), &sub(&c, &a));
        let (toward, away) = (dot(&direction, &normal), dot(&normal, &sub(&a, &origin)));
        let exponent = scale - direction_scale;
        Self { corners: [a, b, c], origin, direction, toward, away, exponent }
    }

    fn t(&self, tmax: f64) -> Option<ExactNumber> {
        if self.toward.is_zero() {
            return None;
        }
        within(ExactNumber::quotient(self.away.clone(), self.toward.clone(), self.exponent), tmax)
    }
}

/// On which side a line passes an edge.
struct Edge {
    /// det(d, p − o, q − o).
    function: IBig,
    /// Its sign for the moved origin.
    side: Sign,
}

impl Edge {
    fn new(p: &Vector, q: &Vector, facet: &Facet) -> Self {
        let Facet { origin, direction, .. } = facet;
        let function = dot(direction, &cross(&sub(p, origin), &sub(q, origin)));
        // Moving the origin by δ adds δ · (d × (q − p)); the powers of ε come one after another.
        let shift = cross(direction, &sub(q, p));
        let side = std::iter::once(&function)
            .chain(&shift)
            .find(|x| !x.is_zero())
            .map_or(Sign::Positive, IBig::sign);
        Self { function, side }
    }
}

/// A line beside a sphere: a t² − 2 h t + c = 0.
struct Line {
    a: IBig,
    h: IBig,
    /// h² − a c, not negative.
    discriminant: IBig,
    /// A root of the integers counts 2 to the power of this.
    exponent: i64,
}

impl Line {
    fn new(center: DVec3, radius: f64, ray: &Ray) -> Option<Self> {
        let (all, scale) = {
            let [c, o] = [center, ray.origin];
            common_scale([c.x, c.y, c.z, o.x, o.y, o.z, radius])
        };
        let [cx, cy, cz, ox, oy, oz, radius] = all;
        let ([direction], direction_scale) = common_scale_of([ray.direction]);
        let to_center = [cx - ox, cy - oy, cz - oz];
        let a = dot(&direction, &direction);
        let h = dot(&to_center, &direction);
        let c = dot(&to_center, &to_center) - &radius * &radius;
        let discriminant = &h * &h - &a * c;
        let crosses = !a.is_zero() && discriminant.sign() == Sign::Positive;
        crosses.then(|| Self { a, h, discriminant, exponent: scale - direction_scale })
    }

    fn root(&self, which: Sign) -> ExactNumber {
        let radicand = self.discriminant.clone().unsigned_abs();
        ExactNumber::root(self.h.clone(), which, radicand, self.a.clone(), self.exponent)
    }
}

/// The distance, if it lies within 0 < t < `tmax`.
fn within(t: ExactNumber, tmax: f64) -> Option<ExactNumber> {
    let inside = t.compare(0.0) == Ordering::Greater && t.compare(tmax) == Ordering::Less;
    inside.then_some(t)
}
