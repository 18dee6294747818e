//! The tables of materials.

use schemars::JsonSchema;
use serde::Deserialize;

use super::color::Color;
use super::spanned::Spanned;
use super::values::{Amount, Index, Number, Priority, Share, Shininess, Triple};

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
