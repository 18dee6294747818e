//! The check of each property by itself, against the schema of its object.

use gltf::json::Value;

use super::extensions::EXTENSIONS;
use super::schema::{Kind, NumberRange, Property, ROOT, Schema, schema};
use super::{EMPTY, EXTENSION, MISSING, RANGE, REFERENCE, TYPE, Validator, extension};
use crate::load::gltf::json::{JsonPath, as_natural, list};

/// The visits go as deep as the schemas, and no deeper.
impl Validator<'_> {
    /// Checks every property that the standard, or a known extension, defines.
    pub(super) fn check_properties(&mut self) {
        self.object(self.root, &JsonPath::Root, &ROOT);
    }

    /// Checks the properties of an object, and its extensions.
    fn object(&mut self, value: &Value, path: &JsonPath, schema: &Schema) {
        let Some(object) = value.as_object() else {
            return self.check(TYPE, false, path, "not an object");
        };
        // The properties that the schema lists; others may be anything.
        for Property { name, is_required, kind } in schema.properties {
            match object.get(*name) {
                Some(value) => self.value(value, &JsonPath::Key(path, name), kind),
                None => self.check(MISSING, !is_required, path, format_args!("has no `{name}`")),
            }
        }
        if let Some(extensions) = object.get("extensions") {
            self.extensions(extensions, &JsonPath::Key(path, "extensions"), schema.name);
        }
    }

    /// Checks the extensions of an object, which is called `parent` in the standard.
    fn extensions(&mut self, value: &Value, path: &JsonPath, parent: &str) {
        let Some(extensions) = value.as_object() else {
            return self.check(TYPE, false, path, "not an object");
        };
        for (name, value) in extensions {
            let path = &JsonPath::Key(path, name);
            let is_declared = self.used.contains(&**name);
            self.check(EXTENSION, is_declared, path, "not in `extensionsUsed`");

            // An unknown extension may be anywhere, and have any properties.
            let mut known = EXTENSIONS.iter().filter(|(extension, ..)| extension == name);
            let is_known = known.clone().next().is_some();
            match known.find(|(_, object, _)| *object == parent) {
                Some((.., properties)) => self.object(value, path, &schema("", properties)),
                None if is_known => self.check(EXTENSION, false, path, "does not belong here"),
                None => self.check(TYPE, value.is_object(), path, "not an object"),
            }
        }
    }

    /// Checks a value of some kind.
    fn value(&mut self, value: &Value, path: &JsonPath, kind: &Kind) {
        // The JSON type: a value of a wrong one is not looked into.
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
            return self.check(TYPE, false, path, needed);
        }

        // The value itself, or what it holds.
        let natural = natural.unwrap_or_default();
        let items = value.as_array().map_or(&[][..], Vec::as_slice);
        match kind {
            Kind::Flag | Kind::Text => {}
            Kind::Uri => {
                let is_uri = is_uri(value.as_str().unwrap_or_default());
                self.check(TYPE, is_uri, path, "not a URI");
            }
            Kind::OneOf(known) => {
                let message = format_args!("{value}, and {known:?} are known");
                self.check(RANGE, known.contains(&natural), path, message);
            }
            Kind::Integer(least) => {
                let message = format_args!("{value}, and at least {least} is needed");
                self.check(RANGE, natural >= *least, path, message);
            }
            Kind::Number(range) => self.number(value, path, *range),
            Kind::Vector(length, range) if items.len() == *length => {
                self.items(items, path, &Kind::Number(*range));
            }
            Kind::Vector(length, _) => {
                let message = format_args!("{} numbers, and {length} are needed", items.len());
                self.check(TYPE, false, path, message);
            }
            Kind::Index(list) => self.index(natural, path, list),
            Kind::List(kind) => {
                self.check(EMPTY, !items.is_empty(), path, "nothing is in it");
                self.items(items, path, kind);
            }
            Kind::Set(kind) => {
                self.value(value, path, &Kind::List(kind));
                // Equal items stand side by side once they are sorted.
                let mut items: Vec<String> = items.iter().map(Value::to_string).collect();
                items.sort_unstable();
                let are_different = items.windows(2).all(|two| two[0] != two[1]);
                self.check(EMPTY, are_different, path, "something stands in it twice");
            }
            Kind::Attributes => {
                let mut attributes = value.as_object().into_iter().flatten().peekable();
                self.check(EMPTY, attributes.peek().is_some(), path, "no attribute is in it");
                for (name, value) in attributes {
                    self.value(value, &JsonPath::Key(path, name), &Kind::Index("accessors"));
                }
            }
            Kind::Object(schema) => self.object(value, path, schema),
        }
    }

    /// Checks the items of a list, all of one kind.
    fn items(&mut self, items: &[Value], path: &JsonPath, kind: &Kind) {
        for (i, item) in items.iter().enumerate() {
            self.value(item, &JsonPath::Item(path, i), kind);
        }
    }

    fn number(&mut self, value: &Value, path: &JsonPath, range: NumberRange) {
        let Some(x) = value.as_f64() else { return };
        let NumberRange { least, is_open, most } = range;
        // The standard lets an index of refraction be 0.
        let is_ior = path.last_key() == "ior" && x == 0.0;
        // Angles up to a quarter turn are rounded in f32.
        let is_valid = x >= least && !(is_open && x == least) && x <= most * (1.0 + 1e-6);
        let message = format_args!("{value} is not from {least} to {most}");
        self.check(RANGE, is_valid || is_ior, path, message);
    }

    /// Checks an index into a list of the root, or of an extension of the root.
    fn index(&mut self, index: u64, path: &JsonPath, name: &str) {
        let length = match name.split_once('.') {
            None => list(self.root, name).len(),
            Some((owner, name)) => extension(self.root, owner).map_or(0, |o| list(o, name).len()),
        };
        let message = format_args!("{index}, and {name} has {length}");
        self.check(REFERENCE, index < length as u64, path, message);
    }
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
