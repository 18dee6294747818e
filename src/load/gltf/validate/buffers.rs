//! The check that accessors fit in their views, and views in their buffers.

use gltf::json::Value;

use super::{LAYOUT, RULE, TYPE, Validator, integer, list, referenced};

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

impl Validator<'_> {
    /// Checks every accessor, view and buffer; `bin` is the length of a GLB's binary chunk.
    pub(super) fn check_buffers(&mut self, bin: Option<usize>) {
        // The first buffer, if it is the binary chunk.
        if let Some(buffer) = list(self.root, "buffers").first()
            && buffer.get("uri").is_none()
            && let (Some(declared), Some(found)) = (integer(buffer, "byteLength"), bin)
        {
            let message = format_args!("{declared}, and the GLB's chunk has {found} bytes");
            self.check(LAYOUT, declared <= found as u64, "buffers[0].byteLength", message);
        }
        self.each("bufferViews", Self::check_view);
        self.each("accessors", Self::check_accessor);
    }

    /// Checks that a view fits in its buffer, and its stride in the view.
    fn check_view(&mut self, view: &Value, path: &str) {
        let length = integer(view, "byteLength");
        let buffer = referenced(self.root, view, "buffer", "buffers");
        if let (Some(length), Some(buffer)) =
            (length, buffer.and_then(|b| integer(b, "byteLength")))
        {
            let end = length.saturating_add(integer(view, "byteOffset").unwrap_or(0));
            let message = format_args!("up to byte {end}, and its buffer has {buffer}");
            self.check(LAYOUT, end <= buffer, path, message);
        }
        if let Some(stride) = integer(view, "byteStride") {
            let fits = length.is_none_or(|length| stride <= length);
            let is_valid = stride % 4 == 0 && stride <= 252 && fits;
            self.check(LAYOUT, is_valid, format_args!("{path}.byteStride"), stride);
        }
    }

    fn check_accessor(&mut self, accessor: &Value, path: &str) {
        let Some(element) = Element::from_accessor(accessor) else { return };
        let count = integer(accessor, "count").unwrap_or(0);
        self.check_elements(accessor, path, count, element);

        // The properties that describe its numbers.
        let is_normalized = accessor.get("normalized").and_then(Value::as_bool) == Some(true);
        let can_normalize = !is_normalized || element.size != 4;
        let message = "of floats or 32-bit integers";
        self.check(RULE, can_normalize, format_args!("{path}.normalized"), message);
        let has_place =
            accessor.get("bufferView").is_some() || accessor.get("byteOffset").is_none();
        self.check(RULE, has_place, format_args!("{path}.byteOffset"), "without a bufferView");
        for bound in ["min", "max"] {
            let Some(found) = accessor.get(bound).and_then(Value::as_array) else { continue };
            let (found, count) = (found.len() as u64, element.count);
            let message = format_args!("{found} numbers for {count}");
            self.check(TYPE, found == count, format_args!("{path}.{bound}"), message);
        }

        // The elements that a sparse accessor replaces.
        let Some(sparse) = accessor.get("sparse") else { return };
        let path = format!("{path}.sparse");
        let replaced = integer(sparse, "count").unwrap_or(0);
        let message = format_args!("{replaced} of {count}");
        self.check(LAYOUT, replaced <= count, format_args!("{path}.count"), message);
        if let Some(indices) = sparse.get("indices")
            && let Some(size) = component_size(indices)
        {
            let index = Element { size, count: 1 };
            self.check_elements(indices, &format!("{path}.indices"), replaced, index);
        }
        if let Some(values) = sparse.get("values") {
            self.check_elements(values, &format!("{path}.values"), replaced, element);
        }
    }

    /// Checks that elements fit in their view, and are aligned to the size of their components.
    fn check_elements(&mut self, object: &Value, path: &str, count: u64, element: Element) {
        let offset = integer(object, "byteOffset").unwrap_or(0);
        let Some(view) = referenced(self.root, object, "bufferView", "bufferViews") else { return };
        let Some(length) = integer(view, "byteLength") else { return };
        let size = element.bytes();
        // Without a stride, elements follow one another.
        let stride = integer(view, "byteStride").unwrap_or(size);

        // The last element takes no more than its own bytes.
        let last = count.saturating_sub(1).saturating_mul(stride);
        let end = last.saturating_add(size).saturating_add(offset);
        let message = format_args!("{count} elements up to byte {end}, and its view has {length}");
        self.check(LAYOUT, end <= length, path, message);
        let message = format_args!("{size} bytes, every {stride} bytes");
        self.check(LAYOUT, stride >= size, path, message);

        // The offset is aligned within the view, and also within the buffer.
        let start = offset.saturating_add(integer(view, "byteOffset").unwrap_or(0));
        let is_aligned = start.is_multiple_of(element.size) && offset.is_multiple_of(element.size);
        let message = format_args!("{} bytes each, from byte {start} on", element.size);
        self.check(LAYOUT, is_aligned, format_args!("{path}.byteOffset"), message);
    }
}
