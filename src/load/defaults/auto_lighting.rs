//! The lights and the background of model files.

use glam::{DMat3, DVec3, Vec3};

use crate::scene::{Camera, Environment, Light, Scene};

/// The radiance of the background, linear: a PNG shows it as #808080, on which white and black things
/// both stand out.
pub const BACKGROUND: f32 = 0.216;
/// The intensity of the key light in the studio.
const STUDIO_KEY: f32 = 0.5;
/// The factor of the studio beside a file's own lights, whose shadows would be black.
const STUDIO_BESIDE_OWN: f32 = 0.25;

/// The brightness of white in the middle of the model for which the exposure stays as it is.
const NORMAL_BRIGHTNESS: std::ops::RangeInclusive<f32> = 0.25..=2.0;

/// Lights a bare model, whose right, up and front are the columns of a rotation, and gives it a neutral
/// background.
///
/// A model without lights gets the built-in studio, turned to its first camera, with a key light from the upper
/// left that casts shadows. Beside a file's own lights the studio is weak: it only keeps shadows from being black,
/// and gives metals something to mirror. With an environment that was asked for (`has_environment`) nothing is
/// added to it. Where the light is far brighter or darker than an image shows, it is exposed for it, and the
/// background and the studio are as much brighter or darker.
pub fn light_model(scene: &mut Scene, axes: DMat3, has_environment: bool) {
    // The brightness of what lights the scene, by which all else is scaled.
    let bright = brightness(scene);
    let is_odd = bright > 0.0 && bright.is_finite() && !NORMAL_BRIGHTNESS.contains(&bright);
    let scale = if is_odd { bright } else { 1.0 };
    if !has_environment {
        let has_own = !scene.lights.is_empty();
        add_studio(scene, axes);
        if let (true, Some(studio)) = (has_own, &mut scene.environment) {
            studio.intensity = Vec3::splat(STUDIO_BESIDE_OWN * scale);
        }
    }
    // The background, and the exposure that brings all back to normal.
    scene.film.background = Vec3::splat(BACKGROUND * scale);
    scene.film.exposure = -f64::from(scale).log2();
}

/// Returns the angle about the vertical axis, counter-clockwise seen from above, from the front of a model, whose
/// right, up and front are the columns of a rotation, to where a camera stands.
fn azimuth(camera: &Camera, axes: DMat3) -> f64 {
    let back = axes.transpose() * -camera.forward;
    // A camera that looks straight down has the top of its picture for the back.
    let level = if back.x.hypot(back.z) > 1e-3 { back } else { axes.transpose() * -camera.up };
    level.x.atan2(level.z)
}

/// Adds the built-in studio, turned to the first camera, and, if the scene has no light, a key light from the upper
/// left, which casts shadows.
pub fn add_studio(scene: &mut Scene, axes: DMat3) {
    let camera = scene.cameras.first();
    let angle = camera.map_or(0.0, |camera| azimuth(camera, axes));
    if scene.lights.is_empty() {
        scene.lights.extend(camera.map(key_light));
    }
    scene.environment = Some(Environment::studio().with_axes(axes).rotated(angle));
}

/// Returns the brightness of white that faces all lights at once, in its environment: the median of the middle of the
/// model and the points halfway to the corners of its box, since a light may stand right beside one of
/// them. The corners themselves are often those of a wide floor, far from what is lit.
fn brightness(scene: &Scene) -> f32 {
    let bounds = scene.bounds();
    let center = bounds.center();
    // Half of the way to a corner of the box, by the bits of its number.
    let halfway = |i: u32| {
        let side = |k: u32| if i >> k & 1 == 0 { bounds.lower } else { bounds.upper };
        center.midpoint(DVec3::new(side(0).x, side(1).y, side(2).z))
    };
    let environment = scene.environment.as_ref();
    let around = environment.map_or(0.0, |environment| environment.mean_radiance().max_element());
    let brightness = |point: DVec3| -> f32 {
        let incident = scene.lights.iter().filter_map(|light| light.incident(point));
        around + incident.map(|incident| incident.intensity.max_element()).sum::<f32>()
    };
    let points = (0..8).map(halfway).chain([center]);
    let mut found: Vec<f32> = points.map(brightness).collect();
    found.sort_by(f32::total_cmp);
    found[found.len() / 2]
}

/// Returns the key light of a scene that this camera sees.
fn key_light(camera: &Camera) -> Light {
    let toward = -camera.right * 0.7 + camera.up * 0.9 - camera.forward * 0.7;
    Light::sun(-toward).with_intensity(Vec3::splat(STUDIO_KEY)).with_name("key")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::defaults::auto_camera::add_camera;
    use crate::load::framing::Framing;
    use crate::scene::{LightKind, MaterialId, Sphere};

    fn ball() -> Scene {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::new(0.0, 3.0, 0.0), 2.0, MaterialId(0)));
        add_camera(&mut scene, &Framing::default()).unwrap();
        scene
    }

    fn light(scene: &mut Scene) {
        light_model(scene, DMat3::IDENTITY, false);
    }

    #[test]
    fn the_key_light_comes_from_where_the_camera_stands() {
        let mut scene = ball();
        light(&mut scene);
        let camera = &scene.cameras[0];
        let [Light { kind: LightKind::Directional { direction, .. }, .. }] = scene.lights[..]
        else {
            panic!("{:?}", scene.lights)
        };
        assert!(direction.dot(camera.forward) > 0.0 && direction.dot(camera.right) > 0.0);
    }

    #[test]
    fn the_studio_is_turned_to_the_camera() {
        // Seen from the camera, its key light is to the upper left, and from behind to the upper right.
        let mut scene = ball();
        let mut behind = ball();
        let camera = &mut behind.cameras[0];
        camera.position = DVec3::new(-camera.position.x, camera.position.y, -camera.position.z);
        let turn = DMat3::from_rotation_y(std::f64::consts::PI);
        for axis in [&mut camera.right, &mut camera.up, &mut camera.forward] {
            *axis = turn * *axis;
        }
        light(&mut scene);
        light(&mut behind);
        let seen = |scene: &Scene| {
            let camera = &scene.cameras[0];
            let toward = -camera.right * 0.7 + camera.up * 0.9 - camera.forward * 0.7;
            scene.environment.as_ref().unwrap().radiance(toward)
        };
        assert!((seen(&scene) - seen(&behind)).abs().max_element() < 1e-3);
        assert!(seen(&scene).x > 1.0);
    }

    #[test]
    fn a_files_own_lights_are_kept_beside_a_weak_studio() {
        let mut scene = ball();
        let own = vec![Light::sun(DVec3::NEG_Y)];
        scene.lights.clone_from(&own);
        light(&mut scene);
        assert_eq!(scene.lights, own);
        let studio = scene.environment.unwrap();
        assert_eq!(studio.intensity, Vec3::splat(STUDIO_BESIDE_OWN));
    }

    #[test]
    fn lights_far_brighter_than_an_image_are_exposed_for() {
        let mut scene = ball();
        scene.lights.push(Light::sun(DVec3::NEG_Y).with_intensity(Vec3::splat(1024.0)));
        light(&mut scene);
        assert_eq!(scene.film.exposure, -10.0);
        assert_eq!(scene.film.background, Vec3::splat(BACKGROUND * 1024.0));
        let studio = scene.environment.unwrap();
        assert_eq!(studio.intensity, Vec3::splat(STUDIO_BESIDE_OWN * 1024.0));
    }

    #[test]
    fn an_environment_far_darker_than_an_image_is_exposed_for() {
        let mut scene = ball();
        scene.environment = Some(Environment::even(Vec3::splat(1.0 / 64.0)));
        light_model(&mut scene, DMat3::IDENTITY, true);
        assert!((scene.film.exposure - 6.0).abs() < 1e-3, "{}", scene.film.exposure);
        assert_eq!(scene.lights, []);
    }

    #[test]
    fn lights_that_an_image_shows_are_not_exposed_for() {
        let mut scene = ball();
        scene.lights.push(Light::sun(DVec3::NEG_Y).with_intensity(Vec3::splat(1.9)));
        light(&mut scene);
        assert_eq!((scene.film.exposure, scene.film.background), (0.0, Vec3::splat(BACKGROUND)));
    }
}
