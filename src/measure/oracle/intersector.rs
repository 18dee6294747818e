//! The intersector that tests every primitive in exact arithmetic.

use crate::geometry::{Bounds, Geometry, Hit, PrimitiveId, Ray, Side};
use crate::intersect::primitive::{
    SphereDeparture, sphere_departure, starts_on_plane, starts_on_triangle,
};
use crate::intersect::{Coherence, Intersector};
use crate::measure::oracle::ExactNumber;
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

    /// Returns every hit of the ray with its exact distance, in no particular order.
    fn all_hits(&self, ray: &Ray) -> impl Iterator<Item = ExactHit> {
        let (ray, planes) = (*ray, self.scene.planes.len() as u32);
        let near = self.boxes.iter().filter(move |(_, bounds)| passes_near(bounds, &ray));
        near.map(|(id, _)| *id)
            .chain((0..planes).map(PrimitiveId::plane))
            .filter_map(move |id| self.hit(id, &ray))
    }

    /// Returns where the ray hits a primitive first, a continuation ray beyond what it crossed.
    fn hit(&self, id: PrimitiveId, ray: &Ray) -> Option<ExactHit> {
        let Some(past) = ray.continuation else { return self.crossing(id, ray, false) };
        let crossed = past.crossed;
        if crossed.id == id {
            let inside = id.geometry == Geometry::Spheres && crossed.side == Side::Back;
            return inside.then(|| self.crossing(id, ray, true))?;
        }
        // The surface that was crossed last, by its distance on a ray that has crossed nothing.
        let unbroken = Ray { continuation: None, ..*ray };
        let last = self.crossing(crossed.id, &unbroken, crossed.side == Side::Front);
        let is_ahead = |hit: &ExactHit| last.as_ref().is_none_or(|last| last.is_before(hit));
        [false, true].into_iter().find_map(|far| self.crossing(id, ray, far).filter(is_ahead))
    }

    /// Returns where the ray crosses a primitive; a sphere at its first root, or at its far one.
    fn crossing(&self, id: PrimitiveId, ray: &Ray, far: bool) -> Option<ExactHit> {
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
                if starts_on_triangle(self.scene, corners, ray) {
                    return None;
                }
                if self.scene.is_cut_out(id, crossing.u, crossing.v) {
                    return None;
                }
                (crossing.t, crossing.u, crossing.v)
            }
        };
        Some(ExactHit { t, u, v, id })
    }
}

/// A hit with its exact distance.
struct ExactHit {
    t: ExactNumber,
    u: f64,
    v: f64,
    id: PrimitiveId,
}

impl ExactHit {
    /// True if this hit comes before `other`: by distance, then by id.
    fn is_before(&self, other: &Self) -> bool {
        self.t.compare_with(&other.t).then(self.id.cmp(&other.id)).is_lt()
    }

    /// The hit with its distance rounded.
    fn rounded(&self) -> Hit {
        Hit { t: self.t.to_f64(), u: self.u, v: self.v, id: self.id }
    }
}

/// True if the ray's line may pass the box before `ray.tmax`. The box is enlarged by 1e-9 of the
/// coordinates, ten million times the rounding error of these few operations.
fn passes_near(bounds: &Bounds, ray: &Ray) -> bool {
    let margin = 1e-9 * (bounds.max_abs() + ray.origin.abs().max_element());
    let (lower, upper) = (bounds.lower - margin - ray.origin, bounds.upper + margin - ray.origin);
    let (mut enter, mut leave) = (0.0f64, ray.tmax);
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
            let first = self.all_hits(ray).reduce(|a, b| if b.is_before(&a) { b } else { a });
            *best = first.map(|hit| hit.rounded());
        }
    }

    fn occluded(&self, rays: &[Ray], _: Coherence, blocked: &mut [bool]) {
        assert_eq!(rays.len(), blocked.len(), "one answer for each ray");
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = self.all_hits(ray).any(|hit| self.scene.blocks_light(hit.id));
        }
    }
}
