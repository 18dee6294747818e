//! The tables of a scene file: one type per table, one field per key. Those of materials, lights and animations
//! have files of their own.
//!
//! The comments and defaults here become those of the JSON Schema. A test compares the defaults with
//! what a missing key means.

use schemars::JsonSchema;
use serde::Deserialize;

use super::animation_tables::AnimationTable;
use super::color::{Color, Pair};
use super::light_tables::{EnvironmentTable, LightTable};
use super::material_table::MaterialTable;
use super::spanned::{OneOrMore, Spanned, Table, Tables};
use super::values::{
    Depth, Direction, FieldOfView, Length, Number, OcclusionRays, Point, PointOrName, Rotation,
    SampleRange, Samples, Scale, Share, Size,
};
use crate::scene::{IntegratorKind, SamplePosition, ShadingModel, Tone, Transfer};

/// The contents of a scene file: objects, lights, cameras, and the picture to make of them.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(title = "envers scene")]
pub struct SceneTable {
    /// The size and quality of the picture.
    pub film: Table<FilmTable>,
    /// The camera. Several are written as `[[camera]]`; the first is used unless another is chosen.
    /// Without one: the first model's own camera, or one that frames the scene.
    pub camera: OneOrMore<CameraTable>,
    /// Materials.
    pub material: Tables<MaterialTable>,
    /// Spheres.
    pub sphere: Tables<SphereTable>,
    /// Infinite planes, such as the ground.
    pub plane: Tables<PlaneTable>,
    /// Models from other files.
    pub model: Tables<ModelTable>,
    /// Lights.
    pub light: Tables<LightTable>,
    /// The lights of a scene that has a model and no light: default ones, or none.
    #[schemars(extend("default" = "auto"))]
    pub lights: Option<DefaultLights>,
    /// The environment: light from infinitely far away, by direction.
    pub environment: Option<Spanned<Table<EnvironmentTable>>>,
    /// The motion of objects, and its length.
    pub animation: Option<Spanned<Table<AnimationTable>>>,
}

/// The lights of a scene that has a model and no light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum DefaultLights {
    /// The lights of a bare model: a key light from the upper left of the camera, a fill light from its right, and
    /// ambient light.
    Auto,
    /// No light.
    None,
}

/// The size and quality of the picture.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FilmTable {
    /// Width and height of the picture, in pixels.
    #[schemars(extend("default" = [1280, 720]))]
    pub size: Option<Spanned<Size>>,
    /// Samples per pixel, from 1 to 65536.
    #[schemars(extend("default" = 1))]
    pub spp: Option<Samples>,
    /// The fewest and the most samples per pixel, in place of `spp`. A pixel gets more than the
    /// fewest where neighbouring samples differ in what they hit, in its normal or in colour.
    pub adaptive: Option<Spanned<SampleRange>>,
    /// The difference from which two colours count as different for `adaptive`, from 0 (always) to
    /// 1; 0.1 by default.
    pub threshold: Option<Spanned<Share>>,
    /// The curve by which the PNG encodes light and hex colours are decoded: sRGB, or none.
    #[schemars(extend("default" = "srgb"))]
    pub transfer: Option<Transfer>,
    /// The exposure of the PNG, in EV: its light is multiplied by 2 to this power.
    #[schemars(extend("default" = 0))]
    pub exposure: Option<Number>,
    /// The tone curve of the PNG, which decides how light brighter than white is shown.
    #[schemars(extend("default" = "none"))]
    pub tone: Option<Tone>,
    /// The colour where a ray hits nothing.
    #[schemars(extend("default" = "#000000"))]
    pub background: Option<Color>,
    /// True for a transparent background: the picture has alpha, the share of each pixel that something
    /// covers. Mirrors and glass still show `background`.
    #[schemars(extend("default" = false))]
    pub transparent: Option<bool>,
    /// The point of its pixel on which a sample is centred: the middle or the upper left corner.
    #[schemars(extend("default" = "center"))]
    pub sample_position: Option<SamplePosition>,
    /// The most reflections and refractions in a row, from 0 to 65536.
    #[schemars(extend("default" = 8))]
    pub max_depth: Option<Depth>,
    /// The integrator: `whitted` has no noise, `path` traces all light by random paths.
    #[schemars(extend("default" = "whitted"))]
    pub integrator: Option<IntegratorKind>,
    /// The number by which the random numbers of the integrator `path` are chosen, from 0 to 4294967295.
    #[schemars(extend("default" = 0))]
    pub seed: Option<u32>,
    /// The number of rays, from 0 to 1024, by which each surface finds how much of the environment's and of
    /// ambient light arrives there. With 0 all of it does.
    #[schemars(extend("default" = 0))]
    pub ambient_occlusion: Option<OcclusionRays>,
    /// The share of a pixel up to which a secondary ray is not traced; 0 leaves out only rays that
    /// add nothing.
    #[schemars(extend("default" = 0))]
    pub cutoff: Option<Share>,
    /// True if light fades out toward the shadow terminator of smooth meshes, instead of ending at the
    /// edges of their faces.
    #[schemars(extend("default" = true))]
    pub soft_terminator: Option<bool>,
}

/// A camera. It looks at `look_at` or along `direction`. One of `fov_y`, `fov_x`, `focal_px` and
/// `ortho_height` says how much it sees.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraTable {
    /// The name by which the camera is chosen and moved; unique among all objects.
    pub name: Option<Spanned<String>>,
    /// The position of the camera.
    pub position: Point,
    /// The point that the camera looks at, or the name of an object.
    pub look_at: Option<Spanned<PointOrName>>,
    /// The direction in which the camera looks, in place of `look_at`.
    pub direction: Option<Spanned<Direction>>,
    /// The direction that is upward in the picture.
    #[schemars(extend("default" = [0, 1, 0]))]
    pub up: Option<Spanned<Direction>>,
    /// The field of view from the lower to the upper edge, in degrees.
    #[schemars(extend("default" = 45))]
    pub fov_y: Option<Spanned<FieldOfView>>,
    /// The field of view from the left to the right edge, in degrees.
    pub fov_x: Option<Spanned<FieldOfView>>,
    /// The distance from the eye to the picture, in pixels of the film's `size`.
    pub focal_px: Option<Spanned<Length>>,
    /// The height of the view in world units, for an orthographic camera.
    pub ortho_height: Option<Spanned<Length>>,
    /// The diameter of the lens's opening, in world units. The integrator `path` blurs what is out of focus by it.
    pub aperture: Option<Spanned<Length>>,
    /// The distance along the view that is sharp, in world units. The default is that of the point `look_at`.
    pub focus_distance: Option<Spanned<Length>>,
}

/// A sphere.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereTable {
    /// The name by which the sphere is moved or looked at; unique among all objects.
    pub name: Option<Spanned<String>>,
    /// The centre of the sphere.
    pub center: Point,
    /// The radius of the sphere, above 0.
    pub radius: Spanned<Length>,
    /// The name of the sphere's material. The default is plain grey.
    pub material: Option<Spanned<String>>,
    /// True if the sphere casts shadows.
    #[schemars(extend("default" = true))]
    pub casts_shadow: Option<bool>,
}

/// An infinite plane.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneTable {
    /// Any point of the plane.
    pub point: Point,
    /// The normal of the plane, of any length but zero.
    pub normal: Direction,
    /// The name of the plane's material. The default is plain grey.
    pub material: Option<Spanned<String>>,
    /// A checker in place of the material's diffuse colour.
    pub checker: Option<Table<CheckerTable>>,
    /// The side of the square that an image of the material covers before it repeats.
    #[schemars(extend("default" = 1))]
    pub texture_size: Option<Length>,
    /// True if the plane casts shadows.
    #[schemars(extend("default" = true))]
    pub casts_shadow: Option<bool>,
}

/// A checker, with a corner of its squares at the plane's point.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CheckerTable {
    /// The two colours of the squares.
    pub colors: Pair,
    /// The side of a square.
    #[schemars(extend("default" = 1))]
    pub size: Option<Length>,
}

/// A model from another file: scaled, then rotated, then translated.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModelTable {
    /// The name by which the model is moved or looked at; unique among all objects.
    pub name: Option<Spanned<String>>,
    /// The model file, `.gltf`, `.glb` or `.obj`, relative to the scene file.
    pub file: Spanned<String>,
    /// The position of the model's origin.
    #[schemars(extend("default" = [0, 0, 0]))]
    pub translate: Option<Point>,
    /// The rotation: angles in degrees about the fixed x axis, then y, then z.
    #[schemars(extend("default" = [0, 0, 0]))]
    pub rotate: Option<Rotation>,
    /// The scale: one factor, or one for each axis; not zero, negative to mirror.
    #[schemars(extend("default" = 1))]
    pub scale: Option<Scale>,
    /// The name of a material that replaces the model's own.
    pub material: Option<Spanned<String>>,
    /// True if the model casts shadows.
    #[schemars(extend("default" = true))]
    pub casts_shadow: Option<bool>,
    /// True if the surfaces of the model that emit light illuminate others.
    #[schemars(extend("default" = false))]
    pub illuminates: Option<Spanned<bool>>,
    /// True if the lights in the model's file shine.
    #[schemars(extend("default" = true))]
    pub lights: Option<bool>,
    /// The name of the animation that a glTF model plays. The default is its first.
    pub animation: Option<Spanned<String>>,
    /// The name of the material variant that a glTF model shows. The default is the one of the
    /// file.
    pub variant: Option<Spanned<String>>,
    /// The shading model of the model's materials: `"pbr"` (physically based), or `"phong"` (Lambert's and
    /// Phong's, as in the tutorial). The default is `"pbr"` for glTF files and for materials of MTL files
    /// with `Pr` or `Pm`, and `"phong"` for other materials of MTL files.
    pub shading: Option<ShadingModel>,
}
