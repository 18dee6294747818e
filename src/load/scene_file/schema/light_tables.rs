//! The tables of lights and of the environment.

use schemars::JsonSchema;
use serde::Deserialize;

use super::color::Color;
use super::spanned::Spanned;
use super::values::{
    Amount, Direction, HalfAngle, Length, LightSamples, Number, Point, ShadowKind, Sides, SunAngle,
    Turbidity,
};
use crate::scene::Falloff;

/// A light.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LightTable {
    /// The name by which the light is moved or looked at; unique among all objects.
    pub name: Option<Spanned<String>>,
    /// The kind of light: point, directional (very far away), spot (a point with a cone), ambient,
    /// rectangle, disk or sphere.
    pub kind: Spanned<Kind>,
    /// The position of the light, or its centre (not directional, ambient).
    pub position: Option<Spanned<Point>>,
    /// The direction in which the light travels (directional, spot), or toward which it emits
    /// (rectangle, disk).
    pub direction: Option<Spanned<Direction>>,
    /// The width and height of the light (rectangle).
    pub size: Option<Spanned<Sides>>,
    /// The direction along which the height runs (rectangle). The default is [0, 1, 0], or [0, 0, 1]
    /// if the light shines straight up or down.
    pub up: Option<Spanned<Direction>>,
    /// The radius of the light (disk, sphere).
    pub radius: Option<Spanned<Length>>,
    /// The angular diameter of the light, in degrees: the sun's is 0.53 (directional). The default is 0,
    /// a point.
    pub angle: Option<Spanned<SunAngle>>,
    /// The half-angle, in degrees, of the cone that has full light (spot).
    #[schemars(extend("default" = 0))]
    pub inner_angle: Option<Spanned<HalfAngle>>,
    /// The half-angle, in degrees, of the cone outside which there is no light (spot).
    #[schemars(extend("default" = 45))]
    pub outer_angle: Option<Spanned<HalfAngle>>,
    /// The colour of the light.
    #[schemars(extend("default" = [1, 1, 1]))]
    pub color: Option<Color>,
    /// A factor on the colour; the two together are the radiance that a rectangle, disk or sphere
    /// emits.
    #[schemars(extend("default" = 1))]
    pub intensity: Option<Spanned<Amount>>,
    /// The decrease with distance: none, or with its square (point, spot).
    #[schemars(extend("default" = "none"))]
    pub falloff: Option<Spanned<Falloff>>,
    /// The distance at which the light has faded to nothing. The default is no limit (point, spot).
    pub range: Option<Spanned<Length>>,
    /// The shadows of the light (not ambient): with `true` and `"tinted"` glass lets light through
    /// and tints it; with `"opaque"` glass blocks it; `false` means no shadows.
    #[schemars(extend("default" = true))]
    pub shadow: Option<Spanned<ShadowKind>>,
    /// The number of samples that stand for the light, from 1 to 1024 (rectangle, disk, sphere, or
    /// directional with an angle). The default is 16.
    pub samples: Option<Spanned<LightSamples>>,
    /// True if the camera, mirrors and glass see the light itself (rectangle, disk, sphere), as they do
    /// by default.
    pub visible: Option<Spanned<bool>>,
}

/// The environment: light from infinitely far away, by direction. One of `file`, `color` and `built_in` says
/// what it is.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct EnvironmentTable {
    /// An equirectangular image file: HDR or EXR (linear), or any format of other images (sRGB).
    pub file: Option<Spanned<String>>,
    /// The same radiance from all directions.
    pub color: Option<Color>,
    /// A built-in environment: the studio that bare models have, or a clear sky with its sun.
    pub built_in: Option<BuiltIn>,
    /// The turn about the vertical axis in degrees, counter-clockwise seen from above.
    #[schemars(extend("default" = 0))]
    pub rotation: Option<Number>,
    /// The direction that is up in the environment.
    #[schemars(extend("default" = [0, 1, 0]))]
    pub up: Option<Spanned<Direction>>,
    /// A factor on the light, also on that of the sky's sun.
    #[schemars(extend("default" = 1))]
    pub intensity: Option<Amount>,
    /// True if camera rays that hit nothing see the environment; false if they see the film's `background`.
    #[schemars(extend("default" = true))]
    pub visible: Option<bool>,
    /// The height of the sun over the horizon, in degrees (built-in sky).
    #[schemars(extend("default" = 40))]
    pub sun_elevation: Option<Spanned<HalfAngle>>,
    /// The direction of the sun in degrees: from +z, counter-clockwise seen from above (built-in sky). The
    /// default is −40.
    pub sun_azimuth: Option<Spanned<Number>>,
    /// The haze of the air, from 1.7 (very clear) to 10 (built-in sky).
    #[schemars(extend("default" = 3))]
    pub turbidity: Option<Spanned<Turbidity>>,
    /// True if the built-in sky's sun is one of the lights.
    #[schemars(extend("default" = true))]
    pub sun: Option<bool>,
}

/// A built-in environment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum BuiltIn {
    /// A bright dome with soft boxes: a large one to the upper left of a viewer at +z.
    Studio,
    /// A clear sky.
    Sky,
}

/// The kind of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A point that shines in all directions.
    Point,
    /// A light from very far away.
    Directional,
    /// A point that shines within a cone.
    Spot,
    /// Light from everywhere: Phong's ambient term.
    Ambient,
    /// A rectangle that emits light from its front.
    Rectangle,
    /// A disk that emits light from its front.
    Disk,
    /// A sphere that emits light.
    Sphere,
}
