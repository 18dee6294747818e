//! The check that accessors fit in their views, and views in their buffers.

use gltf::json::Value;

use super::{IssueKind, Issues, integer, list, referenced};

/// Checks every accessor, view and buffer; `bin` is the length of a GLB's binary chunk.
pub fn check(root: &Value, bin: Option<usize>, issues: &mut Issues) {
    // The first buffer, if it is the binary chunk.
    if let Some(buffer) = list(root, "buffers").first()
        && buffer.get("uri").is_none()
        && let (Some(declared), Some(found)) = (integer(buffer, "byteLength"), bin)
    {
        let message = format_args!("{declared}, and the GLB's chunk has {found} bytes");
        let is_valid = declared <= found as u64;
        issues.check(IssueKind::LAYOUT, is_valid, "buffers[0].byteLength", message);
    }
    for (i, view) in list(root, "bufferViews").iter().enumerate() {
        check_view(root, view, format_args!("bufferViews[{i}]"), issues);
    }
    for (i, accessor) in list(root, "accessors").iter().enumerate() {
        let path = format!("accessors[{i}]");
        let Some(element) = Element::from_accessor(accessor) else { continue };
        let count = integer(accessor, "count").unwrap_or(0);
        check_elements(root, accessor, &path, count, element, issues);
        check_numbers(accessor, &path, element, issues);

        // The elements that a sparse accessor replaces.
        let Some(sparse) = accessor.get("sparse") else { continue };
        let path = format!("{path}.sparse");
        let replaced = integer(sparse, "count").unwrap_or(0);
        let message = format_args!("{replaced} of {count}");
        let count_path = format_args!("{path}.count");
        issues.check(IssueKind::LAYOUT, replaced <= count, count_path, message);
        if let Some(indices) = sparse.get("indices")
            && let Some(size) = component_size(indices)
        {
            let index = Element { size, count: 1 };
            check_elements(root, indices, &format!("{path}.indices"), replaced, index, issues);
        }
        if let Some(values) = sparse.get("values") {
            check_elements(root, values, &format!("{path}.values"), replaced, element, issues);
        }
    }
}

/// An element of an accessor.
#[derive(Clone, Copy)]
struct Element {
    /// The size of a component in bytes.
    size: u64,
    /// The number of components.
    count: u64,
}

impl Element {
    fn from_accessor(accessor: &Value) -> Option<Self> {
        let size = component_size(accessor)?;
        let count = match accessor.get("type")?.as_str()? {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" | "MAT2" => 4,
            "MAT3" => 9,
            "MAT4" => 16,
            _ => return None,
        };
        Some(Self { size, count })
    }

    /// The size in bytes. The columns of matrices begin at multiples of four (part 3.6.2.4).
    fn bytes(self) -> u64 {
        match (self.count, self.size) {
            (9, 1) => 11,
            (9, 2) => 22,
            (count, size) => count * size,
        }
    }
}

fn component_size(object: &Value) -> Option<u64> {
    match integer(object, "componentType")? {
        5120 | 5121 => Some(1),
        5122 | 5123 => Some(2),
        5125 | 5126 => Some(4),
        _ => None,
    }
}

/// Checks that a view fits in its buffer, and its stride in the view.
fn check_view(root: &Value, view: &Value, path: std::fmt::Arguments, issues: &mut Issues) {
    let length = integer(view, "byteLength");
    let buffer = referenced(root, view, "buffer", "buffers").and_then(|b| integer(b, "byteLength"));
    if let (Some(length), Some(buffer)) = (length, buffer) {
        let end = length.saturating_add(integer(view, "byteOffset").unwrap_or(0));
        let message = format_args!("up to byte {end}, and its buffer has {buffer}");
        issues.check(IssueKind::LAYOUT, end <= buffer, path, message);
    }
    if let Some(stride) = integer(view, "byteStride") {
        let is_valid =
            stride % 4 == 0 && stride <= 252 && length.is_none_or(|length| stride <= length);
        issues.check(IssueKind::LAYOUT, is_valid, format_args!("{path}.byteStride"), stride);
    }
}

/// Checks that elements fit in their view, and are aligned to the size of their components.
fn check_elements(
    root: &Value,
    object: &Value,
    path: &str,
    count: u64,
    element: Element,
    issues: &mut Issues,
) {
    let offset = integer(object, "byteOffset").unwrap_or(0);
    let Some(view) = referenced(root, object, "bufferView", "bufferViews") else { return };
    let Some(length) = integer(view, "byteLength") else { return };
    let size = element.bytes();
    let stride = integer(view, "byteStride").unwrap_or(size);
    let last = count.saturating_sub(1).saturating_mul(stride);
    let end = last.saturating_add(size).saturating_add(offset);
    let message = format_args!("{count} elements up to byte {end}, and its view has {length}");
    issues.check(IssueKind::LAYOUT, end <= length, path, message);
    let message = format_args!("{size} bytes, every {stride} bytes");
    issues.check(IssueKind::LAYOUT, stride >= size, path, message);
    let start = offset.saturating_add(integer(view, "byteOffset").unwrap_or(0));
    let is_aligned = start.is_multiple_of(element.size) && offset.is_multiple_of(element.size);
    let message = format_args!("{} bytes each, from byte {start} on", element.size);
    issues.check(IssueKind::LAYOUT, is_aligned, format_args!("{path}.byteOffset"), message);
}

/// Checks the properties of an accessor that describe its numbers.
fn check_numbers(accessor: &Value, path: &str, element: Element, issues: &mut Issues) {
    let is_normalized = accessor.get("normalized").and_then(Value::as_bool) == Some(true);
    let is_valid = !is_normalized || element.size != 4;
    let message = "of floats or 32-bit integers";
    issues.check(IssueKind::RULE, is_valid, format_args!("{path}.normalized"), message);
    let is_valid = accessor.get("bufferView").is_some() || accessor.get("byteOffset").is_none();
    let message = "without a bufferView";
    issues.check(IssueKind::RULE, is_valid, format_args!("{path}.byteOffset"), message);
    for bound in ["min", "max"] {
        let Some(found) = accessor.get(bound).and_then(Value::as_array) else { continue };
        let (found, count) = (found.len() as u64, element.count);
        let message = format_args!("{found} numbers for {count}");
        issues.check(IssueKind::TYPE, found == count, format_args!("{path}.{bound}"), message);
    }
}
