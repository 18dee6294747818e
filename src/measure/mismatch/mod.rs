//! The classification of mismatches: rays on which precision `fast` and exact arithmetic disagree.
//!
//! An f32 ray stays within a margin of the exact one (derived in
//! `intersect/embree/f32_space.rs`), which an instance's object space may magnify. So a mismatch is
//! explained for a triangle whose edge the ray passes within that margin, and for two surfaces that
//! lie, along the ray, closer together than the margin divided by the cosine of the angle of incidence.
//!
//! Spheres and planes are intersected in f64 in either precision. Let f be the vector from a sphere's
//! centre to the ray's origin and r its radius: the formula of `geometry::sphere`
//! rounds f, its dot product with the direction, the quotient by |d|² and the nearest point,
//! together by 6 ε |f| to first order, and squares r. So its distance of the line from the centre is
//! off by at most 8 ε (|f| + r). Two backends that compute so may differ by 16 ε (|f| + r), which is
//! the margin for any pair of backends. The margin of a plane is 16 ε times the coordinates involved.
//!
//! Any other mismatch is an error in one of the two.

#[cfg(test)]
mod tests;

use glam::DVec3;

use crate::geometry::{Geometry, Hit, PrimitiveId, Ray, triangle};
use crate::intersect::{Precision, primitive::Primitives};
use crate::scene::Scene;

/// The explanation of a mismatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MismatchCause {
    /// The ray passes the edge of a triangle within the margin.
    Edge,
    /// The ray touches a sphere, to within the rounding of f64.
    Tangency,
    /// Two surfaces, or a surface and the end of a shadow ray, lie within the margin of each other.
    Tie,
}

impl MismatchCause {
    /// Returns the name: `edge`, `tangency` or `tie`.
    pub const fn name(self) -> &'static str {
        match self {
            MismatchCause::Edge => "edge",
            MismatchCause::Tangency => "tangency",
            MismatchCause::Tie => "tie",
        }
    }
}

/// The margin of f64 formulas for a sphere or a plane, relative to the coordinates involved.
const F64_MARGIN: f64 = 16.0 * f64::EPSILON;

/// A classifier of mismatches in one scene.
pub struct MismatchClassifier<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The greatest distance of an f32 ray from the exact one, in world units: `Embree::margin`.
    pub margin: f64,
}

/// The outcome for a shadow ray and one primitive.
enum Occlusion {
    /// The primitive certainly does not block the ray.
    Clear,
    /// The primitive certainly blocks the ray.
    Blocked,
    /// Either outcome is within the margin.
    Uncertain(MismatchCause),
}

impl MismatchClassifier<'_> {
    /// Returns what explains that two backends find different closest hits of a ray; none for an
    /// unexplained mismatch.
    pub fn classify_hits(
        &self,
        ray: &Ray,
        a: Option<&Hit>,
        b: Option<&Hit>,
    ) -> Option<MismatchCause> {
        // Two surfaces that lie so close together along the ray that either may be the first.
        let hits = || [a, b].into_iter().flatten();
        if let (Some(a), Some(b)) = (a, b) {
            let cosine = hits().map(|h| self.cosine(ray, h)).fold(1.0, f64::min);
            let apart = (a.t - b.t).abs() * ray.direction.length();
            let magnified = hits().map(|h| self.primitive_margin(ray, h.id)).fold(0.0, f64::max);
            if apart * cosine <= magnified {
                return Some(MismatchCause::Tie);
            }
        }
        // A sphere or a triangle that the ray meets in one answer only, and just so.
        if hits().any(|h| self.is_tangent(ray, h.id)) {
            return Some(MismatchCause::Tangency);
        }
        hits().any(|h| self.passes_near_edge(ray, h.id)).then_some(MismatchCause::Edge)
    }

    /// Returns what explains that two backends disagree whether a shadow ray is occluded; none for an
    /// unexplained mismatch. `is_occluded` is the exact answer.
    ///
    /// Tests every primitive, which is slow: mismatches are few.
    pub fn classify_occlusion(&self, ray: &Ray, is_occluded: bool) -> Option<MismatchCause> {
        // All primitives that block light; one that certainly does decides.
        let mut cause = None;
        let spheres = (0..self.scene.spheres.len() as u32).map(PrimitiveId::sphere);
        let planes = (0..self.scene.planes.len() as u32).map(PrimitiveId::plane);
        let triangles = (0..).zip(&self.scene.instances).flat_map(|(instance, placed)| {
            let mesh = placed.mesh.0;
            let count = self.scene.meshes[mesh as usize].triangles.len() as u32;
            (0..count).map(move |t| PrimitiveId::triangle(mesh, t, instance))
        });
        for id in spheres.chain(planes).chain(triangles) {
            if !self.scene.blocks_light(id) {
                continue;
            }
            let occlusion = match id.geometry {
                Geometry::Mesh(_) => self.triangle_occlusion(ray, id),
                _ => self.sphere_or_plane_occlusion(ray, id),
            };
            match occlusion {
                // The exact ray is certainly blocked: nothing explains the other answer.
                Occlusion::Blocked if is_occluded => return None,
                Occlusion::Clear | Occlusion::Blocked => {}
                Occlusion::Uncertain(found) => cause = Some(found),
            }
        }
        cause
    }

    /// Returns the outcome for a sphere or a plane.
    fn sphere_or_plane_occlusion(&self, ray: &Ray, id: PrimitiveId) -> Occlusion {
        if self.is_tangent(ray, id) {
            return Occlusion::Uncertain(MismatchCause::Tangency);
        }
        // The hit on the unbounded ray, and where it lies relative to the ray's end.
        let primitives = Primitives { scene: self.scene, precision: Precision::Certified };
        let unbounded = Ray { tmax: f64::INFINITY, ..*ray };
        let Some(hit) = primitives.with_ray(&unbounded).primitive(id) else {
            return Occlusion::Clear;
        };
        let slack = self.t_margin(ray, &hit);
        if hit.t > ray.tmax + slack {
            return Occlusion::Clear;
        }
        occlusion_between_ends(ray, hit.t, slack)
    }

    /// True if the ray's line is a tangent of the sphere, within the margin of f64; false for other
    /// primitives.
    fn is_tangent(&self, ray: &Ray, id: PrimitiveId) -> bool {
        if id.geometry != Geometry::Spheres {
            return false;
        }
        let s = &self.scene.spheres[id.primitive as usize];
        let f = ray.origin - s.center;
        let along = f.dot(ray.direction) / ray.direction.length_squared();
        let distance = (f - ray.direction * along).length();
        (distance - s.radius).abs() <= self.primitive_margin(ray, id)
    }

    /// Returns the outcome for a triangle.
    fn triangle_occlusion(&self, ray: &Ray, id: PrimitiveId) -> Occlusion {
        if ray.departure.is_some_and(|from| from.id == id) {
            return Occlusion::Clear;
        }
        let corners = self.scene.triangle_vertices(id);
        let edges = triangle::EdgeFunctions::new(corners, ray.origin, ray.direction);
        // Whether the line passes an edge within the margin, at the triangle and not beyond its corners.
        let margin = self.primitive_margin(ray, id);
        let distances = edge_distances(&edges, corners, ray);
        let near_edge =
            distances.iter().any(|d| *d <= margin) && crosses_within(&edges, distances, margin);
        if !edges.crosses() && !near_edge {
            return Occlusion::Clear;
        }
        // The distance, relative to both ends of the ray.
        let hit = Hit { t: edges.t, u: 0.0, v: 0.0, id };
        let slack = self.t_margin(ray, &hit);
        if edges.t < -slack || edges.t > ray.tmax + slack {
            return Occlusion::Clear;
        }
        if near_edge {
            return Occlusion::Uncertain(MismatchCause::Edge);
        }
        occlusion_between_ends(ray, edges.t, slack)
    }

    /// True if the ray passes an edge of the triangle within the margin; false for other primitives.
    fn passes_near_edge(&self, ray: &Ray, id: PrimitiveId) -> bool {
        if !matches!(id.geometry, Geometry::Mesh(_)) {
            return false;
        }
        let corners = self.scene.triangle_vertices(id);
        let edges = triangle::EdgeFunctions::new(corners, ray.origin, ray.direction);
        let margin = self.primitive_margin(ray, id);
        edge_distances(&edges, corners, ray).into_iter().any(|d| d <= margin)
    }

    /// Returns the cosine of the angle between the ray and the surface normal, without its sign.
    fn cosine(&self, ray: &Ray, hit: &Hit) -> f64 {
        let index = hit.id.primitive as usize;
        let normal = match hit.id.geometry {
            Geometry::Spheres => ray.position(hit.t) - self.scene.spheres[index].center,
            Geometry::Planes => self.scene.planes[index].normal,
            Geometry::Mesh(_) => triangle::area_normal(self.scene.triangle_vertices(hit.id)),
        };
        normal.normalize_or_zero().dot(ray.direction.normalize()).abs()
    }

    /// Returns the margin of a hit's distance, in units of the ray's |direction|.
    fn t_margin(&self, ray: &Ray, hit: &Hit) -> f64 {
        let length = ray.direction.length() * self.cosine(ray, hit).max(1e-12);
        self.primitive_margin(ray, hit.id) / length
    }

    /// Returns the margin of a primitive in world units: for spheres and planes that of f64; for a
    /// triangle that of the rays, magnified by the largest scale of its instance's transform over the
    /// smallest.
    fn primitive_margin(&self, ray: &Ray, id: PrimitiveId) -> f64 {
        let index = id.primitive as usize;
        match id.geometry {
            Geometry::Spheres => {
                let s = &self.scene.spheres[index];
                F64_MARGIN * ((ray.origin - s.center).length() + s.radius)
            }
            Geometry::Planes => {
                let p = &self.scene.planes[index];
                F64_MARGIN * (ray.origin.length() + p.point.length())
            }
            Geometry::Mesh(_) => {
                let m = self.scene.instances[id.instance as usize].transform.matrix3;
                let norm = |m: &glam::DMat3| {
                    m.x_axis.length().max(m.y_axis.length()).max(m.z_axis.length())
                };
                self.margin * (norm(&m) * norm(&m.inverse())).max(1.0)
            }
        }
    }
}

/// Returns the outcome for a primitive that the ray hits at `t`: blocked if that lies between the
/// ray's ends by more than the slack.
fn occlusion_between_ends(ray: &Ray, t: f64, slack: f64) -> Occlusion {
    if t > slack && t < ray.tmax - slack {
        Occlusion::Blocked
    } else {
        Occlusion::Uncertain(MismatchCause::Tie)
    }
}

/// True if the line, at these distances from the edges, crosses the triangle enlarged by the margin: it
/// passes each edge on the inner side, or outside by no more than the margin.
fn crosses_within(edges: &triangle::EdgeFunctions, distances: [f64; 3], margin: f64) -> bool {
    let sign = (edges.values[0] + edges.values[1] + edges.values[2]).signum();
    edges.values.iter().zip(distances).all(|(f, d)| f * sign >= 0.0 || d <= margin)
}

/// Returns the distance of the ray's line from the line of each edge, the edge opposite the first
/// vertex first. For edges p, q relative to the origin this is |d·(p×q)| / |d×(q−p)|.
fn edge_distances(edges: &triangle::EdgeFunctions, corners: [DVec3; 3], ray: &Ray) -> [f64; 3] {
    let [a, b, c] = corners;
    let sides = [c - b, a - c, b - a];
    std::array::from_fn(|i| {
        let across = ray.direction.cross(sides[i]).length();
        if across == 0.0 { f64::INFINITY } else { edges.values[i].abs() / across }
    })
}
