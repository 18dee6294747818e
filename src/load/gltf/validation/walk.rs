//! All objects of a file beside what the standard says of each.

use std::collections::HashSet;

use gltf::json::Value;

use super::extensions::{EXTENSIONS, WITHOUT_OBJECT};
use super::schema::{Kind, Limits, ROOT, Schema};
use super::{Fault, Faults, list};

/// Looks at every property that the standard, or an extension that is known, has a word about.
pub fn walk(root: &Value, faults: &mut Faults) {
    let used = list(root, "extensionsUsed").iter().filter_map(Value::as_str).collect();
    Walk { root, used, path: Vec::new(), faults }.object(root, &ROOT);
}

/// A step from an object or a list to something in it.
#[derive(Clone, Copy)]
enum Step<'v> {
    Key(&'v str),
    Index(usize),
}

struct Walk<'v, 'f> {
    root: &'v Value,
    used: HashSet<&'v str>,
    path: Vec<Step<'v>>,
    faults: &'f mut Faults,
}

impl<'v> Walk<'v, '_> {
    fn fault(&mut self, fault: Fault, found: impl FnOnce() -> String) {
        let path = &self.path;
        self.faults.add(fault, || {
            let mut text = String::new();
            for step in path {
                match step {
                    Step::Key(key) if text.is_empty() => text.push_str(key),
                    Step::Key(key) => text += &format!(".{key}"),
                    Step::Index(index) => text += &format!("[{index}]"),
                }
            }
            (if text.is_empty() { "the root".to_owned() } else { text }, found())
        });
    }

    fn within(&mut self, step: Step<'v>, look: impl FnOnce(&mut Self)) {
        self.path.push(step);
        look(self);
        self.path.pop();
    }

    /// The depth is that of the schemas, which no file has a say in.
    fn object(&mut self, value: &'v Value, schema: &'static Schema) {
        let Some(object) = value.as_object() else {
            return self.fault(Fault::Type, || "not an object".to_owned());
        };
        for (name, required, kind) in schema.properties {
            match object.get(*name) {
                Some(value) => self.within(Step::Key(name), |w| w.value(value, kind)),
                None if *required => self.fault(Fault::Missing, || format!("has no `{name}`")),
                None => {}
            }
        }
        let Some(extensions) = object.get("extensions") else { return };
        self.within(Step::Key("extensions"), |w| w.extensions(extensions, schema.name));
    }

    fn extensions(&mut self, value: &'v Value, parent: &str) {
        let Some(extensions) = value.as_object() else {
            return self.fault(Fault::Type, || "not an object".to_owned());
        };
        for (name, value) in extensions {
            let own = EXTENSIONS.iter().filter(|(extension, ..)| extension == name);
            let here = own.clone().find(|(_, place, _)| *place == parent);
            let is_known = own.count() > 0 || WITHOUT_OBJECT.contains(&&**name);
            self.within(Step::Key(name), |w| {
                if !w.used.contains(&&**name) {
                    w.fault(Fault::Extension, || "not in `extensionsUsed`".to_owned());
                }
                match here {
                    Some((.., schema)) => w.object(value, schema),
                    None if is_known => {
                        w.fault(Fault::Extension, || "does not belong here".to_owned());
                    }
                    None if !value.is_object() => {
                        w.fault(Fault::Type, || "not an object".to_owned());
                    }
                    None => {}
                }
            });
        }
    }

    fn value(&mut self, value: &'v Value, kind: &'static Kind) {
        let wrong = match kind {
            Kind::Flag if !value.is_boolean() => "true or false is needed",
            Kind::Text | Kind::Uri if !value.is_string() => "a string is needed",
            Kind::OneOf(_) | Kind::Whole(_) | Kind::Index(_) if natural(value).is_none() => {
                "a whole number from 0 on is needed"
            }
            Kind::Number(_) if !value.is_number() => "a number is needed",
            Kind::Vector(..) | Kind::List(_) | Kind::Set(_) if !value.is_array() => {
                "a list is needed"
            }
            _ => "",
        };
        if !wrong.is_empty() {
            return self.fault(Fault::Type, || wrong.to_owned());
        }
        match kind {
            Kind::Flag | Kind::Text => {}
            Kind::Uri => self.uri(value),
            Kind::OneOf(known) => {
                if natural(value).is_none_or(|n| !known.contains(&n)) {
                    self.fault(Fault::Range, || format!("{value}, and {known:?} are known"));
                }
            }
            Kind::Whole(least) => {
                if natural(value).is_some_and(|n| n < *least) {
                    self.fault(Fault::Range, || format!("{value}, and at least {least} is needed"));
                }
            }
            Kind::Number(limits) => self.number(value, *limits),
            Kind::Vector(length, limits) => self.vector(value, *length, *limits),
            Kind::Index(list) => self.index(value, list),
            Kind::List(kind) => self.list(value, kind),
            Kind::Set(kind) => {
                self.list(value, kind);
                let items = value.as_array().map_or(&[][..], Vec::as_slice);
                let mut keys: Vec<String> = items.iter().map(Value::to_string).collect();
                keys.sort_unstable();
                if keys.windows(2).any(|two| two[0] == two[1]) {
                    self.fault(Fault::Empty, || "something stands in it twice".to_owned());
                }
            }
            Kind::Attributes => self.attributes(value),
            Kind::Object(schema) => self.object(value, schema),
        }
    }

    fn number(&mut self, value: &Value, limits: Limits) {
        let Some(x) = value.as_f64() else { return };
        let Limits { least, open, most } = limits;
        // The standard lets an index of refraction be 0.
        let is_ior = matches!(self.path.last(), Some(Step::Key("ior"))) && x == 0.0;
        // Angles up to a quarter turn are rounded in f32.
        let fits = x >= least && !(open && x == least) && x <= most * (1.0 + 1e-6);
        if !fits && !is_ior {
            self.fault(Fault::Range, || format!("{value} is not from {least} to {most}"));
        }
    }

    fn vector(&mut self, value: &'v Value, length: usize, limits: Limits) {
        let items = value.as_array().map_or(&[][..], Vec::as_slice);
        if items.len() != length {
            let found = items.len();
            return self.fault(Fault::Type, || format!("{found} numbers, and {length} are needed"));
        }
        for (i, item) in items.iter().enumerate() {
            self.within(Step::Index(i), |w| match item.is_number() {
                true => w.number(item, limits),
                false => w.fault(Fault::Type, || "a number is needed".to_owned()),
            });
        }
    }

    fn list(&mut self, value: &'v Value, kind: &'static Kind) {
        let items = value.as_array().map_or(&[][..], Vec::as_slice);
        if items.is_empty() {
            self.fault(Fault::Empty, || "nothing is in it".to_owned());
        }
        for (i, item) in items.iter().enumerate() {
            self.within(Step::Index(i), |w| w.value(item, kind));
        }
    }

    fn attributes(&mut self, value: &'v Value) {
        let Some(attributes) = value.as_object() else {
            return self.fault(Fault::Type, || "not an object".to_owned());
        };
        if attributes.is_empty() {
            self.fault(Fault::Empty, || "no attribute is in it".to_owned());
        }
        for (name, value) in attributes {
            self.within(Step::Key(name), |w| w.value(value, &Kind::Index("accessors")));
        }
    }

    /// An index into a list of the root, or of an extension of the root's.
    fn index(&mut self, value: &Value, name: &str) {
        let length = match name.split_once('.') {
            None => list(self.root, name).len(),
            Some((extension, name)) => {
                let extension = self.root.get("extensions").and_then(|e| e.get(extension));
                extension.map_or(0, |extension| list(extension, name).len())
            }
        };
        if natural(value).is_none_or(|n| n >= length as u64) {
            self.fault(Fault::Reference, || format!("{value}, and {name} has {length}"));
        }
    }

    fn uri(&mut self, value: &Value) {
        let text = value.as_str().unwrap_or_default();
        let is_broken = match text.split_once(':') {
            // Of the data itself nothing is looked at that nobody uses.
            Some(("data", data)) => {
                data.split_once(',').is_none_or(|(head, _)| head.contains(";;"))
            }
            // A drive is no scheme, and the standard knows no other.
            Some((scheme, _)) => scheme.is_empty() || scheme.contains(char::is_whitespace),
            None => text.is_empty(),
        };
        if is_broken {
            self.fault(Fault::Type, || "not a URI".to_owned());
        }
    }
}

/// A whole number; 1.0 is one, too.
fn natural(value: &Value) -> Option<u64> {
    let whole = || value.as_f64().filter(|x| *x >= 0.0 && x.fract() == 0.0 && *x < 2f64.powi(53));
    value.as_u64().or_else(|| whole().map(|x| x as u64))
}
