//! Files that are named on the command line: whether they can be read, and which are the same.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::scene::Scene;

/// Checks that an input is there and is a file; a pipe could keep the program waiting for ever.
///
/// # Errors
/// When it is not.
pub fn check_input(path: &Path) -> Result<()> {
    let metadata = match path.metadata() {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
            let error = Error::input("there is no such file").at(path);
            return Err(match std::env::current_dir() {
                Ok(here) if path.is_relative() => {
                    error.help(format!("it was looked for in {}", here.display()))
                }
                _ => error,
            });
        }
        Err(e) => return Err(Error::io("read", path, &e)),
        Ok(metadata) => metadata,
    };
    if metadata.is_file() {
        return Ok(());
    }
    let what = if metadata.is_dir() { "a folder" } else { "a pipe or a device" };
    Err(Error::input(format!("this is {what}, not a file")).at(path).help("name a file"))
}

/// Checks that no output is a texture of the scene, which it would overwrite.
///
/// # Errors
/// When one is.
pub fn check_not_a_texture<'a>(
    scene: &Scene,
    outputs: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<()> {
    for path in outputs {
        let mut images = scene.textures.iter().map(|t| Path::new(&t.image.name));
        if path.exists() && images.any(|image| same(image, path)) {
            return Err(Error::input("the output is a texture of the scene")
                .at(path)
                .help("choose another name with -o"));
        }
    }
    Ok(())
}

/// Whether two paths lead to the same file, which need not be there yet.
pub fn same(a: &Path, b: &Path) -> bool {
    a == b || identity(a) == identity(b)
}

fn identity(path: &Path) -> PathBuf {
    let in_folder = || {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(folder.canonicalize().ok()?.join(path.file_name()?))
    };
    path.canonicalize().ok().or_else(in_folder).unwrap_or_else(|| path.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_file_has_several_names() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        assert!(same(&path("a"), &path("./a")));
        assert!(!same(&path("a"), &path("b")));
        std::fs::write(path("a"), "").unwrap();
        std::fs::create_dir(path("c")).unwrap();
        assert!(same(&path("a"), &path("c/../a")));
    }
}
