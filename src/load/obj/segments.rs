//! A text in pieces: stretches of another text, and what had to be written anew.

use std::io::{self, BufRead, Read};
use std::ops::Range;

/// A piece.
#[derive(Debug, PartialEq)]
enum Segment {
    /// A stretch of the original.
    Kept(Range<usize>),
    /// What takes the place of something in it.
    Written(String),
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

    /// A text to which lines can be added.
    pub fn write(&mut self) -> &mut String {
        if !matches!(self.0.last(), Some(Segment::Written(_))) {
            self.0.push(Segment::Written(String::new()));
        }
        match self.0.last_mut() {
            Some(Segment::Written(text)) => text,
            _ => unreachable!("a written piece stands last"),
        }
    }

    /// Adds the pieces of another one.
    pub fn append(&mut self, mut other: Self) {
        self.0.append(&mut other.0);
    }

    /// The whole, to be read.
    pub fn reader<'a>(&'a self, original: &'a str) -> Reader<'a> {
        let text = |segment: &'a Segment| match segment {
            Segment::Kept(range) => original.get(range.clone()).unwrap_or_default(),
            Segment::Written(text) => text,
        };
        // The last line of a file may lack its end.
        let closed = |text: &'a str| [text, if text.ends_with('\n') { "" } else { "\n" }];
        Reader { rest: Box::new(self.0.iter().map(text).flat_map(closed)), piece: &[] }
    }
}

/// Reads pieces one after the other.
pub struct Reader<'a> {
    rest: Box<dyn Iterator<Item = &'a str> + 'a>,
    piece: &'a [u8],
}

impl BufRead for Reader<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.piece.is_empty() {
            match self.rest.next() {
                Some(text) => self.piece = text.as_bytes(),
                None => break,
            }
        }
        Ok(self.piece)
    }

    fn consume(&mut self, count: usize) {
        self.piece = self.piece.get(count..).unwrap_or_default();
    }
}

impl Read for Reader<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(out)?;
        self.consume(count);
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_read_in_their_order_and_end_in_line_breaks() {
        let original = "a\nb\n#\nc\nd";
        let mut segments = Segments::default();
        segments.keep(0..2, false);
        segments.keep(2..4, true);
        segments.write().push_str("x\n");
        segments.write().push_str("y\n");
        segments.keep(8..9, false);
        let lines: Vec<_> = segments.reader(original).lines().map(Result::unwrap).collect();
        assert_eq!(lines, ["a", "b", "x", "y", "d"]);
        assert_eq!(segments.0.len(), 3);
    }
}
