//! The places where Embree's library may be.

use std::env;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// The files to try, and what to do if none of them opens.
pub struct Candidates {
    /// Paths of files that exist, and bare names for the system's loader, in the order to try them.
    pub paths: Vec<PathBuf>,
    /// The advice.
    pub help: &'static str,
}

/// The folder into which `scripts/setup` puts Embree, or a link to it.
const SET_UP: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/.deps/embree");

/// The names under which the system's loader is asked for the library.
const SYSTEM_NAMES: &[&str] = if cfg!(windows) {
    &["embree4.dll"]
} else if cfg!(target_os = "macos") {
    &["libembree4.4.dylib", "libembree4.dylib"]
} else {
    &["libembree4.so.4", "libembree4.so"]
};

/// Folders in which libraries are, but where the loader does not look by itself.
const USUAL_FOLDERS: &[&str] = if cfg!(target_os = "macos") {
    &["/opt/homebrew/lib", "/opt/homebrew/opt/embree/lib", "/usr/local/lib", "/opt/local/lib"]
} else if cfg!(unix) {
    &["/usr/local/lib64", "/usr/local/lib"]
} else {
    &[]
};

/// Returns the files to try. `EMBREE_DIR` is an explicit wish, and nothing replaces it. Otherwise a library
/// beside the program comes first, then the one that the checkout was set up with, then the system's.
///
/// # Errors
/// When `EMBREE_DIR` names a folder without the library.
pub fn candidates() -> Result<Candidates> {
    if let Some(named) = env::var_os("EMBREE_DIR").filter(|value| !value.is_empty()) {
        return in_named_folder(Path::new(&named));
    }
    let mut paths = vec![];
    if let Some(folder) = env::current_exe().ok().as_deref().and_then(Path::parent) {
        paths.extend(libraries_in(folder));
        // Where `make install` puts it.
        paths.extend(libraries_in(&folder.join("../lib/envers")));
    }
    paths.extend(libraries_in(Path::new(SET_UP)));
    paths.extend(SYSTEM_NAMES.iter().map(PathBuf::from));
    paths.extend(USUAL_FOLDERS.iter().flat_map(|folder| libraries_in(Path::new(folder))));
    if let Some(conda) = env::var_os("CONDA_PREFIX") {
        paths.extend(libraries_in(&Path::new(&conda).join("lib")));
    }
    let help = "install it (README.md says how), or set EMBREE_DIR to the folder of its library";
    Ok(Candidates { paths, help })
}

/// Returns the libraries in the folder that `EMBREE_DIR` names, or in what usually stands below it.
fn in_named_folder(named: &Path) -> Result<Candidates> {
    let multiarch = format!("lib/{}-linux-gnu", env::consts::ARCH);
    let folders = ["", "lib", "lib64", "bin", &multiarch];
    let paths: Vec<_> = folders.iter().flat_map(|below| libraries_in(&named.join(below))).collect();
    if paths.is_empty() {
        let named = named.display();
        let message = format!("EMBREE_DIR is {named}, and no library of Embree 4 is there");
        return Err(Error::failed(message).help("set it to the folder of the library"));
    }
    Ok(Candidates { paths, help: "set EMBREE_DIR to the folder of another one" })
}

/// Returns the files in a folder that are called like the library, the shortest name first. Packagers add
/// versions and checksums to it, such as `libembree4-4aef3270.so.4`.
fn libraries_in(folder: &Path) -> Vec<PathBuf> {
    let is_library = |name: &str| {
        let is_shared = name.contains(".so") || name.ends_with(".dylib");
        name == "embree4.dll" || name.starts_with("libembree4") && is_shared
    };
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.file_name().and_then(|name| name.to_str()).is_some_and(is_library))
        .collect();
    paths.sort_by_key(|path| (path.as_os_str().len(), path.clone()));
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_are_known_by_their_names() {
        let folder = tempfile::tempdir().unwrap();
        let names = [
            "libembree4.so",
            "libembree4.so.4",
            "libembree4-4aef3270.so.4",
            "libembree4.4.dylib",
            "embree4.dll",
        ];
        let others = ["libembree3.so.3", "libtbb.so.12", "libembree4.a", "embree4.lib"];
        for name in names.iter().chain(&others) {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let mut found: Vec<_> = libraries_in(folder.path())
            .into_iter()
            .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned())
            .collect();
        assert_eq!(found[0].len(), "embree4.dll".len(), "the shortest comes first");
        found.sort();
        let mut expected = names;
        expected.sort();
        assert_eq!(found, expected);
    }

    #[test]
    fn named_folder_must_hold_the_library_itself_or_below() {
        let folder = tempfile::tempdir().unwrap();
        let error = in_named_folder(folder.path()).err().unwrap();
        assert!(error.message().contains("EMBREE_DIR"), "{error}");
        std::fs::create_dir(folder.path().join("lib")).unwrap();
        let library = folder.path().join("lib/libembree4.so.4");
        std::fs::write(&library, "").unwrap();
        assert_eq!(in_named_folder(folder.path()).unwrap().paths, [library]);
    }
}
