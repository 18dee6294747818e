//! The objects of extensions, and the objects that they belong to.

use std::f64::consts::FRAC_PI_2;

use super::schema::Kind::*;
use super::schema::*;

/// An extension's name, the object that it belongs to, and its properties. Extensions that no
/// object of theirs may have are not listed.
pub const EXTENSIONS: &[(&str, &str, &[Property])] = &[
    ("EXT_mesh_gpu_instancing", "node", &[required("attributes", Attributes)]),
    ("EXT_meshopt_compression", "buffer", &[]),
    ("EXT_meshopt_compression", "bufferView", &[required("buffer", Index("buffers"))]),
    ("EXT_texture_webp", "texture", &[optional("source", Index("images"))]),
    ("KHR_animation_pointer", "channel target", &[required("pointer", Text)]),
    ("KHR_draco_mesh_compression", "primitive", &[required("bufferView", Index("bufferViews"))]),
    ("KHR_implicit_shapes", "glTF", &[required("shapes", List(&Object(&SHAPE)))]),
    ("KHR_implicit_shapes", "node", &[required("shape", Index("KHR_implicit_shapes.shapes"))]),
    ("KHR_lights_punctual", "glTF", &[required("lights", List(&Object(&LIGHT)))]),
    ("KHR_lights_punctual", "node", &[required("light", Index("KHR_lights_punctual.lights"))]),
    ("KHR_materials_anisotropy", "material", &[
        share("anisotropyStrength"), optional("anisotropyRotation", Number(ALL)),
        texture("anisotropyTexture"),
    ]),
    ("KHR_materials_clearcoat", "material", &[
        share("clearcoatFactor"), texture("clearcoatTexture"), share("clearcoatRoughnessFactor"),
        texture("clearcoatRoughnessTexture"), texture("clearcoatNormalTexture"),
    ]),
    ("KHR_materials_dispersion", "material", &[optional("dispersion", Number(NOT_NEGATIVE))]),
    ("KHR_materials_emissive_strength", "material", &[
        optional("emissiveStrength", Number(NOT_NEGATIVE)),
    ]),
    // An index of refraction of 0 is valid too, which the check of numbers knows.
    ("KHR_materials_ior", "material", &[optional("ior", Number(FROM_1_OR_0))]),
    ("KHR_materials_iridescence", "material", &[
        share("iridescenceFactor"), texture("iridescenceTexture"),
        optional("iridescenceIor", Number(FROM_1_OR_0)),
        optional("iridescenceThicknessMinimum", Number(NOT_NEGATIVE)),
        optional("iridescenceThicknessMaximum", Number(NOT_NEGATIVE)),
        texture("iridescenceThicknessTexture"),
    ]),
    ("KHR_materials_pbrSpecularGlossiness", "material", &[
        optional("diffuseFactor", Vector(4, SHARE)), texture("diffuseTexture"),
        optional("specularFactor", Vector(3, SHARE)), share("glossinessFactor"),
        texture("specularGlossinessTexture"),
    ]),
    ("KHR_materials_sheen", "material", &[
        optional("sheenColorFactor", Vector(3, SHARE)), texture("sheenColorTexture"),
        share("sheenRoughnessFactor"), texture("sheenRoughnessTexture"),
    ]),
    ("KHR_materials_specular", "material", &[
        share("specularFactor"), texture("specularTexture"),
        optional("specularColorFactor", Vector(3, NOT_NEGATIVE)), texture("specularColorTexture"),
    ]),
    ("KHR_materials_transmission", "material", &[
        share("transmissionFactor"), texture("transmissionTexture"),
    ]),
    ("KHR_materials_unlit", "material", &[]),
    ("KHR_materials_variants", "glTF", &[required("variants", List(&Object(&VARIANT)))]),
    ("KHR_materials_variants", "primitive", &[required("mappings", List(&Object(&MAPPING)))]),
    ("KHR_materials_volume", "material", &[
        optional("thicknessFactor", Number(NOT_NEGATIVE)), texture("thicknessTexture"),
        optional("attenuationDistance", Number(ABOVE_0)),
        optional("attenuationColor", Vector(3, SHARE)),
    ]),
    // It has no object, wherever it is used.
    ("KHR_mesh_quantization", "nothing", &[]),
    ("KHR_node_visibility", "node", &[optional("visible", Flag)]),
    ("KHR_texture_basisu", "texture", &[optional("source", Index("images"))]),
    ("KHR_texture_transform", "textureInfo", &[
        optional("offset", Vector(2, ALL)), optional("rotation", Number(ALL)),
        optional("scale", Vector(2, ALL)), optional("texCoord", Integer(0)),
    ]),
];

/// The range of indices of refraction.
const FROM_1_OR_0: NumberRange = NumberRange { least: 1.0, ..ALL };

const LIGHT: Schema = schema("", &[
    NAME, required("type", Text), optional("color", Vector(3, SHARE)),
    optional("intensity", Number(NOT_NEGATIVE)), optional("range", Number(ABOVE_0)),
    optional("spot", Object(&SPOT)),
]);
const SPOT: Schema = schema("", &[
    optional("innerConeAngle", Number(NumberRange { most: FRAC_PI_2, ..NOT_NEGATIVE })),
    optional("outerConeAngle", Number(NumberRange { most: FRAC_PI_2, ..ABOVE_0 })),
]);
const VARIANT: Schema = schema("", &[required("name", Text)]);
const MAPPING: Schema = schema("", &[
    required("material", Index("materials")),
    required("variants", Set(&Index("KHR_materials_variants.variants"))),
]);
const SHAPE: Schema = schema("", &[required("type", Text)]);
