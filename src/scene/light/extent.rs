//! Lights with an extent: a sun with an angle, rectangles, disks and spheres, and samples of them.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::{IncidentLight, Light, LightKind};
use crate::geometry::sampling::{Cone, SphericalRectangle, disk_point};

/// The most samples that stand for a light with an extent.
pub const MAX_LIGHT_SAMPLES: u32 = 1024;
/// The least angular diameter of a sun other than a point, in radians.
pub const MIN_SUN_ANGLE: f64 = 1e-6;

/// A sample of a light with an extent: a direction to it, by its density per solid angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// The light that arrives if the sample stands for the whole light: the intensity is
    /// radiance / (π · density).
    pub incident: IncidentLight,
    /// The density of the direction among all samples for this point, per steradian.
    pub pdf: f64,
}

/// Samples of lights, from points of the unit square.
///
/// ```
/// use envers::scene::Light;
/// use glam::DVec3;
///
/// // A lamp of radius 1 at distance 2 fills 2π (1 − cos 30°) of the directions.
/// let lamp = Light::sphere(DVec3::Z * 2.0, 1.0);
/// let sample = lamp.sample(DVec3::ZERO, [0.25, 0.75]).unwrap();
/// assert_eq!(lamp.pdf(DVec3::ZERO, sample.incident.toward), sample.pdf);
/// let solid_angle = std::f64::consts::TAU * (1.0 - 30f64.to_radians().cos());
/// assert!((1.0 / sample.pdf - solid_angle).abs() < 1e-15);
/// assert_eq!(lamp.pdf(DVec3::ZERO, DVec3::X), 0.0);
/// ```
impl Light {
    /// True if it has an extent, so that its shadows are soft and samples stand for it.
    #[inline]
    pub fn has_extent(&self) -> bool {
        match self.kind {
            LightKind::Directional { angle, .. } => angle != 0.0,
            LightKind::Rectangle { .. } | LightKind::Disk { .. } | LightKind::Sphere { .. } => true,
            LightKind::Ambient | LightKind::Point { .. } | LightKind::Spot { .. } => false,
        }
    }

    /// The number of samples that stand for it: 1 for a light without an extent.
    #[inline]
    pub fn sample_count(&self) -> u32 {
        if self.has_extent() { self.samples } else { 1 }
    }

    /// The radiance that a light with an extent emits, linear Rec. 709; none for others, whose light
    /// comes from a single direction.
    ///
    /// For a sun of half-angle α it is intensity / sin² α: the irradiance π · radiance · sin² α of a
    /// surface that faces it stays π · intensity, whatever the angle.
    pub fn radiance(&self) -> Option<Vec3> {
        self.has_extent().then(|| self.intensity * self.radiance_per_intensity() as f32)
    }

    /// A sample of a light with an extent for `point`, from `u` in the unit square; `None` for other
    /// lights, and where no light arrives: behind a rectangle or a disk, and within a sphere.
    ///
    /// Directions to a rectangle, a sphere or a sun are uniform in solid angle, those to a disk in its
    /// area, and so are those to a rectangle of less than 1e-5 sr.
    pub fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let (toward, pdf) = match self.kind {
            LightKind::Directional { direction, angle } if angle != 0.0 => {
                let cone = Cone::from_half_angle(-direction, 0.5 * angle);
                (cone.sample(u), 1.0 / cone.solid_angle())
            }
            LightKind::Rectangle { center, u: half_u, v: half_v } => {
                SphericalRectangle::new(center, [half_u, half_v], point)?.sample(u)
            }
            LightKind::Disk { center, normal, radius } => {
                let toward = disk_point(center, normal, radius, u) - point;
                let pdf = disk_pdf(normal, radius, toward);
                (toward, (pdf > 0.0).then_some(pdf)?)
            }
            LightKind::Sphere { center, radius } => {
                let cone = Cone::to_sphere(center, radius, point)?;
                (cone.sample_sphere(center, radius, point, u), 1.0 / cone.solid_angle())
            }
            _ => return None,
        };
        let share = self.radiance_per_intensity() / (PI * pdf);
        let (is_bounded, intensity) = (self.is_bounded(), self.intensity * share as f32);
        Some(LightSample { incident: IncidentLight { toward, is_bounded, intensity }, pdf })
    }

    /// The density per steradian with which [`sample`](Self::sample) returns a direction, of any length
    /// but zero, for `point`: 0 where the light is not, and for lights without an extent.
    pub fn pdf(&self, point: DVec3, direction: DVec3) -> f64 {
        match self.kind {
            LightKind::Directional { direction: travels, angle } if angle != 0.0 => {
                cone_pdf(&Cone::from_half_angle(-travels, 0.5 * angle), direction)
            }
            LightKind::Rectangle { center, u, v } => {
                let seen = SphericalRectangle::new(center, [u, v], point);
                seen.map_or(0.0, |seen| seen.pdf(direction))
            }
            LightKind::Disk { center, normal, radius } => {
                let t = (center - point).dot(normal) / direction.dot(normal);
                let toward = direction * t;
                let is_hit =
                    t > 0.0 && (point + toward - center).length_squared() <= radius * radius;
                if is_hit { disk_pdf(normal, radius, toward) } else { 0.0 }
            }
            LightKind::Sphere { center, radius } => {
                let cone = Cone::to_sphere(center, radius, point);
                cone.map_or(0.0, |cone| cone_pdf(&cone, direction))
            }
            _ => 0.0,
        }
    }

    /// The radiance of a light with an extent, for an intensity of 1.
    fn radiance_per_intensity(&self) -> f64 {
        match self.kind {
            LightKind::Directional { angle, .. } => {
                let sine = (0.5 * angle).sin();
                1.0 / (sine * sine)
            }
            _ => 1.0,
        }
    }
}

/// The density of a direction among those that are uniform within a cone.
fn cone_pdf(cone: &Cone, direction: DVec3) -> f64 {
    if cone.contains(direction) { 1.0 / cone.solid_angle() } else { 0.0 }
}

/// The density per steradian, d² / (area · cos θ), of the vector to a point of a disk that is uniform
/// in area; 0 behind the disk.
fn disk_pdf(normal: DVec3, radius: f64, toward: DVec3) -> f64 {
    let height = -normal.dot(toward);
    let distance_squared = toward.length_squared();
    if height > 0.0 {
        distance_squared * distance_squared.sqrt() / (PI * radius * radius * height)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling::sobol_point;

    /// Returns the irradiance, over π, of a surface at the origin from the fixed set of a light's
    /// samples.
    fn irradiance(light: &Light, normal: DVec3, count: u32) -> f64 {
        let of = |i: u32| {
            let sample = light.sample(DVec3::ZERO, sobol_point(i, count))?;
            let cosine = normal.dot(sample.incident.toward.normalize()).max(0.0);
            Some(f64::from(sample.incident.intensity.x) * cosine / f64::from(count))
        };
        (0..count).filter_map(of).sum()
    }

    /// Asserts that the irradiance, over π, is the closed form to within relative errors, with 16, 64
    /// and 1024 samples.
    #[track_caller]
    fn assert_converges(light: &Light, normal: DVec3, closed_form: f64, errors: [f64; 3]) {
        for (count, bound) in [16, 64, 1024].into_iter().zip(errors) {
            let error = irradiance(light, normal, count) / closed_form - 1.0;
            println!("{count} samples: relative error {error:.1e}, bound {bound:.0e}");
            assert!(error.abs() < bound, "{count} samples: {error:e}");
        }
    }

    /// The irradiance, over π, of a surface at the origin under a polygon of radiance 1 that is wholly
    /// above its horizon, by Lambert's formula: Σ θᵢ (n · γᵢ) / 2π.
    fn lambert_polygon(corners: &[DVec3], normal: DVec3) -> f64 {
        let next = corners.iter().cycle().skip(1);
        let edges = corners.iter().zip(next).map(|(a, b)| {
            let (a, b) = (a.normalize(), b.normalize());
            a.dot(b).acos() * a.cross(b).normalize().dot(normal)
        });
        (edges.sum::<f64>() / (2.0 * PI)).abs()
    }

    #[test]
    fn a_rectangle_gives_the_irradiance_of_lamberts_polygon() {
        for (center, errors) in [
            (DVec3::new(0.0, 2.0, 0.0), [1e-3, 1e-4, 1e-6]),
            (DVec3::new(1.5, 1.0, -0.5), [1e-3, 1e-3, 1e-6]),
            (DVec3::new(0.2, 0.05, 0.3), [1e-2, 1e-3, 3e-5]),
            (DVec3::new(200.0, 500.0, 0.0), [1e-5, 1e-5, 1e-5]),
        ] {
            let (u, v) = (DVec3::X * 0.8, DVec3::Z * 0.5);
            let light = Light::rectangle(center, u, v);
            let corners = [center - u - v, center + u - v, center + u + v, center - u + v];
            let expected = lambert_polygon(&corners, DVec3::Y);
            assert_converges(&light, DVec3::Y, expected, errors);
        }
    }

    #[test]
    fn a_disk_that_faces_a_surface_gives_r2_over_r2_plus_d2() {
        for (radius, distance, errors) in
            [(1.0, 2.0, [2e-2, 3e-3, 2e-4]), (0.1, 3.0, [1e-4, 2e-5, 1e-6])]
        {
            let light = Light::disk(DVec3::Y * distance, DVec3::NEG_Y, radius);
            let square = radius * radius;
            assert_converges(&light, DVec3::Y, square / (square + distance * distance), errors);
        }
    }

    #[test]
    fn a_sphere_above_the_horizon_gives_r2_over_d2_times_the_cosine() {
        for (center, radius) in [(DVec3::new(0.0, 2.0, 0.0), 1.0), (DVec3::new(3.0, 4.0, 0.0), 2.5)]
        {
            let light = Light::sphere(center, radius);
            let distance_squared = center.length_squared();
            let cosine = center.y / distance_squared.sqrt();
            let expected = radius * radius / distance_squared * cosine;
            assert_converges(&light, DVec3::Y, expected, [1e-2, 1e-3, 3e-5]);
        }
    }

    #[test]
    fn a_sun_of_any_angle_gives_a_surface_that_faces_it_its_intensity() {
        for degrees in [1e-4, 0.53, 30.0, 120.0, 180.0] {
            let light = Light::sun(DVec3::NEG_Y).with_angle(f64::to_radians(degrees));
            assert_converges(&light, DVec3::Y, 1.0, [1e-6; 3]);
        }
    }

    #[test]
    fn densities_of_samples_are_those_of_their_directions_and_make_up_the_solid_angle() {
        let at = DVec3::new(0.3, 2.0, -0.2);
        let lights = [
            Light::rectangle(at, DVec3::X, DVec3::Z * 0.7),
            Light::disk(at, DVec3::new(0.1, -1.0, 0.2), 0.6),
            Light::sphere(at, 0.8),
            Light::sun(-at).with_angle(0.6),
        ];
        let count = 4096;
        for light in lights {
            let sample = |i: u32| light.sample(DVec3::ZERO, sobol_point(i, count)).unwrap();
            for i in 0..count {
                let LightSample { incident, pdf } = sample(i);
                let again = light.pdf(DVec3::ZERO, incident.toward * 3.0);
                assert!((again / pdf - 1.0).abs() < 1e-9, "{:?} {i}: {again} {pdf}", light.kind);
            }
            // ∫ pdf dω over all directions is 1: directions uniform on the sphere, each of 4π / n.
            let n = 1 << 18;
            let integral: f64 = (0..n)
                .map(|i| sobol_point(i, n))
                .map(|[x, y]| {
                    let (sin, cos) = (2.0 * PI * x).sin_cos();
                    let (z, r) = (1.0 - 2.0 * y, 2.0 * (y * (1.0 - y)).sqrt());
                    light.pdf(DVec3::ZERO, DVec3::new(r * cos, r * sin, z))
                })
                .sum::<f64>()
                * (4.0 * PI / f64::from(n));
            assert!((integral - 1.0).abs() < 3e-3, "{:?}: {integral}", light.kind);
            // The light of all samples is that of the solid angle.
            let sum: f64 = (0..count).map(|i| 1.0 / sample(i).pdf).sum::<f64>() / f64::from(count);
            let radiance = f64::from(light.radiance().unwrap().x);
            let intensity: f64 =
                (0..count).map(|i| f64::from(sample(i).incident.intensity.x)).sum::<f64>()
                    / f64::from(count);
            assert!((intensity - radiance * sum / PI).abs() < 1e-5 * intensity);
        }
    }

    #[test]
    fn no_light_arrives_behind_or_within() {
        let dark = [
            Light::rectangle(DVec3::Y, DVec3::X, DVec3::NEG_Z),
            Light::disk(DVec3::Y, DVec3::Y, 1.0),
            Light::sphere(DVec3::Y, 2.0),
            Light::point(DVec3::Y),
            Light::sun(DVec3::Y),
        ];
        for light in dark {
            assert_eq!(light.sample(DVec3::ZERO, [0.5; 2]), None, "{:?}", light.kind);
            assert_eq!(light.pdf(DVec3::ZERO, DVec3::Y), 0.0);
        }
    }
}
