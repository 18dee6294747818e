//! Which pictures of a scene something shows: the others are named and not read.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::source::Source;
use super::tables::SceneTable;

/// What shows pictures.
pub struct Shown {
    /// The materials of the file that something is made of.
    materials: HashSet<String>,
    /// The models that stand somewhere in their own materials, by their canonical paths.
    models: HashSet<PathBuf>,
}

impl Shown {
    /// What the tables of a scene file show.
    pub fn of(source: &Source<'_>, tables: &SceneTable) -> Self {
        let spheres = tables.sphere.0.iter().map(|s| &s.value.0.material);
        let planes = tables.plane.0.iter().map(|p| &p.value.0.material);
        let models = || tables.model.0.iter().map(|m| &m.value.0);
        let named = spheres.chain(planes).chain(models().map(|m| &m.material)).flatten();
        let materials = named.map(|name| name.value.clone()).collect();
        let own = models().filter(|model| model.material.is_none());
        let models = own.map(|model| canonical(&source.file(&model.file.value))).collect();
        Self { materials, models }
    }

    /// Whether anything shows the pictures of a material of the file.
    pub fn material(&self, name: &str) -> bool {
        self.materials.contains(name)
    }

    /// Whether anything shows the pictures of a model.
    pub fn model(&self, path: &Path) -> bool {
        self.models.contains(&canonical(path))
    }
}

fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}
