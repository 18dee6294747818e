//! Morph targets.

use gltf::json::{self, Value};

use super::mesh::PrimitiveReader;
use crate::error::Result;
use crate::load::gltf::json::{error_at, list};
use crate::scene::animation::MorphTarget;

impl PrimitiveReader<'_> {
    /// Reads the morph targets of a primitive of `count` vertices.
    ///
    /// # Errors
    /// When an accessor cannot be read, or is not as long as the positions.
    pub(super) fn morph_targets(&mut self, count: usize) -> Result<Vec<MorphTarget>> {
        let mut targets = Vec::new();
        for (i, target) in self.primitive.targets.iter().flatten().enumerate() {
            let path = format!("{}.targets[{i}]", self.path);
            // Each attribute has an offset for every vertex, or is left out.
            let read = |index: &Option<json::Index<json::Accessor>>, name: &str| {
                let Some(index) = index else { return Ok(Vec::new()) };
                let path = format!("{path}.{name}");
                let values = self.accessors.floats::<3>(index.value(), &path)?;
                if values.len() != count {
                    let found = values.len();
                    return Err(error_at(path, format!("{found} values for {count} vertices")));
                }
                Ok(values)
            };
            let mut target = MorphTarget {
                positions: read(&target.positions, "POSITION")?,
                normals: read(&target.normals, "NORMAL")?,
            };

            // What is not finite does not move its vertex.
            let values = target.positions.iter_mut().chain(&mut target.normals).flatten();
            let bad = values.filter(|x| !x.is_finite()).map(|x| *x = 0.0).count() as u64;
            let reason = "{} numbers of morph targets are not finite and become 0";
            self.diagnostics.add(reason, bad, || path);
            targets.push(target);
        }
        Ok(targets)
    }
}

/// Returns the number of attributes of a primitive's targets that are not supported.
pub fn unsupported_attributes(root: Option<&Value>, mesh: usize, primitive: usize) -> u64 {
    let pointer = format!("/meshes/{mesh}/primitives/{primitive}");
    let primitive = root.and_then(|root| root.pointer(&pointer));
    let targets = primitive.map_or(&[][..], |primitive| list(primitive, "targets"));
    let names = targets.iter().filter_map(Value::as_object).flat_map(|target| target.keys());
    names.filter(|n| n.starts_with("TEXCOORD_") || n.starts_with("COLOR_")).count() as u64
}
