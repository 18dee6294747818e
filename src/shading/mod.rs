//! How much light a surface sends to the eye: Lambert and Phong, and what it sends on. Traces
//! nothing.

mod dielectric;
mod normalize;
mod power;

use glam::{DVec3, Vec3};

pub use dielectric::{DielectricInterface, transmittance};
pub use normalize::{normalize, normalize16};
pub use power::{integer_exponent, power, power16};

/// Colours of a surface at one point, with its textures applied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflectance {
    /// Share scattered to all sides.
    pub diffuse: Vec3,
    /// Share in the highlight.
    pub specular: Vec3,
    /// Phong's exponent, the tutorial's α.
    pub shininess: f32,
}

/// The light of one source that a surface sends along −`view`, in units of the light's intensity.
///
/// `view` goes from the eye to the surface, `normal` has length 1, `light` leads to the light;
/// `view` and `light` may have any length but zero. Lambert's share is n·l, without 1/π; Phong's is
/// max(0, r·l)^α with r = u − 2(u·n)n, both as in the tutorial (III.2, III.3; Bui Tuong Phong,
/// *Illumination for Computer Generated Pictures*, 1975). Nothing when the surface faces away
/// from the light.
pub fn direct(reflectance: &Reflectance, normal: DVec3, view: DVec3, light: DVec3) -> Vec3 {
    let (view, light) = (normalize(view), normalize(light));
    let cosine = lambert(normal, light);
    if cosine <= 0.0 {
        return Vec3::ZERO;
    }
    let mut sum = reflectance.diffuse * cosine as f32;
    if reflectance.specular != Vec3::ZERO {
        let toward = phong(normal, view, light);
        sum += reflectance.specular * power(toward, reflectance.shininess) as f32;
    }
    sum
}

/// The cosine n·l of the angle between a normal and the way to a light, both of length 1.
#[inline(always)]
pub fn lambert(normal: DVec3, light: DVec3) -> f64 {
    normal.dot(light)
}

/// The cosine max(0, r·l) of the angle between what a mirror would send on and the way to a light;
/// all of length 1.
#[inline(always)]
pub fn phong(normal: DVec3, view: DVec3, light: DVec3) -> f64 {
    reflect(view, normal).dot(light).clamp(0.0, 1.0)
}

/// The direction u − 2(u·n)n in which a mirror with unit normal `normal` sends `incoming`.
#[inline(always)]
pub fn reflect(incoming: DVec3, normal: DVec3) -> DVec3 {
    incoming - normal * (2.0 * incoming.dot(normal))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MATT: Reflectance =
        Reflectance { diffuse: Vec3::ONE, specular: Vec3::ZERO, shininess: 1.0 };

    #[test]
    fn lambert_at_sixty_degrees_is_a_half() {
        let light = DVec3::new(3f64.sqrt() / 2.0, 0.5, 0.0) * 7.0;
        let sum = direct(&MATT, DVec3::Y, DVec3::NEG_Y, light);
        assert!((sum - Vec3::splat(0.5)).length() < 1e-7);
    }

    #[test]
    fn nothing_from_behind() {
        let shiny = Reflectance { specular: Vec3::ONE, shininess: 2.0, ..MATT };
        assert_eq!(direct(&shiny, DVec3::Y, DVec3::NEG_Y, DVec3::NEG_Y), Vec3::ZERO);
    }

    #[test]
    fn highlight_is_whole_in_the_mirror_direction() {
        let gloss = Reflectance { diffuse: Vec3::ZERO, specular: Vec3::ONE, shininess: 100.0 };
        let view = DVec3::new(1.0, -1.0, 0.0);
        let sum = direct(&gloss, DVec3::Y, view, DVec3::new(1.0, 1.0, 0.0));
        assert!((sum - Vec3::ONE).length() < 1e-6);
    }

    #[test]
    fn even_exponent_does_not_light_what_faces_away_from_the_mirror_direction() {
        let gloss = Reflectance { diffuse: Vec3::ZERO, specular: Vec3::ONE, shininess: 2.0 };
        let view = DVec3::new(1.0, -0.1, 0.0);
        assert_eq!(direct(&gloss, DVec3::Y, view, DVec3::new(-1.0, 0.05, 0.0)), Vec3::ZERO);
    }
}
