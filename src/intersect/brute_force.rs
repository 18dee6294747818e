//! The brute-force intersector, which tests every ray against every primitive.

use glam::DVec3;

use crate::geometry::{Hit, PrimitiveId, Ray};
use crate::intersect::primitive::Primitives;
use crate::intersect::{Coherence, Intersector, Precision, trace_each};
use crate::scene::Scene;

/// True if a ray is so extreme that its distance to a box may overflow or underflow f64, in world space
/// or in object space; such a ray is tested with every primitive instead.
///
/// Directions within 2^±500 and origins within 2^500 leave t normal for coordinates from 1e-157 on,
/// and room for any transform that takes f32 vertices into the bounds of a scene.
#[inline(always)]
pub(in crate::intersect) fn is_extreme(origin: DVec3, direction: DVec3) -> bool {
    const GREATEST: f64 = f64::from_bits((1023 + 500) << 52);
    let (length, distance) = (direction.abs().max_element(), origin.abs().max_element());
    !((1.0 / GREATEST..=GREATEST).contains(&length) & (distance <= GREATEST))
}

/// The intersector that tests every ray against every primitive, for tests: slow, with nothing to go
/// wrong.
pub struct BruteForce<'s> {
    primitives: Primitives<'s>,
}

impl<'s> BruteForce<'s> {
    /// Makes the intersector of a checked scene.
    pub fn new(scene: &'s Scene, precision: Precision) -> Self {
        Self { primitives: Primitives { scene, precision } }
    }

    /// The closest hit of a ray.
    pub(crate) fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let (mut best, tests) = (None, self.primitives.with_ray(ray));
        self.all_hits(ray).for_each(|hit| tests.keep_closest(&mut best, hit));
        best
    }

    /// True if anything that blocks light is hit by a ray.
    pub(crate) fn is_occluded(&self, ray: &Ray) -> bool {
        self.all_hits(ray).any(|hit| self.primitives.scene.blocks_light(hit.id))
    }

    /// Returns every hit of a ray, in no particular order.
    pub fn all_hits(&self, ray: &Ray) -> impl Iterator<Item = Hit> {
        let (primitives, ray) = (self.primitives, *ray);
        let scene = primitives.scene;
        let spheres = (0..scene.spheres.len() as u32)
            .filter_map(move |i| primitives.with_ray(&ray).sphere(i, f64::INFINITY));
        let planes =
            (0..scene.planes.len() as u32).filter_map(move |i| primitives.with_ray(&ray).plane(i));
        let triangles = (0..scene.instances.len() as u32).flat_map(move |instance| {
            let mesh = scene.instances[instance as usize].mesh.0;
            (0..scene.meshes[mesh as usize].triangles.len() as u32).filter_map(move |t| {
                let id = PrimitiveId::triangle(mesh, t, instance);
                primitives.with_ray(&ray).triangle(id, f64::INFINITY)
            })
        });
        spheres.chain(planes).chain(triangles)
    }
}

impl Intersector for BruteForce<'_> {
    fn name(&self) -> &'static str {
        "brute"
    }

    fn version(&self) -> String {
        env!("CARGO_PKG_VERSION").to_owned()
    }

    fn closest(&self, rays: &[Ray], _: Coherence, hits: &mut [Option<Hit>]) {
        trace_each(rays, hits, |ray| self.closest_hit(ray));
    }

    fn occluded(&self, rays: &[Ray], _: Coherence, occluded: &mut [bool]) {
        trace_each(rays, occluded, |ray| self.is_occluded(ray));
    }
}
