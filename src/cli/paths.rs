//! Checks of paths on the command line: inputs exist, and outputs overwrite none of them.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::load::LoadReport;
use crate::scene::Scene;
use crate::write::{folder_of, resolve};

/// Checks that an input exists and is a regular file; a pipe could make the program wait forever.
///
/// # Errors
/// When it does not exist, cannot be accessed, or is not a file.
pub fn check_input(path: &Path) -> Result<()> {
    let metadata = match path.metadata() {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
            let error = Error::input("there is no such file").at(path);
            return Err(match std::env::current_dir() {
                Ok(here) if path.is_relative() => {
                    error.help(format!("the current folder is {}", here.display()))
                }
                _ => error,
            });
        }
        Err(e) => return Err(Error::reading(path, &e)),
        Ok(metadata) => metadata,
    };
    if metadata.is_file() {
        return Ok(());
    }
    let what = if metadata.is_dir() { "a folder" } else { "a pipe or a device" };
    Err(Error::input(format!("this is {what}, not a file")).at(path).help("name a file"))
}

/// The input files of a command, which no output may overwrite.
pub struct InputFiles(HashSet<PathBuf>);

impl InputFiles {
    /// The files that are named on the command line.
    pub fn named(paths: &[&Path]) -> Self {
        Self(paths.iter().map(|path| canonical(path)).collect())
    }

    /// The files of a scene: those that were read, and the textures that no material needed.
    pub fn of_scene(scene: &Scene, report: &LoadReport) -> Self {
        let textures = scene.textures.iter().map(|texture| Path::new(&texture.image.name));
        let textures = textures.filter_map(|path| path.canonicalize().ok());
        Self(report.files.iter().cloned().chain(textures).collect())
    }
}

/// Checks that outputs are distinct files, and none of them is an input file.
///
/// # Errors
/// When two are the same file, or one is an input.
pub fn check_outputs(
    outputs: impl IntoIterator<Item = impl AsRef<Path>>,
    inputs: &InputFiles,
) -> Result<()> {
    let mut seen = HashSet::new();
    for output in outputs {
        let path = output.as_ref();
        let file = canonical(path);
        if inputs.0.contains(&file) {
            return Err(Error::input("this output is an input file, and would overwrite it")
                .at(path)
                .help("choose another name"));
        }
        if !seen.insert(file) {
            return Err(Error::input("two outputs are this file")
                .at(path)
                .help("choose another name for one of them"));
        }
    }
    Ok(())
}

/// Returns the canonical path of a file; the folder at least must exist.
fn canonical(path: &Path) -> PathBuf {
    let in_folder = || {
        let target = resolve(path).ok()?;
        Some(folder_of(&target).canonicalize().ok()?.join(target.file_name()?))
    };
    path.canonicalize().ok().or_else(in_folder).unwrap_or_else(|| path.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_file_has_several_paths() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        assert_eq!(canonical(&path("a")), canonical(&path("./a")));
        assert_ne!(canonical(&path("a")), canonical(&path("b")));
        std::fs::write(path("a"), "").unwrap();
        std::fs::create_dir(path("c")).unwrap();
        assert_eq!(canonical(&path("a")), canonical(&path("c/../a")));
    }
}
