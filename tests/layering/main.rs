//! The one-way arrow: a module imports only modules that stand above it.

use std::fs;
use std::path::{Path, PathBuf};

/// From the top down; a module may use those before it and its own parts.
const ORDER: [&str; 13] = [
    "error",
    "geometry",
    "scene",
    "load",
    "intersect",
    "surface",
    "shading",
    "film",
    "integrator",
    "render",
    "write",
    "measure",
    "cli",
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found
}

/// Every source file with the module of the first level that it belongs to.
fn files() -> Vec<(PathBuf, String)> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    sources(&src)
        .into_iter()
        .map(|path| {
            let first = path.strip_prefix(&src).unwrap().iter().next().unwrap();
            let module = first.to_str().unwrap().trim_end_matches(".rs").to_owned();
            (path, module)
        })
        .collect()
}

fn rank(module: &str) -> Option<usize> {
    ORDER.iter().position(|m| *m == module)
}

#[test]
fn modules_import_only_what_stands_above_them() {
    for (path, module) in files() {
        let Some(own) = rank(&module) else {
            assert!(["lib", "main"].contains(&&*module), "{module} is missing in the order");
            continue;
        };
        let text = fs::read_to_string(&path).unwrap();
        for used in text.split("crate::").skip(1) {
            let name = used.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap();
            let of = rank(name).unwrap_or_else(|| panic!("{}: crate::{name}?", path.display()));
            assert!(of <= own, "{} uses crate::{name}, which stands below it", path.display());
        }
    }
}

#[test]
fn unsafe_code_stays_in_the_embree_files() {
    for (path, _) in files() {
        let allows = fs::read_to_string(&path).unwrap().contains("allow(unsafe_code)");
        let embree = path.to_string_lossy().replace('\\', "/").contains("src/intersect/embree/");
        assert!(!allows || embree, "{} allows unsafe code", path.display());
    }
}
