//! The errors of serde and the TOML parser, reworded to say where the mistake is and how to correct
//! it.
//!
//! serde's errors are English text and nothing else, so this file parses that text: "unknown field
//! `x`, expected one of `a`, `b`", "missing field `x`", "invalid type: x, expected y". If another
//! version of serde or toml words them otherwise, they are reported as they are; the tests of scene
//! files then fail.

use super::schema::json_schema::schema;
use super::source::{Source, Span};
use crate::error::Error;
use crate::load::spelling;

/// The tables that are written under double brackets.
const REPEATED: &[&str] = &["material", "sphere", "plane", "model", "light", "camera"];

/// Turns an error of the TOML reader into one of ours.
pub fn reword(source: &Source<'_>, mut error: toml::de::Error) -> Error {
    let span = error.span().unwrap_or(source.text.len()..source.text.len());
    let message = error.message().to_owned();
    // Without its input the reader's error prints the path of the key that it is about.
    error.set_input(None);
    let shown = error.to_string();
    let path = shown
        .strip_prefix(&message)
        .and_then(|rest| rest.trim().strip_prefix("in `")?.strip_suffix('`'))
        .unwrap_or_default();
    let context = ErrorContext { source, span, path };
    context
        .unknown_name(&message)
        .or_else(|| context.missing_key(&message))
        .or_else(|| context.wrong_value(&message))
        .unwrap_or_else(|| context.other(&message))
}

/// The position of an error of the TOML reader.
struct ErrorContext<'a> {
    source: &'a Source<'a>,
    span: Span,
    /// The keys down to the value that the error is about, with dots.
    path: &'a str,
}

impl ErrorContext<'_> {
    fn error(&self, message: impl Into<String>) -> Error {
        self.source.error(&self.span, message)
    }

    /// Rewords "unknown field `x`, expected one of `a`, `b`" and the same of a variant.
    fn unknown_name(&self, message: &str) -> Option<Error> {
        let (what, rest) = message.strip_prefix("unknown ")?.split_once(" `")?;
        let (found, expected) = rest.rsplit_once("`, expected ")?;
        let candidates: Vec<&str> = expected.split('`').skip(1).step_by(2).collect();
        if what == "variant" {
            let key = self.key()?;
            let advice = spelling::advice(found, &candidates, "it is one of");
            return Some(self.error(format!("`{key}` cannot be \"{found}\"")).help(advice));
        }
        let table = if self.path.is_empty() { "a scene file" } else { &self.table() };
        let error = self.error(format!("{table} has no key `{found}`"));
        let help = match (spelling::closest(found, &candidates), tables_with_key(found)) {
            (None, Some(tables)) => format!("it belongs {tables}"),
            _ => spelling::advice(found, &candidates, "its keys are"),
        };
        Some(error.help(help))
    }

    /// Rewords "missing field `x`".
    fn missing_key(&self, message: &str) -> Option<Error> {
        let key = message.strip_prefix("missing field `")?.strip_suffix('`')?;
        Some(self.error(format!("{} needs the key `{key}`", self.table())))
    }

    /// Rewords "invalid type: x, expected y", the same of a value and of a length.
    fn wrong_value(&self, message: &str) -> Option<Error> {
        if message == "wanted string or table" {
            return Some(self.unexpected("", "a string"));
        }
        let (what, rest) = message.strip_prefix("invalid ")?.split_once([' ', ':'])?;
        let (found, expected) = rest.trim_start().rsplit_once(", expected ")?;
        match what {
            "length" => Some(self.expected(expected, &format!("a list of {found}"))),
            _ if found == "map" && expected == "a list of tables" => {
                let table = self.path;
                Some(
                    self.error(format!("there can be more than one `{table}`"))
                        .help(format!("write its header in double brackets: [[{table}]]")),
                )
            }
            _ if found == "sequence" && expected == "a table" && !self.path.contains('.') => {
                let table = self.path;
                Some(
                    self.error(format!("there can be only one `{table}`"))
                        .help(format!("write its header in single brackets: [{table}]")),
                )
            }
            _ if expected == "a boolean" => Some(self.unexpected(found, "true or false")),
            // Only tracks have lists of any length.
            _ if expected == "a sequence" => {
                Some(self.unexpected(found, "a list with a value for each time"))
            }
            "type" | "value" => Some(self.unexpected(found, expected)),
            _ => None,
        }
    }

    fn unexpected(&self, found: &str, expected: &str) -> Error {
        let excerpt = self.source.excerpt(&self.span);
        let found = match found {
            // The reader hands on a date as a table.
            "map" if !excerpt.starts_with(|c: char| c.is_ascii_digit()) => "a table".to_owned(),
            "sequence" => "a list".to_owned(),
            _ if found.starts_with("string") => format!("the string {excerpt}"),
            _ => format!("`{excerpt}`"),
        };
        self.expected(expected, &found)
    }

    fn expected(&self, expected: &str, found: &str) -> Error {
        let key = self.key().map(|key| format!("`{key}`: ")).unwrap_or_default();
        self.error(format!("{key}expected {expected}, found {found}"))
    }

    /// Rewords any other error: of text that is no TOML, and of our own types of values.
    fn other(&self, message: &str) -> Error {
        let found = self.source.excerpt(&self.span);
        if message == "duplicate key" {
            let error = self.error(format!("`{found}` is there already"));
            return if REPEATED.contains(&found.as_str()) {
                error.help(format!("write each header in double brackets: [[{found}]]"))
            } else {
                error.help("write it once")
            };
        }
        self.error(match self.key() {
            Some(key) => format!("`{key}`: {message}"),
            None => message.to_owned(),
        })
    }

    /// Returns the key whose value the error is about.
    fn key(&self) -> Option<&str> {
        self.path.rsplit('.').next().filter(|key| !key.is_empty())
    }

    /// Returns the table that the error is about, as it is written.
    fn table(&self) -> String {
        match self.path {
            path if path.contains('.') => format!("`{path}`"),
            path if self.source.excerpt(&self.span).starts_with("[[") => format!("[[{path}]]"),
            path => header(path),
        }
    }
}

/// Returns the usual header of a table.
fn header(name: &str) -> String {
    let is_repeated = REPEATED.contains(&name) && name != "camera";
    if is_repeated { format!("[[{name}]]") } else { format!("[{name}]") }
}

/// Returns the tables that have a key, for a key that is in the wrong one.
fn tables_with_key(key: &str) -> Option<String> {
    let schema = schema();
    let tables = schema.get("properties")?.as_object()?;
    if tables.contains_key(key) {
        return Some("under a header of its own, or before the first one".to_owned());
    }
    let found: Vec<String> = tables
        .iter()
        .filter(|(_, table)| {
            let one = table.get("items").or_else(|| table.pointer("/anyOf/0")).unwrap_or(table);
            one.get("properties").is_some_and(|keys| keys.get(key).is_some())
        })
        .map(|(name, _)| header(name))
        .collect();
    (!found.is_empty()).then(|| format!("in {}", found.join(" or ")))
}
