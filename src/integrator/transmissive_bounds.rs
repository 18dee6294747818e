//! The bounding boxes of transmissive objects: shadow rays that miss them hit no glass.

use crate::geometry::{Bounds, LANES, Lanes, Ray16, RayBatch};
use crate::integrator::simd;
use crate::scene::{MaterialId, Scene};

/// The greatest number of boxes; more are united into one.
const MAX_BOXES: usize = 64;

/// The bounding boxes of the transmissive objects of a scene.
#[derive(Debug)]
pub(super) struct TransmissiveBounds {
    boxes: Vec<Bounds>,
    /// True if a plane is transmissive: planes have no box.
    is_unbounded: bool,
}

impl TransmissiveBounds {
    /// Returns the boxes of a scene.
    pub fn new(scene: &Scene) -> Self {
        let transmits = |id: MaterialId| {
            let material = scene.materials.get(id.0 as usize);
            material.is_some_and(|m| !m.blocks_light())
        };
        let spheres = scene.spheres.iter().filter(|s| transmits(s.material)).map(|s| s.bounds());
        let instances = scene
            .instances
            .iter()
            .filter(|i| transmits(i.material))
            .map(|i| scene.meshes[i.mesh.0 as usize].bounds().transformed(&i.transform));
        let mut boxes: Vec<Bounds> = spheres.chain(instances).collect();
        if boxes.len() > MAX_BOXES {
            boxes = vec![boxes.into_iter().fold(Bounds::EMPTY, Bounds::union)];
        }
        Self { boxes, is_unbounded: scene.planes.iter().any(|plane| transmits(plane.material)) }
    }

    /// Sets `misses` to true for each ray that certainly ends before it enters any box. The lanes beyond
    /// the end of the batch get a value too, of no meaning.
    pub fn find_misses(&self, arch: pulp::Arch, rays: &RayBatch, misses: &mut Vec<bool>) {
        misses.clear();
        simd::dispatch(
            arch,
            #[inline(always)]
            || {
                for block in rays.blocks() {
                    misses.extend_from_slice(&self.missing_lanes(block));
                }
            },
        );
    }

    /// Returns true for each of sixteen rays that enters no box.
    ///
    /// Each quotient is right to a few ulp, and so, along the ray, is the point where it enters or
    /// leaves: the boxes are widened by a thousand times that.
    #[inline(always)]
    fn missing_lanes(&self, rays: &Ray16) -> Lanes<bool> {
        let mut misses = [!self.is_unbounded; LANES];
        for bounds in &self.boxes {
            let extent = bounds.max_abs();
            for i in 0..LANES {
                let (origin, direction) = rays.origin_and_direction(i);
                let padding = 1e-12 * (extent + origin.abs().max_element());
                let a = (bounds.lower - padding - origin) / direction;
                let b = (bounds.upper + padding - origin) / direction;
                // `min` and `max` pass over the NaN of 0/0.
                let enters = a.min(b).max_element().max(0.0);
                let leaves = a.max(b).min_element().min(rays.tmax[i]);
                misses[i] &= enters > leaves;
            }
        }
        misses
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use crate::scene::{Material, Plane, Sphere};
    use glam::{DVec3, Vec3};
    use proptest::prelude::*;

    fn misses_glass(bounds: &TransmissiveBounds, ray: &Ray) -> bool {
        let (mut rays, mut misses) = (RayBatch::default(), Vec::new());
        rays.push(ray);
        bounds.find_misses(pulp::Arch::new(), &rays, &mut misses);
        misses[0]
    }

    fn glass(scene: &mut Scene) -> MaterialId {
        scene.add_material(Material { transmit: Vec3::ONE, ..Material::default() })
    }

    proptest! {
        #[test]
        fn no_ray_that_hits_glass_is_a_miss(
            centers in prop::collection::vec(prop::array::uniform3(-9.0..9.0f64), 1..90),
            origin in prop::array::uniform3(-20.0..20.0f64),
            inside in prop::array::uniform3(-0.5..0.5f64),
            ends in 1.0..2.0f64,
        ) {
            let mut scene = Scene::default();
            let glass = glass(&mut scene);
            let centers = centers.into_iter().map(DVec3::from);
            scene.spheres.extend(centers.map(|center| Sphere::new(center, 1.0, glass)));
            let target = scene.spheres[0].center + DVec3::from(inside);
            let ray = Ray::segment(DVec3::from(origin), target);
            let ray = Ray { direction: ray.direction * ends, ..ray };
            prop_assert!(!misses_glass(&TransmissiveBounds::new(&scene), &ray));
        }
    }

    #[test]
    fn a_ray_beside_glass_or_that_ends_before_it_is_a_miss() {
        let mut scene = Scene::default();
        let glass = glass(&mut scene);
        scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, glass));
        let bounds = TransmissiveBounds::new(&scene);
        let misses = |from: DVec3, to: DVec3| misses_glass(&bounds, &Ray::segment(from, to));
        assert!(misses(DVec3::new(2.0, -5.0, 0.0), DVec3::new(2.0, 5.0, 0.0)));
        assert!(misses(DVec3::Y * 5.0, DVec3::Y * 1.5));
        assert!(!misses(DVec3::Y * 5.0, DVec3::Y * 0.5));
    }

    #[test]
    fn no_ray_misses_a_plane_of_glass() {
        let mut scene = Scene::default();
        let glass = glass(&mut scene);
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, glass));
        let ray = Ray::segment(DVec3::Y, DVec3::Y * 2.0);
        assert!(!misses_glass(&TransmissiveBounds::new(&scene), &ray));
    }
}
