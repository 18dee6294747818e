//! The objects of glTF 2.0 and their properties, after the JSON schema of the standard
//! (<https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>, part 5).

/// The kind of value that a property may have.
pub enum Kind {
    /// `true` or `false`.
    Flag,
    /// A string.
    Text,
    /// A string that names data or a file.
    Uri,
    /// One of some integers.
    OneOf(&'static [u64]),
    /// An integer, by the least that is valid.
    Integer(u64),
    /// A number in a range.
    Number(NumberRange),
    /// A list of some length, of numbers in a range.
    Vector(usize, NumberRange),
    /// The index of an item in a list of the root.
    Index(&'static str),
    /// A list of at least one item.
    List(&'static Kind),
    /// A list of at least one item, of which no two are equal.
    Set(&'static Kind),
    /// An object of at least one vertex attribute, each the index of an accessor.
    Attributes,
    /// An object.
    Object(&'static Schema),
}

/// A range of numbers.
#[derive(Clone, Copy)]
pub struct NumberRange {
    /// The least number.
    pub least: f64,
    /// True if the least number itself is not valid.
    pub is_open: bool,
    /// The greatest number.
    pub most: f64,
}

/// The properties of a kind of object.
pub struct Schema {
    /// The object's name in the standard, by which extensions say where they belong.
    pub name: &'static str,
    /// The properties.
    pub properties: &'static [Property],
}

/// A property of an object.
pub struct Property {
    /// Its key.
    pub name: &'static str,
    /// True if it must be there.
    pub is_required: bool,
    /// The kind of its value.
    pub kind: Kind,
}

/// The schema of an object with a name.
pub const fn schema(name: &'static str, properties: &'static [Property]) -> Schema {
    Schema { name, properties }
}

/// A property that must be there.
pub const fn required(name: &'static str, kind: Kind) -> Property {
    Property { name, is_required: true, kind }
}

/// A property that may be missing.
pub const fn optional(name: &'static str, kind: Kind) -> Property {
    Property { name, is_required: false, kind }
}

/// A texture, which may be missing.
pub const fn texture(name: &'static str) -> Property {
    optional(name, Object(&TEXTURE_INFO))
}

/// A number from 0 to 1, which may be missing.
pub const fn share(name: &'static str) -> Property {
    optional(name, Number(SHARE))
}

/// The range of all numbers.
pub const ALL: NumberRange =
    NumberRange { least: f64::NEG_INFINITY, is_open: false, most: f64::INFINITY };
/// The range of 0 and above.
pub const NOT_NEGATIVE: NumberRange = NumberRange { least: 0.0, ..ALL };
/// The range above 0.
pub const ABOVE_0: NumberRange = NumberRange { is_open: true, ..NOT_NEGATIVE };
/// The range from 0 to 1.
pub const SHARE: NumberRange = NumberRange { most: 1.0, ..NOT_NEGATIVE };
/// The range from −1 to 1.
const WITHIN_1: NumberRange = NumberRange { least: -1.0, most: 1.0, ..ALL };

/// The name that an object may have.
pub const NAME: Property = optional("name", Text);

use Kind::*;

/// The root, to which all other objects belong.
pub const ROOT: Schema = schema("glTF", &[
    optional("extensionsUsed", Set(&Text)), optional("extensionsRequired", Set(&Text)),
    optional("accessors", List(&Object(&ACCESSOR))),
    optional("animations", List(&Object(&ANIMATION))), required("asset", Object(&ASSET)),
    optional("buffers", List(&Object(&BUFFER))),
    optional("bufferViews", List(&Object(&BUFFER_VIEW))),
    optional("cameras", List(&Object(&CAMERA))), optional("images", List(&Object(&IMAGE))),
    optional("materials", List(&Object(&MATERIAL))), optional("meshes", List(&Object(&MESH))),
    optional("nodes", List(&Object(&NODE))), optional("samplers", List(&Object(&SAMPLER))),
    optional("scene", Index("scenes")), optional("scenes", List(&Object(&SCENE))),
    optional("skins", List(&Object(&SKIN))), optional("textures", List(&Object(&TEXTURE))),
]);

const ASSET: Schema = schema("asset", &[
    required("version", Text), optional("minVersion", Text), optional("generator", Text),
    optional("copyright", Text),
]);

const ACCESSOR: Schema = schema("accessor", &[
    optional("bufferView", Index("bufferViews")), optional("byteOffset", Integer(0)),
    required("componentType", OneOf(&[5120, 5121, 5122, 5123, 5125, 5126])),
    optional("normalized", Flag), required("count", Integer(1)), required("type", Text),
    optional("min", List(&Number(ALL))), optional("max", List(&Number(ALL))),
    optional("sparse", Object(&SPARSE)),
]);

const SPARSE: Schema = schema("sparse", &[
    required("count", Integer(1)), required("indices", Object(&SPARSE_INDICES)),
    required("values", Object(&SPARSE_VALUES)),
]);

const SPARSE_INDICES: Schema = schema("sparse indices", &[
    required("bufferView", Index("bufferViews")), optional("byteOffset", Integer(0)),
    required("componentType", OneOf(&[5121, 5123, 5125])),
]);

const SPARSE_VALUES: Schema = schema("sparse values", &[
    required("bufferView", Index("bufferViews")), optional("byteOffset", Integer(0)),
]);

const ANIMATION: Schema = schema("animation", &[
    required("channels", List(&Object(&CHANNEL))),
    required("samplers", List(&Object(&ANIMATION_SAMPLER))), NAME,
]);

const CHANNEL: Schema = schema("channel", &[
    required("sampler", Integer(0)), required("target", Object(&TARGET)),
]);

const TARGET: Schema = schema("channel target", &[
    optional("node", Index("nodes")), required("path", Text),
]);

const ANIMATION_SAMPLER: Schema = schema("animation sampler", &[
    required("input", Index("accessors")), optional("interpolation", Text),
    required("output", Index("accessors")),
]);

const BUFFER: Schema = schema("buffer", &[
    optional("uri", Uri), required("byteLength", Integer(1)), NAME,
]);

const BUFFER_VIEW: Schema = schema("bufferView", &[
    required("buffer", Index("buffers")), optional("byteOffset", Integer(0)),
    required("byteLength", Integer(1)), optional("byteStride", Integer(4)),
    optional("target", OneOf(&[34962, 34963])), NAME,
]);

const CAMERA: Schema = schema("camera", &[
    optional("orthographic", Object(&ORTHOGRAPHIC)), optional("perspective", Object(&PERSPECTIVE)),
    required("type", Text), NAME,
]);

const ORTHOGRAPHIC: Schema = schema("orthographic camera", &[
    required("xmag", Number(ALL)), required("ymag", Number(ALL)), required("zfar", Number(ABOVE_0)),
    required("znear", Number(NOT_NEGATIVE)),
]);

const PERSPECTIVE: Schema = schema("perspective camera", &[
    optional("aspectRatio", Number(ABOVE_0)), required("yfov", Number(ABOVE_0)),
    optional("zfar", Number(ABOVE_0)), required("znear", Number(ABOVE_0)),
]);

const IMAGE: Schema = schema("image", &[
    optional("uri", Uri), optional("mimeType", Text), optional("bufferView", Index("bufferViews")),
    NAME,
]);

const MATERIAL: Schema = schema("material", &[
    NAME, optional("pbrMetallicRoughness", Object(&METALLIC_ROUGHNESS)), texture("normalTexture"),
    texture("occlusionTexture"), texture("emissiveTexture"),
    optional("emissiveFactor", Vector(3, SHARE)), optional("alphaMode", Text),
    optional("alphaCutoff", Number(NOT_NEGATIVE)), optional("doubleSided", Flag),
]);

const METALLIC_ROUGHNESS: Schema = schema("pbrMetallicRoughness", &[
    optional("baseColorFactor", Vector(4, SHARE)), texture("baseColorTexture"),
    share("metallicFactor"), share("roughnessFactor"), texture("metallicRoughnessTexture"),
]);

/// A reference to a texture.
pub const TEXTURE_INFO: Schema = schema("textureInfo", &[
    required("index", Index("textures")), optional("texCoord", Integer(0)),
    optional("scale", Number(ALL)), share("strength"),
]);

const MESH: Schema = schema("mesh", &[
    required("primitives", List(&Object(&PRIMITIVE))), optional("weights", List(&Number(ALL))),
    NAME,
]);

const PRIMITIVE: Schema = schema("primitive", &[
    required("attributes", Attributes), optional("indices", Index("accessors")),
    optional("material", Index("materials")), optional("mode", OneOf(&[0, 1, 2, 3, 4, 5, 6])),
    optional("targets", List(&Attributes)),
]);

const NODE: Schema = schema("node", &[
    optional("camera", Index("cameras")), optional("children", Set(&Index("nodes"))),
    optional("skin", Index("skins")), optional("matrix", Vector(16, ALL)),
    optional("mesh", Index("meshes")), optional("rotation", Vector(4, WITHIN_1)),
    optional("scale", Vector(3, ALL)), optional("translation", Vector(3, ALL)),
    optional("weights", List(&Number(ALL))), NAME,
]);

const SAMPLER: Schema = schema("sampler", &[
    optional("magFilter", OneOf(&[9728, 9729])),
    optional("minFilter", OneOf(&[9728, 9729, 9984, 9985, 9986, 9987])),
    optional("wrapS", OneOf(&[33071, 33648, 10497])),
    optional("wrapT", OneOf(&[33071, 33648, 10497])), NAME,
]);

const SCENE: Schema = schema("scene", &[optional("nodes", Set(&Index("nodes"))), NAME]);

const SKIN: Schema = schema("skin", &[
    optional("inverseBindMatrices", Index("accessors")), optional("skeleton", Index("nodes")),
    required("joints", Set(&Index("nodes"))), NAME,
]);

const TEXTURE: Schema = schema("texture", &[
    optional("sampler", Index("samplers")), optional("source", Index("images")), NAME,
]);
