//! The light that arrives from a light at a point.

use glam::{DVec3, Vec3};

use super::{Falloff, Light, LightKind};

/// The light that arrives at a point, before it is known whether it is blocked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IncidentLight {
    /// The vector from the point to the light or, for a directional light, toward it.
    pub toward: DVec3,
    /// True if the light is at the end of `toward`, where shadow rays end.
    pub is_bounded: bool,
    /// The intensity that arrives, with falloff and cone applied.
    pub intensity: Vec3,
}

impl Light {
    /// The light that arrives at `point` if nothing blocks it; `None` when no light does, and for
    /// ambient light, which has no direction. Of a light with an extent it is its middle sample.
    pub fn incident(&self, point: DVec3) -> Option<IncidentLight> {
        let (position, falloff, range) = match self.kind {
            LightKind::Ambient => return None,
            LightKind::Directional { direction, angle: 0.0 } => {
                let (toward, intensity) = (-direction, self.intensity);
                return Some(IncidentLight { toward, is_bounded: false, intensity });
            }
            LightKind::Point { position, falloff, range }
            | LightKind::Spot { position, falloff, range, .. } => (position, falloff, range),
            LightKind::Directional { .. }
            | LightKind::Rectangle { .. }
            | LightKind::Disk { .. }
            | LightKind::Sphere { .. } => {
                return self.sample(point, [0.5; 2]).map(|sample| sample.incident);
            }
        };
        // The way to a light with a position; at that position itself no light arrives.
        let toward = position - point;
        let distance_squared = toward.length_squared();
        if distance_squared == 0.0 {
            return None;
        }

        // The share that falloff, range and cone leave.
        let mut share = match falloff {
            Falloff::None => 1.0,
            Falloff::InverseSquare => 1.0 / distance_squared,
        };
        share *= range_attenuation(distance_squared, range);
        if let LightKind::Spot { direction, inner_angle, outer_angle, .. } = self.kind {
            let cosine = -direction.dot(toward) / distance_squared.sqrt();
            share *= cone_attenuation(cosine, inner_angle, outer_angle);
        }
        let intensity = self.intensity * share as f32;
        (share > 0.0).then_some(IncidentLight { toward, is_bounded: true, intensity })
    }
}

/// The attenuation toward `range`, where it is 0: max(min(1 − (d/range)⁴, 1), 0), as
/// KHR_lights_punctual recommends.
fn range_attenuation(distance_squared: f64, range: f64) -> f64 {
    let ratio = distance_squared / (range * range);
    (1.0 - ratio * ratio).clamp(0.0, 1.0)
}

/// The attenuation from 1 within the inner angle to 0 beyond the outer one: the square of a ramp over
/// the cosine, as KHR_lights_punctual recommends.
fn cone_attenuation(cosine: f64, inner_angle: f64, outer_angle: f64) -> f64 {
    let (inner, outer) = (inner_angle.cos(), outer_angle.cos());
    let ramp = ((cosine - outer) / (inner - outer).max(1e-9)).clamp(0.0, 1.0);
    ramp * ramp
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point_light(falloff: Falloff, range: f64) -> Light {
        Light::new(LightKind::Point { position: DVec3::ZERO, falloff, range })
            .with_intensity(Vec3::splat(8.0))
    }

    #[test]
    fn inverse_square_at_distance_two_is_a_quarter() {
        let light = point_light(Falloff::InverseSquare, f64::INFINITY);
        assert_eq!(light.incident(DVec3::X * 2.0).unwrap().intensity, Vec3::splat(2.0));
    }

    #[test]
    fn no_falloff_at_any_distance() {
        let light = point_light(Falloff::None, f64::INFINITY);
        assert_eq!(light.incident(DVec3::X * 2e6).unwrap().intensity, Vec3::splat(8.0));
    }

    #[test]
    fn nothing_arrives_beyond_the_range() {
        assert_eq!(point_light(Falloff::None, 3.0).incident(DVec3::X * 3.5), None);
    }

    #[test]
    fn nothing_arrives_at_the_light_itself() {
        assert_eq!(point_light(Falloff::InverseSquare, 3.0).incident(DVec3::ZERO), None);
    }

    #[test]
    fn spot_is_whole_inside_and_dark_outside_its_cone() {
        let spot = Light {
            kind: LightKind::Spot {
                position: DVec3::ZERO,
                direction: DVec3::Z,
                falloff: Falloff::None,
                range: f64::INFINITY,
                inner_angle: 0.1,
                outer_angle: 0.2,
            },
            ..point_light(Falloff::None, f64::INFINITY)
        };
        let at = |angle: f64| DVec3::new(angle.sin(), 0.0, angle.cos()) * 5.0;
        assert_eq!(spot.incident(at(0.09)).unwrap().intensity, Vec3::splat(8.0));
        assert!(spot.incident(at(0.15)).unwrap().intensity.x < 8.0);
        assert_eq!(spot.incident(at(0.21)), None);
    }
}
