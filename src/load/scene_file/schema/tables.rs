//! The tables of a scene file: one type per table, one field per key.
//!
//! The comments and defaults here become those of the JSON Schema. A test compares the defaults with
//! what a missing key means.

use schemars::JsonSchema;
use serde::Deserialize;

use super::animation_tables::AnimationTable;
use super::color::{Color, Pair};
use super::spanned::{OneOrMore, Spanned, Table, Tables};
use super::values::{
    Amount, Depth, Direction, FieldOfView, HalfAngle, Index, Length, LightSamples, Number,
    OcclusionRays, Point, PointOrName, Priority, Rotation, SampleRange, Samples, Scale, ShadowKind,
    Share, Shininess, Sides, Size, SunAngle, Triple, Turbidity,
};
use crate::scene::{Falloff, SamplePosition, ShadingModel, Tone, Transfer};

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
}

/// A material: Lambert's diffuse and Phong's specular reflection, mirrors and glass; or, with `metallic` or
/// `roughness`, a physically based one.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialTable {
    /// The name by which objects refer to the material; unique among the materials.
    pub name: Spanned<String>,
    /// The share of the light that is scattered in all directions; the base colour of a physically based
    /// material.
    #[schemars(extend("default" = 0.8))]
    pub diffuse: Option<Spanned<Color>>,
    /// An image file (PNG, JPEG, WebP, TGA, BMP or KTX 2, in sRGB; HDR or EXR, linear) multiplied
    /// by `diffuse`.
    pub diffuse_map: Option<Spanned<String>>,
    /// The share of the light in Phong's highlight.
    #[schemars(extend("default" = 0))]
    pub specular: Option<Spanned<Color>>,
    /// An image file, in sRGB, multiplied by `specular`.
    pub specular_map: Option<Spanned<String>>,
    /// Phong's exponent: the greater, the smaller the highlight.
    #[schemars(extend("default" = 50))]
    pub shininess: Option<Spanned<Shininess>>,
    /// The light that the surface emits.
    #[schemars(extend("default" = 0))]
    pub emission: Option<Color>,
    /// True if the light that the surface emits lights other surfaces. Not on planes.
    #[schemars(extend("default" = false))]
    pub illuminates: Option<Spanned<bool>>,
    /// An image file, in sRGB, multiplied by `emission`.
    pub emission_map: Option<Spanned<String>>,
    /// An image file of normals in tangent space, as in glTF: linear, y up in the image.
    pub normal_map: Option<Spanned<String>>,
    /// The filter of the material's images: `"nearest"`, `"linear"`, or `"mipmap"`, which averages
    /// the area that a sample covers.
    #[schemars(extend("default" = "linear"))]
    pub filter: Option<MapFilter>,
    /// The meaning of the alpha of `diffuse_map`: none; a hole where it is below `alpha_cutoff`; or
    /// the share of what lies behind that the surface covers.
    #[schemars(extend("default" = "opaque"))]
    pub alpha_mode: Option<Spanned<MapAlpha>>,
    /// The alpha below which `alpha_mode = "mask"` cuts holes. The default is 0.5.
    pub alpha_cutoff: Option<Spanned<Share>>,
    /// The share of the light that is reflected as by a mirror.
    #[schemars(extend("default" = 0))]
    pub reflect: Option<Spanned<Color>>,
    /// The share of the light that goes through as through glass, less what Fresnel's law reflects.
    #[schemars(extend("default" = 0))]
    pub transmit: Option<Spanned<Color>>,
    /// The index of refraction of the inside.
    #[schemars(extend("default" = 1.5))]
    pub ior: Option<Index>,
    /// The absorption of the inside per unit of length: light falls to e^(−absorption). One number,
    /// or three for red, green and blue.
    #[schemars(extend("default" = 0))]
    pub absorption: Option<Triple>,
    /// True if the object is a thin sheet, such as a pane, with no inside.
    #[schemars(extend("default" = false))]
    pub thin: Option<bool>,
    /// The priority where two transparent bodies overlap: the body with the greater one fills the
    /// place; with equal ones, the smaller body does.
    #[schemars(extend("default" = 0))]
    pub priority: Option<Priority>,
    /// True if a sphere is lit on its inside too. Planes and meshes always are.
    #[schemars(extend("default" = false))]
    pub double_sided: Option<bool>,
    /// The metalness: 1 for a metal, 0 for anything else. It makes the material physically based, as in glTF.
    /// Beside `roughness` the default is 0.
    pub metallic: Option<Spanned<Share>>,
    /// The roughness: 0 for a mirror, 1 for chalk. It makes the material physically based, as in glTF.
    /// Beside `metallic` the default is 0.5.
    pub roughness: Option<Spanned<Share>>,
    /// An image file, linear, whose green multiplies `roughness` and whose blue `metallic`.
    pub metallic_roughness_map: Option<Spanned<String>>,
    /// The share of the light that enters and goes through, tinted by the base colour (physically based).
    pub transmission: Option<Spanned<Share>>,
    /// The strength of a clear coat over the base (physically based).
    pub clearcoat: Option<Spanned<Share>>,
    /// The roughness of the clear coat.
    pub clearcoat_roughness: Option<Spanned<Share>>,
    /// The colour of a sheen, as of velvet (physically based).
    pub sheen_color: Option<Spanned<Color>>,
    /// The roughness of the sheen.
    pub sheen_roughness: Option<Spanned<Share>>,
    /// The strength of the stretch of reflections, as on brushed metal (physically based).
    pub anisotropy: Option<Spanned<Share>>,
    /// The direction of the stretch in degrees, counter-clockwise from the tangent.
    pub anisotropy_rotation: Option<Spanned<Number>>,
    /// The strength of the colours of a thin film, as of soap (physically based).
    pub iridescence: Option<Spanned<Share>>,
    /// The index of refraction of the film.
    pub iridescence_ior: Option<Spanned<Index>>,
    /// The thickness of the film in nanometres.
    pub iridescence_thickness: Option<Spanned<Amount>>,
    /// The dispersion: 20 divided by the Abbe number, about 0.33 for glass (physically based).
    pub dispersion: Option<Spanned<Amount>>,
    /// The share of the diffuse light that goes through, as through a leaf (physically based).
    pub diffuse_transmission: Option<Spanned<Share>>,
}

/// The filter by which images are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MapFilter {
    /// The pixel at the point.
    Nearest,
    /// The four pixels around the point, weighted by distance.
    #[default]
    Linear,
    /// The mean of the area that a sample covers.
    Mipmap,
}

/// The meaning of the alpha of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MapAlpha {
    /// No meaning: the surface is opaque.
    Opaque,
    /// A hole where the alpha is below a cutoff.
    Mask,
    /// The share of what lies behind that the surface covers.
    Blend,
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
