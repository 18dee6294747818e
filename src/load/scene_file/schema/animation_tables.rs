//! The tables of a scene file that describe motion: `[animation]` and those in it.

use schemars::JsonSchema;
use serde::Deserialize;

use super::spanned::{Spanned, Tables};
use super::values::{
    Amount, Coordinate, Direction, FieldOfView, FrameCount, Length, Point, PointOrName, Rate,
    Rotation, Scale, Seconds,
};

/// The motion of objects, and its length.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AnimationTable {
    /// The number of frames, from 1 to 1000000.
    pub frames: FrameCount,
    /// The number of frames per second.
    #[schemars(extend("default" = 24))]
    pub fps: Option<Rate>,
    /// Objects that circle around others, or move along with them.
    #[serde(default)]
    pub orbit: Tables<OrbitTable>,
    /// Objects whose keys change over time.
    #[serde(default)]
    pub track: Tables<TrackTable>,
}

/// An orbit: an object circles around a centre, starting where its own table places it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OrbitTable {
    /// The name of the object that circles.
    pub object: Spanned<String>,
    /// The centre: a point, or the name of an object, which may move itself.
    pub around: Spanned<PointOrName>,
    /// The seconds for one turn. Without it the object does not circle, but moves along with its
    /// centre.
    pub period: Option<Seconds>,
    /// The axis of the orbit, of any length but zero. Seen from the axis's end, the object circles
    /// counterclockwise.
    #[schemars(extend("default" = [0, 1, 0]))]
    pub axis: Option<Direction>,
    /// True if the object turns as it circles, so that the same side always faces the centre.
    #[schemars(extend("default" = false))]
    pub turn: Option<bool>,
}

/// A track: values over time for keys of an object's own table, which replace the one value there.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrackTable {
    /// The name of the object.
    pub object: Spanned<String>,
    /// The times of the values in seconds, increasing: one for each value.
    pub times: Spanned<List<Spanned<Coordinate>>>,
    /// The interpolation between the values: linear, a step, or a smooth curve.
    #[schemars(extend("default" = "linear"))]
    pub interpolation: Option<Interpolation>,
    /// Centres (sphere).
    pub center: Option<Spanned<List<Point>>>,
    /// Radii (sphere).
    pub radius: Option<Spanned<List<Length>>>,
    /// Positions of the origin (model).
    pub translate: Option<Spanned<List<Point>>>,
    /// Angles in degrees, each of which is interpolated by itself (model).
    pub rotate: Option<Spanned<List<Rotation>>>,
    /// Scales: one factor, or three (model).
    pub scale: Option<Spanned<List<Scale>>>,
    /// Positions (light, camera).
    pub position: Option<Spanned<List<Point>>>,
    /// Directions in which the light travels or the camera looks (light, camera).
    pub direction: Option<Spanned<List<Direction>>>,
    /// Points that the camera looks at (camera).
    pub look_at: Option<Spanned<List<Point>>>,
    /// Factors on the colour (light).
    pub intensity: Option<Spanned<List<Amount>>>,
    /// Fields of view from the lower to the upper edge, in degrees (camera).
    pub fov_y: Option<Spanned<List<FieldOfView>>>,
    /// Fields of view from the left to the right edge, in degrees (camera).
    pub fov_x: Option<Spanned<List<FieldOfView>>>,
    /// Distances from the eye to the picture, in pixels of the film's `size` (camera).
    pub focal_px: Option<Spanned<List<Length>>>,
    /// Heights of the view, for an orthographic camera (camera).
    pub ortho_height: Option<Spanned<List<Length>>>,
}

/// The interpolation between two values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Interpolation {
    /// A straight line.
    #[default]
    Linear,
    /// The first value, then a jump.
    Step,
    /// A smooth curve that starts and ends at rest and does not go beyond the values.
    Smooth,
}

/// A list with a value for each time of a track.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(extend("minItems" = 1), description = "")]
pub struct List<T>(pub Vec<T>);
