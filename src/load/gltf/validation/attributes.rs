//! Attributes of vertices: their names, and what each may be made of (part 3.7.2.1).

use gltf::json::Value;

use super::whole;

/// Type, component type, and whether it is normalised.
pub fn format_of(accessor: &Value) -> Option<(&str, u64, bool)> {
    let normalized = accessor.get("normalized").and_then(Value::as_bool).unwrap_or(false);
    Some((accessor.get("type")?.as_str()?, whole(accessor, "componentType")?, normalized))
}

/// Whether an attribute may have accessors of this form, with KHR_mesh_quantization or without.
pub fn may_be(name: &str, (kind, component, normalized): (&str, u64, bool)) -> bool {
    let float = component == 5126;
    match name.rsplit_once('_').map_or(name, |(set, _)| set) {
        "POSITION" => kind == "VEC3" && component != 5125,
        "NORMAL" => kind == "VEC3" && (float || matches!(component, 5120 | 5122)),
        "TANGENT" => kind == "VEC4" && (float || matches!(component, 5120 | 5122)),
        "TEXCOORD" => kind == "VEC2" && component != 5125,
        "COLOR" => {
            matches!(kind, "VEC3" | "VEC4")
                && (float || matches!(component, 5121 | 5123) && normalized)
        }
        "JOINTS" => kind == "VEC4" && matches!(component, 5121 | 5123) && !normalized,
        "WEIGHTS" => kind == "VEC4" && (float || matches!(component, 5121 | 5123) && normalized),
        _ => component != 5125,
    }
}

/// Whether a name is one of the standard's, or one of an application's own.
pub fn is_semantic(name: &str) -> bool {
    let is_set = |n: &str| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit());
    match name.rsplit_once('_') {
        _ if name.starts_with('_') => true,
        Some(("TEXCOORD" | "COLOR" | "JOINTS" | "WEIGHTS", n)) => is_set(n),
        _ => matches!(name, "POSITION" | "NORMAL" | "TANGENT"),
    }
}
