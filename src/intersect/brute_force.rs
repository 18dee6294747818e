//! Every ray against every primitive: slow, and with nothing to go wrong.

use glam::DVec3;

use crate::geometry::{Hit, PrimitiveId, Ray, sphere};
use crate::intersect::primitive::Primitives;
use crate::intersect::{Coherence, Intersector, Precision};
use crate::scene::Scene;

/// Whether a line is so far out of proportion that its way to a box may overflow or underflow f64,
/// in the world or in an instance's space; such a ray tries every primitive instead.
///
/// Directions within 2^±500 and origins within 2^500 leave t normal for coordinates from 1e-157 on,
/// and room for any transform that takes f32 vertices into the bounds of a scene.
#[inline(always)]
pub(in crate::intersect) fn is_extreme(origin: DVec3, direction: DVec3) -> bool {
    const GREATEST: f64 = f64::from_bits((1023 + 500) << 52);
    let (way, place) = (direction.abs().max_element(), origin.abs().max_element());
    !((1.0 / GREATEST..=GREATEST).contains(&way) & (place <= GREATEST))
}

/// The intersector that tries everything; for tests.
pub struct BruteForce<'s> {
    primitives: Primitives<'s>,
}

impl<'s> BruteForce<'s> {
    /// An intersector of a checked scene.
    pub fn new(scene: &'s Scene, precision: Precision) -> Self {
        Self { primitives: Primitives { scene, precision } }
    }

    /// The closest hit of the ray, planes and all.
    pub(crate) fn first(&self, ray: &Ray) -> Option<Hit> {
        let mut best = None;
        self.all(ray).for_each(|hit| Hit::keep_closest(&mut best, hit));
        best
    }

    /// Whether anything that blocks light stands in the ray's way.
    pub(crate) fn blocks(&self, ray: &Ray) -> bool {
        self.all(ray).any(|hit| self.primitives.scene.blocks_light(hit.id))
    }

    /// Every hit of the ray, in no particular order.
    pub fn all(&self, ray: &Ray) -> impl Iterator<Item = Hit> {
        let (primitives, ray) = (self.primitives, *ray);
        let scene = primitives.scene;
        let inverse = sphere::inverse_length_squared(ray.direction);
        let spheres = (0..scene.spheres.len() as u32)
            .filter_map(move |i| primitives.sphere(i, &ray, inverse, f64::INFINITY));
        let planes = (0..scene.planes.len() as u32).filter_map(move |i| primitives.plane(i, &ray));
        let triangles = (0..scene.instances.len() as u32).flat_map(move |instance| {
            let mesh = scene.instances[instance as usize].mesh.0;
            (0..scene.meshes[mesh as usize].triangles.len() as u32).filter_map(move |t| {
                primitives.triangle(PrimitiveId::triangle(mesh, t, instance), &ray, f64::INFINITY)
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
        assert_eq!(rays.len(), hits.len(), "one hit for each ray");
        for (ray, best) in rays.iter().zip(hits) {
            *best = self.first(ray);
        }
    }

    fn occluded(&self, rays: &[Ray], _: Coherence, blocked: &mut [bool]) {
        assert_eq!(rays.len(), blocked.len(), "one answer for each ray");
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = self.blocks(ray);
        }
    }
}
