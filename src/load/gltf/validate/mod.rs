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

use std::collections::HashSet;
use std::fmt::Display;

use gltf::json::Value;

use super::json::{as_index, list};
use crate::load::diagnostics::Diagnostics;

/// Warns of what is not valid in a file; `bin` is the length of a GLB's binary chunk.
pub fn validate(root: &Value, bin: Option<usize>, diagnostics: &mut Diagnostics) {
    let mut validator = Validator::new(
        root,
        Box::new(|kind, path, message| {
            diagnostics.add(kind, 1, || format!("{path} ({message})"));
        }),
    );
    validator.check_properties();
    validator.check_buffers(bin);
    validator.check_rules();
}

/// Returns the path of the first property that is missing or of the wrong type, and what is wrong.
pub fn first_missing_or_mistyped(root: &Value) -> Option<(String, String)> {
    let mut first = None;
    Validator::new(
        root,
        Box::new(|kind, path, message| {
            if first.is_none() && (kind == MISSING || kind == TYPE) {
                first = Some((path.to_string(), message.to_string()));
            }
        }),
    )
    .check_properties();
    first
}

/// A kind of issue: the sentence about issues of this kind, with `{}` where their number belongs.
type IssueKind = &'static str;

const EMPTY: IssueKind = "not valid glTF: {} lists are empty or name something twice";
const EXTENSION: IssueKind =
    "not valid glTF: {} extensions stand where they do not belong, or are not declared";
const LAYOUT: IssueKind = "not valid glTF: {} ranges of bytes do not fit in what holds them";
const MISSING: IssueKind = "not valid glTF: {} properties are missing";
const RANGE: IssueKind = "not valid glTF: {} values are out of range";
const REFERENCE: IssueKind = "not valid glTF: {} references lead nowhere";
const RULE: IssueKind = "not valid glTF: {} objects contradict themselves or others";
const TYPE: IssueKind = "not valid glTF: {} values are of the wrong type";

/// The validation of a file, which reports its issues: of each the kind, the JSON path, and a
/// message.
struct Validator<'a> {
    root: &'a Value,
    /// The names of the extensions that the file declares.
    used: HashSet<&'a str>,
    report: Report<'a>,
}

type Report<'a> = Box<dyn FnMut(IssueKind, &dyn Display, &dyn Display) + 'a>;

impl<'a> Validator<'a> {
    fn new(root: &'a Value, report: Report<'a>) -> Self {
        Self { root, used: names(root, "extensionsUsed"), report }
    }

    /// Reports an issue of a kind, unless what is checked holds.
    fn check(&mut self, kind: IssueKind, holds: bool, path: impl Display, message: impl Display) {
        if !holds {
            (self.report)(kind, &path, &message);
        }
    }

    /// Checks each item of a list of the root, by a function of the item and its JSON path.
    fn each(&mut self, key: &str, mut check: impl FnMut(&mut Self, &Value, &str)) {
        for (i, item) in list(self.root, key).iter().enumerate() {
            check(self, item, &format!("{key}[{i}]"));
        }
    }
}

/// Returns the strings of the list that is a property of an object.
fn names<'v>(object: &'v Value, key: &str) -> HashSet<&'v str> {
    list(object, key).iter().filter_map(Value::as_str).collect()
}

/// Returns an integer property of an object.
fn integer(object: &Value, key: &str) -> Option<u64> {
    object.get(key)?.as_u64()
}

/// Returns an extension's object in an object.
fn extension<'v>(object: &'v Value, name: &str) -> Option<&'v Value> {
    object.get("extensions")?.get(name)
}

/// Returns the item of the root's list `to` that a property of an object refers to.
fn referenced<'v>(root: &'v Value, object: &Value, key: &str, to: &str) -> Option<&'v Value> {
    list(root, to).get(object.get(key).and_then(as_index)?)
}
