//! Lights.

use glam::{DAffine3, DVec3, Vec3};
use schemars::JsonSchema;
use serde::Deserialize;

/// How light from a point or a spot weakens with distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Falloff {
    /// Not at all, as in the tutorial.
    #[default]
    None,
    /// With the square of the distance, as light does.
    InverseSquare,
}

/// What kind of light, and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Light from everywhere, reaching every point alike: Phong's ambient term.
    Ambient,
    /// Light from very far away.
    Directional {
        /// Where the light travels, of length 1.
        direction: DVec3,
    },
    /// Light from a point to all sides.
    Point {
        /// Where it stands, in world space.
        position: DVec3,
        /// How it weakens with distance.
        falloff: Falloff,
        /// The distance at which it has faded to nothing, or infinity.
        range: f64,
    },
    /// Light from a point within a cone, fading from the inner to the outer angle.
    Spot {
        /// Where it stands, in world space.
        position: DVec3,
        /// The cone's axis: where the light travels, of length 1.
        direction: DVec3,
        /// How it weakens with distance.
        falloff: Falloff,
        /// The distance at which it has faded to nothing, or infinity.
        range: f64,
        /// Half-angle within which the light is whole, in radians, in \[0, outer).
        inner_angle: f64,
        /// Half-angle beyond which there is none, in radians, in (inner, π/2\].
        outer_angle: f64,
    },
}

/// What keeps a light from what lies behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shadow {
    /// Nothing: every point that faces the light is lit.
    None,
    /// What stands in the way; glass lets through what its colour leaves. The light goes straight
    /// on through it, since a path that bends would have to be searched for.
    #[default]
    Tinted,
    /// What stands in the way, glass like anything else.
    Opaque,
}

/// A light.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its name, or nothing.
    pub name: String,
    /// What kind, and where.
    pub kind: LightKind,
    /// Colour times intensity, linear Rec. 709: what a white diffuse surface that faces the light
    /// reflects (at distance 1 with `inverse_square`).
    pub intensity: Vec3,
    /// What keeps it from what lies behind it.
    pub shadow: Shadow,
}

/// The light that reaches a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IncidentLight {
    /// From the point to the light; its end is the light's position, or far away for a
    /// directional light, whose shadow rays have no end.
    pub toward: DVec3,
    /// Whether a shadow ray ends at `toward` rather than going on.
    pub is_bounded: bool,
    /// What arrives, falloff and cone included.
    pub intensity: Vec3,
}

impl Light {
    /// Whether anything keeps it from what lies behind; ambient light comes from no direction in
    /// which something could stand.
    pub fn casts_shadow(&self) -> bool {
        self.shadow != Shadow::None && self.kind != LightKind::Ambient
    }

    /// Whether its light comes from somewhere, rather than from infinitely far.
    #[inline]
    pub fn is_bounded(&self) -> bool {
        matches!(self.kind, LightKind::Point { .. } | LightKind::Spot { .. })
    }

    /// Whether it is a point that sends the same light everywhere: without falloff, range or cone.
    #[inline]
    pub fn has_constant_intensity(&self) -> bool {
        matches!(self.kind, LightKind::Point { falloff: Falloff::None, range: f64::INFINITY, .. })
    }

    /// The light moved and turned. Its intensity and its range stay as they are under any scale, as
    /// KHR_lights_punctual has it.
    pub fn transformed(&self, transform: &DAffine3) -> Self {
        let turned = |v: DVec3| transform.transform_vector3(v).normalize();
        let mut light = self.clone();
        match &mut light.kind {
            LightKind::Ambient => {}
            LightKind::Directional { direction } => *direction = turned(*direction),
            LightKind::Point { position, .. } => *position = transform.transform_point3(*position),
            LightKind::Spot { position, direction, .. } => {
                *position = transform.transform_point3(*position);
                *direction = turned(*direction);
            }
        }
        light
    }

    /// What arrives at `point`, shadows aside; `None` when nothing does, and for ambient light,
    /// which comes from no direction.
    pub fn incident(&self, point: DVec3) -> Option<IncidentLight> {
        let (position, falloff, range) = match self.kind {
            LightKind::Ambient => return None,
            LightKind::Directional { direction } => {
                return Some(IncidentLight {
                    toward: -direction,
                    is_bounded: false,
                    intensity: self.intensity,
                });
            }
            LightKind::Point { position, falloff, range }
            | LightKind::Spot { position, falloff, range, .. } => (position, falloff, range),
        };
        let toward = position - point;
        let distance_squared = toward.length_squared();
        if distance_squared == 0.0 {
            return None;
        }
        let mut share = match falloff {
            Falloff::None => 1.0,
            Falloff::InverseSquare => 1.0 / distance_squared,
        };
        share *= range_attenuation(distance_squared, range);
        if let LightKind::Spot { direction, inner_angle, outer_angle, .. } = self.kind {
            share *= cone_attenuation(
                -direction.dot(toward) / distance_squared.sqrt(),
                inner_angle,
                outer_angle,
            );
        }
        (share > 0.0).then(|| IncidentLight {
            toward,
            is_bounded: true,
            intensity: self.intensity * share as f32,
        })
    }
}

/// Fades to nothing at `range`: max(min(1 − (d/range)⁴, 1), 0), as KHR_lights_punctual recommends.
fn range_attenuation(distance_squared: f64, range: f64) -> f64 {
    let ratio = distance_squared / (range * range);
    (1.0 - ratio * ratio).clamp(0.0, 1.0)
}

/// From 1 within the inner angle to 0 beyond the outer one: the square of a ramp over the cosine,
/// as KHR_lights_punctual recommends.
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
