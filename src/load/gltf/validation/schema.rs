//! The objects of glTF 2.0 and their properties, after the JSON schema of the standard
//! (<https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>, part 5).

/// What a property may be.
pub enum Kind {
    /// `true` or `false`.
    Flag,
    /// A string.
    Text,
    /// A string that names data or a file.
    Uri,
    /// One of these numbers.
    OneOf(&'static [u64]),
    /// A whole number from this one on.
    Whole(u64),
    /// A number in this range.
    Number(Limits),
    /// So many numbers in this range.
    Vector(usize, Limits),
    /// The index of something in a list of the root.
    Index(&'static str),
    /// A list of at least one.
    List(&'static Kind),
    /// A list of at least one, of which no two are equal.
    Set(&'static Kind),
    /// At least one attribute of vertices, each an accessor.
    Attributes,
    /// An object.
    Object(&'static Schema),
}

/// A range of numbers.
#[derive(Clone, Copy)]
pub struct Limits {
    /// The least.
    pub least: f64,
    /// Whether that is one of them.
    pub open: bool,
    /// The greatest.
    pub most: f64,
}

/// A kind of object.
pub struct Schema {
    /// Its name in the standard; extensions say by it where they belong.
    pub name: &'static str,
    /// Its properties: name, whether it must be there, and what it may be.
    pub properties: &'static [(&'static str, bool, Kind)],
}

/// All of the numbers.
pub const ALL: Limits = Limits { least: f64::NEG_INFINITY, open: false, most: f64::INFINITY };
/// 0 and above.
pub const NOT_NEGATIVE: Limits = Limits { least: 0.0, ..ALL };
/// Above 0.
pub const ABOVE_0: Limits = Limits { open: true, ..NOT_NEGATIVE };
/// From 0 to 1.
pub const SHARE: Limits = Limits { most: 1.0, ..NOT_NEGATIVE };
/// From −1 to 1.
const WITHIN_1: Limits = Limits { least: -1.0, most: 1.0, ..ALL };

use Kind::{Attributes, Flag, Index, List, Number, Object, OneOf, Set, Text, Uri, Vector, Whole};

/// The root, from which all others hang.
pub const ROOT: Schema = Schema {
    name: "glTF",
    properties: &[
        ("extensionsUsed", false, Set(&Text)),
        ("extensionsRequired", false, Set(&Text)),
        ("accessors", false, List(&Object(&ACCESSOR))),
        ("animations", false, List(&Object(&ANIMATION))),
        ("asset", true, Object(&ASSET)),
        ("buffers", false, List(&Object(&BUFFER))),
        ("bufferViews", false, List(&Object(&BUFFER_VIEW))),
        ("cameras", false, List(&Object(&CAMERA))),
        ("images", false, List(&Object(&IMAGE))),
        ("materials", false, List(&Object(&MATERIAL))),
        ("meshes", false, List(&Object(&MESH))),
        ("nodes", false, List(&Object(&NODE))),
        ("samplers", false, List(&Object(&SAMPLER))),
        ("scene", false, Index("scenes")),
        ("scenes", false, List(&Object(&SCENE))),
        ("skins", false, List(&Object(&SKIN))),
        ("textures", false, List(&Object(&TEXTURE))),
    ],
};

const ASSET: Schema = Schema {
    name: "asset",
    properties: &[
        ("version", true, Text),
        ("minVersion", false, Text),
        ("generator", false, Text),
        ("copyright", false, Text),
    ],
};

const ACCESSOR: Schema = Schema {
    name: "accessor",
    properties: &[
        ("bufferView", false, Index("bufferViews")),
        ("byteOffset", false, Whole(0)),
        ("componentType", true, OneOf(&[5120, 5121, 5122, 5123, 5125, 5126])),
        ("normalized", false, Flag),
        ("count", true, Whole(1)),
        ("type", true, Text),
        ("min", false, List(&Number(ALL))),
        ("max", false, List(&Number(ALL))),
        ("sparse", false, Object(&SPARSE)),
    ],
};

const SPARSE: Schema = Schema {
    name: "sparse",
    properties: &[
        ("count", true, Whole(1)),
        ("indices", true, Object(&SPARSE_INDICES)),
        ("values", true, Object(&SPARSE_VALUES)),
    ],
};

const SPARSE_INDICES: Schema = Schema {
    name: "sparse indices",
    properties: &[
        ("bufferView", true, Index("bufferViews")),
        ("byteOffset", false, Whole(0)),
        ("componentType", true, OneOf(&[5121, 5123, 5125])),
    ],
};

const SPARSE_VALUES: Schema = Schema {
    name: "sparse values",
    properties: &[("bufferView", true, Index("bufferViews")), ("byteOffset", false, Whole(0))],
};

const ANIMATION: Schema = Schema {
    name: "animation",
    properties: &[
        ("channels", true, List(&Object(&CHANNEL))),
        ("samplers", true, List(&Object(&ANIMATION_SAMPLER))),
        ("name", false, Text),
    ],
};

const CHANNEL: Schema = Schema {
    name: "channel",
    properties: &[("sampler", true, Whole(0)), ("target", true, Object(&TARGET))],
};

const TARGET: Schema = Schema {
    name: "channel target",
    properties: &[("node", false, Index("nodes")), ("path", true, Text)],
};

const ANIMATION_SAMPLER: Schema = Schema {
    name: "animation sampler",
    properties: &[
        ("input", true, Index("accessors")),
        ("interpolation", false, Text),
        ("output", true, Index("accessors")),
    ],
};

const BUFFER: Schema = Schema {
    name: "buffer",
    properties: &[("uri", false, Uri), ("byteLength", true, Whole(1)), ("name", false, Text)],
};

const BUFFER_VIEW: Schema = Schema {
    name: "bufferView",
    properties: &[
        ("buffer", true, Index("buffers")),
        ("byteOffset", false, Whole(0)),
        ("byteLength", true, Whole(1)),
        ("byteStride", false, Whole(4)),
        ("target", false, OneOf(&[34962, 34963])),
        ("name", false, Text),
    ],
};

const CAMERA: Schema = Schema {
    name: "camera",
    properties: &[
        ("orthographic", false, Object(&ORTHOGRAPHIC)),
        ("perspective", false, Object(&PERSPECTIVE)),
        ("type", true, Text),
        ("name", false, Text),
    ],
};

const ORTHOGRAPHIC: Schema = Schema {
    name: "orthographic camera",
    properties: &[
        ("xmag", true, Number(ALL)),
        ("ymag", true, Number(ALL)),
        ("zfar", true, Number(ABOVE_0)),
        ("znear", true, Number(NOT_NEGATIVE)),
    ],
};

const PERSPECTIVE: Schema = Schema {
    name: "perspective camera",
    properties: &[
        ("aspectRatio", false, Number(ABOVE_0)),
        ("yfov", true, Number(ABOVE_0)),
        ("zfar", false, Number(ABOVE_0)),
        ("znear", true, Number(ABOVE_0)),
    ],
};

const IMAGE: Schema = Schema {
    name: "image",
    properties: &[
        ("uri", false, Uri),
        ("mimeType", false, Text),
        ("bufferView", false, Index("bufferViews")),
        ("name", false, Text),
    ],
};

const MATERIAL: Schema = Schema {
    name: "material",
    properties: &[
        ("name", false, Text),
        ("pbrMetallicRoughness", false, Object(&METALLIC_ROUGHNESS)),
        ("normalTexture", false, Object(&TEXTURE_INFO)),
        ("occlusionTexture", false, Object(&TEXTURE_INFO)),
        ("emissiveTexture", false, Object(&TEXTURE_INFO)),
        ("emissiveFactor", false, Vector(3, SHARE)),
        ("alphaMode", false, Text),
        ("alphaCutoff", false, Number(NOT_NEGATIVE)),
        ("doubleSided", false, Flag),
    ],
};

const METALLIC_ROUGHNESS: Schema = Schema {
    name: "pbrMetallicRoughness",
    properties: &[
        ("baseColorFactor", false, Vector(4, SHARE)),
        ("baseColorTexture", false, Object(&TEXTURE_INFO)),
        ("metallicFactor", false, Number(SHARE)),
        ("roughnessFactor", false, Number(SHARE)),
        ("metallicRoughnessTexture", false, Object(&TEXTURE_INFO)),
    ],
};

/// A use of a texture.
pub const TEXTURE_INFO: Schema = Schema {
    name: "textureInfo",
    properties: &[
        ("index", true, Index("textures")),
        ("texCoord", false, Whole(0)),
        ("scale", false, Number(ALL)),
        ("strength", false, Number(SHARE)),
    ],
};

const MESH: Schema = Schema {
    name: "mesh",
    properties: &[
        ("primitives", true, List(&Object(&PRIMITIVE))),
        ("weights", false, List(&Number(ALL))),
        ("name", false, Text),
    ],
};

const PRIMITIVE: Schema = Schema {
    name: "primitive",
    properties: &[
        ("attributes", true, Attributes),
        ("indices", false, Index("accessors")),
        ("material", false, Index("materials")),
        ("mode", false, OneOf(&[0, 1, 2, 3, 4, 5, 6])),
        ("targets", false, List(&Attributes)),
    ],
};

const NODE: Schema = Schema {
    name: "node",
    properties: &[
        ("camera", false, Index("cameras")),
        ("children", false, Set(&Index("nodes"))),
        ("skin", false, Index("skins")),
        ("matrix", false, Vector(16, ALL)),
        ("mesh", false, Index("meshes")),
        ("rotation", false, Vector(4, WITHIN_1)),
        ("scale", false, Vector(3, ALL)),
        ("translation", false, Vector(3, ALL)),
        ("weights", false, List(&Number(ALL))),
        ("name", false, Text),
    ],
};

const SAMPLER: Schema = Schema {
    name: "sampler",
    properties: &[
        ("magFilter", false, OneOf(&[9728, 9729])),
        ("minFilter", false, OneOf(&[9728, 9729, 9984, 9985, 9986, 9987])),
        ("wrapS", false, OneOf(&[33071, 33648, 10497])),
        ("wrapT", false, OneOf(&[33071, 33648, 10497])),
        ("name", false, Text),
    ],
};

const SCENE: Schema = Schema {
    name: "scene",
    properties: &[("nodes", false, Set(&Index("nodes"))), ("name", false, Text)],
};

const SKIN: Schema = Schema {
    name: "skin",
    properties: &[
        ("inverseBindMatrices", false, Index("accessors")),
        ("skeleton", false, Index("nodes")),
        ("joints", true, Set(&Index("nodes"))),
        ("name", false, Text),
    ],
};

const TEXTURE: Schema = Schema {
    name: "texture",
    properties: &[
        ("sampler", false, Index("samplers")),
        ("source", false, Index("images")),
        ("name", false, Text),
    ],
};
