//! Why an f32 traversal and exact arithmetic may disagree about a ray.
//!
//! An f32 ray stays within a margin of the exact one (derived in `intersect/embree/frame.rs`), and
//! an instance's own space may magnify that. So the two may rightly disagree about a triangle that
//! the ray passes at most that far from an edge, and about the order of two surfaces that lie, along
//! the ray, closer together than the margin divided by the cosine at which the ray meets them.
//! Whatever is not of this kind is an error in one of the two.

use glam::DVec3;

use crate::geometry::{Geometry, Hit, PrimitiveId, Ray, triangle};
use crate::scene::Scene;

/// What explains a disagreement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The ray passes the edge of a triangle within the margin.
    Edge,
    /// Two surfaces, or a surface and the end of a shadow ray, lie within the margin of each other.
    Tie,
}

/// Judges disagreements about rays in one scene.
pub struct Disputes<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// How far an f32 ray may be from the exact one, in world units.
    pub margin: f64,
}

impl Disputes<'_> {
    /// Two closest hits of one ray that differ.
    pub fn primary(&self, ray: &Ray, a: Option<&Hit>, b: Option<&Hit>) -> Option<Cause> {
        let hits = || [a, b].into_iter().flatten();
        if let (Some(a), Some(b)) = (a, b) {
            let cosine = hits().map(|h| self.cosine(ray, h)).fold(1.0, f64::min);
            let apart = (a.t - b.t).abs() * ray.direction.length();
            let magnified = hits().map(|h| self.margin_at(h.id)).fold(0.0, f64::max);
            if apart * cosine <= magnified {
                return Some(Cause::Tie);
            }
        }
        hits().any(|h| self.passes_edge(ray, h.id)).then_some(Cause::Edge)
    }

    /// A shadow ray that one says is blocked and the other is not; `truth` is the exact answer.
    ///
    /// Tries every triangle: this is for the few rays in dispute.
    pub fn shadow(&self, ray: &Ray, truth: bool) -> Option<Cause> {
        let mut cause = None;
        for (instance, placed) in (0..).zip(&self.scene.instances) {
            if !placed.casts_shadow {
                continue;
            }
            let mesh = placed.mesh.0;
            let count = self.scene.meshes[mesh as usize].triangles.len() as u32;
            for id in (0..count).map(|t| PrimitiveId::triangle(mesh, t, instance)) {
                let Some(doubt) = self.doubt(ray, id) else { continue };
                match doubt {
                    // The exact ray is clearly blocked: no excuse for saying that it is not.
                    None if truth => return None,
                    None => {}
                    found => cause = found,
                }
            }
        }
        cause
    }

    /// Whether the ray comes within the margin of a triangle between its ends: `None` when it does
    /// not, `Some(None)` when it is clearly blocked, `Some(cause)` when f32 may say either.
    fn doubt(&self, ray: &Ray, id: PrimitiveId) -> Option<Option<Cause>> {
        if ray.from.is_some_and(|from| from.id == id) {
            return None;
        }
        let corners = self.scene.triangle(id);
        let edges = triangle::Edges::new(corners, ray.origin, ray.direction);
        let margin = self.margin_at(id);
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
            return Some(Some(Cause::Edge));
        }
        let inside = edges.t > slack && edges.t < ray.tmax - slack;
        Some((!inside).then_some(Cause::Tie))
    }

    /// Whether the line passes the triangle within the margin: on the inner side of each edge, or
    /// no farther outside it than the margin.
    fn within(&self, edges: &triangle::Edges, corners: [DVec3; 3], ray: &Ray, margin: f64) -> bool {
        let sign = (edges.functions[0] + edges.functions[1] + edges.functions[2]).signum();
        let distances = edge_distances(edges, corners, ray);
        edges.functions.iter().zip(distances).all(|(f, d)| f * sign >= 0.0 || d <= margin)
    }

    /// Whether the ray passes an edge of the triangle within the margin.
    fn passes_edge(&self, ray: &Ray, id: PrimitiveId) -> bool {
        if !matches!(id.geometry, Geometry::Mesh(_)) {
            return false;
        }
        let corners = self.scene.triangle(id);
        let edges = triangle::Edges::new(corners, ray.origin, ray.direction);
        let margin = self.margin_at(id);
        edge_distances(&edges, corners, ray).into_iter().any(|d| d <= margin)
    }

    /// The cosine at which the ray meets the surface.
    fn cosine(&self, ray: &Ray, hit: &Hit) -> f64 {
        let index = hit.id.primitive as usize;
        let normal = match hit.id.geometry {
            Geometry::Spheres => ray.at(hit.t) - self.scene.spheres[index].center,
            Geometry::Planes => self.scene.planes[index].normal,
            Geometry::Mesh(_) => triangle::area_normal(self.scene.triangle(hit.id)),
        };
        normal.normalize_or_zero().dot(ray.direction.normalize()).abs()
    }

    /// The margin in world space for a primitive: magnified by its instance's own space, where it
    /// has one, by at most the ratio of the transform's longest stretch to its shortest.
    fn margin_at(&self, id: PrimitiveId) -> f64 {
        let Geometry::Mesh(_) = id.geometry else { return self.margin };
        let m = self.scene.instances[id.instance as usize].transform.matrix3;
        let norm =
            |m: &glam::DMat3| m.x_axis.length().max(m.y_axis.length()).max(m.z_axis.length());
        self.margin * (norm(&m) * norm(&m.inverse())).max(1.0)
    }
}

/// How far the ray's line passes from the line of each edge; the edge opposite the first vertex
/// first. For edges p, q relative to the origin this is |d·(p×q)| / |d×(q−p)|.
fn edge_distances(edges: &triangle::Edges, corners: [DVec3; 3], ray: &Ray) -> [f64; 3] {
    let [a, b, c] = corners;
    let sides = [c - b, a - c, b - a];
    std::array::from_fn(|i| {
        let across = ray.direction.cross(sides[i]).length();
        if across == 0.0 { f64::INFINITY } else { edges.functions[i].abs() / across }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, MaterialId, Mesh};
    use glam::DAffine3;

    fn scene() -> Scene {
        let mut scene = Scene::default();
        let positions = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        let mesh = scene.add_mesh(mesh);
        for z in [0.0, 1e-7, 1.0] {
            let transform = DAffine3::from_translation(DVec3::Z * z);
            scene.instances.push(Instance::new(mesh, transform, MaterialId(0)));
        }
        scene
    }

    fn hit(ray: &Ray, scene: &Scene, instance: u32) -> Hit {
        let id = PrimitiveId::triangle(0, 0, instance);
        let t = triangle::Edges::new(scene.triangle(id), ray.origin, ray.direction).t;
        Hit { t, u: 0.0, v: 0.0, id }
    }

    fn judge(x: f64, instances: [Option<u32>; 2]) -> Option<Cause> {
        let scene = scene();
        let ray = Ray::new(DVec3::new(x, 0.3, 2.0), DVec3::NEG_Z);
        let [a, b] = instances.map(|i| i.map(|i| hit(&ray, &scene, i)));
        Disputes { scene: &scene, margin: 1e-6 }.primary(&ray, a.as_ref(), b.as_ref())
    }

    #[test]
    fn miss_beside_an_edge_is_explained() {
        assert_eq!(judge(-5e-7, [Some(0), None]), Some(Cause::Edge));
    }

    #[test]
    fn miss_in_the_middle_of_a_triangle_is_not_explained() {
        assert_eq!(judge(0.3, [Some(0), None]), None);
    }

    #[test]
    fn close_surfaces_are_a_tie() {
        assert_eq!(judge(0.3, [Some(0), Some(1)]), Some(Cause::Tie));
    }

    #[test]
    fn far_surfaces_are_not_a_tie() {
        assert_eq!(judge(0.3, [Some(0), Some(2)]), None);
    }

    #[test]
    fn clearly_blocked_shadow_ray_is_not_explained() {
        let scene = scene();
        let ray = Ray::between(DVec3::new(0.3, 0.3, 2.0), DVec3::new(0.3, 0.3, -2.0));
        assert_eq!(Disputes { scene: &scene, margin: 1e-6 }.shadow(&ray, true), None);
    }

    #[test]
    fn shadow_ray_beside_an_edge_is_explained() {
        let scene = scene();
        let ray = Ray::between(DVec3::new(-5e-7, 0.3, 2.0), DVec3::new(-5e-7, 0.3, -2.0));
        let disputes = Disputes { scene: &scene, margin: 1e-6 };
        assert_eq!(disputes.shadow(&ray, false), Some(Cause::Edge));
    }

    #[test]
    fn shadow_ray_far_from_everything_is_not_explained() {
        let scene = scene();
        let ray = Ray::between(DVec3::new(-0.5, 0.3, 2.0), DVec3::new(-0.5, 0.3, -2.0));
        assert_eq!(Disputes { scene: &scene, margin: 1e-6 }.shadow(&ray, false), None);
    }
}
