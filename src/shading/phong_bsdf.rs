//! Lambert's and Phong's model as a BSDF that can be sampled.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::{Reflectance, reflect};

/// Lambert's and Phong's model at one point (tutorial III.2 and III.3). Directions have length 1 and point away from
/// the surface, in world space; the normal is on the viewer's side. A light of intensity I, irradiance divided by π,
/// gives (diffuse · cos θ + specular · max(0, r·ℓ)^α) · I, and so f |cos θ| is that share divided by π.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhongBsdf {
    reflectance: Reflectance,
    normal: DVec3,
    /// The mirrored direction of the viewer.
    mirrored: DVec3,
    /// The share of the samples that are spread by the highlight.
    highlight_share: f64,
}

impl PhongBsdf {
    /// The model of a surface that is seen from a direction.
    pub fn new(reflectance: Reflectance, normal: DVec3, viewer: DVec3) -> Self {
        let mirrored = reflect(-viewer, normal);
        // The integrals of both lobes over all directions: π and 2π/(α + 1).
        let diffuse = f64::from(reflectance.diffuse.max_element());
        let exponent = f64::from(reflectance.shininess) + 1.0;
        let highlight = f64::from(reflectance.specular.max_element()) * 2.0 / exponent;
        let sum = diffuse + highlight;
        let highlight_share = if sum > 0.0 { highlight / sum } else { 0.0 };
        Self { reflectance, normal, mirrored, highlight_share }
    }

    /// Returns about how much of the light it scatters, at most.
    pub fn strength(&self) -> f32 {
        let Reflectance { diffuse, specular, shininess } = self.reflectance;
        (diffuse + specular * (2.0 / (shininess + 1.0))).max_element()
    }

    /// Returns f |cos θ|.
    pub fn evaluate(&self, light: DVec3) -> Vec3 {
        let cosine = self.normal.dot(light);
        if cosine <= 0.0 {
            return Vec3::ZERO;
        }
        let Reflectance { diffuse, specular, shininess } = self.reflectance;
        let highlight = self.mirrored.dot(light).clamp(0.0, 1.0).powf(f64::from(shininess));
        (diffuse * cosine as f32 + specular * highlight as f32) / std::f32::consts::PI
    }

    /// Returns the density with which [`sample`](Self::sample) returns a direction, per steradian.
    pub fn pdf(&self, light: DVec3) -> f64 {
        let exponent = f64::from(self.reflectance.shininess);
        let cosine = self.mirrored.dot(light).clamp(0.0, 1.0);
        let highlight = (exponent + 1.0) / TAU * cosine.powf(exponent);
        let diffuse = self.normal.dot(light).max(0.0) / PI;
        diffuse + (highlight - diffuse) * self.highlight_share
    }

    /// Samples a direction to where light comes from: `choice` chooses the lobe, `u` the direction within it.
    pub fn sample(&self, choice: f64, [u, v]: [f64; 2]) -> DVec3 {
        let (axis, cosine) = if choice < self.highlight_share {
            let exponent = f64::from(self.reflectance.shininess);
            (self.mirrored, v.powf(1.0 / (exponent + 1.0)))
        } else {
            (self.normal, v.sqrt())
        };
        let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
        let (sin, cos) = (TAU * u).sin_cos();
        let (x, y) = axis.any_orthonormal_pair();
        (x * (sine * cos) + y * (sine * sin) + axis * cosine).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling::sobol_point;

    #[test]
    fn samples_are_spread_by_their_density_and_the_light_that_comes_back_is_the_integral() {
        for (diffuse, specular, shininess) in
            [(0.8, 0.0, 10.0), (0.0, 0.5, 30.0), (0.5, 0.4, 5.0), (0.3, 0.9, 200.0)]
        {
            let [diffuse, specular] = [diffuse, specular].map(Vec3::splat);
            let reflectance = Reflectance { diffuse, specular, shininess };
            let bsdf = PhongBsdf::new(reflectance, DVec3::Z, DVec3::Z);
            let (mut sum, mut mass, count) = (0.0, 0.0, 1 << 16);
            for i in 0..count {
                let [u, v] = sobol_point(i, count);
                // Lobes are chosen by a number of its own.
                let choice = (f64::from(i) * 0.618_033_988_749_895).fract();
                let light = bsdf.sample(choice, [u, v]);
                let pdf = bsdf.pdf(light);
                assert!(pdf > 0.0 && pdf.is_finite());
                sum += f64::from(bsdf.evaluate(light).x) / pdf / f64::from(count);
                // The even hemisphere by the same density.
                mass += if light.z > 0.0 { 1.0 / pdf } else { 0.0 } / f64::from(count);
            }
            // Head-on: the diffuse share and 2/(α + 1) of the specular one.
            let expected = f64::from(diffuse.x + specular.x * 2.0 / (shininess + 1.0));
            assert!((sum / expected - 1.0).abs() < 5e-3, "{reflectance:?}: {sum} {expected}");
            if specular.x == 0.0 {
                assert!((mass / TAU - 1.0).abs() < 0.02, "{mass}");
            }
        }
    }
}
