//! Light, backdrop and ground for bare model files: a small photographer's studio.

use glam::{DVec3, Vec3};

use super::auto_camera::extents;
use crate::scene::{
    Camera, Light, LightKind, Material, MetallicRoughness, Plane, Scene, Shadow, mirror_share,
};

/// The radiance of the backdrop, linear: a PNG shows it as #808080, on which white and black things
/// both stand out, and which metals have to mirror.
const BACKDROP: f32 = 0.216;
/// How far below a model its ground is, as a share of its size: what lies on it does not coincide.
const GAP: f64 = 1e-4;
/// The light from everywhere, of ours and beside a file's own lights, whose shadows would be black.
const AMBIENT: [f32; 2] = [0.2, 0.1];

/// How bright a file's own lights may make white in the middle of the model, as they are.
const SHOWN: std::ops::RangeInclusive<f32> = 0.25..=2.0;

/// Gives a bare model a neutral backdrop and, where it has none, lights, as its first camera sees
/// it: a key light from the upper left, a weaker one from the right, and a little from everywhere.
/// A file's own lights are kept, with a little from everywhere beside them; where they are far
/// brighter or darker than a picture shows, it is exposed for them, and backdrop and ambient light
/// are as much brighter or darker.
pub fn light(scene: &mut Scene) {
    let has_own = !scene.lights.is_empty();
    let is_ambient = |light: &Light| light.kind == LightKind::Ambient;
    let mut unit = 1.0;
    if has_own {
        let bright = brightness(scene);
        if bright > 0.0 && bright.is_finite() && !SHOWN.contains(&bright) {
            unit = bright;
        }
    } else {
        let camera = scene.cameras.first();
        scene.lights.extend(camera.map(directional).into_iter().flatten());
    }
    scene.film.background = Vec3::splat(BACKDROP * unit);
    scene.materials.iter_mut().for_each(|material| blur(material, scene.film.background));
    scene.film.exposure = -f64::from(unit).log2();
    if !scene.lights.iter().any(is_ambient) {
        scene.lights.push(Light {
            name: "ambient".to_owned(),
            kind: LightKind::Ambient,
            intensity: Vec3::splat(AMBIENT[usize::from(has_own)] * unit),
            shadow: Shadow::None,
        });
    }
}

/// Adds what a rough metal has of the backdrop: a reflection so blurred that no ray shows it, which,
/// where all around looks the same, is as bright as that. Only where the metal is one everywhere.
fn blur(material: &mut Material, backdrop: Vec3) {
    let Some(maps) = &material.metallic else { return };
    if maps.metallic.is_some() || maps.roughness.is_some() || material.emission != Vec3::ZERO {
        return;
    }
    let MetallicRoughness { base, metallic, roughness, .. } = maps.factors;
    let share = metallic * (1.0 - mirror_share(roughness));
    if share > 0.0 {
        material.emission = base.min(Vec3::ONE) * share * backdrop;
        material.emission_map = maps.base;
        // Colours of vertices are those of the metal.
        material.unlit = true;
    }
}

/// How bright white is that faces all lights at once: the median of the middle of the model and the
/// points halfway to the corners of its box, since a light may stand right beside one of them. The
/// corners themselves are often those of a wide floor, far from what is lit.
fn brightness(scene: &Scene) -> f32 {
    let bounds = scene.bounds();
    let center = bounds.center();
    let halfway = |i: u32| {
        let side = |k: u32| if i >> k & 1 == 0 { bounds.lower } else { bounds.upper };
        center.midpoint(DVec3::new(side(0).x, side(1).y, side(2).z))
    };
    let at = |point: DVec3| -> f32 {
        let arrivals = scene.lights.iter().filter_map(|light| light.incident(point));
        arrivals.map(|arrival| arrival.intensity.max_element()).sum()
    };
    let mut found: Vec<f32> = (0..8).map(halfway).chain([center]).map(at).collect();
    found.sort_by(f32::total_cmp);
    found[found.len() / 2]
}

/// The key light, which casts shadows, and the fill, which brightens them.
fn directional(camera: &Camera) -> [Light; 2] {
    // To the light, in the camera's axes: right, up, and back to the viewer.
    let sun = |name: &str, [right, up, back]: [f64; 3], intensity: f32, shadow: Shadow| {
        let to = camera.right * right + camera.up * up - camera.forward * back;
        Light {
            name: name.to_owned(),
            kind: LightKind::Directional { direction: -to.normalize() },
            intensity: Vec3::splat(intensity),
            shadow,
        }
    };
    [
        sun("key", [-0.7, 0.9, 0.7], 0.8, Shadow::Tinted),
        sun("fill", [0.9, 0.1, 0.6], 0.25, Shadow::None),
    ]
}

/// Puts matt ground under a scene, on which its shadow falls: a plane just below its lowest point,
/// that without a shadow looks like the background, so that it has no horizon. Where lights that
/// are no suns shine on it, it is an even grey instead.
///
/// Nothing happens to a scene that has no finite lowest point.
pub fn add_ground(scene: &mut Scene) {
    let bounds = scene.bounds_over_time();
    let [lowest] = extents(scene, &bounds, [DVec3::NEG_Y]).map(|extent| -extent);
    if bounds.is_empty() || !lowest.is_finite() {
        return;
    }
    // How bright white would be there.
    let bright = scene.lights.iter().try_fold(Vec3::ZERO, |sum, light| match light.kind {
        LightKind::Ambient => Some(sum + light.intensity),
        LightKind::Directional { direction } => {
            Some(sum + light.intensity * (-direction.y).max(0.0) as f32)
        }
        LightKind::Point { .. } | LightKind::Spot { .. } => None,
    });
    let diffuse = match bright {
        Some(bright) if bright.min_element() > 0.0 => {
            (scene.film.background / bright).min(Vec3::ONE)
        }
        _ => Vec3::splat(BACKDROP),
    };
    let material = Material { name: "ground".to_owned(), diffuse, ..Material::default() };
    let material = scene.add_material(material);
    let point = bounds.center().with_y(lowest - GAP * bounds.diagonal());
    scene.planes.push(Plane::new(point, DVec3::Y, material));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::defaults::auto_camera::frame;
    use crate::scene::{MaterialId, MetallicRoughnessMaps, Sphere};

    fn ball() -> Scene {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::new(0.0, 3.0, 0.0), 2.0, MaterialId(0)));
        frame(&mut scene);
        scene
    }

    #[test]
    fn lights_come_from_where_the_camera_stands() {
        let mut scene = ball();
        light(&mut scene);
        let camera = &scene.cameras[0];
        let LightKind::Directional { direction } = scene.lights[0].kind else { panic!() };
        assert!(direction.dot(camera.forward) > 0.0 && direction.dot(camera.right) > 0.0);
        assert_eq!(scene.lights.len(), 3);
    }

    #[test]
    fn a_files_own_lights_are_kept_with_a_little_light_from_everywhere() {
        let mut scene = ball();
        light(&mut scene);
        let own = vec![scene.lights.swap_remove(0)];
        scene.lights.clone_from(&own);
        light(&mut scene);
        assert_eq!(scene.lights[..1], own);
        assert_eq!(scene.lights[1].kind, LightKind::Ambient);
        assert_eq!(scene.lights.len(), 2);
        let lights = scene.lights.clone();
        light(&mut scene);
        assert_eq!(scene.lights, lights);
    }

    #[test]
    fn lights_far_brighter_than_a_picture_are_exposed_for() {
        let mut scene = ball();
        light(&mut scene);
        scene.lights.truncate(1);
        scene.lights[0].intensity = Vec3::splat(1024.0);
        light(&mut scene);
        assert_eq!(scene.film.exposure, -10.0);
        assert_eq!(scene.film.background, Vec3::splat(BACKDROP * 1024.0));
        assert_eq!(scene.lights[1].intensity, Vec3::splat(AMBIENT[1] * 1024.0));
    }

    #[test]
    fn lights_that_a_picture_shows_are_not_exposed_for() {
        let mut scene = ball();
        light(&mut scene);
        scene.lights.truncate(1);
        scene.lights[0].intensity = Vec3::splat(1.9);
        light(&mut scene);
        assert_eq!((scene.film.exposure, scene.film.background), (0.0, Vec3::splat(BACKDROP)));
    }

    #[test]
    fn rough_metals_have_the_light_of_the_backdrop_and_smooth_ones_mirror_it() {
        let emission = |metallic: f32, roughness: f32| {
            let mut scene = ball();
            let factors = MetallicRoughness {
                base: Vec3::new(1.0, 0.5, 0.0),
                metallic,
                roughness,
                specular: 1.0,
                specular_color: Vec3::ONE,
                transmission: 0.0,
                ior: 1.5,
            };
            let mut material = Material::default();
            material.set_metallic_roughness(MetallicRoughnessMaps::new(factors));
            let id = scene.add_material(material);
            light(&mut scene);
            scene.materials[id.0 as usize].emission / BACKDROP
        };
        assert_eq!(emission(1.0, 1.0), Vec3::new(1.0, 0.5, 0.0));
        assert_eq!(emission(0.5, 1.0), Vec3::new(0.5, 0.25, 0.0));
        assert_eq!((emission(1.0, 0.0), emission(0.0, 1.0)), (Vec3::ZERO, Vec3::ZERO));
    }

    #[test]
    fn the_ground_lies_under_the_lowest_point_and_looks_like_the_background() {
        let mut scene = ball();
        light(&mut scene);
        add_ground(&mut scene);
        let plane = &scene.planes[0];
        assert!(plane.point.y < 1.0 && plane.point.y > 0.99);
        let diffuse = scene.materials[plane.material.0 as usize].diffuse;
        let bright: f32 = scene
            .lights
            .iter()
            .map(|light| match light.kind {
                LightKind::Directional { direction } => {
                    light.intensity.x * (-direction.y).max(0.0) as f32
                }
                _ => light.intensity.x,
            })
            .sum();
        assert!((diffuse.x * bright - BACKDROP).abs() < 1e-6);
    }

    #[test]
    fn nothing_stands_on_no_ground() {
        let mut scene = Scene::default();
        add_ground(&mut scene);
        assert_eq!(scene.planes.len(), 0);
    }
}
