//! The objects of extensions, and where each of them belongs.

use super::schema::Kind::{
    self, Attributes, Flag, Index, List, Number, Object, Set, Text, Vector, Whole,
};
use super::schema::{ABOVE_0, ALL, Limits, NOT_NEGATIVE, SHARE, Schema, TEXTURE_INFO};

/// An extension's name, the object that it stands in, and what it is; those that stand nowhere have
/// no line.
pub const EXTENSIONS: &[(&str, &str, Schema)] = &[
    ("EXT_mesh_gpu_instancing", "node", plain(&[("attributes", true, Attributes)])),
    ("EXT_meshopt_compression", "buffer", plain(&[])),
    ("EXT_meshopt_compression", "bufferView", plain(&[("buffer", true, Index("buffers"))])),
    ("EXT_texture_webp", "texture", plain(&[("source", false, Index("images"))])),
    ("KHR_animation_pointer", "channel target", plain(&[("pointer", true, Text)])),
    (
        "KHR_draco_mesh_compression",
        "primitive",
        plain(&[("bufferView", true, Index("bufferViews"))]),
    ),
    ("KHR_implicit_shapes", "glTF", plain(&[("shapes", true, List(&Object(&SHAPE)))])),
    ("KHR_implicit_shapes", "node", plain(&[("shape", true, Index("KHR_implicit_shapes.shapes"))])),
    ("KHR_lights_punctual", "glTF", plain(&[("lights", true, List(&Object(&LIGHT)))])),
    ("KHR_lights_punctual", "node", plain(&[("light", true, Index("KHR_lights_punctual.lights"))])),
    (
        "KHR_materials_anisotropy",
        "material",
        plain(&[
            ("anisotropyStrength", false, Number(SHARE)),
            ("anisotropyRotation", false, Number(ALL)),
            ("anisotropyTexture", false, Object(&TEXTURE_INFO)),
        ]),
    ),
    (
        "KHR_materials_clearcoat",
        "material",
        plain(&[
            ("clearcoatFactor", false, Number(SHARE)),
            ("clearcoatTexture", false, Object(&TEXTURE_INFO)),
            ("clearcoatRoughnessFactor", false, Number(SHARE)),
            ("clearcoatRoughnessTexture", false, Object(&TEXTURE_INFO)),
            ("clearcoatNormalTexture", false, Object(&TEXTURE_INFO)),
        ]),
    ),
    ("KHR_materials_dispersion", "material", plain(&[("dispersion", false, Number(NOT_NEGATIVE))])),
    (
        "KHR_materials_emissive_strength",
        "material",
        plain(&[("emissiveStrength", false, Number(NOT_NEGATIVE))]),
    ),
    // An ior of 0 is allowed too, which the walk knows of.
    ("KHR_materials_ior", "material", plain(&[("ior", false, Number(FROM_1_OR_0))])),
    (
        "KHR_materials_iridescence",
        "material",
        plain(&[
            ("iridescenceFactor", false, Number(SHARE)),
            ("iridescenceTexture", false, Object(&TEXTURE_INFO)),
            ("iridescenceIor", false, Number(FROM_1_OR_0)),
            ("iridescenceThicknessMinimum", false, Number(NOT_NEGATIVE)),
            ("iridescenceThicknessMaximum", false, Number(NOT_NEGATIVE)),
            ("iridescenceThicknessTexture", false, Object(&TEXTURE_INFO)),
        ]),
    ),
    (
        "KHR_materials_pbrSpecularGlossiness",
        "material",
        plain(&[
            ("diffuseFactor", false, Vector(4, SHARE)),
            ("diffuseTexture", false, Object(&TEXTURE_INFO)),
            ("specularFactor", false, Vector(3, SHARE)),
            ("glossinessFactor", false, Number(SHARE)),
            ("specularGlossinessTexture", false, Object(&TEXTURE_INFO)),
        ]),
    ),
    (
        "KHR_materials_sheen",
        "material",
        plain(&[
            ("sheenColorFactor", false, Vector(3, SHARE)),
            ("sheenColorTexture", false, Object(&TEXTURE_INFO)),
            ("sheenRoughnessFactor", false, Number(SHARE)),
            ("sheenRoughnessTexture", false, Object(&TEXTURE_INFO)),
        ]),
    ),
    (
        "KHR_materials_specular",
        "material",
        plain(&[
            ("specularFactor", false, Number(SHARE)),
            ("specularTexture", false, Object(&TEXTURE_INFO)),
            ("specularColorFactor", false, Vector(3, NOT_NEGATIVE)),
            ("specularColorTexture", false, Object(&TEXTURE_INFO)),
        ]),
    ),
    (
        "KHR_materials_transmission",
        "material",
        plain(&[
            ("transmissionFactor", false, Number(SHARE)),
            ("transmissionTexture", false, Object(&TEXTURE_INFO)),
        ]),
    ),
    ("KHR_materials_unlit", "material", plain(&[])),
    ("KHR_materials_variants", "glTF", plain(&[("variants", true, List(&Object(&VARIANT)))])),
    ("KHR_materials_variants", "primitive", plain(&[("mappings", true, List(&Object(&MAPPING)))])),
    (
        "KHR_materials_volume",
        "material",
        plain(&[
            ("thicknessFactor", false, Number(NOT_NEGATIVE)),
            ("thicknessTexture", false, Object(&TEXTURE_INFO)),
            ("attenuationDistance", false, Number(ABOVE_0)),
            ("attenuationColor", false, Vector(3, SHARE)),
        ]),
    ),
    ("KHR_node_visibility", "node", plain(&[("visible", false, Flag)])),
    ("KHR_texture_basisu", "texture", plain(&[("source", false, Index("images"))])),
    (
        "KHR_texture_transform",
        "textureInfo",
        plain(&[
            ("offset", false, Vector(2, ALL)),
            ("rotation", false, Number(ALL)),
            ("scale", false, Vector(2, ALL)),
            ("texCoord", false, Whole(0)),
        ]),
    ),
];

/// Extensions that have no object, wherever they are used.
pub const WITHOUT_OBJECT: [&str; 1] = ["KHR_mesh_quantization"];

/// An index of refraction.
const FROM_1_OR_0: Limits = Limits { least: 1.0, ..ALL };

const LIGHT: Schema = plain(&[
    ("name", false, Text),
    ("type", true, Text),
    ("color", false, Vector(3, SHARE)),
    ("intensity", false, Number(NOT_NEGATIVE)),
    ("range", false, Number(ABOVE_0)),
    ("spot", false, Object(&SPOT)),
]);

const SPOT: Schema = plain(&[
    ("innerConeAngle", false, Number(Limits { most: std::f64::consts::FRAC_PI_2, ..NOT_NEGATIVE })),
    ("outerConeAngle", false, Number(Limits { most: std::f64::consts::FRAC_PI_2, ..ABOVE_0 })),
]);

const VARIANT: Schema = plain(&[("name", true, Text)]);

const MAPPING: Schema = plain(&[
    ("material", true, Index("materials")),
    ("variants", true, Set(&Index("KHR_materials_variants.variants"))),
]);

const SHAPE: Schema = plain(&[("type", true, Text)]);

/// An object that no extension stands in.
const fn plain(properties: &'static [(&'static str, bool, Kind)]) -> Schema {
    Schema { name: "", properties }
}
