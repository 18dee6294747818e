//! A text in pieces: stretches of another text, and what had to be written anew.

use std::ops::Range;

/// A piece.
#[derive(Debug, PartialEq)]
pub enum Segment {
    /// A stretch of the original.
    Kept(Range<usize>),
    /// What takes the place of something in it.
    Written(String),
}

impl Segment {
    /// What the piece says, given the original.
    pub fn text<'a>(&'a self, original: &'a str) -> &'a str {
        match self {
            Self::Kept(range) => original.get(range.clone()).unwrap_or_default(),
            Self::Written(text) => text,
        }
    }
}

/// Pieces of whole lines.
#[derive(Debug, Default)]
pub struct Segments(Vec<Segment>);

impl Segments {
    /// Adds a stretch of the original; the last piece grows up to its end where it `joins` it.
    pub fn keep(&mut self, line: Range<usize>, joins: bool) {
        match self.0.last_mut() {
            Some(Segment::Kept(last)) if joins => last.end = line.end,
            _ => self.0.push(Segment::Kept(line)),
        }
    }

    /// Adds the lines that `write` adds to a text.
    pub fn write<T>(&mut self, write: impl FnOnce(&mut String) -> T) -> T {
        if let Some(Segment::Written(text)) = self.0.last_mut() {
            return write(text);
        }
        let mut text = String::new();
        let done = write(&mut text);
        self.0.push(Segment::Written(text));
        done
    }

    /// Adds the pieces of another one.
    pub fn append(&mut self, mut other: Self) {
        self.0.append(&mut other.0);
    }
}

impl IntoIterator for Segments {
    type Item = Segment;
    type IntoIter = std::vec::IntoIter<Segment>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_that_join_are_one() {
        let original = "a\nb\n#\nc\nd";
        let mut segments = Segments::default();
        segments.keep(0..2, false);
        segments.keep(2..4, true);
        segments.write(|text| text.push_str("x\n"));
        segments.write(|text| text.push_str("y\n"));
        segments.keep(8..9, false);
        let texts: Vec<_> = segments.into_iter().map(|s| s.text(original).to_owned()).collect();
        assert_eq!(texts, ["a\nb\n", "x\ny\n", "d"]);
    }
}
