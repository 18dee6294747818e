//! Whether a file is what the standard says, and where not.
//!
//! An error stops a file only where something is used that cannot be had; this looks at all of it,
//! used or not, and warns. What it looks for, and what not, stands in docs/formats.md beside the
//! verdicts of Khronos' validator.

mod attributes;
mod extensions;
mod layout;
mod rules;
mod schema;
mod walk;

use gltf::json::Value;

use crate::load::diagnostics::Diagnostics;

/// Warns of what in a file is not valid; `bin` is the length of a GLB's binary chunk.
pub fn validate(root: &Value, bin: Option<usize>, tally: &mut Diagnostics) {
    let mut faults = Faults::default();
    walk::walk(root, &mut faults);
    layout::check(root, bin, &mut faults);
    rules::check(root, &mut faults);
    for found in faults.found {
        let place = || format!("{} ({})", found.path, found.what);
        tally.add(found.fault.sentence(), found.count, place);
    }
}

/// The place of the first property that is missing or of the wrong type, and what is wrong with it.
pub fn blame(root: &Value) -> Option<(String, String)> {
    let mut faults = Faults::default();
    walk::walk(root, &mut faults);
    faults.found.into_iter().find_map(|found| match found.fault {
        Fault::Missing | Fault::Type => Some((found.path, found.what)),
        _ => None,
    })
}

/// A kind of fault.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fault {
    Empty,
    Extension,
    Layout,
    Missing,
    Range,
    Reference,
    Rule,
    Type,
}

/// The faults of a file, by kind, in the order in which the first of each was found.
#[derive(Default)]
struct Faults {
    found: Vec<Found>,
}

struct Found {
    fault: Fault,
    count: u64,
    path: String,
    what: String,
}

impl Faults {
    /// Counts a fault; `place` gives its path, and what is wrong there.
    fn add(&mut self, fault: Fault, place: impl FnOnce() -> (String, String)) {
        match self.found.iter_mut().find(|found| found.fault == fault) {
            Some(found) => found.count += 1,
            None => {
                let (path, what) = place();
                self.found.push(Found { fault, count: 1, path, what });
            }
        }
    }

    /// Counts a breach of a rule, unless that holds.
    fn rule(&mut self, holds: bool, path: impl FnOnce() -> String, what: &str) {
        if !holds {
            self.add(Fault::Rule, || (path(), what.to_owned()));
        }
    }
}

impl Fault {
    /// The sentence about faults of this kind, with `{}` where their number belongs.
    fn sentence(self) -> &'static str {
        match self {
            Fault::Empty => "not valid glTF: {} lists are empty or name something twice",
            Fault::Extension => {
                "not valid glTF: {} extensions stand where they do not belong, or are not declared"
            }
            Fault::Layout => "not valid glTF: {} stretches of bytes do not fit in what holds them",
            Fault::Missing => "not valid glTF: {} properties are missing",
            Fault::Range => "not valid glTF: {} values are out of range",
            Fault::Reference => "not valid glTF: {} references lead nowhere",
            Fault::Rule => "not valid glTF: {} objects contradict themselves or others",
            Fault::Type => "not valid glTF: {} values are of the wrong type",
        }
    }
}

/// The objects of a list of the root.
fn list<'v>(root: &'v Value, name: &str) -> &'v [Value] {
    root.get(name).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

/// An index or a length.
fn whole(object: &Value, name: &str) -> Option<u64> {
    object.get(name)?.as_u64()
}

/// What an index in `object` leads to.
fn follow<'v>(root: &'v Value, object: &Value, name: &str, to: &str) -> Option<&'v Value> {
    list(root, to).get(usize::try_from(whole(object, name)?).ok()?)
}
