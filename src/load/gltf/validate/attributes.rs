//! The names of vertex attributes, and the types of accessors that each may have (part 3.7.2.1).

use gltf::json::Value;

use super::integer;

/// The type of an accessor's elements.
#[derive(Clone, Copy)]
pub struct ElementType<'v> {
    /// `SCALAR`, `VEC2` …
    pub shape: &'v str,
    /// The component type.
    pub component: u64,
    /// True if integers are normalised.
    pub normalized: bool,
}

impl<'v> ElementType<'v> {
    /// The type of an accessor, if it has one.
    pub fn from_accessor(accessor: &'v Value) -> Option<Self> {
        Some(Self {
            shape: accessor.get("type")?.as_str()?,
            component: integer(accessor, "componentType")?,
            normalized: accessor.get("normalized").and_then(Value::as_bool).unwrap_or(false),
        })
    }

    /// True if an attribute may have this type, with KHR_mesh_quantization or without.
    pub fn is_valid_for(self, attribute: &str) -> bool {
        let Self { shape, component, normalized } = self;
        let is_float = component == 5126;
        let is_signed = is_float || matches!(component, 5120 | 5122);
        let is_unsigned = matches!(component, 5121 | 5123);
        let is_share = is_float || is_unsigned && normalized;
        match attribute.rsplit_once('_').map_or(attribute, |(set, _)| set) {
            "POSITION" => shape == "VEC3" && component != 5125,
            "NORMAL" => shape == "VEC3" && is_signed,
            "TANGENT" => shape == "VEC4" && is_signed,
            "TEXCOORD" => shape == "VEC2" && component != 5125,
            "COLOR" => matches!(shape, "VEC3" | "VEC4") && is_share,
            "JOINTS" => shape == "VEC4" && is_unsigned && !normalized,
            "WEIGHTS" => shape == "VEC4" && is_share,
            _ => component != 5125,
        }
    }

    /// True if vertex indices may have this type.
    pub fn is_valid_for_indices(self) -> bool {
        let is_unsigned = matches!(self.component, 5121 | 5123 | 5125);
        self.shape == "SCALAR" && is_unsigned && !self.normalized
    }
}

/// True if a name is an attribute of the standard, or one of an application's own.
pub fn is_attribute(name: &str) -> bool {
    let is_number = |n: &str| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit());
    match name.rsplit_once('_') {
        _ if name.starts_with('_') => true,
        Some(("TEXCOORD" | "COLOR" | "JOINTS" | "WEIGHTS", n)) => is_number(n),
        _ => matches!(name, "POSITION" | "NORMAL" | "TANGENT"),
    }
}

/// Returns the attribute that another one must not be without: TEXCOORD_0 for TEXCOORD_1, the
/// weights for joints, and the joints for weights.
pub fn prerequisite(name: &str) -> Option<String> {
    match name.rsplit_once('_')? {
        (set @ ("TEXCOORD" | "COLOR"), n) => {
            Some(format!("{set}_{}", n.parse::<u32>().ok()?.checked_sub(1)?))
        }
        ("JOINTS", n) => Some(format!("WEIGHTS_{n}")),
        ("WEIGHTS", n) => Some(format!("JOINTS_{n}")),
        _ => None,
    }
}
