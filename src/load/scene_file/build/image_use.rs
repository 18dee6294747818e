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
        let spheres = tables.sphere.iter().map(|sphere| &sphere.material);
        let planes = tables.plane.iter().map(|plane| &plane.material);
        let models = tables.model.iter().map(|model| &model.material);
        let names = spheres.chain(planes).chain(models).flatten();
        let materials = names.map(|name| name.value.clone()).collect();
        let own = tables.model.iter().filter(|model| model.material.is_none());
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
