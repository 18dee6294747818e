//! The ground under a scene that has none.

use glam::{DVec3, Vec3};

use super::auto_lighting::BACKGROUND;
use super::extents::extents;
use crate::scene::{LightKind, Material, Plane, Scene};

/// The distance of the ground from the lowest point of a model, as a share of its size, so
/// that a flat bottom does not coincide with it.
const GAP: f64 = 1e-4;

/// Adds a matt plane just below the lowest point of a scene, where `up` is the upward direction of length 1,
/// to receive its shadows. Without a shadow it looks like the background, so that it has no horizon; where point or spot lights shine
/// on it, it is an even grey instead.
///
/// Nothing happens to a scene that has no finite lowest point.
pub fn add_ground(scene: &mut Scene, up: DVec3) {
    let bounds = scene.bounds_over_time();
    let [lowest] = extents(scene, &bounds, [-up]).map(|extent| -extent);
    if bounds.is_empty() || !lowest.is_finite() {
        return;
    }
    // The brightness of white there, where it is the same everywhere.
    let environment = scene.environment.as_ref();
    let around = environment.map_or(Vec3::ZERO, |environment| environment.diffuse_light(up));
    let white = scene.lights.iter().try_fold(around, |sum, light| match light.kind {
        LightKind::Ambient => Some(sum + light.intensity),
        LightKind::Directional { direction, .. } => {
            Some(sum + light.intensity * (-direction.dot(up)).max(0.0) as f32)
        }
        _ => None,
    });

    // The diffuse colour that makes the ground as bright as the background.
    let diffuse = match white {
        Some(white) if white.min_element() > 0.0 => (scene.film.background / white).min(Vec3::ONE),
        _ => Vec3::splat(BACKGROUND),
    };

    // The plane itself, a little lower than the lowest point.
    let material = Material { name: "ground".to_owned(), diffuse, ..Material::default() };
    let material = scene.add_material(material);
    let center = bounds.center();
    let point = center - up * center.dot(up) + up * (lowest - GAP * bounds.diagonal());
    scene.planes.push(Plane::new(point, up, material));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::defaults::auto_camera::add_camera;
    use crate::load::defaults::auto_lighting::light_model;
    use crate::load::framing::Framing;
    use crate::scene::{MaterialId, Sphere};

    #[test]
    fn the_ground_lies_under_the_lowest_point_and_looks_like_the_background() {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::new(0.0, 3.0, 0.0), 2.0, MaterialId(0)));
        add_camera(&mut scene, &Framing::default()).unwrap();
        light_model(&mut scene, glam::DMat3::IDENTITY, false);
        add_ground(&mut scene, DVec3::Y);
        let plane = &scene.planes[0];
        assert!(plane.point.y < 1.0 && plane.point.y > 0.99);
        let diffuse = scene.materials[plane.material.0 as usize].diffuse;
        let around = scene.environment.as_ref().unwrap().diffuse_light(DVec3::Y).x;
        let bright: f32 = scene
            .lights
            .iter()
            .map(|light| match light.kind {
                LightKind::Directional { direction, .. } => {
                    light.intensity.x * (-direction.y).max(0.0) as f32
                }
                _ => light.intensity.x,
            })
            .sum::<f32>()
            + around;
        assert!((diffuse.x * bright - BACKGROUND).abs() < 1e-6);
    }

    #[test]
    fn an_empty_scene_gets_no_ground() {
        let mut scene = Scene::default();
        add_ground(&mut scene, DVec3::Y);
        assert_eq!(scene.planes.len(), 0);
    }
}
