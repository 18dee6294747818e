//! The text of a scene file, and errors that point into it.

use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::error::{Error, Location};

/// A range of bytes in the text.
pub type Span = Range<usize>;

/// The bytes of memory that the parser is estimated to take for a sign of a text.
const PER_SIGN: u64 = 128;
/// The same for spaces between words, and for each other byte.
const PER_SPACE: u64 = 48;
const PER_BYTE: u64 = 8;

/// Returns what [`estimated_memory`] is at least, for a file of so many bytes.
pub const fn least_memory(bytes: u64) -> u64 {
    PER_BYTE.saturating_mul(bytes)
}

/// Returns an estimate of the memory that a text takes as TOML: its parser keeps a record of every
/// bracket, comma and word.
pub fn estimated_memory(text: &str) -> u64 {
    let (mut bytes, mut after_space) = (0, false);
    for byte in text.bytes() {
        let is_space = matches!(byte, b' ' | b'\t');
        let is_sign = matches!(
            byte,
            b'[' | b']' | b'{' | b'}' | b'=' | b',' | b'.' | b'"' | b'\'' | b'#' | b'\n' | b'\r'
        );
        bytes += match (is_sign, is_space) {
            (true, _) => PER_SIGN,
            (_, true) if !after_space => PER_SPACE,
            _ => PER_BYTE,
        };
        after_space = is_space;
    }
    bytes
}

/// Returns the place of the first control character that no TOML may have, if there is one: a parser
/// would go on and report each of a thousand million of them.
pub fn control_character(text: &str) -> Option<(usize, char)> {
    text.char_indices().find(|(_, c)| c.is_ascii_control() && !matches!(c, '\t' | '\n' | '\r'))
}

/// The path and the text of a scene file.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// The file's path.
    pub path: &'a Path,
    /// The whole text.
    pub text: &'a str,
}

impl Source<'_> {
    /// Returns an error at a span of the text.
    pub fn error(&self, span: &Span, message: impl Into<String>) -> Error {
        self.locate(span, Error::input(message))
    }

    /// Adds the file and a span of its text to an error that names no file yet.
    pub fn locate(&self, span: &Span, error: Error) -> Error {
        error.at(self.path).with_location(Location::in_text(self.text, span.clone()))
    }

    /// Returns the folder of the scene file, to which the paths that it names are relative.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// Returns the path of a file that the scene names.
    pub fn resolve_path(&self, name: &str) -> PathBuf {
        self.folder().join(name)
    }

    /// Returns the error that a file cannot be read that the scene names: a `kind` of "model" or
    /// "image".
    pub fn unreadable(&self, span: &Span, kind: &str, name: &str, error: &Error) -> Error {
        let path = self.resolve_path(name);
        let message = format!("the {kind} {}: {}", path.display(), error.message());
        let help = error.advice().unwrap_or("a path is relative to the scene file's folder");
        let located = self.error(span, message).help(help);
        match error.remedy() {
            Some(remedy) => located.remedied_by(remedy),
            None => located,
        }
    }

    /// Returns the line on which a span starts, counted from 1.
    pub fn line(&self, span: &Span) -> usize {
        self.text[..span.start].matches('\n').count() + 1
    }

    /// Returns the start of a span as FILE:line:column, for warnings.
    pub fn location(&self, span: &Span) -> String {
        format!("{}:{}", self.path.display(), Location::in_text(self.text, span.clone()))
    }

    /// Returns the span of `key` in `key = value`, given that of the value; the value's own when
    /// the key is written another way.
    pub fn key_span(&self, key: &str, value: &Span) -> Span {
        let before = self.text[..value.start].trim_end();
        match before.strip_suffix('=').map(str::trim_end).and_then(|b| b.strip_suffix(key)) {
            Some(rest) => rest.len()..rest.len() + key.len(),
            None => value.clone(),
        }
    }

    /// Returns the text of a span, cut short when it is long or has several lines.
    pub fn excerpt(&self, span: &Span) -> String {
        const MAX_LENGTH: usize = 40;
        let text = self.text.get(span.clone()).unwrap_or_default();
        let line = text.lines().next().unwrap_or_default();
        match line.char_indices().nth(MAX_LENGTH) {
            Some((cut, _)) => format!("{}…", &line[..cut]),
            None if line.len() < text.len() => format!("{line}…"),
            None => line.to_owned(),
        }
    }
}
