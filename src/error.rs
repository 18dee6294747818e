//! The error type of the library: a message with its file, the place in the file, and advice.
//!
//! ```
//! use envers::{Error, Location};
//! use std::path::Path;
//!
//! let error = Error::input("unknown key `centre`")
//!     .at(Path::new("scene.toml"))
//!     .with_location(Location::Line(3))
//!     .help("did you mean `center`?");
//! assert_eq!(error.to_string(), "scene.toml:3: unknown key `centre` (did you mean `center`?)");
//! ```

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// The kind of an [`Error`], which decides the command's exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The input or the request is wrong: a file, a key, a flag, an output whose folder does not
    /// exist.
    Input,
    /// The request was fine and the work failed: Embree, memory, a full disk, a folder or a file that
    /// is read-only.
    Failed,
}

/// An option of the library that avoids an [`Error`]; a command has a flag for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Remedy {
    /// Reading files outside the folder of the one that was named, by
    /// `load::LoadOptions::allow_outside`.
    AllowOutside,
    /// Raising a limit, by `load::LoadOptions::limits`.
    RaiseLimit {
        /// The limit's name, as `load::Limit::name` gives it.
        name: &'static str,
        /// The lowest limit that allows what was found, if that is known.
        least: Option<u64>,
    },
    /// Tracing with the pure-Rust BVH, by `intersect::Backend::Rust`.
    RustBackend,
    /// Rendering the reference of a benchmark with this many samples per pixel.
    ReferenceSamples(u32),
}

/// The most characters of a line that an error quotes: those before its place, and those from there on.
const MAX_BEFORE: usize = 60;
const MAX_BEHIND: usize = 100;

/// The place of an error in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Location {
    /// A place in a text file.
    Text {
        /// The line, counted from 1.
        line: usize,
        /// The column, counted from 1, in characters.
        column: usize,
        /// The number of quoted characters that the error is about, at least 1.
        length: usize,
        /// The line itself, without its line break; of a long line the part around the place, with
        /// `…` where it is cut.
        quote: String,
        /// The number of characters of the quote before the place.
        before: usize,
    },
    /// A line of a text file that is not quoted, counted from 1.
    Line(usize),
    /// A JSON path such as `meshes[3].primitives[0].attributes.POSITION`.
    Json(String),
}

impl Location {
    /// The place of the bytes `span` in `text`; a span past the end means the end.
    pub fn in_text(text: &str, span: std::ops::Range<usize>) -> Self {
        // The bytes of whole characters, and of the line that they begin in.
        let floor = |at: usize| (0..=at.min(text.len())).rfind(|&i| text.is_char_boundary(i));
        let [start, end] = [span.start, span.end].map(|at| floor(at).unwrap_or(0));
        let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
        // The part of the line that is quoted: all of a short one.
        let (before, rest) = (&text[line_start..start], &text[start..line_end]);
        let cut = match before.char_indices().rev().nth(MAX_BEFORE - 1) {
            Some((cut, _)) if line_end - line_start > MAX_BEFORE + MAX_BEHIND => cut,
            _ => 0,
        };
        let kept = rest.char_indices().nth(MAX_BEHIND).map_or(rest.len(), |(cut, _)| cut);
        let mark = |is_cut: bool| if is_cut { "…" } else { "" };
        let shown = format!("{}{}", mark(cut > 0), &before[cut..]);
        let behind = format!("{}{}", &rest[..kept], mark(kept < rest.len()));
        Location::Text {
            line: text[..line_start].matches('\n').count() + 1,
            column: before.chars().count() + 1,
            length: text[start..end.clamp(start, start + kept)].chars().count().max(1),
            before: shown.chars().count(),
            quote: (shown + &behind).trim_end_matches('\r').to_owned(),
        }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Location::Text { line, column, .. } => write!(f, "{line}:{column}"),
            Location::Line(line) => write!(f, "{line}"),
            Location::Json(path) => f.write_str(path),
        }
    }
}

/// An error: a message, with the file, the place in it and advice, as far as they are known.
#[derive(Clone, Debug, thiserror::Error)]
pub struct Error(Box<ErrorDetails>);

#[derive(Clone, Debug)]
struct ErrorDetails {
    kind: ErrorKind,
    path: Option<PathBuf>,
    place: Option<Location>,
    message: String,
    /// The lines of the list that the message announces.
    list: Vec<String>,
    help: Option<String>,
    remedy: Option<Remedy>,
}

/// A result whose error is [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

impl Error {
    /// An error in the input; `message` says what was found.
    pub fn input(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Input, message)
    }

    /// A failure of the work although the input was valid.
    pub fn failed(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Failed, message)
    }

    /// An error of reading a file: an error in the input, unless memory ran out.
    pub fn reading(path: &Path, error: &io::Error) -> Self {
        let kind = match error.kind() {
            io::ErrorKind::OutOfMemory => ErrorKind::Failed,
            _ => ErrorKind::Input,
        };
        Self::new(kind, format!("cannot read it: {error}")).at(path)
    }

    /// An error of writing a file or making a folder: a failure, unless no file can have such a path.
    pub fn writing(path: &Path, error: &io::Error) -> Self {
        use io::ErrorKind::{InvalidFilename, IsADirectory, NotADirectory};
        let kind = match error.kind() {
            InvalidFilename | IsADirectory | NotADirectory => ErrorKind::Input,
            _ => ErrorKind::Failed,
        };
        Self::new(kind, format!("cannot write it: {error}")).at(path)
    }

    fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self(Box::new(ErrorDetails {
            kind,
            path: None,
            place: None,
            message: message.into(),
            list: Vec::new(),
            help: None,
            remedy: None,
        }))
    }

    /// Adds the file, unless one is named already.
    #[must_use]
    pub fn at(mut self, path: &Path) -> Self {
        self.0.path.get_or_insert_with(|| path.to_owned());
        self
    }

    /// Adds the place in the file, unless one is named already.
    #[must_use]
    pub fn with_location(mut self, place: Location) -> Self {
        self.0.place.get_or_insert(place);
        self
    }

    /// Adds advice, unless there is some already.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.0.help.get_or_insert(help.into());
        self
    }

    /// Adds a list of what the message announces, which is shown line by line.
    #[cfg(feature = "cli")]
    #[must_use]
    pub(crate) fn listing(mut self, list: Vec<String>) -> Self {
        self.0.list = list;
        self
    }

    /// Adds the option that avoids the error.
    #[must_use]
    pub fn remedied_by(mut self, remedy: Remedy) -> Self {
        self.0.remedy.get_or_insert(remedy);
        self
    }

    /// The kind of the error.
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// The file, if there is one.
    pub fn path(&self) -> Option<&Path> {
        self.0.path.as_deref()
    }

    /// The place in the file, if it is known.
    pub fn location(&self) -> Option<&Location> {
        self.0.place.as_ref()
    }

    /// The message, without file and place.
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// The list that the message announces; mostly empty.
    #[cfg(feature = "cli")]
    pub(crate) fn list(&self) -> &[String] {
        &self.0.list
    }

    /// The advice, if there is some.
    pub fn advice(&self) -> Option<&str> {
        self.0.help.as_deref()
    }

    /// The option that avoids the error, if there is one.
    pub fn remedy(&self) -> Option<Remedy> {
        self.0.remedy
    }
}

/// Writes `FILE:line:column: message (advice)`, as far as these are known; `{:#}` leaves the advice out.
impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(path) = &self.0.path {
            write!(f, "{}:", path.display())?;
        }
        if let Some(place) = &self.0.place {
            write!(f, "{place}:")?;
        }
        if self.0.path.is_some() || self.0.place.is_some() {
            f.write_str(" ")?;
        }
        f.write_str(&self.0.message)?;
        self.0.list.iter().try_for_each(|line| write!(f, "\n  {line}"))?;
        match &self.0.help {
            Some(help) if !f.alternate() => write!(f, " ({help})"),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn place_counts_lines_and_characters_from_one() {
        let text = "a = 1\né = \"x\"\r\n";
        let start = text.find('"').unwrap();
        let place = Location::in_text(text, start..start + 3);
        assert_eq!(
            place,
            Location::Text { line: 2, column: 5, length: 3, quote: "é = \"x\"".into(), before: 4 }
        );
    }

    #[test]
    fn long_lines_are_quoted_around_the_place() {
        let text = format!("{}é = {}", "a".repeat(1 << 20), "b".repeat(1 << 20));
        let at = 1 << 20;
        let Location::Text { column, length, quote, before, .. } =
            Location::in_text(&text, at..text.len())
        else {
            unreachable!()
        };
        assert_eq!((column, length, before), ((1 << 20) + 1, 100, 61));
        assert_eq!(quote, format!("…{}é = {}…", "a".repeat(60), "b".repeat(96)));
        // The whole of one that is not long.
        let text = "x".repeat(150);
        assert!(
            matches!(Location::in_text(&text, 70..71), Location::Text { quote, before: 70, .. } if quote == text)
        );
    }

    #[test]
    fn place_past_the_end_is_the_end() {
        assert_eq!(Location::in_text("ab", 9..12).to_string(), "1:3");
    }

    #[test]
    fn display_names_file_place_message_and_advice() {
        let error = Error::input("unknown key `centre`")
            .at(Path::new("s.toml"))
            .with_location(Location::Line(3))
            .help("did you mean `center`?");
        assert_eq!(error.to_string(), "s.toml:3: unknown key `centre` (did you mean `center`?)");
    }
}
