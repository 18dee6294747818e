//! The validation of a file against the standard.
//!
//! An error stops a load only where something is used that cannot be read; the validation covers the
//! whole file, used or not, and warns. docs/formats.md lists what it checks, and what not, beside
//! the verdicts of Khronos' validator.

mod attributes;
mod buffers;
#[rustfmt::skip] // Tables, with several properties in a line.
mod extensions;
mod properties;
mod rules;
#[rustfmt::skip]
mod schema;

use std::fmt::Display;

use gltf::json::Value;

use super::json::{as_index, list};
use crate::load::diagnostics::Diagnostics;

/// Warns of what is not valid in a file; `bin` is the length of a GLB's binary chunk.
pub fn validate(root: &Value, bin: Option<usize>, diagnostics: &mut Diagnostics) {
    let mut issues = Issues::default();
    properties::check(root, &mut issues);
    buffers::check(root, bin, &mut issues);
    rules::check(root, &mut issues);
    for issue in issues.0 {
        let place = || format!("{} ({})", issue.path, issue.message);
        diagnostics.add(issue.kind.sentence(), issue.count, place);
    }
}

/// Returns the path of the first property that is missing or of the wrong type, and what is wrong.
pub fn first_missing_or_mistyped(root: &Value) -> Option<(String, String)> {
    let mut issues = Issues::default();
    properties::check(root, &mut issues);
    let is_needed = |issue: &Issue| matches!(issue.kind, IssueKind::Missing | IssueKind::Type);
    issues.0.into_iter().find(is_needed).map(|issue| (issue.path, issue.message))
}

/// A kind of issue.
#[derive(Clone, Copy, PartialEq, Eq)]
enum IssueKind {
    Empty,
    Extension,
    Layout,
    Missing,
    Range,
    Reference,
    Rule,
    Type,
}

/// The issues of a file, by kind, in the order in which the first of each kind was found.
#[derive(Default)]
struct Issues(Vec<Issue>);

/// The issues of one kind: their number, and the path and the message of the first.
struct Issue {
    kind: IssueKind,
    count: u64,
    path: String,
    message: String,
}

impl Issues {
    /// Counts an issue at a JSON path.
    fn add(&mut self, kind: IssueKind, path: impl Display, message: impl Display) {
        match self.0.iter_mut().find(|known| known.kind == kind) {
            Some(known) => known.count += 1,
            None => {
                let (path, message) = (path.to_string(), message.to_string());
                self.0.push(Issue { kind, count: 1, path, message });
            }
        }
    }

    /// Counts an issue of a kind if `is_valid` is false.
    fn check(
        &mut self,
        kind: IssueKind,
        is_valid: bool,
        path: impl Display,
        message: impl Display,
    ) {
        if !is_valid {
            self.add(kind, path, message);
        }
    }
}

impl IssueKind {
    /// The sentence about issues of this kind, with `{}` where their number belongs.
    fn sentence(self) -> &'static str {
        match self {
            Self::Empty => "not valid glTF: {} lists are empty or name something twice",
            Self::Extension => {
                "not valid glTF: {} extensions stand where they do not belong, or are not declared"
            }
            Self::Layout => "not valid glTF: {} ranges of bytes do not fit in what holds them",
            Self::Missing => "not valid glTF: {} properties are missing",
            Self::Range => "not valid glTF: {} values are out of range",
            Self::Reference => "not valid glTF: {} references lead nowhere",
            Self::Rule => "not valid glTF: {} objects contradict themselves or others",
            Self::Type => "not valid glTF: {} values are of the wrong type",
        }
    }
}

/// Returns an integer property of an object.
fn integer(object: &Value, key: &str) -> Option<u64> {
    object.get(key)?.as_u64()
}

/// Returns the item of the root's list `to` that a property of an object refers to.
fn referenced<'v>(root: &'v Value, object: &Value, key: &str, to: &str) -> Option<&'v Value> {
    list(root, to).get(object.get(key).and_then(as_index)?)
}
