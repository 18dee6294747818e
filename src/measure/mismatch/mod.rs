//! Why precision `fast` and exact arithmetic may disagree about a ray.
//!
//! An f32 ray stays within a margin of the exact one (derived in `intersect/embree/frame.rs`), and
//! an instance's own space may magnify that. So the two may rightly disagree about a triangle that
//! the ray passes at most that far from an edge, and about the order of two surfaces that lie, along
//! the ray, closer together than the margin divided by the cosine at which the ray meets them.
//!
//! Spheres and planes are intersected in f64 whatever the rays are traced with. Let f be the way
//! from a sphere's centre to the ray's origin and r its radius: the formula of `geometry::sphere`
//! rounds f, its dot product with the direction, the quotient by |d|² and the nearest point, all in
//! all by 6 ε |f| to first order, and squares r, so that it takes the line for at most
//! 8 ε (|f| + r) nearer to the centre or farther from it than it is. Two that compute so may differ
//! by 16 ε (|f| + r), and that is what is allowed, whoever is compared. A plane is met within 16 ε of
//! the coordinates involved.
//!
//! Whatever is not of this kind is an error in one of the two.

#[cfg(test)]
mod tests;

use glam::DVec3;

use crate::geometry::{Geometry, Hit, PrimitiveId, Ray, triangle};
use crate::intersect::Precision;
use crate::intersect::primitive::Primitives;
use crate::scene::Scene;

/// What explains a disagreement.
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
    /// What it is called: `edge`, `tangency` or `tie`.
    pub const fn name(self) -> &'static str {
        match self {
            MismatchCause::Edge => "edge",
            MismatchCause::Tangency => "tangency",
            MismatchCause::Tie => "tie",
        }
    }
}

/// How far f64 may be off a sphere or a plane, in units of ε and the numbers involved.
const F64_MARGIN: f64 = 16.0 * f64::EPSILON;

/// Judges disagreements about rays in one scene.
pub struct MismatchClassifier<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// How far a ray that triangles are found with may be from the exact one, in world units:
    /// `Embree::margin`.
    pub margin: f64,
}

impl MismatchClassifier<'_> {
    /// Two closest hits of one ray that differ.
    pub fn primary(&self, ray: &Ray, a: Option<&Hit>, b: Option<&Hit>) -> Option<MismatchCause> {
        let hits = || [a, b].into_iter().flatten();
        if let (Some(a), Some(b)) = (a, b) {
            let cosine = hits().map(|h| self.cosine(ray, h)).fold(1.0, f64::min);
            let apart = (a.t - b.t).abs() * ray.direction.length();
            let magnified = hits().map(|h| self.margin_at(ray, h.id)).fold(0.0, f64::max);
            if apart * cosine <= magnified {
                return Some(MismatchCause::Tie);
            }
        }
        if hits().any(|h| self.touches(ray, h.id)) {
            return Some(MismatchCause::Tangency);
        }
        hits().any(|h| self.passes_edge(ray, h.id)).then_some(MismatchCause::Edge)
    }

    /// A shadow ray that one says is blocked and the other is not; `truth` is the exact answer.
    ///
    /// Tries every primitive: this is for the few rays in dispute.
    pub fn shadow(&self, ray: &Ray, truth: bool) -> Option<MismatchCause> {
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
            let doubt = match id.geometry {
                Geometry::Mesh(_) => self.doubt(ray, id),
                _ => self.doubt_in_f64(ray, id),
            };
            let Some(doubt) = doubt else { continue };
            match doubt {
                // The exact ray is clearly blocked: no excuse for saying that it is not.
                None if truth => return None,
                None => {}
                found => cause = found,
            }
        }
        cause
    }

    /// As `doubt`, of a sphere or a plane.
    fn doubt_in_f64(&self, ray: &Ray, id: PrimitiveId) -> Option<Option<MismatchCause>> {
        let unbounded = Ray { tmax: f64::INFINITY, ..*ray };
        let hit =
            |ray| Primitives { scene: self.scene, precision: Precision::Certified }.test(id, ray);
        if self.touches(ray, id) {
            return Some(Some(MismatchCause::Tangency));
        }
        let hit = hit(&unbounded)?;
        let length = ray.direction.length() * self.cosine(ray, &hit).max(1e-12);
        let slack = self.margin_at(ray, id) / length;
        if hit.t > ray.tmax + slack {
            return None;
        }
        let inside = hit.t > slack && hit.t < ray.tmax - slack;
        Some((!inside).then_some(MismatchCause::Tie))
    }

    /// Whether the ray's line touches the sphere, to within the rounding of f64.
    fn touches(&self, ray: &Ray, id: PrimitiveId) -> bool {
        if id.geometry != Geometry::Spheres {
            return false;
        }
        let s = &self.scene.spheres[id.primitive as usize];
        let f = ray.origin - s.center;
        let along = f.dot(ray.direction) / ray.direction.length_squared();
        let distance = (f - ray.direction * along).length();
        (distance - s.radius).abs() <= self.margin_at(ray, id)
    }

    /// Whether the ray comes within the margin of a triangle between its ends: `None` when it does
    /// not, `Some(None)` when it is clearly blocked, `Some(cause)` when f32 may say either.
    fn doubt(&self, ray: &Ray, id: PrimitiveId) -> Option<Option<MismatchCause>> {
        if ray.departure.is_some_and(|from| from.id == id) {
            return None;
        }
        let corners = self.scene.triangle_vertices(id);
        let edges = triangle::EdgeFunctions::new(corners, ray.origin, ray.direction);
        let margin = self.margin_at(ray, id);
        let near_edge = self.passes_edge(ray, id) && self.within(&edges, corners, ray, margin);
        if !edges.crosses() && !near_edge {
            return None;
        }
        let hit = Hit { t: edges.t, u: 0.0, v: 0.0, id };
        let length = ray.direction.length() * self.cosine(ray, &hit).max(1e-12);
        let slack = margin / length;
        if edges.t < -slack || edges.t > ray.tmax + slack {
            return None;
        }
        if near_edge {
            return Some(Some(MismatchCause::Edge));
        }
        let inside = edges.t > slack && edges.t < ray.tmax - slack;
        Some((!inside).then_some(MismatchCause::Tie))
    }

    /// Whether the line passes the triangle within the margin: on the inner side of each edge, or
    /// no farther outside it than the margin.
    fn within(
        &self,
        edges: &triangle::EdgeFunctions,
        corners: [DVec3; 3],
        ray: &Ray,
        margin: f64,
    ) -> bool {
        let sign = (edges.values[0] + edges.values[1] + edges.values[2]).signum();
        let distances = edge_distances(edges, corners, ray);
        edges.values.iter().zip(distances).all(|(f, d)| f * sign >= 0.0 || d <= margin)
    }

    /// Whether the ray passes an edge of the triangle within the margin.
    fn passes_edge(&self, ray: &Ray, id: PrimitiveId) -> bool {
        if !matches!(id.geometry, Geometry::Mesh(_)) {
            return false;
        }
        let corners = self.scene.triangle_vertices(id);
        let edges = triangle::EdgeFunctions::new(corners, ray.origin, ray.direction);
        let margin = self.margin_at(ray, id);
        edge_distances(&edges, corners, ray).into_iter().any(|d| d <= margin)
    }

    /// The cosine at which the ray meets the surface.
    fn cosine(&self, ray: &Ray, hit: &Hit) -> f64 {
        let index = hit.id.primitive as usize;
        let normal = match hit.id.geometry {
            Geometry::Spheres => ray.position(hit.t) - self.scene.spheres[index].center,
            Geometry::Planes => self.scene.planes[index].normal,
            Geometry::Mesh(_) => triangle::area_normal(self.scene.triangle_vertices(hit.id)),
        };
        normal.normalize_or_zero().dot(ray.direction.normalize()).abs()
    }

    /// The margin in world space for a primitive: of f64 for spheres and planes; for a triangle
    /// that of the rays, magnified by its instance's own space, where it has one, by at most the
    /// ratio of the transform's longest stretch to its shortest.
    fn margin_at(&self, ray: &Ray, id: PrimitiveId) -> f64 {
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

/// How far the ray's line passes from the line of each edge; the edge opposite the first vertex
/// first. For edges p, q relative to the origin this is |d·(p×q)| / |d×(q−p)|.
fn edge_distances(edges: &triangle::EdgeFunctions, corners: [DVec3; 3], ray: &Ray) -> [f64; 3] {
    let [a, b, c] = corners;
    let sides = [c - b, a - c, b - a];
    std::array::from_fn(|i| {
        let across = ray.direction.cross(sides[i]).length();
        if across == 0.0 { f64::INFINITY } else { edges.values[i].abs() / across }
    })
}
