//! The order of the modules: each imports only what stands above it, and no files import one another
//! in a circle.

mod imports;
mod tokens;

use std::path::{Path, PathBuf};

use imports::{Source, circles, graph, sources};

/// The modules from the top down; each may use those before it and its own parts.
const ORDER: [&str; 13] = [
    "error",
    "geometry",
    "scene",
    "load",
    "intersect",
    "surface",
    "shading",
    "film",
    "write",
    "integrator",
    "render",
    "measure",
    "cli",
];

fn src() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// The place of a module of the first level in the order.
fn rank(module: &str) -> Option<usize> {
    ORDER.iter().position(|m| *m == module)
}

/// Asserts that a file may use what stands in a module of the first level.
#[track_caller]
fn assert_stands_above(source: &Source, module: &str) {
    let Some(own) = source.module.first() else { return };
    let own = rank(own).unwrap_or_else(|| panic!("{own} is missing in the order"));
    let path = source.path.display();
    let used =
        rank(module).unwrap_or_else(|| panic!("{path} uses crate::{module}: which is that?"));
    assert!(used <= own, "{path} uses crate::{module}, which stands below it");
}

#[test]
fn modules_import_only_what_stands_above_them() {
    for source in sources(&src()) {
        for import in &source.imports {
            if let Some(module) = import.path.first() {
                assert_stands_above(&source, module);
            }
        }
    }
}

/// Comments, too: what they link to stands above.
#[test]
fn texts_name_only_what_stands_above_them() {
    for source in sources(&src()) {
        for used in source.text.split("crate::").skip(1) {
            let end = used.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(used.len());
            if end > 0 {
                assert_stands_above(&source, &used[..end]);
            }
        }
    }
}

#[test]
fn no_files_import_one_another_in_a_circle() {
    let sources = sources(&src());
    let graph = graph(&sources);
    let name = |i: &usize| sources[*i].path.strip_prefix(src()).unwrap().display().to_string();
    let mut found = String::new();
    for circle in circles(&graph) {
        for file in &circle {
            let used: Vec<String> = graph[*file].intersection(&circle).map(name).collect();
            found += &format!("{} uses {}\n", name(file), used.join(", "));
        }
        found.push('\n');
    }
    assert!(found.is_empty(), "these files import one another:\n{found}");
}

#[test]
fn unsafe_code_stays_in_the_embree_files() {
    for source in sources(&src()).into_iter().filter(|s| !s.module.is_empty()) {
        let allows = source.text.contains("allow(unsafe_code)");
        let is_embree = source.module.starts_with(&["intersect".to_owned(), "embree".to_owned()]);
        assert!(!allows || is_embree, "{} allows unsafe code", source.path.display());
    }
}

/// A crate of files, given by their module and text.
fn crate_of(files: &[(&str, &str)]) -> Vec<Source> {
    let module = |name: &str| name.split_terminator("::").map(str::to_owned).collect();
    let source = |(name, text): &(&str, &str)| {
        Source::new(PathBuf::from(name), module(name), (*text).to_owned())
    };
    files.iter().map(source).collect()
}

/// Asserts which files of a crate use which, by their places in the list.
#[track_caller]
fn assert_uses(files: &[(&str, &str)], expected: &[(usize, usize)]) {
    let graph = graph(&crate_of(files));
    let edges = graph.iter().enumerate().flat_map(|(i, used)| used.iter().map(move |&j| (i, j)));
    assert_eq!(edges.collect::<Vec<_>>(), expected);
}

#[test]
fn paths_are_read_from_nested_declarations_and_from_code() {
    let text = "use crate::{a::{self, b::C}, d::*};\nfn f() { super::g::<u8>(crate::h::I::new()) }";
    let source = &crate_of(&[("m::n", text)])[0];
    let paths: Vec<String> = source.imports.iter().map(|i| i.path.join("::")).collect();
    assert_eq!(paths, ["a", "a::b::C", "d::*", "m::g", "h::I::new"]);
}

#[test]
fn paths_in_comments_and_strings_and_visibilities_are_not_imports() {
    let text =
        "/// [`crate::a`] // super::b\npub(in crate::c) fn f() -> &'static str { \"crate::d\" }";
    assert!(crate_of(&[("m", text)])[0].imports.is_empty());
}

#[test]
fn imports_of_tests_are_told_from_others() {
    let text = "#[cfg(test)]\nmod tests { use super::*; use crate::a::B; }\nuse crate::c::D;";
    let source = &crate_of(&[("m", text)])[0];
    let found: Vec<_> = source.imports.iter().map(|i| (i.path.join("::"), i.is_test)).collect();
    assert_eq!(found, [("m::*".into(), true), ("a::B".into(), true), ("c::D".into(), false)]);
}

#[test]
fn siblings_that_import_one_another_are_a_circle() {
    let files = [("m", ""), ("m::a", "use super::b::B;"), ("m::b", "use crate::m::a::A;")];
    assert_uses(&files, &[(1, 2), (2, 1)]);
    assert_eq!(circles(&graph(&crate_of(&files))), [[1, 2].into()]);
}

#[test]
fn a_module_that_reexports_its_parts_is_no_circle() {
    let files = [
        ("m", "mod a;\nmod b;\npub use a::A;\npub use b::B;\npub fn own() {}"),
        ("m::a", "use super::own;"),
        ("m::b", "use super::A;"),
    ];
    assert_uses(&files, &[(1, 0), (2, 1)]);
    assert!(circles(&graph(&crate_of(&files))).is_empty());
}

#[test]
fn a_circle_through_reexports_is_one() {
    let files = [
        ("m", "mod a;\nmod b;\npub use a::A;\npub use b::*;"),
        ("m::a", "use super::B;"),
        ("m::b", "use super::A;\npub struct B;"),
    ];
    assert_uses(&files, &[(1, 2), (2, 1)]);
}
