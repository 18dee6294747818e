//! The intersector that tests every primitive in exact arithmetic.

use crate::geometry::{Bounds, Geometry, Hit, PrimitiveId, Ray, Side};
use crate::intersect::{Coherence, Intersector};
use crate::measure::oracle::ends::{self, Start};
use crate::measure::oracle::{self, Crossing, ExactNumber};
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

    /// Returns where the ray hits a primitive first, a continuation ray beyond what it crossed. A shadow
    /// ray may be blocked at its origin, by a hit at the least t; and does not hit what its light lies on.
    fn hit(&self, id: PrimitiveId, ray: &Ray) -> Option<ExactHit> {
        if let Some(blocked) = self.blocked_at_origin(id, ray) {
            return Some(blocked);
        }
        let Some(past) = ray.continuation else { return self.crossing(id, ray, false) };
        let crossed = past.crossed;
        if crossed.id == id {
            let inside = id.geometry == Geometry::Spheres && crossed.side == Side::Back;
            return inside.then(|| self.crossing(id, ray, true))?;
        }
        // The surface that was crossed last, by its distance on a ray that has crossed nothing.
        let unbroken = Ray { continuation: None, shadow: None, ..*ray };
        let last = self.crossing(crossed.id, &unbroken, crossed.side == Side::Front);
        let is_ahead = |hit: &ExactHit| last.as_ref().is_none_or(|last| last.is_before(hit));
        [false, true].into_iter().find_map(|far| self.crossing(id, ray, far).filter(is_ahead))
    }

    /// Returns the hit on a surface that blocks a shadow ray at its origin.
    fn blocked_at_origin(&self, id: PrimitiveId, ray: &Ray) -> Option<ExactHit> {
        if !ends::blocks_origin(self.scene, id, ray) {
            return None;
        }
        let least = ExactNumber::least();
        let is_passed = ray.continuation.is_some_and(|past| {
            least.compare(past.t) == std::cmp::Ordering::Less || past.crossed.id >= id
        });
        let (u, v) = match id.geometry {
            Geometry::Mesh(_) => ends::weights(self.scene.triangle_vertices(id), ray.origin),
            _ => (0.0, 0.0),
        };
        let is_cut_out =
            matches!(id.geometry, Geometry::Mesh(_)) && self.scene.is_cut_out(id, u, v);
        (!is_passed && !is_cut_out).then_some(ExactHit { t: least, u, v, id })
    }

    /// Returns where the ray crosses a primitive; a sphere at its first root, or at its far one.
    fn crossing(&self, id: PrimitiveId, ray: &Ray, far: bool) -> Option<ExactHit> {
        let scene = self.scene;
        let index = id.primitive as usize;
        let start = || ends::start(scene, id, ray);
        match id.geometry {
            Geometry::Spheres => {
                let from_inside = match start() {
                    Start::Elsewhere => far,
                    Start::Leaves => return None,
                    Start::Enters => true,
                };
                let s = &scene.spheres[index];
                let t = oracle::sphere(s.center, s.radius, ray, from_inside)?;
                // The root is the far one where the origin lies inside.
                let is_far =
                    from_inside || oracle::signed_distance(s.center, s.radius, ray, 0.0) <= 0.0;
                let is_hit = !ends::ends_on(scene, id, ray, is_far);
                is_hit.then_some(ExactHit { t, u: 0.0, v: 0.0, id })
            }
            Geometry::Planes => {
                let p = &scene.planes[index];
                let t = oracle::plane(p.point, p.normal, ray)?;
                let is_hit = start() == Start::Elsewhere && !ends::ends_on(scene, id, ray, false);
                is_hit.then_some(ExactHit { t, u: 0.0, v: 0.0, id })
            }
            Geometry::Mesh(_) => {
                let Crossing { t, u, v } = oracle::triangle(scene.triangle_vertices(id), ray)?;
                let is_hit = start() == Start::Elsewhere
                    && !ends::ends_on(scene, id, ray, false)
                    && !scene.is_cut_out(id, u, v);
                is_hit.then_some(ExactHit { t, u, v, id })
            }
        }
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

/// True if the ray's line may pass the box before `ray.tmax`. The box is enlarged by 1e-12 of the
/// coordinates, thousands of times the rounding error of these few operations.
fn passes_near(bounds: &Bounds, ray: &Ray) -> bool {
    let margin = 1e-12 * (bounds.max_abs() + ray.origin.abs().max_element());
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
