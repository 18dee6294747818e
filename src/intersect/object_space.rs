//! The object space of an instance, as intersectors transform rays into it.

use glam::{DAffine3, DMat3, DVec3};

use crate::geometry::Bounds;
use crate::scene::Instance;

/// The box in world space of an instance whose mesh has box `mesh_bounds` in object space.
pub fn world_bounds(instance: &Instance, mesh_bounds: &Bounds) -> Bounds {
    let bounds = mesh_bounds.transformed(&instance.transform);
    // A baked vertex may round to just outside the transformed box.
    bounds.padded(16.0 * f64::EPSILON * bounds.max_abs())
}

/// The transform of rays from world space into the object space of an instance, with a bound on its
/// error: to choose boxes there. Primitives are tested in world space.
#[derive(Clone, Copy, Debug)]
pub struct ObjectSpace {
    inverse: DAffine3,
    /// ‖M⁻¹‖, by which a world length grows.
    inverse_norm: f64,
    /// ‖M‖·‖M⁻¹‖, by which the rounding of the inverse grows.
    condition: f64,
    /// The largest coordinates that cancel in the transform: of the instance in the world, and of the
    /// translation that brings it to the origin.
    max_coordinate: f64,
}

impl ObjectSpace {
    /// Makes the object space of an instance, whose box in world space is `bounds`.
    pub fn new(instance: &Instance, bounds: &Bounds) -> Self {
        let inverse = instance.transform.inverse();
        let inverse_norm = norm(&inverse.matrix3);
        let condition = norm(&instance.transform.matrix3) * inverse_norm;
        let max_coordinate =
            inverse_norm * bounds.max_abs() + inverse.translation.abs().max_element();
        Self { inverse, inverse_norm, condition, max_coordinate }
    }

    /// The origin and direction of a ray in object space; its t are those of world space.
    #[inline(always)]
    pub fn object_ray(&self, origin: DVec3, direction: DVec3) -> (DVec3, DVec3) {
        (self.inverse.transform_point3(origin), self.inverse.transform_vector3(direction))
    }

    /// The distance by which, on each axis of object space, a ray from `origin` may be off anywhere in
    /// the instance.
    ///
    /// Point and vector are each a sum of four rounded products with rounded factors: 8 ulp of
    /// the terms, before they cancel. The inverse itself is right to `condition` times a few
    /// ulp. The direction's error counts over the way from the origin to the instance, which is
    /// no longer than the sum of the two terms.
    #[inline(always)]
    pub fn error(&self, origin: DVec3) -> f64 {
        let terms = self.inverse_norm * origin.abs().max_element() + self.max_coordinate;
        64.0 * f64::EPSILON * self.condition * terms
    }

    /// The greatest length in object space of what is `length` long in the world.
    #[inline(always)]
    pub fn max_object_length(&self, length: f64) -> f64 {
        self.inverse_norm * length
    }
}

/// The sum of the columns' lengths, which bounds the operator norm.
fn norm(m: &DMat3) -> f64 {
    m.x_axis.length() + m.y_axis.length() + m.z_axis.length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{MaterialId, MeshId};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_point_of_the_instance_is_transformed_back_to_within_the_error(
            local in prop::array::uniform3(-1.0..1.0f64),
            offset in prop::array::uniform3(-1e7..1e7f64),
            scale in prop::array::uniform3(1e-3..1e3f64),
            angle in 0.0..6.3f64,
        ) {
            let transform = DAffine3::from_translation(DVec3::from(offset))
                * DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), angle)
                * DAffine3::from_scale(DVec3::from(scale));
            let instance = Instance::new(MeshId(0), transform, MaterialId(0));
            let unit = Bounds { lower: -DVec3::ONE, upper: DVec3::ONE };
            let space = ObjectSpace::new(&instance, &unit.transformed(&transform));
            let local = DVec3::from(local);
            let world = transform.transform_point3(local);
            let back = space.object_ray(world, DVec3::X).0;
            prop_assert!((back - local).abs().max_element() <= space.error(world));
        }
    }
}
