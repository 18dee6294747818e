//! Where light may go through anything on its way to a surface.

use crate::geometry::{Bounds, LANES, Lanes, Ray16, RayBatch};
use crate::scene::{MaterialId, Scene};

/// More boxes than these are taken as one.
const MOST: usize = 64;

/// The boxes of what lets light through: a ray that comes into none need not look for it.
#[derive(Debug)]
pub(super) struct TransmissiveBounds {
    boxes: Vec<Bounds>,
    /// Whether a plane lets light through, which is everywhere.
    everywhere: bool,
}

impl TransmissiveBounds {
    pub fn of(scene: &Scene) -> Self {
        let transmits =
            |id: MaterialId| scene.materials.get(id.0 as usize).is_some_and(|m| m.may_transmit());
        let spheres = scene.spheres.iter().filter(|s| transmits(s.material)).map(|s| s.bounds());
        let instances = scene
            .instances
            .iter()
            .filter(|i| transmits(i.material))
            .map(|i| scene.meshes[i.mesh.0 as usize].bounds().transformed(&i.transform));
        let mut boxes: Vec<Bounds> = spheres.chain(instances).collect();
        if boxes.len() > MOST {
            boxes = vec![boxes.into_iter().fold(Bounds::EMPTY, Bounds::union)];
        }
        Self { boxes, everywhere: scene.planes.iter().any(|plane| transmits(plane.material)) }
    }

    /// Whether each ray certainly comes into none of the boxes before it ends; the last sixteen may
    /// be filled up with any answers.
    pub fn of_all(&self, rays: &RayBatch, arch: pulp::Arch, clear: &mut Vec<bool>) {
        clear.clear();
        arch.dispatch(Ask { clearance: self, rays, clear });
    }

    /// Each quotient is right to a few ulp, and so, along the ray, is the place where it enters or
    /// leaves: the boxes are widened by a thousand times that.
    #[inline(always)]
    fn of_sixteen(&self, lines: &Ray16) -> Lanes<bool> {
        let mut clear = [!self.everywhere; LANES];
        for bounds in &self.boxes {
            let reach = bounds.max_abs();
            for i in 0..LANES {
                let (origin, direction) = lines.origin_and_direction(i);
                let pad = 1e-12 * (reach + origin.abs().max_element());
                let a = (bounds.lower - pad - origin) / direction;
                let b = (bounds.upper + pad - origin) / direction;
                // `min` and `max` pass over the NaN of 0/0.
                let enters = a.min(b).max_element().max(0.0);
                let leaves = a.max(b).min_element().min(lines.tmax[i]);
                clear[i] &= enters > leaves;
            }
        }
        clear
    }
}

/// [`TransmissiveBounds::of_all`], compiled for what the processor can do at once.
struct Ask<'a> {
    clearance: &'a TransmissiveBounds,
    rays: &'a RayBatch,
    clear: &'a mut Vec<bool>,
}

impl pulp::WithSimd for Ask<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for lines in self.rays.blocks() {
            self.clear.extend_from_slice(&self.clearance.of_sixteen(lines));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use crate::scene::{Material, Plane, Sphere};
    use glam::{DVec3, Vec3};
    use proptest::prelude::*;

    fn is_clear(clearance: &TransmissiveBounds, ray: &Ray) -> bool {
        let (mut rays, mut clear) = (RayBatch::default(), Vec::new());
        rays.push(ray);
        clearance.of_all(&rays, pulp::Arch::new(), &mut clear);
        clear[0]
    }

    fn glass(scene: &mut Scene) -> MaterialId {
        scene.add_material(Material { transmit: Vec3::ONE, ..Material::default() })
    }

    proptest! {
        #[test]
        fn no_ray_is_clear_that_meets_glass(
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
            prop_assert!(!is_clear(&TransmissiveBounds::of(&scene), &ray));
        }
    }

    #[test]
    fn a_ray_beside_the_glass_or_that_ends_before_it_is_clear() {
        let mut scene = Scene::default();
        let glass = glass(&mut scene);
        scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, glass));
        let clearance = TransmissiveBounds::of(&scene);
        let clear = |from: DVec3, to: DVec3| is_clear(&clearance, &Ray::segment(from, to));
        assert!(clear(DVec3::new(2.0, -5.0, 0.0), DVec3::new(2.0, 5.0, 0.0)));
        assert!(clear(DVec3::Y * 5.0, DVec3::Y * 1.5));
        assert!(!clear(DVec3::Y * 5.0, DVec3::Y * 0.5));
    }

    #[test]
    fn nothing_is_clear_of_a_plane_of_glass() {
        let mut scene = Scene::default();
        let glass = glass(&mut scene);
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, glass));
        let ray = Ray::segment(DVec3::Y, DVec3::Y * 2.0);
        assert!(!is_clear(&TransmissiveBounds::of(&scene), &ray));
    }
}
