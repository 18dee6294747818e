//! What may be written in a scene file: one type a table, one field a key.
//!
//! The comments and the defaults here are those of the JSON Schema; a test holds the defaults to
//! what a missing key means.

use schemars::JsonSchema;
use serde::Deserialize;

use super::animation_tables::AnimationTable;
use super::color::{Color, Pair};
use super::spanned::{At, OneOrMore, Table, Tables};
use super::values::{
    Amount, Depth, Direction, FieldOfView, HalfAngle, Index, Length, Number, Point, PointOrName,
    Priority, Rotation, SampleRange, Samples, Scale, ShadowKind, Share, Shininess, Size, Triple,
};
use crate::scene::{Falloff, SamplePosition, Tone, Transfer};

/// A scene for envers: what stands in it, what lights it, and who looks at it.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(title = "envers scene")]
pub struct SceneTable {
    /// What the picture is to be.
    pub film: Table<FilmTable>,
    /// The eye; several under `[[camera]]`, of which the first is used unless another is asked
    /// for. Without one: the first model's own camera, or one that frames the scene.
    pub camera: OneOrMore<CameraTable>,
    /// What things are made of.
    pub material: Tables<MaterialTable>,
    /// Spheres.
    pub sphere: Tables<SphereTable>,
    /// Infinite planes, such as the ground.
    pub plane: Tables<PlaneTable>,
    /// Models from other files.
    pub model: Tables<ModelTable>,
    /// Lights.
    pub light: Tables<LightTable>,
    /// What moves, and for how long.
    pub animation: Option<At<Table<AnimationTable>>>,
}

/// What the picture is to be.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FilmTable {
    /// Width and height of the picture, in pixels.
    #[schemars(extend("default" = [1280, 720]))]
    pub size: Option<At<Size>>,
    /// Samples per pixel, from 1 to 65536.
    #[schemars(extend("default" = 1))]
    pub spp: Option<Samples>,
    /// The fewest and the most samples per pixel, in place of `spp`: more than the fewest where
    /// neighbouring ones disagree in what they hit, in its normal or in colour.
    pub adaptive: Option<At<SampleRange>>,
    /// From which difference on two colours disagree, from 0 (always) to 1; for `adaptive`, where it
    /// is 0.1 unless it is said.
    pub threshold: Option<At<Share>>,
    /// How the PNG encodes light, and what hex colours are decoded by: the sRGB curve, or none.
    #[schemars(extend("default" = "srgb"))]
    pub transfer: Option<Transfer>,
    /// The PNG's light is multiplied with 2 to the power of this.
    #[schemars(extend("default" = 0))]
    pub exposure: Option<Number>,
    /// How the PNG shows what is brighter than white: as white, or by a tone curve.
    #[schemars(extend("default" = "none"))]
    pub tone: Option<Tone>,
    /// The colour where there is nothing.
    #[schemars(extend("default" = "#000000"))]
    pub background: Option<Color>,
    /// Where in its pixel a sample is centred: the middle or the upper left corner.
    #[schemars(extend("default" = "center"))]
    pub sample_position: Option<SamplePosition>,
    /// How often light is followed off mirrors and through glass, from 0 to 65536.
    #[schemars(extend("default" = 8))]
    pub max_depth: Option<Depth>,
    /// Rays that can add no more than this share of what they see are not followed; 0 leaves out
    /// only those that add nothing.
    #[schemars(extend("default" = 0))]
    pub cutoff: Option<Share>,
}

/// The eye. It looks at `look_at` or along `direction`, and sees as much as one of `fov_y`,
/// `fov_x`, `focal_px` and `ortho_height` says.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraTable {
    /// A name to choose it by, and to move it by; unique among all objects.
    pub name: Option<At<String>>,
    /// Where it stands.
    pub position: Point,
    /// The point that it looks at, or the name of the object.
    pub look_at: Option<At<PointOrName>>,
    /// The direction that it looks in, in place of `look_at`.
    pub direction: Option<At<Direction>>,
    /// What is upward in the picture.
    #[schemars(extend("default" = [0, 1, 0]))]
    pub up: Option<At<Direction>>,
    /// Field of view from the lower to the upper edge, in degrees.
    #[schemars(extend("default" = 45))]
    pub fov_y: Option<At<FieldOfView>>,
    /// Field of view from the left to the right edge, in degrees.
    pub fov_x: Option<At<FieldOfView>>,
    /// Distance from the eye to the picture, in pixels of the film's `size`.
    pub focal_px: Option<At<Length>>,
    /// Height of what is seen, in world units, for a camera without perspective.
    pub ortho_height: Option<At<Length>>,
}

/// What things are made of: Lambert's diffuse and Phong's specular reflection.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialTable {
    /// The name that objects refer to it by; unique among the materials.
    pub name: At<String>,
    /// Share of the light that is scattered to all sides.
    #[schemars(extend("default" = 0.8))]
    pub diffuse: Option<At<Color>>,
    /// Picture file (PNG, JPEG, WebP, TGA, BMP or KTX 2, in sRGB; HDR or EXR, linear) multiplied with
    /// `diffuse`.
    pub diffuse_map: Option<At<String>>,
    /// Share of the light in the highlight.
    #[schemars(extend("default" = 0))]
    pub specular: Option<Color>,
    /// Picture file, in sRGB, multiplied with `specular`.
    pub specular_map: Option<At<String>>,
    /// Phong's exponent: the greater, the smaller the highlight.
    #[schemars(extend("default" = 50))]
    pub shininess: Option<Shininess>,
    /// Light of its own, which lights nothing else.
    #[schemars(extend("default" = 0))]
    pub emission: Option<Color>,
    /// Picture file, in sRGB, multiplied with `emission`.
    pub emission_map: Option<At<String>>,
    /// Picture file of normals in tangent space, as in glTF: linear, y up in the picture.
    pub normal_map: Option<At<String>>,
    /// How the pictures are read: `"nearest"`, `"linear"`, or `"mipmap"`, which averages what each
    /// sample sees of them.
    #[schemars(extend("default" = "linear"))]
    pub filter: Option<MapFilter>,
    /// What the alpha of `diffuse_map` means: nothing, a hole where it is below `alpha_cutoff`, or
    /// how much is covered of what lies behind.
    #[schemars(extend("default" = "opaque"))]
    pub alpha_mode: Option<At<MapAlpha>>,
    /// The alpha below which `alpha_mode = "mask"` cuts holes; 0.5 unless it is said.
    pub alpha_cutoff: Option<At<Share>>,
    /// Share of what is seen in it as in a mirror.
    #[schemars(extend("default" = 0))]
    pub reflect: Option<At<Color>>,
    /// Share of what is seen through it as through glass, less what Fresnel's law reflects.
    #[schemars(extend("default" = 0))]
    pub transmit: Option<At<Color>>,
    /// Index of refraction of what is inside.
    #[schemars(extend("default" = 1.5))]
    pub ior: Option<Index>,
    /// What is lost on the way through it, for each unit of length: light falls to e^(−absorption).
    /// One number, or three for red, green and blue.
    #[schemars(extend("default" = 0))]
    pub absorption: Option<Triple>,
    /// Whether it is a thin sheet, such as a pane, with nothing inside.
    #[schemars(extend("default" = false))]
    pub thin: Option<bool>,
    /// Which of two things holds where both are: the one with the greater priority, of two equal
    /// ones the smaller thing.
    #[schemars(extend("default" = 0))]
    pub priority: Option<Priority>,
    /// Whether a sphere is lit on its inside too; planes and meshes always are.
    #[schemars(extend("default" = false))]
    pub double_sided: Option<bool>,
}

/// How pictures are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MapFilter {
    /// The pixel that holds the point.
    Nearest,
    /// The four around it, in proportion.
    #[default]
    Linear,
    /// The mean of what a sample sees.
    Mipmap,
}

/// What the alpha of a picture means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MapAlpha {
    /// Nothing.
    Opaque,
    /// A hole where it is below a cutoff.
    Mask,
    /// How much is covered of what lies behind.
    Blend,
}

/// A sphere.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereTable {
    /// A name to move it by, or to look at it; unique among all objects.
    pub name: Option<At<String>>,
    /// Its centre.
    pub center: Point,
    /// Its radius, above 0.
    pub radius: At<Length>,
    /// The name of its material; without one it is of a plain grey.
    pub material: Option<At<String>>,
    /// Whether it keeps light from what lies behind it.
    #[schemars(extend("default" = true))]
    pub casts_shadow: Option<bool>,
}

/// An infinite plane.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneTable {
    /// Any point of it.
    pub point: Point,
    /// Its normal, of any length but zero.
    pub normal: Direction,
    /// The name of its material; without one it is of a plain grey.
    pub material: Option<At<String>>,
    /// A checker in place of the material's diffuse colour.
    pub checker: Option<Table<CheckerTable>>,
    /// The side of the square that a picture of its material takes before it repeats.
    #[schemars(extend("default" = 1))]
    pub texture_size: Option<Length>,
    /// Whether it keeps light from what lies behind it.
    #[schemars(extend("default" = true))]
    pub casts_shadow: Option<bool>,
}

/// A checker, with a corner of its squares at the plane's point.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CheckerTable {
    /// The colours of its squares.
    pub colors: Pair,
    /// The side of a square.
    #[schemars(extend("default" = 1))]
    pub size: Option<Length>,
}

/// A model from another file, placed by translate · rotate · scale.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModelTable {
    /// A name to move it by, or to look at it; unique among all objects.
    pub name: Option<At<String>>,
    /// The file, `.gltf`, `.glb` or `.obj`, relative to the scene file.
    pub file: At<String>,
    /// Where its origin goes.
    #[schemars(extend("default" = [0, 0, 0]))]
    pub translate: Option<Point>,
    /// Angles in degrees about the fixed x axis, then y, then z.
    #[schemars(extend("default" = [0, 0, 0]))]
    pub rotate: Option<Rotation>,
    /// One factor, or one for each axis; not zero, negative to mirror.
    #[schemars(extend("default" = 1))]
    pub scale: Option<Scale>,
    /// The name of a material in place of the model's own.
    pub material: Option<At<String>>,
    /// Whether it keeps light from what lies behind it.
    #[schemars(extend("default" = true))]
    pub casts_shadow: Option<bool>,
    /// Whether the lights in the model's file shine.
    #[schemars(extend("default" = true))]
    pub lights: Option<bool>,
    /// Which of the animations in a glTF file it plays, by name; without one, the first.
    pub animation: Option<At<String>>,
    /// Which variant of its materials a glTF file shows, by name; without one, the default.
    pub variant: Option<At<String>>,
}

/// A light.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LightTable {
    /// A name to move it by, or to look at it; unique among all objects.
    pub name: Option<At<String>>,
    /// From a point to all sides, from far away, from a point within a cone, or from everywhere.
    pub kind: At<Kind>,
    /// Where it stands (point, spot).
    pub position: Option<At<Point>>,
    /// Where the light travels (directional, spot).
    pub direction: Option<At<Direction>>,
    /// Half-angle of the cone within which the light is whole, in degrees (spot).
    #[schemars(extend("default" = 0))]
    pub inner_angle: Option<At<HalfAngle>>,
    /// Half-angle of the cone beyond which there is no light, in degrees (spot).
    #[schemars(extend("default" = 45))]
    pub outer_angle: Option<At<HalfAngle>>,
    /// Its colour.
    #[schemars(extend("default" = [1, 1, 1]))]
    pub color: Option<Color>,
    /// A factor of its colour.
    #[schemars(extend("default" = 1))]
    pub intensity: Option<At<Amount>>,
    /// How it weakens with distance: not at all, or with the square (point, spot).
    #[schemars(extend("default" = "none"))]
    pub falloff: Option<At<Falloff>>,
    /// The distance at which it has faded to nothing; without one there is none (point, spot).
    pub range: Option<At<Length>>,
    /// Whether things keep it from what lies behind them (all but ambient): `true` and `"tinted"`
    /// let glass pass on what its colour leaves, `"opaque"` does not.
    #[schemars(extend("default" = true))]
    pub shadow: Option<At<ShadowKind>>,
}

/// What kind of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// From a point to all sides.
    Point,
    /// From very far away.
    Directional,
    /// From a point within a cone.
    Spot,
    /// From everywhere: Phong's ambient term.
    Ambient,
}
