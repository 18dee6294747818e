//! MTL files: the materials of an OBJ file.
//!
//! Whatever is wrong with them is a warning: the shape can still be shown.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec3;

use super::illumination::Illumination;
use super::lines::decode;
use super::map::Map;
use super::mtl::{UNNAMED, clean};
use crate::error::{Error, Result};
use crate::load::guard::{Guard, Opened};
use crate::load::picture;
use crate::load::tally::Tally;
use crate::scene::{Material, MaterialId, Scene, Texture, TextureId, Wrap};

/// The range of shininess that is drawn.
const SHININESS: std::ops::RangeInclusive<f32> = 1.0..=10_000.0;

/// The materials that an OBJ file can name, each made when a face first uses it.
pub struct Library<'a> {
    guard: &'a Guard,
    /// Whether anything shows the pictures; otherwise they are only named.
    wanted: bool,
    sources: HashMap<String, (tobj::Material, PathBuf)>,
    made: HashMap<String, MaterialId>,
    textures: HashMap<(String, bool), TextureId>,
    /// The files that were read.
    files: HashSet<PathBuf>,
}

impl<'a> Library<'a> {
    /// Reads the files that an OBJ file's `mtllib` lines name, beside it in `folder`; pictures are
    /// read where they are `wanted`.
    pub fn read(
        names: &[String],
        folder: &Path,
        guard: &'a Guard,
        wanted: bool,
        tally: &mut Tally,
    ) -> Self {
        let mut library = Self {
            guard,
            wanted,
            sources: HashMap::new(),
            made: HashMap::new(),
            textures: HashMap::new(),
            files: HashSet::new(),
        };
        for name in names {
            // A name may hold spaces, and a line several names.
            match find(guard, folder, name) {
                Ok(file) => library.add(file, tally),
                Err(whole) => match names_of_line(name).as_slice() {
                    [_] => say_missing(name, &whole, tally),
                    names => names.iter().for_each(|name| match find(guard, folder, name) {
                        Ok(file) => library.add(file, tally),
                        Err(error) => say_missing(name, &error, tally),
                    }),
                },
            }
        }
        library
    }

    fn add(&mut self, file: Opened, tally: &mut Tally) {
        if !self.files.insert(file.identity.clone()) {
            return;
        }
        let path = &file.path.clone();
        let bytes = match file.read(self.guard) {
            Ok(bytes) => bytes,
            Err(error) => {
                tally.say(format!("the materials are missing and drawn grey: {error}"));
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
    pub fn get(&mut self, name: &str, scene: &mut Scene, tally: &mut Tally) -> MaterialId {
        if let Some(&id) = self.made.get(name) {
            return id;
        }
        let material = match self.sources.remove(name) {
            Some((source, folder)) => self.make(&source, &folder, scene, tally),
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

    fn make(
        &mut self,
        source: &tobj::Material,
        folder: &Path,
        scene: &mut Scene,
        tally: &mut Tally,
    ) -> Material {
        let name = || format!("`{}`", source.name);
        let other = |key: &str| source.unknown_param.get(key).map(String::as_str);
        let diffuse_map = source.diffuse_texture.as_deref();
        let emission_map = other("map_Ke").or(other("map_ke"));
        let mut material = Material { name: source.name.clone(), ..Material::default() };
        if let Some(diffuse) = source.diffuse {
            material.diffuse = Vec3::from(diffuse);
        } else if diffuse_map.is_some() {
            material.diffuse = Vec3::ONE;
        }
        material.diffuse_map = diffuse_map.and_then(|m| self.texture(m, folder, scene, tally));
        // Models 0 and 1 are those without a highlight.
        if source.illumination_model.is_none_or(|model| model > 1) {
            material.specular = source.specular.map_or(Vec3::ZERO, Vec3::from);
        }
        if let Some(shininess) = source.shininess {
            material.shininess = shininess.clamp(*SHININESS.start(), *SHININESS.end());
        }
        material.emission = source.emissive.map_or(Vec3::ZERO, Vec3::from);
        if let Some(map) = emission_map {
            if source.emissive.is_none() {
                material.emission = Vec3::ONE;
            }
            material.emission_map = self.texture(map, folder, scene, tally);
        }
        let illumination = illumination(source);
        illumination.apply(&mut material);
        if illumination.opacity == 0.0 {
            tally.add("{} materials have an opacity of 0 (d 0, or Tr 1)", 1, name);
        }
        let pictures = [&source.specular_texture, &source.shininess_texture];
        let pictures = pictures.into_iter().flatten().count();
        tally.unsupported("{} textures of highlights are not read", pictures as u64, name);
        let bumps = source.normal_texture.iter().count() + other("norm").iter().count();
        tally.unsupported("{} textures of bumps and normals are not read", bumps as u64, name);
        let metal = ["Pr", "Pm", "map_Pr", "map_Pm"].into_iter().flat_map(other).count();
        tally.unsupported("{} values of roughness and metalness are not read", metal as u64, name);
        let opacities = u64::from(source.dissolve_texture.is_some());
        tally.unsupported("{} textures of opacity are not read", opacities, name);
        material
    }

    fn texture(
        &mut self,
        value: &str,
        folder: &Path,
        scene: &mut Scene,
        tally: &mut Tally,
    ) -> Option<TextureId> {
        let map = Map::parse(value)?;
        if (map.scale, map.offset) != ([1.0; 2], [0.0; 2]) {
            let reason = "{} textures are laid on without their options `-s` and `-o`";
            tally.unsupported(reason, 1, || format!("`{value}`"));
        }
        for option in &map.ignored {
            let reason = format!("the option `{option}` of {{}} textures is not read");
            tally.unsupported(&reason, 1, || format!("`{value}`"));
        }
        let file = find(self.guard, folder, &map.file);
        let shown = folder.join(&map.file).display().to_string();
        let name = file.as_ref().map_or(shown, |file| file.identity.display().to_string());
        let key = (name, map.clamp);
        if let Some(&id) = self.textures.get(&key) {
            return Some(id);
        }
        let read = file.and_then(|file| picture::read(file, self.guard, self.wanted));
        let image = read.unwrap_or_else(|error| {
            let error = error.at(&folder.join(&*map.file));
            tally.placeholder(format!("{error}; a magenta checker takes its place"));
            picture::placeholder(&map.file)
        });
        let id = scene.add_texture(Texture {
            wrap: [if map.clamp { Wrap::Clamp } else { Wrap::Repeat }; 2],
            ..Texture::new(Arc::new(image))
        });
        self.textures.insert(key, id);
        Some(id)
    }
}

/// What [`clean`] has left of a material's illumination.
fn illumination(source: &tobj::Material) -> Illumination {
    let other = |key: &str| source.unknown_param.get(key).map(String::as_str);
    let transparency = other("Tr").and_then(|t| t.parse().ok()).unwrap_or(0.0f32);
    let filter = other("Tf").map(|tf| {
        let mut numbers = tf.split_whitespace().flat_map(str::parse);
        Vec3::from_array([0; 3].map(|_| numbers.next().unwrap_or(0.0)))
    });
    Illumination {
        model: source.illumination_model.unwrap_or(2),
        opacity: source.dissolve.unwrap_or(1.0 - transparency).clamp(0.0, 1.0),
        filter,
        ior: source.optical_density,
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

/// A file named in a model: as it stands, or as written on Windows, or beside the model when the
/// folder it was in is on another machine.
fn find(guard: &Guard, folder: &Path, name: &str) -> Result<Opened> {
    let slashes = name.replace('\\', "/");
    let last = slashes.rsplit('/').next().unwrap_or_default();
    guard.open(folder, &[name, &slashes, last])
}

fn say_missing(name: &str, error: &Error, tally: &mut Tally) {
    tally.say(format!("the materials `{name}` are missing and drawn grey: {error}"));
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
