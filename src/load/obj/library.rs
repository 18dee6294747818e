//! MTL files: the materials of an OBJ file.
//!
//! Whatever is wrong with them is a warning: the shape can still be shown.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::files::find;
use super::lines::decode;
use super::material::Maker;
use super::mtl::{UNNAMED, clean};
use super::textures::Textures;
use crate::load::tally::Tally;
use crate::scene::{Material, MaterialId, Scene};

/// The materials that an OBJ file can name, each made when a face first uses it.
#[derive(Default)]
pub struct Library {
    sources: HashMap<String, (tobj::Material, PathBuf)>,
    made: HashMap<String, MaterialId>,
    textures: Textures,
}

impl Library {
    /// Reads the files that the `mtllib` lines of the OBJ file at `path` name, beside it. Where one
    /// is not there, or none is named, that of the OBJ file's own name is read, if there is one.
    pub fn read(names: &[String], path: &Path, tally: &mut Tally) -> Self {
        let mut library = Self::default();
        let folder = path.parent().unwrap_or(Path::new(""));
        let own = find(
            folder,
            &path.with_extension("mtl").file_name().unwrap_or_default().to_string_lossy(),
        );
        let mut files = Vec::new();
        for name in names {
            // A name may hold spaces, and a line several names.
            let whole = find(folder, name);
            match whole.is_file() {
                true => files.push(whole),
                false => files.extend(names_of_line(name).into_iter().map(|n| find(folder, &n))),
            }
        }
        if names.is_empty() && own.is_file() {
            files.push(own.clone());
        }
        let mut done = Vec::new();
        for file in files {
            let read = if file.exists() || !own.is_file() { &file } else { &own };
            if *read != file {
                let [file, own] = [&file, &own].map(|path| path.display());
                tally.say(format!("{file} is missing; the materials are those of {own}"));
            }
            if !done.contains(read) {
                library.add(read, tally);
                done.push(read.clone());
            }
        }
        library
    }

    fn add(&mut self, path: &Path, tally: &mut Tally) {
        let bytes = match crate::load::read(path) {
            Ok(bytes) => bytes,
            Err(error) => {
                tally.say(format!("the materials are missing and drawn grey: {error}"));
                return;
            }
        };
        let materials = decode(&bytes).and_then(|text| {
            let clean = clean(&text, path, tally);
            tobj::load_mtl_buf(&mut clean.as_bytes()).map_err(|e| {
                crate::error::Error::input(format!("the materials cannot be read: {e}"))
            })
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
    pub fn get(&mut self, name: &str, scene: &mut Scene, tally: &mut Tally) -> MaterialId {
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
                    tally.add(reason, 1, || format!("`{name}`"));
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
    pub fn decode(self, wanted: bool, scene: &mut Scene, tally: &mut Tally) {
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
