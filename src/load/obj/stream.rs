//! What tobj reads: the text that is made of a file, while threads still make it.

use std::collections::HashMap;
use std::io::{self, BufRead, Read};
use std::sync::mpsc::Receiver;
use std::vec::IntoIter;

use super::lines::end_of_line;
use super::segments::{Segment, Segments};
use super::setting::Part;
use super::sorter::Sorted;
use crate::error::{Error, Result};
use crate::load::diagnostics::Diagnostics;

/// A chunk of the file, as a thread is done with it.
pub type Done = Result<(Sorted, Diagnostics)>;

/// What an OBJ file says beside vertices and faces.
#[derive(Debug, Default)]
pub struct Rewritten {
    /// The parts; tobj finds them as groups that are named by their number.
    pub parts: Vec<Part>,
    /// The material libraries that the file names.
    pub libraries: Vec<String>,
}

/// Reads the vertices of all chunks, in their order and each as soon as it is there, and then the
/// faces, part by part.
pub struct Stream<'a> {
    original: &'a str,
    chunks: IntoIter<Receiver<Done>>,
    /// What comes next.
    pieces: IntoIter<Segment>,
    /// What is being read, and how much of it has been.
    piece: Segment,
    read: usize,
    numbers: HashMap<Part, usize>,
    /// Of each part; taken when they are read.
    faces: Vec<Segments>,
    /// Parts whose faces were read, or are being read.
    begun: usize,
    made: Rewritten,
    tally: Diagnostics,
    error: Option<Error>,
}

impl<'a> Stream<'a> {
    /// Begins to read what is made of a text, chunk by chunk.
    pub fn new(original: &'a str, chunks: Vec<Receiver<Done>>) -> Self {
        Self {
            original,
            chunks: chunks.into_iter(),
            pieces: Segments::default().into_iter(),
            piece: Segment::Kept(0..0),
            read: 0,
            numbers: HashMap::new(),
            faces: Vec::new(),
            begun: 0,
            made: Rewritten::default(),
            tally: Diagnostics::default(),
            error: None,
        }
    }

    /// What the file says beside vertices and faces, after all of it was read or its reader gave
    /// up.
    ///
    /// # Errors
    /// What was wrong with the first chunk that could not be sorted.
    pub fn finish(mut self, tally: &mut Diagnostics) -> Result<Rewritten> {
        while let Some(chunk) = self.next_chunk() {
            self.store(chunk);
        }
        tally.append(self.tally);
        self.error.map_or(Ok(self.made), Err)
    }

    /// Waits for a chunk; nothing after the last one, or after one that went wrong.
    fn next_chunk(&mut self) -> Option<(Sorted, Diagnostics)> {
        if self.error.is_some() {
            return None;
        }
        // One that is never sent is that of a thread that panicked, which its scope passes on.
        match self.chunks.next()?.recv().ok()? {
            Ok(chunk) => Some(chunk),
            Err(error) => {
                self.error = Some(error);
                None
            }
        }
    }

    /// Keeps a chunk's faces for later, with the parts in the order in which they come up in the
    /// file, and gives its vertices.
    fn store(&mut self, (chunk, said): (Sorted, Diagnostics)) -> Segments {
        self.tally.append(said);
        self.made.libraries.extend(chunk.libraries);
        for (part, segments) in chunk.parts {
            let number = *self.numbers.entry(part.clone()).or_insert(self.faces.len());
            match self.faces.get_mut(number) {
                Some(faces) => faces.append(segments),
                None => {
                    self.made.parts.push(part);
                    self.faces.push(segments);
                }
            }
        }
        chunk.vertices
    }

    /// The next piece, if any is left.
    fn next_piece(&mut self) -> Option<Segment> {
        loop {
            if let Some(piece) = self.pieces.next() {
                return Some(piece);
            }
            if let Some(chunk) = self.next_chunk() {
                self.pieces = self.store(chunk).into_iter();
                continue;
            }
            let faces = std::mem::take(self.faces.get_mut(self.begun)?);
            self.pieces = faces.into_iter();
            self.begun += 1;
            return Some(Segment::Written(format!("g {}\n", self.begun - 1)));
        }
    }

    /// What is left of the piece that is being read, or the next one; nothing at the end.
    fn rest(&mut self) -> io::Result<&str> {
        while self.read >= self.piece.text(self.original).len() {
            // The last line of a file may lack its end.
            let is_open = !matches!(self.piece.text(self.original).as_bytes(), [] | [.., b'\n']);
            let next =
                if is_open { Some(Segment::Written("\n".to_owned())) } else { self.next_piece() };
            if self.error.is_some() {
                return Err(io::Error::other("a line cannot be understood"));
            }
            (self.piece, self.read) = (next.unwrap_or(Segment::Kept(0..0)), 0);
            if self.piece == Segment::Kept(0..0) {
                break;
            }
        }
        Ok(self.piece.text(self.original).get(self.read..).unwrap_or_default())
    }
}

impl BufRead for Stream<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.rest().map(str::as_bytes)
    }

    fn consume(&mut self, count: usize) {
        self.read += count;
    }

    /// As it is by default, without the search for what is no UTF-8: here is none, and tobj reads
    /// line by line.
    fn read_line(&mut self, line: &mut String) -> io::Result<usize> {
        let rest = self.rest()?;
        let end = end_of_line(rest.as_bytes());
        line.push_str(rest.get(..end).unwrap_or_default());
        self.consume(end);
        Ok(end)
    }
}

impl Read for Stream<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(out)?;
        self.consume(count);
        Ok(count)
    }
}
