//! One ray against one primitive, in f64 and in world space: what every backend means by a hit.
//!
//! Here stands also how a ray leaves the surface it was spawned on. Nothing is skipped by
//! distance: the primitive that was left is left out by identity, a sphere that is left toward
//! its inside is met at its far root, and a triangle that shares a vertex with the one that was
//! left is passed over where the origin lies in its plane to within rounding, since such a ray
//! meets that plane at its origin and nowhere else.

use crate::geometry::{Geometry, Hit, PrimitiveId, Ray, Side, plane, sphere, triangle};
use crate::intersect::Precision;
use crate::scene::Scene;
use glam::DVec3;

/// The primitives of a scene, as a precision tests them.
#[derive(Clone, Copy, Debug)]
pub struct Primitives<'s> {
    /// The scene.
    pub scene: &'s Scene,
    /// By which arithmetic.
    pub precision: Precision,
}

impl Primitives<'_> {
    /// Where `ray` meets sphere `index`, with `inverse_length_squared` = 1 / |direction|². A hit
    /// beyond `limit` may be left out.
    #[inline]
    pub fn sphere(
        &self,
        index: u32,
        ray: &Ray,
        inverse_length_squared: f64,
        limit: f64,
    ) -> Option<Hit> {
        let s = &self.scene.spheres[index as usize];
        let id = PrimitiveId::sphere(index);
        let inward = match ray.from {
            Some(from) if from.id == id => match from.side {
                Side::Front => return None, // A convex body is not met again from outside.
                Side::Back => true,
            },
            _ => false,
        };
        let (origin, direction) = (ray.origin, ray.direction);
        let inverse = inverse_length_squared;
        let t = match self.precision {
            Precision::Fast => {
                let roots = sphere::roots(s.center, s.radius, origin, direction, inverse)?;
                sphere::first_root(roots, ray.tmax, inward)?
            }
            Precision::Certified => {
                use sphere::certified::{estimate, first_root};
                // The estimate is of the near root, which a ray that goes inward leaves out.
                if !inward
                    && estimate(s.center, s.radius, origin, direction, inverse).is_outside(limit)
                {
                    return None;
                }
                first_root(s.center, s.radius, origin, direction, ray.tmax, inward)?
            }
        };
        Some(Hit { t, u: 0.0, v: 0.0, id })
    }

    /// Where `ray` meets plane `index`.
    #[inline]
    pub fn plane(&self, index: u32, ray: &Ray) -> Option<Hit> {
        let p = &self.scene.planes[index as usize];
        let id = PrimitiveId::plane(index);
        if ray.from.is_some_and(|from| from.id == id) {
            return None;
        }
        let t = match self.precision {
            Precision::Fast => plane::intersect(p.point, p.normal, ray.origin, ray.direction)
                .filter(|&t| t > 0.0 && t < ray.tmax)?,
            Precision::Certified => {
                plane::certified::crossing(p.point, p.normal, ray.origin, ray.direction, ray.tmax)?
            }
        };
        Some(Hit { t, u: 0.0, v: 0.0, id })
    }

    /// Where `ray` meets the triangle `id`. A hit beyond `limit` may be left out.
    #[inline]
    pub fn triangle(&self, id: PrimitiveId, ray: &Ray, limit: f64) -> Option<Hit> {
        if ray.from.is_some_and(|from| from.id == id) {
            return None;
        }
        let corners = self.scene.triangle(id);
        let crossing = match self.precision {
            Precision::Fast => triangle::intersect(corners, ray.origin, ray.direction)
                .filter(|hit| hit.t > 0.0 && hit.t < ray.tmax)?,
            Precision::Certified => {
                use triangle::certified::{crossing, estimate};
                if estimate(corners, ray.origin, ray.direction).is_outside(limit) {
                    return None;
                }
                crossing(corners, ray.origin, ray.direction, ray.tmax)?
            }
        };
        let hit = Hit { t: crossing.t, u: crossing.u, v: crossing.v, id };
        (!starts_on(self.scene, corners, ray)).then_some(hit)
    }

    /// Where `ray` meets whatever `id` names.
    pub fn test(&self, id: PrimitiveId, ray: &Ray) -> Option<Hit> {
        match id.geometry {
            Geometry::Spheres => {
                let inverse = 1.0 / ray.direction.length_squared();
                self.sphere(id.primitive, ray, inverse, f64::INFINITY)
            }
            Geometry::Planes => self.plane(id.primitive, ray),
            Geometry::Mesh(_) => self.triangle(id, ray, f64::INFINITY),
        }
    }

    /// Merges the infinite planes into a hit on what is finite: they stand in no tree, since
    /// nothing infinite can be bounded.
    #[inline]
    pub fn merge_planes(&self, ray: &Ray, best: &mut Option<Hit>) {
        for index in 0..self.scene.planes.len() as u32 {
            if let Some(hit) = self.plane(index, ray) {
                Hit::keep_first(best, hit);
            }
        }
    }

    /// Whether a plane that casts a shadow stands in the ray's way.
    #[inline]
    pub fn planes_occlude(&self, ray: &Ray) -> bool {
        (0..self.scene.planes.len() as u32)
            .any(|i| self.scene.planes[i as usize].casts_shadow && self.plane(i, ray).is_some())
    }
}

/// Whether the ray left a neighbour of the triangle with these corners, at a point of the
/// triangle's own plane.
#[inline]
pub fn starts_on(scene: &Scene, corners: [DVec3; 3], ray: &Ray) -> bool {
    let Some(from) = ray.from else { return false };
    if !matches!(from.id.geometry, Geometry::Mesh(_)) {
        return false;
    }
    // The origin carries the rounding of its own coordinates and of the vertices it was made
    // from: a few ulp of the largest of them.
    let scale =
        corners.iter().fold(ray.origin.abs().max_element(), |s, c| s.max(c.abs().max_element()));
    let normal = triangle::area_normal(corners);
    let height = normal.dot(ray.origin - corners[0]).abs();
    if height > 32.0 * f64::EPSILON * scale * normal.length() {
        return false;
    }
    let left = scene.triangle(from.id);
    corners.iter().any(|c| left.contains(c))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Departure;
    use crate::scene::{Instance, MaterialId, Mesh, Plane, Sphere};
    use glam::DAffine3;

    fn fast(scene: &Scene) -> Primitives<'_> {
        Primitives { scene, precision: Precision::Fast }
    }

    fn roof() -> Scene {
        // Two triangles that share the edge x = 0 and rise away from it: a valley.
        let mut scene = Scene::default();
        let mesh = scene.add_mesh(Mesh {
            positions: vec![[0., 0., -1.], [0., 0., 1.], [1., 1., 0.], [-1., 1., 0.]],
            triangles: vec![[0, 1, 2], [1, 0, 3]],
            ..Mesh::default()
        });
        scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, MaterialId(0)));
        scene
    }

    fn leaving(origin: DVec3, direction: DVec3, id: PrimitiveId, side: Side) -> Ray {
        Ray { from: Some(Departure { id, side }), ..Ray::new(origin, direction) }
    }

    #[test]
    fn ray_does_not_meet_the_triangle_it_left() {
        let scene = roof();
        let id = PrimitiveId::triangle(0, 0, 0);
        let origin = DVec3::new(0.5, 0.5 + 1e-17, 0.0);
        let ray = leaving(origin, DVec3::new(1.0, -1.0, 0.0), id, Side::Back);
        assert_eq!(fast(&scene).triangle(id, &ray, f64::INFINITY), None);
    }

    #[test]
    fn ray_from_the_shared_edge_does_not_meet_the_neighbour() {
        let scene = roof();
        let ray = leaving(
            DVec3::new(1e-17, 0.0, 0.25),
            DVec3::new(-1.0, 1.0 - 1e-15, 0.0),
            PrimitiveId::triangle(0, 0, 0),
            Side::Front,
        );
        assert_eq!(
            fast(&scene).triangle(PrimitiveId::triangle(0, 1, 0), &ray, f64::INFINITY),
            None
        );
    }

    #[test]
    fn ray_across_the_valley_meets_the_neighbour() {
        let scene = roof();
        let ray = leaving(
            DVec3::new(0.25, 0.25, 0.0),
            DVec3::NEG_X,
            PrimitiveId::triangle(0, 0, 0),
            Side::Front,
        );
        let hit =
            fast(&scene).triangle(PrimitiveId::triangle(0, 1, 0), &ray, f64::INFINITY).unwrap();
        assert_eq!(hit.t, 0.5);
    }

    #[test]
    fn sphere_left_outward_is_not_met_again() {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, MaterialId(0)));
        let inside = DVec3::X * (1.0 - 1e-16);
        let ray = leaving(inside, DVec3::new(1e-9, 1.0, 0.0), PrimitiveId::sphere(0), Side::Front);
        assert_eq!(fast(&scene).sphere(0, &ray, 1.0, f64::INFINITY), None);
    }

    #[test]
    fn sphere_left_inward_is_met_at_its_far_side() {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, MaterialId(0)));
        let ray = leaving(DVec3::X, -DVec3::X, PrimitiveId::sphere(0), Side::Back);
        assert_eq!(fast(&scene).sphere(0, &ray, 1.0, f64::INFINITY).unwrap().t, 2.0);
    }

    #[test]
    fn plane_merges_before_a_farther_hit_and_behind_a_nearer_one() {
        let mut scene = Scene::default();
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, MaterialId(0)));
        let ray = Ray::new(DVec3::Y * 2.0, -DVec3::Y);
        for (t, expected) in [(1.0, 1.0), (3.0, 2.0)] {
            let mut best = Some(Hit { t, u: 0.0, v: 0.0, id: PrimitiveId::triangle(0, 0, 0) });
            fast(&scene).merge_planes(&ray, &mut best);
            assert_eq!(best.unwrap().t, expected);
        }
    }

    #[test]
    fn end_of_a_segment_is_not_met() {
        let mut scene = Scene::default();
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, MaterialId(0)));
        assert!(!fast(&scene).planes_occlude(&Ray::between(DVec3::Y, DVec3::ZERO)));
        assert!(fast(&scene).planes_occlude(&Ray::between(DVec3::Y, -DVec3::Y)));
    }
}
