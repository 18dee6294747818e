//! Checks of paths on the command line: inputs exist, and outputs overwrite none of them.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
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

/// Checks that no output would overwrite a texture of the scene.
///
/// # Errors
/// When one would.
pub fn check_not_a_texture<'a>(
    scene: &Scene,
    outputs: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<()> {
    let is_texture =
        |path: &Path| scene.textures.iter().any(|t| is_same(Path::new(&t.image.name), path));
    match outputs.into_iter().find(|path| path.exists() && is_texture(path)) {
        None => Ok(()),
        Some(path) => {
            Err(Error::input("the output is a texture of the scene, and would overwrite it")
                .at(path)
                .help("choose another name with -o"))
        }
    }
}

/// True if two paths name the same file, which need not exist yet.
pub fn is_same(a: &Path, b: &Path) -> bool {
    a == b || canonical(a) == canonical(b)
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
        assert!(is_same(&path("a"), &path("./a")));
        assert!(!is_same(&path("a"), &path("b")));
        std::fs::write(path("a"), "").unwrap();
        std::fs::create_dir(path("c")).unwrap();
        assert!(is_same(&path("a"), &path("c/../a")));
    }
}
