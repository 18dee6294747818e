//! MTL files: the materials of an OBJ file.
//!
//! Whatever is wrong with them is a warning: the shape can still be shown.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::files::{find, unquoted};
use super::lines::decode;
use super::material::Maker;
use super::mtl::{UNNAMED, clean};
use super::textures::Textures;
use crate::error::Error;
use crate::load::diagnostics::Diagnostics;
use crate::load::sandbox::{OpenedFile, Sandbox};
use crate::scene::{Material, MaterialId, Scene};

/// The materials that an OBJ file can name, each made when a face first uses it.
pub struct Library<'a> {
    guard: &'a Sandbox,
    sources: HashMap<String, (tobj::Material, PathBuf)>,
    made: HashMap<String, MaterialId>,
    textures: Textures<'a>,
    /// The files that were read.
    files: HashSet<PathBuf>,
}

impl<'a> Library<'a> {
    /// Reads the files that the `mtllib` lines of the OBJ file at `path` name, beside it. In place
    /// of one that is missing, or where none is named, that of the OBJ file's own name is read.
    pub fn read(
        names: &[String],
        path: &Path,
        guard: &'a Sandbox,
        tally: &mut Diagnostics,
    ) -> Self {
        let textures = Textures::new(guard);
        let (sources, made, files) = Default::default();
        let mut library = Self { guard, sources, made, textures, files };
        let folder = path.parent().unwrap_or(Path::new(""));
        let own = path.with_extension("mtl");
        let own = || find(guard, folder, &own.file_name().unwrap_or_default().to_string_lossy());
        for name in names {
            // A name may stand in quotes or hold spaces, and a line have several names.
            let name = unquoted(name);
            if let Ok(file) = find(guard, folder, name) {
                library.add(file, tally);
                continue;
            }
            for name in names_of_line(name) {
                match (find(guard, folder, &name), own()) {
                    (Ok(file), _) => library.add(file, tally),
                    (Err(error), Ok(own)) => {
                        tally.say(format!(
                            "the materials `{name}` are missing ({error}); those of {} take their \
                             place",
                            own.path.display()
                        ));
                        library.add(own, tally);
                    }
                    (Err(error), Err(_)) => tally.placeholder(format!(
                        "the materials `{name}` are missing and drawn grey: {error}"
                    )),
                }
            }
        }
        if let (true, Ok(own)) = (names.is_empty(), own()) {
            library.add(own, tally);
        }
        library
    }

    fn add(&mut self, file: OpenedFile, tally: &mut Diagnostics) {
        if !self.files.insert(file.identity.clone()) {
            return;
        }
        let path = &file.path.clone();
        let bytes = match file.read(self.guard) {
            Ok(bytes) => bytes,
            Err(error) => {
                tally.placeholder(format!("the materials are missing and drawn grey: {error}"));
                return;
            }
        };
        let materials = decode(&bytes).and_then(|text| {
            let clean = clean(&text, path, tally);
            tobj::load_mtl_buf(&mut clean.as_bytes())
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
            Err(error) => tally.say(error.at(path).to_string()),
        }
    }

    /// The material of a name, made if it is new; a neutral grey if there is none of the name.
    pub fn get(&mut self, name: &str, scene: &mut Scene, tally: &mut Diagnostics) -> MaterialId {
        if let Some(&id) = self.made.get(name) {
            return id;
        }
        let material = match self.sources.remove(name) {
            Some((source, folder)) => {
                let textures = &mut self.textures;
                Maker { source: &source, folder: &folder, textures, scene, tally }.make()
            }
            None => {
                if !name.is_empty() {
                    let reason = "{} materials are in no MTL file and drawn grey";
                    tally.placeholders(reason, 1, || format!("`{name}`"));
                }
                Material { name: name.to_owned(), ..Material::default() }
            }
        };
        let id = scene.add_material(material);
        self.made.insert(name.to_owned(), id);
        id
    }

    /// Decodes the pictures that the materials show, if they are `wanted`; otherwise they are only
    /// named.
    pub fn decode(self, wanted: bool, scene: &mut Scene, tally: &mut Diagnostics) {
        self.textures.decode(wanted, scene, tally);
    }
}

/// The names on a `mtllib` line: each ends in `.mtl`, or else at a space that no `\\` escapes.
fn names_of_line(line: &str) -> Vec<String> {
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
        assert_eq!(names_of_line("a b.mtl c.MTL"), ["a b.mtl", "c.MTL"]);
        assert_eq!(names_of_line("x.mat y.mat"), ["x.mat", "y.mat"]);
        assert_eq!(names_of_line("a\\ b.mat c.mtl"), ["a b.mat c.mtl"]);
    }
}
