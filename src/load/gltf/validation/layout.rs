//! Whether accessors fit in their views, and views in their buffers.

use gltf::json::Value;

use super::{Fault, Faults, follow, list, whole};

/// Looks at every accessor, view and buffer.
pub fn check(root: &Value, bin: Option<usize>, faults: &mut Faults) {
    if let Some(buffer) = list(root, "buffers").first()
        && buffer.get("uri").is_none()
        && let (Some(declared), Some(found)) = (whole(buffer, "byteLength"), bin)
        && declared > found as u64
    {
        faults.add(Fault::Layout, || {
            (
                "buffers[0].byteLength".to_owned(),
                format!("{declared}, and the GLB's chunk has {found} bytes"),
            )
        });
    }
    for (i, view) in list(root, "bufferViews").iter().enumerate() {
        let length = whole(view, "byteLength");
        let buffer = follow(root, view, "buffer", "buffers").and_then(|b| whole(b, "byteLength"));
        let end = length.zip(Some(whole(view, "byteOffset").unwrap_or(0)));
        let end = end.map(|(length, offset)| length.saturating_add(offset));
        if let (Some(end), Some(buffer)) = (end, buffer)
            && end > buffer
        {
            faults.add(Fault::Layout, || {
                (
                    format!("bufferViews[{i}]"),
                    format!("up to byte {end}, and its buffer has {buffer}"),
                )
            });
        }
        let Some(stride) = whole(view, "byteStride") else { continue };
        if stride % 4 != 0 || stride > 252 || length.is_some_and(|length| stride > length) {
            let place = || (format!("bufferViews[{i}].byteStride"), format!("{stride}"));
            faults.add(Fault::Layout, place);
        }
    }
    for (i, accessor) in list(root, "accessors").iter().enumerate() {
        let at = format!("accessors[{i}]");
        let Some(element) = Element::of(accessor) else { continue };
        let count = whole(accessor, "count").unwrap_or(0);
        rows(root, accessor, &at, count, element, faults);
        numbers(accessor, &at, element, faults);
        let Some(sparse) = accessor.get("sparse") else { continue };
        let replaced = whole(sparse, "count").unwrap_or(0);
        if replaced > count {
            faults.add(Fault::Layout, || {
                (format!("{at}.sparse.count"), format!("{replaced} of {count}"))
            });
        }
        let (indices, values) = (sparse.get("indices"), sparse.get("values"));
        let index = indices.and_then(component).map(|size| Element { size, count: 1 });
        for (part, element, name) in
            [(indices, index, "indices"), (values, Some(element), "values")]
        {
            if let (Some(part), Some(element)) = (part, element) {
                rows(root, part, &format!("{at}.sparse.{name}"), replaced, element, faults);
            }
        }
    }
}

/// So many numbers of so many bytes.
#[derive(Clone, Copy)]
struct Element {
    size: u64,
    count: u64,
}

impl Element {
    fn of(accessor: &Value) -> Option<Self> {
        let size = component(accessor)?;
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

    /// Its bytes: the columns of matrices begin at multiples of four, part 3.6.2.4 says.
    fn bytes(self) -> u64 {
        match (self.count, self.size) {
            (9, 1) => 11,
            (9, 2) => 22,
            (count, size) => count * size,
        }
    }
}

fn component(object: &Value) -> Option<u64> {
    match whole(object, "componentType")? {
        5120 | 5121 => Some(1),
        5122 | 5123 => Some(2),
        5125 | 5126 => Some(4),
        _ => None,
    }
}

/// Whether elements fit in their view, and begin where numbers of their size may.
fn rows(root: &Value, of: &Value, at: &str, count: u64, element: Element, faults: &mut Faults) {
    let offset = whole(of, "byteOffset").unwrap_or(0);
    let Some(view) = follow(root, of, "bufferView", "bufferViews") else { return };
    let Some(length) = whole(view, "byteLength") else { return };
    let stride = whole(view, "byteStride").unwrap_or(element.bytes());
    let before_last = count.saturating_sub(1).saturating_mul(stride);
    let end = before_last.saturating_add(element.bytes()).saturating_add(offset);
    if end > length {
        faults.add(Fault::Layout, || {
            (at.to_owned(), format!("{count} elements up to byte {end}, and its view has {length}"))
        });
    }
    if stride < element.bytes() {
        let size = element.bytes();
        faults
            .add(Fault::Layout, || (at.to_owned(), format!("{size} bytes, every {stride} bytes")));
    }
    let place = offset.saturating_add(whole(view, "byteOffset").unwrap_or(0));
    if !place.is_multiple_of(element.size) || !offset.is_multiple_of(element.size) {
        faults.add(Fault::Layout, || {
            (
                format!("{at}.byteOffset"),
                format!("{} bytes each, from byte {place} on", element.size),
            )
        });
    }
}

/// What an accessor says of its numbers.
fn numbers(accessor: &Value, at: &str, element: Element, faults: &mut Faults) {
    let is_normalized = accessor.get("normalized").and_then(Value::as_bool) == Some(true);
    if is_normalized && element.size == 4 {
        faults.add(Fault::Rule, || {
            (format!("{at}.normalized"), "of floats or 32-bit integers".to_owned())
        });
    }
    if accessor.get("bufferView").is_none() && accessor.get("byteOffset").is_some() {
        faults.rule(false, || format!("{at}.byteOffset"), "without a bufferView");
    }
    for bound in ["min", "max"] {
        let Some(found) = accessor.get(bound).and_then(Value::as_array) else { continue };
        if found.len() as u64 != element.count {
            faults.add(Fault::Type, || {
                let what = format!("{} numbers for {}", found.len(), element.count);
                (format!("{at}.{bound}"), what)
            });
        }
    }
}
