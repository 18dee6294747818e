//! The lights: points, suns, spots, ambient light, and lights with an extent.

mod extent;
mod incident;

use glam::{DAffine3, DVec3, Vec3};
use schemars::JsonSchema;
use serde::Deserialize;

pub use extent::{LightSample, MAX_LIGHT_SAMPLES, MIN_SUN_ANGLE};
pub use incident::IncidentLight;

/// The number of samples of a light with an extent, where nothing else is said.
pub(crate) const DEFAULT_LIGHT_SAMPLES: u32 = 16;

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
        /// The angle from one edge of the sun to the other, in radians: 0 for a point, or in
        /// \[1e-6, π\].
        angle: f64,
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
    /// A rectangle that emits light from its front, toward `u` × `v`.
    Rectangle {
        /// The centre, in world space.
        center: DVec3,
        /// Half of one side, from the centre; not 0.
        u: DVec3,
        /// Half of the other side, perpendicular to `u`; not 0.
        v: DVec3,
    },
    /// A disk that emits light from its front.
    Disk {
        /// The centre, in world space.
        center: DVec3,
        /// The normal, of length 1, toward the side that emits.
        normal: DVec3,
        /// The radius, above 0.
        radius: f64,
    },
    /// A sphere that emits light outward.
    Sphere {
        /// The centre, in world space.
        center: DVec3,
        /// The radius, above 0.
        radius: f64,
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
    /// light reflects (at distance 1 with `inverse_square`). Of a rectangle, a disk or a sphere it is the
    /// radiance that the light emits.
    pub intensity: Vec3,
    /// The shadows that it casts.
    pub shadow: Shadow,
    /// The number of samples that stand for the light if it has an extent, from 1 to
    /// [`MAX_LIGHT_SAMPLES`]; other lights have no use for it.
    pub samples: u32,
    /// The surface by which it is seen, if it is: one that emits the light's radiance and casts no shadow.
    pub shape: Option<LightShape>,
}

/// The surface by which a light with an extent is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightShape {
    /// The sphere with this index in the scene.
    Sphere(u32),
    /// The instance with this index in the scene.
    Instance(u32),
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
///
/// // Lights with an extent cast soft shadows; what they have for intensity is radiance.
/// let panel = Light::rectangle(DVec3::Y * 3.0, DVec3::X, DVec3::Z * 0.5).with_samples(64);
/// let spotlight = Light::disk(DVec3::Y * 3.0, DVec3::NEG_Y, 0.5);
/// let (bulb, real_sun) = (Light::sphere(DVec3::Y, 0.1), sun.with_angle(0.53f64.to_radians()));
/// assert!([panel, spotlight, bulb, real_sun].iter().all(Light::has_extent));
/// ```
impl Light {
    /// An ambient light of this intensity.
    pub fn ambient(intensity: Vec3) -> Self {
        Self::new(LightKind::Ambient).with_intensity(intensity)
    }

    /// A directional light that travels in `direction`, of any length but zero.
    pub fn sun(direction: DVec3) -> Self {
        Self::new(LightKind::Directional { direction: direction.normalize(), angle: 0.0 })
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

    /// A rectangle with half-sides `u` and `v`, which are perpendicular and of any length but zero; it
    /// emits light toward `u` × `v`.
    pub fn rectangle(center: DVec3, u: DVec3, v: DVec3) -> Self {
        Self::new(LightKind::Rectangle { center, u, v })
    }

    /// A disk that emits light toward `normal`, of any length but zero.
    pub fn disk(center: DVec3, normal: DVec3, radius: f64) -> Self {
        Self::new(LightKind::Disk { center, normal: normal.normalize(), radius })
    }

    /// A sphere that emits light.
    pub fn sphere(center: DVec3, radius: f64) -> Self {
        Self::new(LightKind::Sphere { center, radius })
    }

    /// A white light of intensity 1 with tinted shadows, and with 16 samples if it has an extent.
    pub fn new(kind: LightKind) -> Self {
        let (name, shadow) = (String::new(), Shadow::default());
        let samples = DEFAULT_LIGHT_SAMPLES;
        Self { name, kind, intensity: Vec3::ONE, shadow, samples, shape: None }
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

    /// Sets the angular diameter of a directional light, in radians; other lights have none.
    #[must_use]
    pub fn with_angle(mut self, new: f64) -> Self {
        if let LightKind::Directional { angle, .. } = &mut self.kind {
            *angle = new;
        }
        self
    }

    /// Sets the number of samples that stand for a light with an extent.
    #[must_use]
    pub fn with_samples(self, samples: u32) -> Self {
        Self { samples, ..self }
    }

    /// Sets the surface by which it is seen.
    #[must_use]
    pub fn with_shape(self, shape: LightShape) -> Self {
        Self { shape: Some(shape), ..self }
    }

    /// True if it casts shadows; ambient light has no direction in which anything could block it.
    pub fn casts_shadow(&self) -> bool {
        self.shadow != Shadow::None && self.kind != LightKind::Ambient
    }

    /// True if it has a position, rather than being infinitely far away or ambient.
    #[inline]
    pub fn is_bounded(&self) -> bool {
        !matches!(self.kind, LightKind::Ambient | LightKind::Directional { .. })
    }

    /// The position, if it has one: the centre of a light with an extent.
    pub fn position(&self) -> Option<DVec3> {
        let mut kind = self.kind;
        kind.position_mut().map(|position| *position)
    }

    /// True if the same intensity arrives from it at all points: a point light without falloff and
    /// range.
    #[inline]
    pub fn has_constant_intensity(&self) -> bool {
        matches!(self.kind, LightKind::Point { falloff: Falloff::None, range: f64::INFINITY, .. })
    }

    /// The light with its position and directions transformed. Intensity, range and size do not scale,
    /// as in KHR_lights_punctual.
    pub fn transformed(&self, transform: &DAffine3) -> Self {
        let turned = |v: DVec3| transform.transform_vector3(v).normalize();
        let mut light = self.clone();
        let kind = &mut light.kind;
        if let Some(position) = kind.position_mut() {
            *position = transform.transform_point3(*position);
        }
        match kind {
            LightKind::Directional { direction, .. }
            | LightKind::Spot { direction, .. }
            | LightKind::Disk { normal: direction, .. } => *direction = turned(*direction),
            LightKind::Rectangle { u, v, .. } => {
                // The front stays the front, also in a mirror.
                let normal = turned(u.cross(*v));
                let (u_length, v_length) = (u.length(), v.length());
                let across = turned(*u);
                let across = (across - normal * across.dot(normal)).normalize();
                (*u, *v) = (across * u_length, normal.cross(across) * v_length);
            }
            LightKind::Ambient | LightKind::Point { .. } | LightKind::Sphere { .. } => {}
        }
        light
    }
}

impl LightKind {
    /// The position, mutable, of a light that has one.
    pub(crate) fn position_mut(&mut self) -> Option<&mut DVec3> {
        match self {
            Self::Ambient | Self::Directional { .. } => None,
            Self::Point { position, .. } | Self::Spot { position, .. } => Some(position),
            Self::Rectangle { center, .. }
            | Self::Disk { center, .. }
            | Self::Sphere { center, .. } => Some(center),
        }
    }
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
            samples: 16,
            shape: None,
        }
    }

    #[test]
    fn constructors_give_white_lights_with_tinted_shadows() {
        let white = |kind| Light {
            name: String::new(),
            kind,
            intensity: Vec3::ONE,
            shadow: Shadow::Tinted,
            samples: 16,
            shape: None,
        };
        let (position, direction) = (DVec3::new(1.0, 2.0, 3.0), DVec3::NEG_Y);
        let (falloff, range) = (Falloff::None, f64::INFINITY);
        let (inner_angle, outer_angle) = (0.1, 0.2);
        let spot =
            LightKind::Spot { position, direction, falloff, range, inner_angle, outer_angle };
        assert_eq!(Light::ambient(Vec3::ONE), white(LightKind::Ambient));
        assert_eq!(
            Light::sun(direction * 4.0),
            white(LightKind::Directional { direction, angle: 0.0 })
        );
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
    fn a_rectangle_keeps_its_size_and_its_front_when_it_is_moved_or_mirrored() {
        let light = Light::rectangle(DVec3::X, DVec3::X * 2.0, DVec3::Y * 0.5);
        let turn = DAffine3::from_rotation_x(0.7);
        let mirror = DAffine3::from_scale(DVec3::new(-3.0, 1.0, 1.0));
        for transform in [turn, mirror, turn * mirror] {
            let LightKind::Rectangle { center, u, v } = light.transformed(&transform).kind else {
                panic!("a rectangle");
            };
            assert!((center - transform.transform_point3(DVec3::X)).length() < 1e-15);
            assert!((u.length() - 2.0).abs() < 1e-15 && (v.length() - 0.5).abs() < 1e-15);
            let normal = transform.transform_vector3(DVec3::Z).normalize();
            assert!((u.cross(v) - normal).length() < 1e-14);
        }
    }
}
