//! The intersector that tests every primitive in exact arithmetic.

use crate::geometry::{Bounds, Geometry, Hit, PrimitiveId, Ray, Side};
use crate::intersect::primitive::{
    SphereDeparture, sphere_departure, starts_on_plane, starts_on_triangle,
};
use crate::intersect::{Coherence, Intersector};
use crate::scene::Scene;

/// An intersector in exact arithmetic; slow, for small pictures that others are compared with.
///
/// Boxes, enlarged by far more than any rounding error, exclude primitives that a ray cannot hit.
pub struct Oracle<'s> {
    scene: &'s Scene,
    /// The boxes of spheres and triangles.
    boxes: Vec<(PrimitiveId, Bounds)>,
}

impl<'s> Oracle<'s> {
    /// Creates the oracle of a checked scene.
    pub fn new(scene: &'s Scene) -> Self {
        let spheres = (0..).zip(&scene.spheres).map(|(i, s)| (PrimitiveId::sphere(i), s.bounds()));
        let triangles = (0..).zip(&scene.instances).flat_map(|(instance, placed)| {
            let mesh = placed.mesh.0;
            let count = scene.meshes[mesh as usize].triangles.len() as u32;
            (0..count).map(move |t| {
                let id = PrimitiveId::triangle(mesh, t, instance);
                (id, Bounds::from_points(scene.triangle_vertices(id)))
            })
        });
        Self { scene, boxes: spheres.chain(triangles).collect() }
    }

    /// Returns every hit of the ray, in no particular order.
    pub fn all_hits(&self, ray: &Ray) -> impl Iterator<Item = Hit> {
        let (ray, planes) = (*ray, self.scene.planes.len() as u32);
        let near = self.boxes.iter().filter(move |(_, bounds)| passes_near(bounds, &ray));
        let ids = near.map(|(id, _)| *id).chain((0..planes).map(PrimitiveId::plane));
        ids.filter_map(move |id| self.hit(id, &ray))
    }

    /// Returns where the ray hits a primitive first, a continuation ray beyond what it crossed.
    fn hit(&self, id: PrimitiveId, ray: &Ray) -> Option<Hit> {
        // A ray that did not cross anything before; the rule of departures is that of `crossing`.
        let Some(past) = ray.continuation else { return self.crossing(id, ray, false) };
        // Another primitive than the one that was crossed: the first crossing that lies beyond that.
        if past.crossed.id != id {
            let beyond = |far| self.crossing(id, ray, far).filter(|hit| !past.excludes(hit.t, id));
            return beyond(false).or_else(|| beyond(true));
        }
        // The same primitive again: only a sphere is crossed twice, at its far side.
        let inside = id.geometry == Geometry::Spheres && past.crossed.side == Side::Back;
        inside.then(|| self.crossing(id, ray, true))?.filter(|hit| hit.t >= past.t)
    }

    /// Returns where the ray crosses a primitive; a sphere at its first root, or at its far one.
    fn crossing(&self, id: PrimitiveId, ray: &Ray, far: bool) -> Option<Hit> {
        // A ray does not hit the plane or triangle that it leaves; a sphere it may hit at its far side.
        if ray.departure.is_some_and(|from| from.id == id && id.geometry != Geometry::Spheres) {
            return None;
        }
        let (t, u, v) = match id.geometry {
            Geometry::Spheres => {
                let inward = match sphere_departure(self.scene, id.primitive, ray) {
                    SphereDeparture::No => far,
                    SphereDeparture::Outward => return None,
                    SphereDeparture::Inward => true,
                };
                let s = &self.scene.spheres[id.primitive as usize];
                (super::sphere(s.center, s.radius, ray, inward)?, 0.0, 0.0)
            }
            Geometry::Planes => {
                let p = &self.scene.planes[id.primitive as usize];
                let t = super::plane(p.point, p.normal, ray)?;
                if starts_on_plane(self.scene, id.primitive, ray) {
                    return None;
                }
                (t, 0.0, 0.0)
            }
            Geometry::Mesh(_) => {
                let corners = self.scene.triangle_vertices(id);
                let crossing = super::triangle(corners, ray)?;
                if starts_on_triangle(self.scene, corners, ray)
                    || self.scene.is_cut_out(id, crossing.u, crossing.v)
                {
                    return None;
                }
                (crossing.t, crossing.u, crossing.v)
            }
        };
        Some(Hit { t: t.to_f64(), u, v, id })
    }
}

/// True if the ray's line may pass the box before `ray.tmax`. The box is enlarged by 1e-9 of the
/// coordinates, ten million times the rounding error of these few operations.
fn passes_near(bounds: &Bounds, ray: &Ray) -> bool {
    let margin = 1e-9 * (bounds.max_abs() + ray.origin.abs().max_element());
    let (lower, upper) = (bounds.lower - margin - ray.origin, bounds.upper + margin - ray.origin);
    let (mut enter, mut leave) = (0.0f64, ray.tmax);
    // Where the line enters and leaves each of the three slabs of the box.
    for axis in 0..3 {
        let (low, high, along) = (lower[axis], upper[axis], ray.direction[axis]);
        if along == 0.0 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (low / along, high / along);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    enter <= leave
}

impl Intersector for Oracle<'_> {
    fn name(&self) -> &'static str {
        "oracle"
    }

    fn version(&self) -> String {
        env!("CARGO_PKG_VERSION").to_owned()
    }

    fn closest(&self, rays: &[Ray], _: Coherence, hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit for each ray");
        for (ray, best) in rays.iter().zip(hits) {
            *best = None;
            self.all_hits(ray).for_each(|hit| Hit::keep_closest(best, hit));
        }
    }

    fn occluded(&self, rays: &[Ray], _: Coherence, blocked: &mut [bool]) {
        assert_eq!(rays.len(), blocked.len(), "one answer for each ray");
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = self.all_hits(ray).any(|hit| self.scene.blocks_light(hit.id));
        }
    }
}
