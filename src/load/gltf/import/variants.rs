//! KHR_materials_variants: the materials of primitives in the variant that is shown.

use std::collections::BTreeSet;

use gltf::json::{self, Value, mesh::Primitive};

use crate::load::gltf::json::{as_index, list};

const EXTENSION: &str = "KHR_materials_variants";

/// The variants of a file, and the one that is shown.
pub struct Variants<'a> {
    names: Vec<&'a str>,
    /// The index of the variant that is shown; `None` for the default materials.
    shown: Option<u64>,
}

impl<'a> Variants<'a> {
    /// Reads the variants of a file, of which the first with this name is shown.
    pub fn read(root: &'a json::Root, name: Option<&str>) -> Self {
        let extension = root.extensions.as_ref().and_then(|e| e.others.get(EXTENSION));
        let all = extension.map_or(&[][..], |extension| list(extension, "variants"));
        let named = || (0..).zip(all).filter_map(|(i, v)| Some((i, v.get("name")?.as_str()?)));
        let shown = named().find(|(_, found)| Some(*found) == name).map(|(i, _)| i);
        Self { names: named().map(|(_, name)| name).collect(), shown }
    }

    /// Returns the index of the material of a primitive, whose JSON path is `path`, if it has one;
    /// and the path of the reference to it. A primitive that does not mention the variant keeps its
    /// default.
    pub fn material(&self, primitive: &Primitive, path: &str) -> (Option<usize>, String) {
        let of_variant = || {
            let shown = Value::from(self.shown?);
            let extension = primitive.extensions.as_ref()?.others.get(EXTENSION)?;
            let mut mappings = list(extension, "mappings").iter().enumerate();
            let (i, mapping) = mappings.find(|(_, m)| list(m, "variants").contains(&shown))?;
            // A value that is no index becomes one that no file has.
            let index = mapping.get("material").and_then(as_index).unwrap_or(usize::MAX);
            Some((Some(index), format!("{path}.extensions.{EXTENSION}.mappings[{i}].material")))
        };
        let default = || (primitive.material.map(|m| m.value()), format!("{path}.material"));
        of_variant().unwrap_or_else(default)
    }

    /// The names of the variants.
    pub fn names(&self) -> BTreeSet<String> {
        self.names.iter().map(|name| (*name).to_owned()).collect()
    }
}
