//! The images of a scene file that something shows: the others are named and not read.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use crate::load::scene_file::schema::tables::SceneTable;
use crate::load::scene_file::source::Source;

/// The materials and models in use, whose images are read.
pub struct ImageUse {
    /// The names of the file's materials that an object has.
    materials: HashSet<String>,
    /// The canonical paths of the models that are shown in their own materials.
    models: HashSet<PathBuf>,
}

impl ImageUse {
    /// Collects what the tables of a scene file use.
    pub fn from_tables(source: &Source<'_>, tables: &SceneTable) -> Self {
        let spheres = tables.sphere.0.iter().map(|s| &s.value.0.material);
        let planes = tables.plane.0.iter().map(|p| &p.value.0.material);
        let models = || tables.model.0.iter().map(|m| &m.value.0);
        let names = spheres.chain(planes).chain(models().map(|m| &m.material)).flatten();
        let materials = names.map(|name| name.value.clone()).collect();
        let own = models().filter(|model| model.material.is_none());
        let models = own.map(|model| canonical(&source.resolve_path(&model.file.value))).collect();
        Self { materials, models }
    }

    /// True if an object has this material of the file.
    pub fn uses_material(&self, name: &str) -> bool {
        self.materials.contains(name)
    }

    /// True if the model is shown in its own materials.
    pub fn uses_materials_of_model(&self, path: &Path) -> bool {
        self.models.contains(&canonical(path))
    }
}

fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}
