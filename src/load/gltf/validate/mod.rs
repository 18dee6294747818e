//! The validation of a file against the standard.
//!
//! An error stops a load only where something is used that cannot be read; the validation covers
//! the whole file, used or not, and warns. docs/formats.md lists what it checks, and what not,
//! beside the verdicts of Khronos' validator.

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
    let mut issues = Issues(&mut |kind: IssueKind, path, message| {
        diagnostics.add(kind.0, 1, || format!("{path} ({message})"));
    });
    properties::check(root, &mut issues);
    buffers::check(root, bin, &mut issues);
    rules::check(root, &mut issues);
}

/// Returns the path of the first property that is missing or of the wrong type, and what is wrong.
pub fn first_missing_or_mistyped(root: &Value) -> Option<(String, String)> {
    let mut first = None;
    let mut issues = Issues(&mut |kind, path, message| {
        if first.is_none() && (kind == IssueKind::MISSING || kind == IssueKind::TYPE) {
            first = Some((path.to_string(), message.to_string()));
        }
    });
    properties::check(root, &mut issues);
    first
}

/// A kind of issue: the sentence about issues of this kind, with `{}` where their number belongs.
#[derive(Clone, Copy, PartialEq, Eq)]
struct IssueKind(&'static str);

impl IssueKind {
    const EMPTY: Self = Self("not valid glTF: {} lists are empty or name something twice");
    const EXTENSION: Self =
        Self("not valid glTF: {} extensions stand where they do not belong, or are not declared");
    const LAYOUT: Self = Self("not valid glTF: {} ranges of bytes do not fit in what holds them");
    const MISSING: Self = Self("not valid glTF: {} properties are missing");
    const RANGE: Self = Self("not valid glTF: {} values are out of range");
    const REFERENCE: Self = Self("not valid glTF: {} references lead nowhere");
    const RULE: Self = Self("not valid glTF: {} objects contradict themselves or others");
    const TYPE: Self = Self("not valid glTF: {} values are of the wrong type");
}

/// The receiver of the issues of a file: of each the kind, the JSON path, and a message.
struct Issues<'a>(&'a mut dyn FnMut(IssueKind, &dyn Display, &dyn Display));

impl Issues<'_> {
    /// Reports an issue of a kind if `is_valid` is false.
    fn check(
        &mut self,
        kind: IssueKind,
        is_valid: bool,
        path: impl Display,
        message: impl Display,
    ) {
        if !is_valid {
            self.0(kind, &path, &message);
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
