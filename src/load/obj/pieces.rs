//! A text in pieces: ranges of an original text, and lines that replace some of it.

use std::ops::Range;

/// A piece of a text.
#[derive(Debug, PartialEq)]
pub enum Piece {
    /// A range of the original.
    Original(Range<usize>),
    /// Lines that replace some of the original.
    Rewritten(String),
}

impl Piece {
    /// Returns the text of the piece, given the original.
    pub fn text<'a>(&'a self, original: &'a str) -> &'a str {
        match self {
            Self::Original(range) => original.get(range.clone()).unwrap_or_default(),
            Self::Rewritten(text) => text,
        }
    }
}

/// The pieces of a text, in order; each consists of whole lines.
#[derive(Debug, Default)]
pub struct Pieces(pub Vec<Piece>);

impl Pieces {
    /// Adds a line of the original: as a piece of its own, or to the end of the last piece if it
    /// `is_continuation` of that one.
    pub fn add_original(&mut self, line: Range<usize>, is_continuation: bool) {
        match self.0.last_mut() {
            Some(Piece::Original(last)) if is_continuation => last.end = line.end,
            _ => self.0.push(Piece::Original(line)),
        }
    }

    /// Adds the lines that `write` appends to the text that it is given, and returns its result.
    pub fn add_rewritten<T>(&mut self, write: impl FnOnce(&mut String) -> T) -> T {
        if let Some(Piece::Rewritten(text)) = self.0.last_mut() {
            return write(text);
        }
        let mut text = String::new();
        let result = write(&mut text);
        self.0.push(Piece::Rewritten(text));
        result
    }

    /// Appends the pieces of another text.
    pub fn append(&mut self, mut other: Self) {
        self.0.append(&mut other.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_continuation_extends_the_last_piece() {
        let original = "a\nb\n#\nc\nd";
        let mut pieces = Pieces::default();
        pieces.add_original(0..2, false);
        pieces.add_original(2..4, true);
        pieces.add_rewritten(|text| text.push_str("x\n"));
        pieces.add_rewritten(|text| text.push_str("y\n"));
        pieces.add_original(8..9, false);
        let texts: Vec<_> = pieces.0.into_iter().map(|s| s.text(original).to_owned()).collect();
        assert_eq!(texts, ["a\nb\n", "x\ny\n", "d"]);
    }
}
