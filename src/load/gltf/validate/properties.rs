//! The check of each property by itself, against the schema of its object.

use std::collections::HashSet;

use gltf::json::Value;

use super::extensions::{EXTENSIONS, WITHOUT_OBJECT};
use super::schema::{Kind, NumberRange, Property, ROOT};
use super::{IssueKind, Issues};
use crate::load::gltf::json::{JsonPath, Segment, as_natural, list};

/// Checks every property that the standard, or a known extension, defines.
pub fn check(root: &Value, issues: &mut Issues) {
    let used = list(root, "extensionsUsed").iter().filter_map(Value::as_str).collect();
    let mut checker = Checker { root, used, path: JsonPath::default(), issues };
    checker.object(root, ROOT.name, ROOT.properties);
}

/// The state of the check, which visits the values as the schemas tell: no deeper than these.
struct Checker<'v, 'i, 'r> {
    root: &'v Value,
    /// The names of the extensions that the file declares.
    used: HashSet<&'v str>,
    /// The path of the value that is visited.
    path: JsonPath<'v>,
    issues: &'i mut Issues<'r>,
}

impl<'v> Checker<'v, '_, '_> {
    /// Reports an issue of the current value.
    fn add(&mut self, kind: IssueKind, message: impl std::fmt::Display) {
        if self.path.is_root() {
            self.issues.check(kind, false, "the root", message);
        } else {
            self.issues.check(kind, false, &self.path, message);
        }
    }

    /// Checks a value within the current one.
    fn within(&mut self, segment: Segment<'v>, check: impl FnOnce(&mut Self)) {
        self.path.push(segment);
        check(self);
        self.path.pop();
    }

    /// Checks an object, by its name in the standard and its properties.
    fn object(&mut self, value: &'v Value, name: &str, properties: &'static [Property]) {
        let Some(object) = value.as_object() else {
            return self.add(IssueKind::TYPE, "not an object");
        };
        for Property { name, is_required, kind } in properties {
            match object.get(*name) {
                Some(value) => self.within(Segment::Key(name), |c| c.value(value, kind)),
                None if *is_required => {
                    self.add(IssueKind::MISSING, format_args!("has no `{name}`"));
                }
                None => {}
            }
        }
        if let Some(extensions) = object.get("extensions") {
            self.within(Segment::Key("extensions"), |c| c.extensions(extensions, name));
        }
    }

    fn extensions(&mut self, value: &'v Value, parent: &str) {
        let Some(extensions) = value.as_object() else {
            return self.add(IssueKind::TYPE, "not an object");
        };
        for (name, value) in extensions {
            let mut known = EXTENSIONS.iter().filter(|(extension, ..)| extension == name);
            let is_known = known.clone().count() > 0 || WITHOUT_OBJECT.contains(&&**name);
            let here = known.find(|(_, object, _)| *object == parent);
            self.within(Segment::Key(name), |c| {
                if !c.used.contains(&**name) {
                    c.add(IssueKind::EXTENSION, "not in `extensionsUsed`");
                }
                match here {
                    Some((.., properties)) => c.object(value, "", properties),
                    None if is_known => c.add(IssueKind::EXTENSION, "does not belong here"),
                    None if !value.is_object() => c.add(IssueKind::TYPE, "not an object"),
                    None => {}
                }
            });
        }
    }

    fn value(&mut self, value: &'v Value, kind: &'static Kind) {
        // The JSON type.
        let natural = as_natural(value);
        let (is_type, needed) = match kind {
            Kind::Flag => (value.is_boolean(), "true or false is needed"),
            Kind::Text | Kind::Uri => (value.is_string(), "a string is needed"),
            Kind::OneOf(_) | Kind::Integer(_) | Kind::Index(_) => {
                (natural.is_some(), "a whole number from 0 on is needed")
            }
            Kind::Number(_) => (value.is_number(), "a number is needed"),
            Kind::Vector(..) | Kind::List(_) | Kind::Set(_) => {
                (value.is_array(), "a list is needed")
            }
            Kind::Attributes | Kind::Object(_) => (value.is_object(), "not an object"),
        };
        if !is_type {
            return self.add(IssueKind::TYPE, needed);
        }

        // The value.
        let natural = natural.unwrap_or_default();
        match kind {
            Kind::Flag | Kind::Text => {}
            Kind::Uri if is_uri(value.as_str().unwrap_or_default()) => {}
            Kind::Uri => self.add(IssueKind::TYPE, "not a URI"),
            Kind::OneOf(known) if known.contains(&natural) => {}
            Kind::OneOf(known) => {
                self.add(IssueKind::RANGE, format_args!("{value}, and {known:?} are known"));
            }
            Kind::Integer(least) if natural >= *least => {}
            Kind::Integer(least) => {
                self.add(IssueKind::RANGE, format_args!("{value}, and at least {least} is needed"));
            }
            Kind::Number(range) => self.number(value, *range),
            Kind::Vector(length, range) => self.vector(value, *length, *range),
            Kind::Index(list) => self.index(natural, list),
            Kind::List(kind) => self.list(value, kind),
            Kind::Set(kind) => {
                self.list(value, kind);
                let mut items: Vec<String> = items(value).iter().map(Value::to_string).collect();
                items.sort_unstable();
                if items.windows(2).any(|two| two[0] == two[1]) {
                    self.add(IssueKind::EMPTY, "something stands in it twice");
                }
            }
            Kind::Attributes => {
                let attributes = value.as_object().into_iter().flatten();
                if attributes.clone().next().is_none() {
                    self.add(IssueKind::EMPTY, "no attribute is in it");
                }
                for (name, value) in attributes {
                    let kind = &Kind::Index("accessors");
                    self.within(Segment::Key(name), |c| c.value(value, kind));
                }
            }
            Kind::Object(schema) => self.object(value, schema.name, schema.properties),
        }
    }

    fn number(&mut self, value: &Value, range: NumberRange) {
        let Some(x) = value.as_f64() else { return };
        let NumberRange { least, is_open, most } = range;
        // The standard lets an index of refraction be 0.
        let is_ior = self.path.last_key() == "ior" && x == 0.0;
        // Angles up to a quarter turn are rounded in f32.
        let is_valid = x >= least && !(is_open && x == least) && x <= most * (1.0 + 1e-6);
        if !is_valid && !is_ior {
            self.add(IssueKind::RANGE, format_args!("{value} is not from {least} to {most}"));
        }
    }

    fn vector(&mut self, value: &'v Value, length: usize, range: NumberRange) {
        let found = items(value).len();
        if found != length {
            let message = format!("{found} numbers, and {length} are needed");
            return self.add(IssueKind::TYPE, message);
        }
        for (i, item) in items(value).iter().enumerate() {
            self.within(Segment::Index(i), |c| {
                if item.is_number() {
                    c.number(item, range);
                } else {
                    c.add(IssueKind::TYPE, "a number is needed");
                }
            });
        }
    }

    fn list(&mut self, value: &'v Value, kind: &'static Kind) {
        if items(value).is_empty() {
            self.add(IssueKind::EMPTY, "nothing is in it");
        }
        for (i, item) in items(value).iter().enumerate() {
            self.within(Segment::Index(i), |c| c.value(item, kind));
        }
    }

    /// Checks an index into a list of the root, or of an extension of the root.
    fn index(&mut self, index: u64, name: &str) {
        let length = match name.split_once('.') {
            None => list(self.root, name).len(),
            Some((extension, name)) => {
                let extension = self.root.get("extensions").and_then(|e| e.get(extension));
                extension.map_or(0, |extension| list(extension, name).len())
            }
        };
        if index >= length as u64 {
            self.add(IssueKind::REFERENCE, format_args!("{index}, and {name} has {length}"));
        }
    }
}

/// The items of a list.
fn items(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// True if a text can be a URI. The data of a data URI are decoded only if they are used.
fn is_uri(text: &str) -> bool {
    match text.split_once(':') {
        Some(("data", data)) => data.split_once(',').is_some_and(|(head, _)| !head.contains(";;")),
        // A Windows drive is no scheme, and the standard knows no other.
        Some((scheme, _)) => !scheme.is_empty() && !scheme.contains(char::is_whitespace),
        None => !text.is_empty(),
    }
}
