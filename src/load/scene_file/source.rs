//! The text that a scene is read from, and errors that point into it.

use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::error::{Error, Place};

/// A range of bytes in the text.
pub type Span = Range<usize>;

/// A scene file's path and text.
pub struct Source<'a> {
    path: &'a Path,
    /// The whole text.
    pub text: &'a str,
}

impl<'a> Source<'a> {
    /// The source with this path and text.
    pub fn new(path: &'a Path, text: &'a str) -> Self {
        Self { path, text }
    }

    /// An error at a place in the text.
    pub fn error(&self, span: &Span, message: impl Into<String>) -> Error {
        self.place(span, Error::input(message))
    }

    /// Adds a place in the text to an error that names no file yet.
    pub fn place(&self, span: &Span, error: Error) -> Error {
        error.at(self.path).place(Place::in_text(self.text, span.clone()))
    }

    /// The scene file's folder, to which the paths that it names are relative.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// The path of a file that the scene names.
    pub fn file(&self, name: &str) -> PathBuf {
        self.folder().join(name)
    }

    /// The error that a file, a model or a picture, which the scene names is not to be had.
    pub fn cannot_have(&self, span: &Span, what: &str, name: &str, error: &Error) -> Error {
        let message = format!("the {what} {}: {}", self.file(name).display(), error.message());
        let help = error.advice().unwrap_or("a path is relative to the scene file's folder");
        let named = self.error(span, message).help(help);
        match error.remedy() {
            Some(remedy) => named.remedied_by(remedy),
            None => named,
        }
    }

    /// The line of a place, counted from 1.
    pub fn line(&self, span: &Span) -> usize {
        self.text[..span.start].matches('\n').count() + 1
    }

    /// FILE:line:column of a place, for warnings.
    pub fn shown(&self, span: &Span) -> String {
        format!("{}:{}", self.path.display(), Place::in_text(self.text, span.clone()))
    }

    /// The place of `key` in `key = value`, by the place of the value; that of the value itself
    /// when the key is written another way.
    pub fn key(&self, key: &str, value: &Span) -> Span {
        let before = self.text[..value.start].trim_end();
        match before.strip_suffix('=').map(str::trim_end).and_then(|b| b.strip_suffix(key)) {
            Some(rest) => rest.len()..rest.len() + key.len(),
            None => value.clone(),
        }
    }

    /// What stands at a place, cut short when it is long or goes on over several lines.
    pub fn excerpt(&self, span: &Span) -> String {
        const LONGEST: usize = 40;
        let text = self.text.get(span.clone()).unwrap_or_default();
        let line = text.lines().next().unwrap_or_default();
        match line.char_indices().nth(LONGEST) {
            Some((cut, _)) => format!("{}…", &line[..cut]),
            None if line.len() < text.len() => format!("{line}…"),
            None => line.to_owned(),
        }
    }
}
