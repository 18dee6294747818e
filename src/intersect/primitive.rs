//! The tests of one ray against one primitive, in f64 and in world space: what every backend means by a
//! hit.
//!
//! A ray does not hit, at its own origin, the surfaces that it was spawned on: [`sphere_departure`],
//! [`starts_on_plane`] and [`starts_on_triangle`] say which those are.

#[cfg(any(feature = "measure", feature = "embree"))]
use crate::geometry::Geometry;
use crate::geometry::{Hit, PrimitiveId, Ray, Side, plane, sphere, triangle};
use crate::intersect::Precision;
pub use crate::intersect::self_intersection::{
    SphereDeparture, sphere_departure, starts_on_plane, starts_on_triangle,
};
use crate::scene::Scene;

/// The primitives of a scene, with the precision in which they are tested.
#[derive(Clone, Copy, Debug)]
pub struct Primitives<'s> {
    /// The scene.
    pub scene: &'s Scene,
    /// The precision.
    pub precision: Precision,
}

impl Primitives<'_> {
    /// The hit of `ray` on sphere `index`, with `inverse_length_squared` = 1 / |direction|². A hit
    /// beyond `limit` may be left out.
    #[inline]
    pub fn sphere(
        &self,
        index: u32,
        ray: &Ray,
        inverse_length_squared: f64,
        limit: f64,
    ) -> Option<Hit> {
        let Some(continuation) = ray.continuation else {
            return self.sphere_root(index, ray, inverse_length_squared, limit, false);
        };
        let id = PrimitiveId::sphere(index);
        let root = |far| self.sphere_root(index, ray, inverse_length_squared, limit, far);
        if continuation.crossed.id != id {
            let ahead = |far| root(far).filter(|hit| !self.has_passed(ray, hit.t, id, far));
            return ahead(false).or_else(|| ahead(true));
        }
        // A sphere that the ray entered is hit at its far side, which rounding may put at the same t.
        if continuation.crossed.side == Side::Front {
            return None;
        }
        root(true).filter(|hit| hit.t >= continuation.t)
    }

    /// The hit at the first root that counts, or at the far one.
    #[inline(always)]
    pub(super) fn sphere_root(
        &self,
        index: u32,
        ray: &Ray,
        inverse_length_squared: f64,
        limit: f64,
        far: bool,
    ) -> Option<Hit> {
        let s = &self.scene.spheres[index as usize];
        let (origin, direction) = (ray.origin, ray.direction);
        let inverse = inverse_length_squared;
        let t = match self.precision {
            Precision::Fast => {
                let roots = sphere::roots(s.center, s.radius, origin, direction, inverse)?;
                let t = sphere::first_root(roots, ray.tmax, false)?;
                match sphere_departure(self.scene, index, ray) {
                    SphereDeparture::Outward => return None,
                    SphereDeparture::No if !far => t,
                    _ => sphere::first_root(roots, ray.tmax, true)?,
                }
            }
            Precision::Certified => {
                use sphere::certified::{estimate, first_root};
                // Where the first root lies outside, so does the far one.
                if estimate(s.center, s.radius, origin, direction, inverse).is_outside(limit) {
                    return None;
                }
                let inward = match sphere_departure(self.scene, index, ray) {
                    SphereDeparture::Outward => return None,
                    SphereDeparture::No => far,
                    SphereDeparture::Inward => true,
                };
                first_root(s.center, s.radius, origin, direction, ray.tmax, inward)?
            }
        };
        let id = PrimitiveId::sphere(index);
        Some(Hit { t, u: 0.0, v: 0.0, id })
    }

    /// The hit of `ray` on plane `index`.
    #[inline]
    pub fn plane(&self, index: u32, ray: &Ray) -> Option<Hit> {
        let p = &self.scene.planes[index as usize];
        let t = match self.precision {
            Precision::Fast => plane::intersect(p.point, p.normal, ray.origin, ray.direction)
                .filter(|&t| t > 0.0 && t < ray.tmax)?,
            Precision::Certified => {
                use plane::certified::{certainly_misses, crossing};
                // A ray that leaves the plane nearly hits it, which is expensive to decide.
                if certainly_misses(p.point, p.normal, ray.origin, ray.direction, ray.tmax)
                    || starts_on_plane(self.scene, index, ray)
                {
                    return None;
                }
                crossing(p.point, p.normal, ray.origin, ray.direction, ray.tmax)?
            }
        };
        let id = PrimitiveId::plane(index);
        if starts_on_plane(self.scene, index, ray) || self.is_passed(ray, t, id) {
            return None;
        }
        Some(Hit { t, u: 0.0, v: 0.0, id })
    }

    /// The hit of `ray` on the triangle `id`. A hit beyond `limit` may be left out.
    #[inline]
    pub fn triangle(&self, id: PrimitiveId, ray: &Ray, limit: f64) -> Option<Hit> {
        if ray.departure.is_some_and(|departure| departure.id == id) {
            return None;
        }
        let vertices = self.scene.triangle_vertices(id);
        let crossing = match self.precision {
            Precision::Fast => triangle::intersect(vertices, ray.origin, ray.direction)
                .filter(|hit| hit.t > 0.0 && hit.t < ray.tmax)?,
            Precision::Certified => {
                use triangle::certified::{crossing, estimate};
                if estimate(vertices, ray.origin, ray.direction).is_outside(limit) {
                    return None;
                }
                crossing(vertices, ray.origin, ray.direction, ray.tmax)?
            }
        };
        let hit = Hit { t: crossing.t, u: crossing.u, v: crossing.v, id };
        let excluded =
            starts_on_triangle(self.scene, vertices, ray) || self.is_passed(ray, hit.t, id);
        (!excluded && !self.scene.is_cut_out(id, hit.u, hit.v)).then_some(hit)
    }

    /// The hit of `ray` on the primitive `id`.
    #[cfg(any(feature = "measure", feature = "embree"))]
    pub fn test(&self, id: PrimitiveId, ray: &Ray) -> Option<Hit> {
        match id.geometry {
            Geometry::Spheres => {
                let inverse = sphere::inverse_length_squared(ray.direction);
                self.sphere(id.primitive, ray, inverse, f64::INFINITY)
            }
            Geometry::Planes => self.plane(id.primitive, ray),
            Geometry::Mesh(_) => self.triangle(id, ray, f64::INFINITY),
        }
    }

    /// Merges the infinite planes into a hit on finite primitives: they are in no tree, since nothing
    /// infinite can be bounded.
    #[inline]
    pub fn merge_planes(&self, ray: &Ray, best: &mut Option<Hit>) {
        for index in 0..self.scene.planes.len() as u32 {
            if let Some(hit) = self.plane(index, ray) {
                self.keep_closest(ray, best, hit);
            }
        }
    }

    /// True if a plane that blocks light is hit by the ray.
    #[inline]
    pub fn planes_occlude(&self, ray: &Ray) -> bool {
        (0..self.scene.planes.len() as u32)
            .any(|i| self.scene.blocks_light(PrimitiveId::plane(i)) && self.plane(i, ray).is_some())
    }

    /// True if a continuation ray has passed a surface that its line crosses once, at `t`.
    #[inline(always)]
    fn is_passed(&self, ray: &Ray, t: f64, id: PrimitiveId) -> bool {
        ray.continuation.is_some_and(|c| c.crossed.id == id || self.has_passed(ray, t, id, false))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Departure;
    use crate::scene::{Instance, MaterialId, Mesh, Plane, Sphere};
    use glam::{DAffine3, DVec3};

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

    fn spawned(origin: DVec3, direction: DVec3, id: PrimitiveId, side: Side) -> Ray {
        Ray { departure: Some(Departure { id, side }), ..Ray::new(origin, direction) }
    }

    #[test]
    fn a_ray_does_not_hit_the_triangle_it_left() {
        let scene = roof();
        let id = PrimitiveId::triangle(0, 0, 0);
        let origin = DVec3::new(0.5, 0.5 + 1e-17, 0.0);
        let ray = spawned(origin, DVec3::new(1.0, -1.0, 0.0), id, Side::Back);
        assert_eq!(fast(&scene).triangle(id, &ray, f64::INFINITY), None);
    }

    #[test]
    fn a_ray_from_the_shared_edge_does_not_hit_the_neighbour() {
        let scene = roof();
        let ray = spawned(
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
    fn a_ray_across_the_valley_hits_the_neighbour() {
        let scene = roof();
        let ray = spawned(
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
    fn a_sphere_left_outward_is_not_hit_again() {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, MaterialId(0)));
        let inside = DVec3::X * (1.0 - 1e-16);
        let ray = spawned(inside, DVec3::new(1e-9, 1.0, 0.0), PrimitiveId::sphere(0), Side::Front);
        assert_eq!(fast(&scene).sphere(0, &ray, 1.0, f64::INFINITY), None);
    }

    #[test]
    fn a_sphere_left_inward_is_hit_at_its_far_side() {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, MaterialId(0)));
        let ray = spawned(DVec3::X, -DVec3::X, PrimitiveId::sphere(0), Side::Back);
        assert_eq!(fast(&scene).sphere(0, &ray, 1.0, f64::INFINITY).unwrap().t, 2.0);
    }

    #[test]
    fn a_plane_merges_before_a_farther_hit_and_behind_a_closer_one() {
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
    fn the_end_of_a_segment_is_not_hit() {
        let mut scene = Scene::default();
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, MaterialId(0)));
        assert!(!fast(&scene).planes_occlude(&Ray::segment(DVec3::Y, DVec3::ZERO)));
        assert!(fast(&scene).planes_occlude(&Ray::segment(DVec3::Y, -DVec3::Y)));
    }
}
