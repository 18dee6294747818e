//! The ends of rays in exact arithmetic: which surfaces these lie on, and which of them block a shadow
//! ray at its origin. The rule is that of `intersect::ray_ends`, and shares no code with it.

use dashu_int::{IBig, Sign};
use glam::DVec3;

use super::ExactNumber;
use super::integers::{IntegerVector, common_scale, cross, dot, sub};
use crate::geometry::{Geometry, PrimitiveId, Ray, Side};
use crate::scene::Scene;

/// The way in which a ray leaves a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// A ray that starts somewhere else.
    Elsewhere,
    /// A ray that starts on the surface, and has no other crossing with it ahead.
    Leaves,
    /// A ray that starts on a sphere and goes into it.
    Enters,
}

/// Returns how a ray leaves the surface of a primitive.
pub fn start(scene: &Scene, id: PrimitiveId, ray: &Ray) -> Start {
    let Some(from) = ray.departure else { return Start::Elsewhere };
    let is_sphere = id.geometry == Geometry::Spheres;
    if from.id == id {
        return if is_sphere && from.side == Side::Back { Start::Enters } else { Start::Leaves };
    }
    let slack = origin_slack(scene, id, ray);
    if !Contact::new(scene, id, ray.origin, slack).is_on_surface() {
        return Start::Elsewhere;
    }
    if is_sphere && enters(scene, id, ray.origin, ray.direction, slack) {
        return Start::Enters;
    }
    Start::Leaves
}

/// True if the surface of a primitive, other than the one it left, separates the light of a shadow ray
/// from its viewer at the ray's origin.
pub fn blocks_origin(scene: &Scene, id: PrimitiveId, ray: &Ray) -> bool {
    let (Some(ends), Some(from)) = (ray.shadow, ray.departure) else { return false };
    // The faces at a vertex are judged together, also from somewhat farther off than rounding.
    let reach = if matches!(id.geometry, Geometry::Mesh(_)) { 16.0 } else { 1.0 };
    let contact = Contact::new(scene, id, ray.origin, reach * origin_slack(scene, id, ray));
    from.id != id && contact.is_on_surface() && contact.separates(ends.viewer, ray.direction)
}

/// True if a shadow ray ends on the surface of a primitive, at its far root if it is a sphere.
pub fn ends_on(scene: &Scene, id: PrimitiveId, ray: &Ray, is_far_root: bool) -> bool {
    if ray.shadow.is_none() || ray.tmax == f64::INFINITY {
        return false;
    }
    let end = ray.origin + ray.direction * ray.tmax;
    let slack = slack(&[coordinate(ray.origin), coordinate(end), extent(scene, id)]);
    Contact::new(scene, id, end, slack).is_on_surface()
        && (id.geometry != Geometry::Spheres
            || is_far_root
            || !enters(scene, id, end, -ray.direction, slack))
}

/// Returns the weights of the second and third corner at a point of a triangle, correctly rounded, in
/// \[0, 1\].
pub fn weights(corners: [DVec3; 3], point: DVec3) -> (f64, f64) {
    let [a, b, c] = corners;
    let ([a, b, c, point], _) = common_scale([a, b, c, point]);
    let (first, second, offset) = (sub(&b, &a), sub(&c, &a), sub(&point, &a));
    let normal = cross(&first, &second);
    let weight = |x: &IntegerVector, y: &IntegerVector| {
        let area = dot(&cross(x, y), &normal);
        if area <= IBig::ZERO {
            return 0.0;
        }
        ExactNumber::quotient(area, dot(&normal, &normal), 0).to_f64().min(1.0)
    };
    (weight(&offset, &second), weight(&first, &offset))
}

/// Returns 2⁻⁴⁷ times the largest of the sizes.
fn slack(sizes: &[f64]) -> f64 {
    sizes.iter().copied().fold(0.0, f64::max) / (1u64 << 47) as f64
}

fn origin_slack(scene: &Scene, id: PrimitiveId, ray: &Ray) -> f64 {
    let left = ray.departure.map_or(0.0, |from| extent(scene, from.id));
    slack(&[coordinate(ray.origin), left, extent(scene, id)])
}

fn coordinate(p: DVec3) -> f64 {
    p.x.abs().max(p.y.abs()).max(p.z.abs())
}

/// Returns the largest coordinate of a sphere's box or of a triangle; 0 for a plane.
fn extent(scene: &Scene, id: PrimitiveId) -> f64 {
    match id.geometry {
        Geometry::Planes => 0.0,
        Geometry::Spheres => {
            let s = &scene.spheres[id.primitive as usize];
            coordinate(s.center) + s.radius
        }
        Geometry::Mesh(_) => {
            scene.triangle_vertices(id).map(coordinate).into_iter().fold(0.0, f64::max)
        }
    }
}

/// True if a ray from a point on a sphere goes into it by a chord of more than twice the slack.
fn enters(scene: &Scene, id: PrimitiveId, point: DVec3, direction: DVec3, slack: f64) -> bool {
    let s = &scene.spheres[id.primitive as usize];
    let ([center, point, slack], _) = common_scale([s.center, point, DVec3::splat(slack)]);
    let ([direction], _) = common_scale([direction]);
    let depth = dot(&sub(&center, &point), &direction);
    depth > IBig::ZERO && &depth * &depth > &slack[0] * &slack[0] * dot(&direction, &direction)
}

/// A point and a surface, in integers.
struct Contact {
    shape: ContactShape,
    point: IntegerVector,
    slack: IBig,
}

enum ContactShape {
    Sphere { center: IntegerVector, radius: IBig },
    Plane { on: IntegerVector, normal: IntegerVector },
    Triangle { corners: [IntegerVector; 3], normal: IntegerVector },
}

impl Contact {
    fn new(scene: &Scene, id: PrimitiveId, point: DVec3, slack: f64) -> Self {
        let slack = DVec3::splat(slack);
        let index = id.primitive as usize;
        match id.geometry {
            Geometry::Spheres => {
                let s = &scene.spheres[index];
                let all = [s.center, DVec3::splat(s.radius), point, slack];
                let ([center, [radius, ..], point, [slack, ..]], _) = common_scale(all);
                Self { shape: ContactShape::Sphere { center, radius }, point, slack }
            }
            Geometry::Planes => {
                let p = &scene.planes[index];
                let ([on, point, [slack, ..]], _) = common_scale([p.point, point, slack]);
                let ([normal], _) = common_scale([p.normal]);
                Self { shape: ContactShape::Plane { on, normal }, point, slack }
            }
            Geometry::Mesh(_) => {
                let [a, b, c] = scene.triangle_vertices(id);
                let ([a, b, c, point, [slack, ..]], _) = common_scale([a, b, c, point, slack]);
                let normal = cross(&sub(&b, &a), &sub(&c, &a));
                Self { shape: ContactShape::Triangle { corners: [a, b, c], normal }, point, slack }
            }
        }
    }

    /// True if the point lies within the slack of the sphere or of the plane.
    fn is_on_surface(&self) -> bool {
        match &self.shape {
            ContactShape::Sphere { center, radius } => {
                let offset = sub(&self.point, center);
                let square = dot(&offset, &offset);
                let (low, high) = (radius - &self.slack, radius + &self.slack);
                square <= &high * &high && (low <= IBig::ZERO || square >= &low * &low)
            }
            ContactShape::Plane { on, normal } => self.is_level(normal, on),
            ContactShape::Triangle { corners, normal } => self.is_level(normal, &corners[0]),
        }
    }

    /// True if the point lies within the slack of the plane through `on` with this normal.
    fn is_level(&self, normal: &IntegerVector, on: &IntegerVector) -> bool {
        let height = dot(normal, &sub(&self.point, on));
        &height * &height <= &self.slack * &self.slack * dot(normal, normal)
    }

    /// True if the surface, on which the point lies, is crossed by a ray along `direction` from the point
    /// displaced toward the viewer, and by far smaller steps along the axes.
    fn separates(&self, viewer: DVec3, direction: DVec3) -> bool {
        let ([viewer], _) = common_scale([viewer]);
        let ([direction], _) = common_scale([direction]);
        // In integers the displacement is v·2³ᴷ + (2²ᴷ, 2ᴷ, 1): with K large enough each term outweighs
        // those after it in any of the products below.
        let bits =
            |v: &IntegerVector| v.iter().map(dashu_int::ops::BitTest::bit_len).max().unwrap_or(0);
        let normal = match &self.shape {
            ContactShape::Sphere { center, .. } => sub(&self.point, center),
            ContactShape::Plane { normal, .. } | ContactShape::Triangle { normal, .. } => {
                normal.clone()
            }
        };
        let k = 64 + 4 * (bits(&viewer) + bits(&direction) + bits(&normal) + bits(&self.point));
        let k = match &self.shape {
            ContactShape::Triangle { corners, .. } => {
                k + 4 * corners.iter().map(bits).max().unwrap_or(0)
            }
            _ => k,
        };
        let displacement: IntegerVector =
            std::array::from_fn(|i| (&viewer[i] << (3 * k)) + (IBig::from(1) << (k * (2 - i))));
        let (start, slope) = (dot(&normal, &displacement), dot(&normal, &direction));
        if slope.is_zero() || start.is_zero() || start.sign() == slope.sign() {
            return false;
        }
        let ContactShape::Triangle { corners, .. } = &self.shape else { return true };
        // Where it crosses the plane, relative to the point, times |slope|.
        let sign = if slope.sign() == Sign::Negative { IBig::from(-1) } else { IBig::from(1) };
        let crossing: IntegerVector =
            std::array::from_fn(|i| (&displacement[i] * &slope - &direction[i] * &start) * &sign);
        let edges = [(0, 1), (1, 2), (2, 0)];
        edges.into_iter().all(|(p, q)| {
            let inward = cross(&normal, &sub(&corners[q], &corners[p]));
            if self.is_level(&inward, &corners[p]) {
                return dot(&inward, &crossing) >= IBig::ZERO;
            }
            dot(&inward, &sub(&self.point, &corners[p])) > IBig::ZERO
        })
    }
}
