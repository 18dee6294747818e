//! The lights and the background of model files.

use glam::{DVec3, Vec3};

use crate::scene::{
    Camera, Light, LightKind, Material, MetallicRoughness, Scene, Shadow, mirror_share,
};

/// The radiance of the background, linear: a PNG shows it as #808080, on which white and black things
/// both stand out, and which metals have to mirror.
pub const BACKGROUND: f32 = 0.216;
/// The ambient light beside the automatic lights.
const AMBIENT: f32 = 0.2;
/// The ambient light beside a file's own lights, whose shadows would be black.
const AMBIENT_BESIDE_OWN: f32 = 0.1;

/// The brightness of white in the middle of the model for which the exposure stays as it is.
const NORMAL_BRIGHTNESS: std::ops::RangeInclusive<f32> = 0.25..=2.0;

/// Adds a neutral background to a bare model and, where it has none, lights, as its first camera
/// sees it: a key light from the upper left, a weaker fill light from the right, and a little ambient
/// light.
///
/// A file's own lights are kept, with a little ambient light beside them; where they are far brighter
/// or darker than an image shows, it is exposed for them, and background and ambient light are as much
/// brighter or darker.
pub fn add_lights(scene: &mut Scene) {
    let has_own = !scene.lights.is_empty();
    let is_ambient = |light: &Light| light.kind == LightKind::Ambient;
    // The brightness of the lights, by which all else is scaled.
    let mut scale = 1.0;
    if has_own {
        let bright = brightness(scene);
        if bright > 0.0 && bright.is_finite() && !NORMAL_BRIGHTNESS.contains(&bright) {
            scale = bright;
        }
    } else {
        add_default_lights(scene);
    }

    // The background, which rough metals reflect, and the exposure that brings all back to normal.
    let background = Vec3::splat(BACKGROUND * scale);
    scene.film.background = background;
    scene.materials.iter_mut().for_each(|material| add_blurred_reflection(material, background));
    scene.film.exposure = -f64::from(scale).log2();

    // Ambient light, so that no shadow is black.
    if !scene.lights.iter().any(is_ambient) {
        scene.lights.push(ambient(AMBIENT_BESIDE_OWN * scale));
    }
}

/// Adds the default lights to a scene that has none: key, fill and ambient light.
pub fn add_default_lights(scene: &mut Scene) {
    let camera = scene.cameras.first();
    scene.lights.extend(camera.map(key_and_fill).into_iter().flatten());
    scene.lights.push(ambient(AMBIENT));
}

/// Returns ambient light.
fn ambient(intensity: f32) -> Light {
    Light {
        name: "ambient".to_owned(),
        kind: LightKind::Ambient,
        intensity: Vec3::splat(intensity),
        shadow: Shadow::None,
    }
}

/// Adds the background's reflection in a rough metal, as emission: it is so blurred that no ray shows
/// it, and, where all around looks the same, as bright as that. Only materials that are metal
/// everywhere get it.
fn add_blurred_reflection(material: &mut Material, background: Vec3) {
    let Some(maps) = &material.metallic else { return };
    if maps.metallic.is_some() || maps.roughness.is_some() || material.emission != Vec3::ZERO {
        return;
    }
    let MetallicRoughness { base, metallic, roughness, .. } = maps.factors;
    let share = metallic * (1.0 - mirror_share(roughness));
    if share > 0.0 {
        material.emission = base.min(Vec3::ONE) * share * background;
        material.emission_map = maps.base;
        // Colours of vertices are those of the metal.
        material.unlit = true;
    }
}

/// Returns the brightness of white that faces all lights at once: the median of the middle of the
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
    let brightness = |point: DVec3| -> f32 {
        let incident = scene.lights.iter().filter_map(|light| light.incident(point));
        incident.map(|incident| incident.intensity.max_element()).sum()
    };
    let points = (0..8).map(halfway).chain([center]);
    let mut found: Vec<f32> = points.map(brightness).collect();
    found.sort_by(f32::total_cmp);
    found[found.len() / 2]
}

/// Returns the key light, which casts shadows, and the fill light, which brightens them.
fn key_and_fill(camera: &Camera) -> [Light; 2] {
    // The directions to the light, in the camera's axes: right, up, and back to the viewer.
    let light = |name: &str, [right, up, back]: [f64; 3], intensity: f32, shadow: Shadow| {
        let to = camera.right * right + camera.up * up - camera.forward * back;
        Light {
            name: name.to_owned(),
            kind: LightKind::Directional { direction: -to.normalize() },
            intensity: Vec3::splat(intensity),
            shadow,
        }
    };
    [
        light("key", [-0.7, 0.9, 0.7], 0.8, Shadow::Tinted),
        light("fill", [0.9, 0.1, 0.6], 0.25, Shadow::None),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::defaults::auto_camera::add_camera;
    use crate::load::framing::Framing;
    use crate::scene::{MaterialId, MetallicRoughnessMaps, Sphere};

    fn ball() -> Scene {
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::new(0.0, 3.0, 0.0), 2.0, MaterialId(0)));
        add_camera(&mut scene, &Framing::default()).unwrap();
        scene
    }

    #[test]
    fn lights_come_from_where_the_camera_stands() {
        let mut scene = ball();
        add_lights(&mut scene);
        let camera = &scene.cameras[0];
        let LightKind::Directional { direction } = scene.lights[0].kind else { panic!() };
        assert!(direction.dot(camera.forward) > 0.0 && direction.dot(camera.right) > 0.0);
        assert_eq!(scene.lights.len(), 3);
    }

    #[test]
    fn a_files_own_lights_are_kept_with_a_little_ambient_light() {
        let mut scene = ball();
        add_lights(&mut scene);
        let own = vec![scene.lights.swap_remove(0)];
        scene.lights.clone_from(&own);
        add_lights(&mut scene);
        assert_eq!(scene.lights[..1], own);
        assert_eq!(scene.lights[1].kind, LightKind::Ambient);
        assert_eq!(scene.lights.len(), 2);
        let lights = scene.lights.clone();
        add_lights(&mut scene);
        assert_eq!(scene.lights, lights);
    }

    #[test]
    fn lights_far_brighter_than_an_image_are_exposed_for() {
        let mut scene = ball();
        add_lights(&mut scene);
        scene.lights.truncate(1);
        scene.lights[0].intensity = Vec3::splat(1024.0);
        add_lights(&mut scene);
        assert_eq!(scene.film.exposure, -10.0);
        assert_eq!(scene.film.background, Vec3::splat(BACKGROUND * 1024.0));
        assert_eq!(scene.lights[1].intensity, Vec3::splat(AMBIENT_BESIDE_OWN * 1024.0));
    }

    #[test]
    fn lights_that_an_image_shows_are_not_exposed_for() {
        let mut scene = ball();
        add_lights(&mut scene);
        scene.lights.truncate(1);
        scene.lights[0].intensity = Vec3::splat(1.9);
        add_lights(&mut scene);
        assert_eq!((scene.film.exposure, scene.film.background), (0.0, Vec3::splat(BACKGROUND)));
    }

    #[test]
    fn rough_metals_have_the_light_of_the_background_and_smooth_ones_mirror_it() {
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
            add_lights(&mut scene);
            scene.materials[id.0 as usize].emission / BACKGROUND
        };
        assert_eq!(emission(1.0, 1.0), Vec3::new(1.0, 0.5, 0.0));
        assert_eq!(emission(0.5, 1.0), Vec3::new(0.5, 0.25, 0.0));
        assert_eq!((emission(1.0, 0.0), emission(0.0, 1.0)), (Vec3::ZERO, Vec3::ZERO));
    }
}
