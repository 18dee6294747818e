//! A camera and lights for model files that bring none.

use glam::{DVec3, Vec3};

use crate::geometry::Bounds;
use crate::scene::{Camera, Lens, Light, LightKind, Scene, Shadow};

/// Half the vertical field of view of the framing camera, in radians: 35° in all.
const HALF_FOV: f64 = 17.5 * std::f64::consts::PI / 180.0;

/// Gives a scene default lights, when it has none.
pub fn light(scene: &mut Scene) {
    if scene.lights.is_empty() {
        scene.lights = default_lights();
    }
}

/// Gives a scene a camera that frames it, when it has none: a view from above and to the side
/// that keeps the whole bounding sphere in the picture.
pub fn frame(scene: &mut Scene) {
    if !scene.cameras.is_empty() {
        return;
    }
    let bounds = match scene.bounds_over_time() {
        // Nothing finite to frame: look at the origin from a little above.
        b if b.is_empty() => Bounds { lower: DVec3::NEG_ONE, upper: DVec3::ONE },
        b => b,
    };
    let [width, height] = scene.film.size.map(f64::from);
    // The narrower of the two half-angles must hold the sphere.
    let narrow = (HALF_FOV.tan() * (width / height).min(1.0)).atan();
    let radius = (bounds.diagonal() * 0.5).max(1e-6 * (1.0 + bounds.max_abs()));
    let distance = radius / narrow.sin() * 0.95;
    let target = bounds.center();
    let position = target + DVec3::new(0.55, 0.45, 1.0).normalize() * distance;
    let lens = Lens::FovY(2.0 * HALF_FOV);
    // Fails only where the scene is not finite, which `Scene::check` then says.
    if let Ok(mut camera) = Camera::look_at(position, target, DVec3::Y, lens) {
        camera.name = "framing".to_owned();
        scene.cameras.push(camera);
    }
}

/// A key light from the upper left, a weaker fill from the right, and a little from everywhere.
fn default_lights() -> Vec<Light> {
    let sun = |name: &str, direction: DVec3, intensity: f32, shadow: Shadow| Light {
        name: name.to_owned(),
        kind: LightKind::Directional { direction: direction.normalize() },
        intensity: Vec3::splat(intensity),
        shadow,
    };
    vec![
        sun("key", DVec3::new(0.5, -1.0, -0.6), 0.8, Shadow::Tinted),
        sun("fill", DVec3::new(-1.0, -0.3, -0.4), 0.25, Shadow::None),
        Light {
            name: "ambient".to_owned(),
            kind: LightKind::Ambient,
            intensity: Vec3::splat(0.15),
            shadow: Shadow::None,
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{MaterialId, Sphere};

    #[test]
    fn framing_camera_sees_the_whole_model_at_any_shape_of_picture() {
        for size in [[400, 300], [300, 900], [1000, 100]] {
            let mut scene = Scene::default();
            scene.film.size = size;
            scene.spheres.push(Sphere::new(DVec3::new(5.0, -3.0, 2.0), 2.0, MaterialId(0)));
            frame(&mut scene);
            let camera = &scene.cameras[0];
            let rays = camera.rays(size);
            let edges = [(0.0, 0.5), (1.0, 0.5), (0.5, 0.0), (0.5, 1.0)];
            for (x, y) in edges.map(|(x, y)| (x * f64::from(size[0]), y * f64::from(size[1]))) {
                let ray = rays.through(x, y);
                let to = scene.spheres[0].center - ray.origin;
                let past =
                    to - ray.direction * (to.dot(ray.direction) / ray.direction.length_squared());
                assert!(past.length() > 2.0, "{size:?} cuts the sphere");
            }
        }
    }

    #[test]
    fn a_scene_that_is_not_finite_gets_no_camera() {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::INFINITY, 2.0, MaterialId(0)));
        frame(&mut scene);
        assert_eq!(scene.cameras, []);
    }

    #[test]
    fn a_files_own_camera_and_lights_are_kept() {
        let mut scene = Scene::default();
        frame(&mut scene);
        light(&mut scene);
        let (camera, lights) = (scene.cameras.clone(), scene.lights.clone());
        frame(&mut scene);
        light(&mut scene);
        assert_eq!((camera, lights), (scene.cameras, scene.lights));
    }
}
