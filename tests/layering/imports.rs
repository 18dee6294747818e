//! The imports among the source files of a crate: which file names items of which other file.
//!
//! Paths that begin with `crate`, `super` or `self` are resolved to the file that defines what they
//! name: through nested braces, and through the `use` declarations of the modules on the way, so that
//! `crate::scene::Mesh` is a use of `scene/mesh.rs` rather than of `scene/mod.rs`, which re-exports it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::tokens::tokens;

/// The path of a module from the root of its crate.
pub type Module = Vec<String>;

/// A path in a source file, from the root of the crate.
pub struct Import {
    /// The modules, then the item; `*` for all of a module.
    pub path: Vec<String>,
    /// The name that it is imported by; none for a path in an expression.
    name: Option<String>,
    /// True in code that only tests compile.
    pub is_test: bool,
}

/// A source file.
pub struct Source {
    /// The path of the file.
    pub path: PathBuf,
    /// The module that it is.
    pub module: Module,
    /// The whole text.
    pub text: String,
    /// The paths in its code.
    pub imports: Vec<Import>,
    /// The modules that only tests compile, by their names.
    test_modules: BTreeSet<String>,
}

impl Source {
    /// Reads the text of a module.
    pub fn new(path: PathBuf, module: Module, text: String) -> Self {
        let mut reader = Reader { module: module.clone(), ..Reader::default() };
        reader.read(&tokens(&text), false);
        let Reader { imports, test_modules, .. } = reader;
        Self { path, module, text, imports, test_modules }
    }
}

/// Returns every source file of a crate but `main.rs`, which is a crate of its own.
pub fn sources(root: &Path) -> Vec<Source> {
    let (mut sources, mut folders) = (Vec::new(), vec![root.to_owned()]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") && path != root.join("main.rs") {
                let within = path.strip_prefix(root).unwrap().with_extension("");
                let mut module: Module =
                    within.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
                module.pop_if(|last| ["mod", "lib"].contains(&&**last));
                let text = std::fs::read_to_string(&path).unwrap();
                sources.push(Source::new(path, module, text));
            }
        }
    }
    sources.sort_by(|a, b| a.path.cmp(&b.path));
    sources
}

/// A reader of the tokens of one file.
#[derive(Default)]
struct Reader {
    /// The module that the tokens stand in.
    module: Module,
    imports: Vec<Import>,
    test_modules: BTreeSet<String>,
}

impl Reader {
    /// Reads the tokens of a module, or of an item in it.
    fn read(&mut self, tokens: &[&str], is_test: bool) {
        const TEST_ONLY: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
        let mut at = 0;
        while at < tokens.len() {
            let rest = &tokens[at..];
            at += match *rest {
                _ if rest.starts_with(&TEST_ONLY) => {
                    let length = item_length(&rest[TEST_ONLY.len()..]);
                    let item = &rest[TEST_ONLY.len()..][..length];
                    let name = item.iter().skip_while(|token| **token != "mod").nth(1);
                    if let (Some(name), Some(&";")) = (name, item.last()) {
                        self.test_modules.insert((*name).to_owned());
                    }
                    self.read(item, true);
                    TEST_ONLY.len() + length
                }
                ["mod", name, "{", ..] => {
                    let length = item_length(rest);
                    self.module.push(name.to_owned());
                    self.read(&rest[3..length], is_test);
                    self.module.pop();
                    length
                }
                ["use", ..] => {
                    let length = item_length(rest);
                    self.read_tree(&rest[1..length - 1], &[], is_test);
                    length
                }
                // A visibility, as in `pub(in crate::scene)`, is no use.
                ["(", "in", ..] => 2 + path_length(&rest[2..]),
                ["crate" | "super" | "self", "::", ..] => {
                    let length = path_length(rest);
                    self.import(&rest[..length], None, is_test);
                    length
                }
                _ => 1,
            };
        }
    }

    /// Reads what stands behind `use`, or within its braces.
    fn read_tree(&mut self, tokens: &[&str], prefix: &[&str], is_test: bool) {
        let (mut start, mut depth) = (0, 0);
        for (i, token) in tokens.iter().chain([&","]).enumerate() {
            match *token {
                "{" => depth += 1,
                "}" => depth -= 1,
                "," if depth == 0 => {
                    let branch = &tokens[start..i];
                    start = i + 1;
                    let names = branch.iter().position(|t| *t == "{").unwrap_or(branch.len());
                    let mut path: Vec<&str> = prefix.to_vec();
                    path.extend(branch[..names].iter().filter(|token| **token != "::"));
                    if names < branch.len() {
                        self.read_tree(&branch[names + 1..branch.len() - 1], &path, is_test);
                        continue;
                    }
                    let renamed = path.iter().position(|token| *token == "as");
                    let name = path.last().copied();
                    path.truncate(renamed.unwrap_or(path.len()));
                    path.pop_if(|last| *last == "self");
                    if !path.is_empty() {
                        let name = name.filter(|name| *name != "self").or(path.last().copied());
                        self.import(&path, name, is_test);
                    }
                }
                _ => {}
            }
        }
    }

    /// Adds a path, made one from the root of the crate.
    fn import(&mut self, path: &[&str], name: Option<&str>, is_test: bool) {
        let mut absolute = self.module.clone();
        let mut path = path.iter().filter(|token| **token != "::").peekable();
        if path.next_if(|first| **first == "crate").is_some() {
            absolute.clear();
        }
        while let Some(first) = path.next_if(|first| ["self", "super"].contains(first)) {
            if *first == "super" {
                absolute.pop();
            }
        }
        absolute.extend(path.map(|&part| part.to_owned()));
        let name = name.map(str::to_owned);
        self.imports.push(Import { path: absolute, name, is_test });
    }
}

/// The number of tokens of an item: to its `;`, or to the end of its block.
fn item_length(tokens: &[&str]) -> usize {
    let mut depth = 0;
    for (i, token) in tokens.iter().enumerate() {
        match *token {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => {}
        }
        let is_use = tokens.iter().take_while(|token| **token != "{").any(|token| *token == "use");
        if depth == 0 && (*token == ";" || *token == "}" && !is_use) {
            return i + 1;
        }
    }
    tokens.len()
}

/// The number of tokens of a path.
fn path_length(tokens: &[&str]) -> usize {
    let mut length = 1;
    while let [_, "::", next, ..] = tokens[length - 1..]
        && next.starts_with(|c: char| c.is_alphabetic() || c == '_')
    {
        length += 2;
    }
    length
}

/// For each file, the files whose items it names outside of tests, by their indices.
///
/// A module does not count as a user of the modules within it: it is made of them, declares them and
/// re-exports what they define.
pub fn graph(sources: &[Source]) -> Vec<BTreeSet<usize>> {
    let crate_map = Crate::new(sources);
    let is_for_tests = |source: &Source| {
        (0..source.module.len()).any(|depth| {
            let parent = crate_map.files.get(&source.module[..depth]);
            parent.is_some_and(|i| sources[*i].test_modules.contains(&source.module[depth]))
        })
    };
    let edges = |(i, source): (usize, &Source)| {
        let imports = source.imports.iter().filter(|import| !import.is_test);
        let used = imports.filter_map(|import| crate_map.file(&import.path, 0));
        used.filter(|&j| i != j && !sources[j].module.starts_with(&source.module)).collect()
    };
    let all = sources.iter().enumerate();
    all.map(|(i, s)| if is_for_tests(s) { BTreeSet::new() } else { edges((i, s)) }).collect()
}

/// Every module of a crate, and what its declarations import.
struct Crate<'s> {
    sources: &'s [Source],
    files: BTreeMap<&'s [String], usize>,
}

impl<'s> Crate<'s> {
    fn new(sources: &'s [Source]) -> Self {
        let files = sources.iter().enumerate().map(|(i, s)| (&*s.module, i)).collect();
        Self { sources, files }
    }

    /// The file that defines what a path names; none for a path into another crate.
    fn file(&self, path: &[String], depth: usize) -> Option<usize> {
        let known = (0..=path.len()).rev().find(|n| self.files.contains_key(&path[..*n]))?;
        let file = self.files[&path[..known]];
        let item = path.get(known).filter(|item| *item != "*" && depth < 8);
        let Some(item) = item else { return Some(file) };
        // The module may have it from another one.
        let source = &self.sources[file];
        let imported = source.imports.iter().find(|import| {
            import.name.as_ref() == Some(item) && import.path != path[..=known] && !import.is_test
        });
        if let Some(import) = imported {
            let target = [&import.path, &path[known + 1..]].concat();
            return self.file(&target, depth + 1);
        }
        let globs = source.imports.iter().filter(|i| i.name.as_deref() == Some("*"));
        let mut of_globs = globs.filter_map(|import| {
            let module = &import.path[..import.path.len() - 1];
            let other = *self.files.get(module)?;
            self.sources[other].defines(item).then_some(other)
        });
        Some(of_globs.next_back().unwrap_or(file))
    }
}

impl Source {
    /// True if the file defines an item of this name.
    fn defines(&self, name: &str) -> bool {
        let kinds = ["fn", "struct", "enum", "trait", "type", "const", "static", "union"];
        tokens(&self.text).windows(2).any(|w| kinds.contains(&w[0]) && w[1] == name)
    }
}

/// The circles of a graph: sets of nodes of which each leads to every other.
pub fn circles(graph: &[BTreeSet<usize>]) -> Vec<BTreeSet<usize>> {
    let reached: Vec<BTreeSet<usize>> = (0..graph.len())
        .map(|start| {
            let (mut reached, mut open) = (BTreeSet::new(), vec![start]);
            while let Some(node) = open.pop() {
                open.extend(graph[node].iter().filter(|next| reached.insert(**next)));
            }
            reached
        })
        .collect();
    let mut circles = BTreeSet::new();
    for (node, ahead) in reached.iter().enumerate().filter(|(node, ahead)| ahead.contains(node)) {
        circles.insert(
            ahead.iter().copied().filter(|&other| reached[other].contains(&node)).collect(),
        );
    }
    circles.into_iter().collect()
}
