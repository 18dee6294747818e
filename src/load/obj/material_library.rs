//! The materials of an OBJ file, from its MTL files.
//!
//! Errors in them are warnings: the shape can still be shown.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::file_lookup::{open_file, unquote};
use super::illumination::Illumination;
use super::lexer::decode_text;
use super::material::MaterialBuilder;
use super::mtl::{UNNAMED, normalize};
use super::textures::Textures;
use crate::error::Error;
use crate::load::diagnostics::Diagnostics;
use crate::load::sandbox::{OpenedFile, Sandbox};
use crate::scene::{Material, MaterialId, Scene, ShadingModel};

/// The materials that an OBJ file can name, each built when a face first uses it.
pub struct MaterialLibrary<'a> {
    sandbox: &'a Sandbox,
    /// The shading model of the materials; none for the one that their statements ask for.
    shading: Option<ShadingModel>,
    /// The materials of the MTL files by name, each with the folder of its file.
    sources: HashMap<String, (tobj::Material, PathBuf)>,
    /// The materials that were added to the scene.
    built: HashMap<String, MaterialId>,
    textures: Textures<'a>,
    /// The canonical paths of the files that were read.
    files: HashSet<PathBuf>,
}

impl<'a> MaterialLibrary<'a> {
    /// Returns a library without materials, of which all will have this shading model, if one is given.
    pub fn new(sandbox: &'a Sandbox, shading: Option<ShadingModel>) -> Self {
        Self {
            sandbox,
            shading,
            sources: HashMap::new(),
            built: HashMap::new(),
            textures: Textures::new(sandbox),
            files: HashSet::new(),
        }
    }

    /// Reads the files that the `mtllib` lines of the OBJ file at `path` name, beside it. In place of
    /// a file that is missing, or where none is named, that of the OBJ file's own name is read.
    pub fn read(&mut self, names: &[String], path: &Path, diagnostics: &mut Diagnostics) {
        let sandbox = self.sandbox;
        let folder = path.parent().unwrap_or(Path::new(""));
        let own = path.with_extension("mtl");
        let own =
            || open_file(sandbox, folder, &own.file_name().unwrap_or_default().to_string_lossy());
        // The files that the lines name.
        for name in names {
            // A name may stand in quotes or hold spaces, and a line have several names.
            let name = unquote(name);
            if let Ok(file) = open_file(sandbox, folder, name) {
                self.add_file(file, diagnostics);
                continue;
            }
            for name in split_names(name) {
                match (open_file(sandbox, folder, &name), own()) {
                    (Ok(file), _) => self.add_file(file, diagnostics),
                    (Err(error), Ok(own)) => {
                        diagnostics.note(format!(
                            "the materials `{name}` are missing ({error}); those of {} take their \
                             place",
                            own.path.display()
                        ));
                        self.add_file(own, diagnostics);
                    }
                    (Err(error), Err(_)) => diagnostics.placeholder(format!(
                        "the materials `{name}` are missing and drawn grey: {error}"
                    )),
                }
            }
        }
        // The file of the OBJ file's own name.
        if names.is_empty()
            && let Ok(own) = own()
        {
            self.add_file(own, diagnostics);
        }
    }

    /// Adds the materials of a file, unless it was read before.
    fn add_file(&mut self, file: OpenedFile, diagnostics: &mut Diagnostics) {
        if !self.files.insert(file.identity.clone()) {
            return;
        }
        let path = &file.path.clone();
        let bytes = match file.read(self.sandbox) {
            Ok(bytes) => bytes,
            Err(error) => {
                diagnostics
                    .placeholder(format!("the materials are missing and drawn grey: {error}"));
                return;
            }
        };
        let materials = decode_text(&bytes).and_then(|text| {
            let normalized = normalize(&text, path, diagnostics);
            tobj::load_mtl_buf(&mut normalized.as_bytes())
                .map_err(|e| Error::input(format!("the materials cannot be read: {e}")))
        });
        let folder = path.parent().unwrap_or(Path::new(""));
        match materials {
            Ok((materials, _)) => {
                let named = materials.into_iter().map(|m| {
                    let name = if m.name == UNNAMED { String::new() } else { m.name.clone() };
                    (name, (m, folder.to_owned()))
                });
                self.sources.extend(named);
            }
            Err(error) => diagnostics.note(error.at(path).to_string()),
        }
    }

    /// Makes the materials of these names opaque if every one of them has `d 0`: nothing at all would be
    /// seen, where other programs show the model.
    pub fn show_what_is_all_clear<'n>(
        &mut self,
        names: impl Iterator<Item = &'n str> + Clone,
        diagnostics: &mut Diagnostics,
    ) {
        let is_clear = |name| {
            self.sources.get(name).is_some_and(|(source, _)| {
                source.dissolve == Some(0.0)
                    && source.dissolve_texture.is_none()
                    && Illumination::read(source).is_invisible()
            })
        };
        if names.clone().next().is_none() || !names.clone().all(is_clear) {
            return;
        }
        for name in names {
            self.sources.entry(name.to_owned()).and_modify(|(source, _)| source.dissolve = None);
        }
        diagnostics.note(
            "all materials have an opacity of 0 (`d 0`), by which nothing could be seen: they are drawn \
             opaque, as other programs draw them",
        );
    }

    /// Returns the material of a name, which is added to the scene if it is new; a neutral grey if there
    /// is no material of this name.
    pub fn material(
        &mut self,
        name: &str,
        scene: &mut Scene,
        diagnostics: &mut Diagnostics,
    ) -> MaterialId {
        if let Some(&id) = self.built.get(name) {
            return id;
        }
        let material = match self.sources.remove(name) {
            Some((source, folder)) => {
                let textures = &mut self.textures;
                let shading = self.shading;
                let (source, folder) = (&source, &*folder);
                MaterialBuilder { source, folder, shading, textures, scene, diagnostics }.build()
            }
            None => {
                if !name.is_empty() {
                    let reason = "{} materials are in no MTL file and drawn grey";
                    diagnostics.placeholders(reason, 1, || format!("`{name}`"));
                }
                Material { name: name.to_owned(), ..Material::default() }
            }
        };
        let id = scene.add_material(material);
        self.built.insert(name.to_owned(), id);
        id
    }

    /// Decodes the images of the materials' textures, if the scene `needs_images`; otherwise they are only
    /// named.
    pub fn decode_images(
        self,
        needs_images: bool,
        scene: &mut Scene,
        diagnostics: &mut Diagnostics,
    ) {
        self.textures.decode(needs_images, scene, diagnostics);
    }
}

/// Splits the names on a `mtllib` line: each ends in `.mtl`, or else at a space that no `\\` escapes.
fn split_names(line: &str) -> Vec<String> {
    let line = line.replace("\\ ", "\0");
    let mut names = Vec::new();
    let mut name = String::new();
    for word in line.split_whitespace() {
        if !name.is_empty() {
            name.push(' ');
        }
        name.push_str(word);
        if word.to_ascii_lowercase().ends_with(".mtl") {
            names.push(std::mem::take(&mut name));
        }
    }
    names.extend(name.split(' ').filter(|n| !n.is_empty()).map(str::to_owned));
    names.into_iter().map(|n| n.replace('\0', " ")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn library_names_with_spaces() {
        assert_eq!(split_names("a b.mtl c.MTL"), ["a b.mtl", "c.MTL"]);
        assert_eq!(split_names("x.mat y.mat"), ["x.mat", "y.mat"]);
        assert_eq!(split_names("a\\ b.mat c.mtl"), ["a b.mat c.mtl"]);
    }
}
