//! KHR_materials_variants: which material a primitive has in the variant that is shown.

use std::collections::BTreeSet;

use gltf::json;
use gltf::json::Value;
use gltf::json::mesh::Primitive;

const EXTENSION: &str = "KHR_materials_variants";

/// The variants of a file, and which one is shown.
pub struct Variants<'a> {
    names: Vec<&'a str>,
    /// The number of the one that is shown; none for the default materials.
    shown: Option<u64>,
}

impl<'a> Variants<'a> {
    /// Those of a file, of which the one with this name is shown, the first of several.
    pub fn read(root: &'a json::Root, name: Option<&str>) -> Self {
        let extension = root.extensions.as_ref().and_then(|e| e.others.get(EXTENSION));
        let all = list(extension, "variants");
        let named = || (0..).zip(all).filter_map(|(i, v)| Some((i, v.get("name")?.as_str()?)));
        let shown = named().find(|(_, found)| Some(*found) == name).map(|(i, _)| i);
        Self { names: named().map(|(_, name)| name).collect(), shown }
    }

    /// The material of a primitive, if it has one, and where the file says so. `at` is the place
    /// of the primitive; one that says nothing of the variant keeps its default.
    pub fn material(&self, primitive: &Primitive, at: &str) -> (Option<usize>, String) {
        let default = primitive.material.map(|m| m.value());
        let default = || (default, format!("{at}.material"));
        let Some(shown) = self.shown else { return default() };
        let extension = primitive.extensions.as_ref().and_then(|e| e.others.get(EXTENSION));
        let is_of = |mapping: &Value| {
            list(Some(mapping), "variants").iter().any(|v| v == &Value::from(shown))
        };
        let mut mappings = list(extension, "mappings").iter().enumerate();
        let Some((i, mapping)) = mappings.find(|(_, mapping)| is_of(mapping)) else {
            return default();
        };
        let place = format!("{at}.extensions.{EXTENSION}.mappings[{i}].material");
        // What is no index is one that no file has.
        let material = mapping.get("material").and_then(Value::as_u64);
        (Some(material.and_then(|m| usize::try_from(m).ok()).unwrap_or(usize::MAX)), place)
    }

    /// Their names.
    pub fn names(&self) -> BTreeSet<String> {
        self.names.iter().map(|name| (*name).to_owned()).collect()
    }
}

/// A list in an object, or an empty one.
fn list<'v>(object: Option<&'v Value>, key: &str) -> &'v [Value] {
    object.and_then(|o| o.get(key)).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}
