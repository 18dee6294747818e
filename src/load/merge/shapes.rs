//! The spheres and planes of a placed model.

use glam::DVec3;

use super::{MergedModel, Placement};
use crate::scene::{Plane, Scene, Sphere};

impl MergedModel {
    /// Adds the model's spheres and planes as they are placed. A sphere stays one: where it is
    /// scaled unevenly it gets the mean scale, with a warning.
    pub(super) fn place_shapes(
        &self,
        scene: &mut Scene,
        placement: &Placement,
        warnings: &mut Vec<String>,
    ) {
        let transform = &placement.transform;
        let axes = [0, 1, 2].map(|i| transform.matrix3.col(i).length());
        let mean = transform.matrix3.determinant().abs().cbrt();
        let is_uneven = axes.iter().any(|axis| (axis - mean).abs() > 1e-6 * mean);
        if is_uneven && !self.spheres.is_empty() {
            let count = self.spheres.len();
            warnings.push(format!(
                "{count} spheres of a model that is scaled unevenly stay spheres, of its mean scale"
            ));
        }
        scene.spheres.extend(self.spheres.iter().map(|sphere| Sphere {
            center: transform.transform_point3(sphere.center),
            radius: sphere.radius * mean,
            material: placement.material.unwrap_or(sphere.material),
            casts_shadow: placement.casts_shadow && sphere.casts_shadow,
        }));
        if placement.node.is_some() && !self.planes.is_empty() {
            warnings.push("planes of a model that moves stand still".to_owned());
        }
        let cofactors = transform.matrix3.inverse().transpose();
        scene.planes.extend(self.planes.iter().map(|plane| Plane {
            point: transform.transform_point3(plane.point),
            normal: (cofactors * plane.normal).try_normalize().unwrap_or(DVec3::Y),
            material: placement.material.unwrap_or(plane.material),
            casts_shadow: placement.casts_shadow && plane.casts_shadow,
            ..*plane
        }));
    }
}
