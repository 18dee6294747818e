//! The lights, and the light that arrives from them at a point.

use glam::{DAffine3, DVec3, Vec3};
use schemars::JsonSchema;
use serde::Deserialize;

/// The falloff of a point light or spot with distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Falloff {
    /// Not at all, as in the tutorial.
    #[default]
    None,
    /// With the square of the distance, as light does.
    InverseSquare,
}

/// The kind of a light, with its position and direction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum LightKind {
    /// Light from all directions, the same at every point: Phong's ambient term.
    Ambient,
    /// Light from very far away.
    Directional {
        /// The direction in which the light travels, of length 1.
        direction: DVec3,
    },
    /// Light from a point in all directions.
    Point {
        /// The position, in world space.
        position: DVec3,
        /// The falloff with distance.
        falloff: Falloff,
        /// The distance at which the light has faded to nothing, or infinity.
        range: f64,
    },
    /// Light from a point within a cone, fading from the inner to the outer angle.
    Spot {
        /// The position, in world space.
        position: DVec3,
        /// The axis of the cone, along which the light travels, of length 1.
        direction: DVec3,
        /// The falloff with distance.
        falloff: Falloff,
        /// The distance at which the light has faded to nothing, or infinity.
        range: f64,
        /// The half-angle within which the light is whole, in radians, in \[0, outer).
        inner_angle: f64,
        /// The half-angle beyond which there is no light, in radians, in (inner, π/2\].
        outer_angle: f64,
    },
}

/// The shadows that a light casts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Shadow {
    /// No shadows: every point that faces the light is lit.
    None,
    /// Shadows that transparent objects tint. Light goes straight through these, since a refracted
    /// path would have to be searched for.
    #[default]
    Tinted,
    /// Shadows of transparent objects like those of any other.
    Opaque,
}

/// A light.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// The name, which may be empty.
    pub name: String,
    /// The kind, with position and direction.
    pub kind: LightKind,
    /// The colour times the intensity, linear Rec. 709: what a white diffuse surface that faces the
    /// light reflects (at distance 1 with `inverse_square`).
    pub intensity: Vec3,
    /// The shadows that it casts.
    pub shadow: Shadow,
}

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

/// White lights of intensity 1 with tinted shadows.
///
/// ```
/// use envers::scene::{Falloff, Light, Shadow};
/// use glam::{DVec3, Vec3};
///
/// let lamp = Light::point(DVec3::Y * 2.0)
///     .with_falloff(Falloff::InverseSquare)
///     .with_intensity(Vec3::splat(8.0))
///     .with_name("lamp");
/// assert_eq!(lamp.incident(DVec3::ZERO).unwrap().intensity, Vec3::splat(2.0));
/// let sun = Light::sun(DVec3::new(1.0, -2.0, 0.5)).with_shadow(Shadow::Opaque);
/// assert!(!sun.is_bounded());
/// ```
impl Light {
    /// An ambient light of this intensity.
    pub fn ambient(intensity: Vec3) -> Self {
        Self::new(LightKind::Ambient).with_intensity(intensity)
    }

    /// A directional light that travels in `direction`, of any length but zero.
    pub fn sun(direction: DVec3) -> Self {
        Self::new(LightKind::Directional { direction: direction.normalize() })
    }

    /// A point light without falloff and with infinite range.
    pub fn point(position: DVec3) -> Self {
        let (falloff, range) = (Falloff::None, f64::INFINITY);
        Self::new(LightKind::Point { position, falloff, range })
    }

    /// A spot without falloff and with infinite range, which shines in `direction`, of any length but
    /// zero; the half-angles of its cone are in radians, 0 ≤ inner < outer ≤ π/2.
    pub fn spot(position: DVec3, direction: DVec3, inner_angle: f64, outer_angle: f64) -> Self {
        let (direction, falloff, range) = (direction.normalize(), Falloff::None, f64::INFINITY);
        Self::new(LightKind::Spot { position, direction, falloff, range, inner_angle, outer_angle })
    }

    /// A white light of intensity 1 with tinted shadows.
    pub fn new(kind: LightKind) -> Self {
        Self { name: String::new(), kind, intensity: Vec3::ONE, shadow: Shadow::default() }
    }

    /// Sets the intensity, linear Rec. 709.
    #[must_use]
    pub fn with_intensity(self, intensity: Vec3) -> Self {
        Self { intensity, ..self }
    }

    /// Sets the name.
    #[must_use]
    pub fn with_name(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// Sets the shadows.
    #[must_use]
    pub fn with_shadow(self, shadow: Shadow) -> Self {
        Self { shadow, ..self }
    }

    /// Sets the falloff of a point light or spot; other lights have none.
    #[must_use]
    pub fn with_falloff(mut self, new: Falloff) -> Self {
        if let LightKind::Point { falloff, .. } | LightKind::Spot { falloff, .. } = &mut self.kind {
            *falloff = new;
        }
        self
    }

    /// True if it casts shadows; ambient light has no direction in which anything could block it.
    pub fn casts_shadow(&self) -> bool {
        self.shadow != Shadow::None && self.kind != LightKind::Ambient
    }

    /// True if it has a position, rather than being infinitely far away or ambient.
    #[inline]
    pub fn is_bounded(&self) -> bool {
        matches!(self.kind, LightKind::Point { .. } | LightKind::Spot { .. })
    }

    /// True if the same intensity arrives from it at all points: a point light without falloff and
    /// range.
    #[inline]
    pub fn has_constant_intensity(&self) -> bool {
        matches!(self.kind, LightKind::Point { falloff: Falloff::None, range: f64::INFINITY, .. })
    }

    /// The light with its position and direction transformed. Intensity and range do not scale, as
    /// in KHR_lights_punctual.
    pub fn transformed(&self, transform: &DAffine3) -> Self {
        let turned = |v: DVec3| transform.transform_vector3(v).normalize();
        let mut light = self.clone();
        let kind = &mut light.kind;
        if let LightKind::Point { position, .. } | LightKind::Spot { position, .. } = kind {
            *position = transform.transform_point3(*position);
        }
        if let LightKind::Directional { direction } | LightKind::Spot { direction, .. } = kind {
            *direction = turned(*direction);
        }
        light
    }

    /// The light that arrives at `point` if nothing blocks it; `None` when no light does, and for
    /// ambient light, which has no direction.
    pub fn incident(&self, point: DVec3) -> Option<IncidentLight> {
        let (position, falloff, range) = match self.kind {
            LightKind::Ambient => return None,
            LightKind::Directional { direction } => {
                let (toward, intensity) = (-direction, self.intensity);
                return Some(IncidentLight { toward, is_bounded: false, intensity });
            }
            LightKind::Point { position, falloff, range }
            | LightKind::Spot { position, falloff, range, .. } => (position, falloff, range),
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
        Light {
            name: String::new(),
            kind: LightKind::Point { position: DVec3::ZERO, falloff, range },
            intensity: Vec3::splat(8.0),
            shadow: Shadow::default(),
        }
    }

    #[test]
    fn constructors_give_white_lights_with_tinted_shadows() {
        let white = |kind| Light {
            name: String::new(),
            kind,
            intensity: Vec3::ONE,
            shadow: Shadow::Tinted,
        };
        let (position, direction) = (DVec3::new(1.0, 2.0, 3.0), DVec3::NEG_Y);
        let (falloff, range) = (Falloff::None, f64::INFINITY);
        let (inner_angle, outer_angle) = (0.1, 0.2);
        let spot =
            LightKind::Spot { position, direction, falloff, range, inner_angle, outer_angle };
        assert_eq!(Light::ambient(Vec3::ONE), white(LightKind::Ambient));
        assert_eq!(Light::sun(direction * 4.0), white(LightKind::Directional { direction }));
        assert_eq!(Light::point(position), white(LightKind::Point { position, falloff, range }));
        assert_eq!(Light::spot(position, direction * 4.0, 0.1, 0.2), white(spot));
    }

    #[test]
    fn builders_set_one_field_each() {
        let light = Light::point(DVec3::ZERO)
            .with_intensity(Vec3::X)
            .with_name("lamp")
            .with_shadow(Shadow::None)
            .with_falloff(Falloff::InverseSquare);
        let expected = Light {
            name: "lamp".into(),
            intensity: Vec3::X,
            shadow: Shadow::None,
            ..point_light(Falloff::InverseSquare, f64::INFINITY)
        };
        assert_eq!(light, expected);
        let sun = Light::sun(DVec3::X);
        assert_eq!(sun.clone().with_falloff(Falloff::InverseSquare), sun);
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
