//! The text that tobj reads, while other threads are still parsing the file.

use std::collections::HashMap;
use std::io::{self, BufRead, Read};
use std::sync::mpsc::Receiver;
use std::vec::IntoIter;

use super::face_numbers::FaceNumbers;
use super::lexer::line_length;
use super::parse::{GroupFaces, ParsedChunk};
use super::pieces::{Piece, Pieces};
use super::state::FaceGroup;
use crate::error::{Error, Result};
use crate::load::diagnostics::Diagnostics;

/// The content of an OBJ file beside its vertices and faces.
#[derive(Debug, Default)]
pub struct FileInfo {
    /// The groups of faces; tobj finds each under the name that is its index.
    pub groups: Vec<FaceGroup>,
    /// The numbers of the faces of each group.
    pub faces: Vec<FaceNumbers>,
    /// The number of all faces.
    face_count: u32,
    /// The material libraries that the file names.
    pub libraries: Vec<String>,
}

/// A reader of the vertices of all chunks, in order and each as soon as it is parsed, and then of the
/// faces, group by group.
pub struct TobjInput<'a> {
    original: &'a str,
    chunks: IntoIter<Receiver<Result<ParsedChunk>>>,
    /// The pieces after the present one.
    pieces: IntoIter<Piece>,
    /// The piece that is being read.
    piece: Piece,
    /// The position in that piece.
    position: usize,
    indices: HashMap<FaceGroup, usize>,
    /// The faces of each group; empty once they are being read.
    faces: Vec<Pieces>,
    /// The number of groups whose faces were read, or are being read.
    begun: usize,
    info: FileInfo,
    diagnostics: Diagnostics,
    error: Option<Error>,
}

impl<'a> TobjInput<'a> {
    /// Returns the reader of a text, whose chunks are received in order as they are parsed.
    pub fn new(original: &'a str, chunks: Vec<Receiver<Result<ParsedChunk>>>) -> Self {
        Self {
            original,
            chunks: chunks.into_iter(),
            pieces: Vec::new().into_iter(),
            piece: Piece::Original(0..0),
            position: 0,
            indices: HashMap::new(),
            faces: Vec::new(),
            begun: 0,
            info: FileInfo::default(),
            diagnostics: Diagnostics::default(),
            error: None,
        }
    }

    /// Returns the content beside vertices and faces, after everything was read or tobj gave up.
    ///
    /// # Errors
    /// The error of the first chunk that could not be parsed.
    pub fn into_info(mut self, diagnostics: &mut Diagnostics) -> Result<FileInfo> {
        while let Some(chunk) = self.next_chunk() {
            self.store(chunk);
        }
        diagnostics.append(self.diagnostics);
        self.error.map_or(Ok(self.info), Err)
    }

    /// Waits for the next chunk; none after the last one, or after an error.
    fn next_chunk(&mut self) -> Option<ParsedChunk> {
        if self.error.is_some() {
            return None;
        }
        // A chunk that is never sent is that of a thread that panicked, which its scope passes on.
        match self.chunks.next()?.recv().ok()? {
            Ok(chunk) => Some(chunk),
            Err(error) => {
                self.error = Some(error);
                None
            }
        }
    }

    /// Stores the faces of a chunk, with the groups in the order in which they come up in the file,
    /// and returns its vertices.
    fn store(&mut self, chunk: ParsedChunk) -> Pieces {
        self.diagnostics.append(chunk.diagnostics);
        self.info.libraries.extend(chunk.libraries);
        let before = self.info.face_count;
        self.info.face_count = before.saturating_add(chunk.face_count);
        for (group, GroupFaces { pieces, numbers }) in chunk.groups {
            let index = *self.indices.entry(group.clone()).or_insert(self.faces.len());
            if index == self.faces.len() {
                self.info.groups.push(group);
                self.info.faces.push(FaceNumbers::default());
                self.faces.push(Pieces::default());
            }
            self.faces[index].append(pieces);
            self.info.faces[index].append(numbers, before);
        }
        chunk.vertices
    }

    /// Returns the next piece, if any is left.
    fn next_piece(&mut self) -> Option<Piece> {
        loop {
            if let Some(piece) = self.pieces.next() {
                return Some(piece);
            }
            if let Some(chunk) = self.next_chunk() {
                self.pieces = self.store(chunk).0.into_iter();
                continue;
            }
            // All chunks are there: now the faces.
            let faces = std::mem::take(self.faces.get_mut(self.begun)?);
            self.pieces = faces.0.into_iter();
            self.begun += 1;
            return Some(Piece::Rewritten(format!("g {}\n", self.begun - 1)));
        }
    }

    /// Returns the unread rest of the present piece, or the next one; nothing at the end.
    fn unread(&mut self) -> io::Result<&str> {
        while self.position >= self.piece.text(self.original).len() {
            // The last line of a file may lack its end.
            let is_open = !matches!(self.piece.text(self.original).as_bytes(), [] | [.., b'\n']);
            let next =
                if is_open { Some(Piece::Rewritten("\n".to_owned())) } else { self.next_piece() };
            if self.error.is_some() {
                return Err(io::Error::other("a line cannot be understood"));
            }
            let is_end = next.is_none();
            (self.piece, self.position) = (next.unwrap_or(Piece::Original(0..0)), 0);
            if is_end {
                break;
            }
        }
        Ok(self.piece.text(self.original).get(self.position..).unwrap_or_default())
    }
}

impl BufRead for TobjInput<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.unread().map(str::as_bytes)
    }

    fn consume(&mut self, count: usize) {
        self.position += count;
    }

    /// Reads a line as the default method does, but does not check that it is UTF-8: the pieces are, and
    /// tobj reads line by line.
    fn read_line(&mut self, line: &mut String) -> io::Result<usize> {
        let rest = self.unread()?;
        let end = line_length(rest.as_bytes());
        line.push_str(rest.get(..end).unwrap_or_default());
        self.consume(end);
        Ok(end)
    }
}

impl Read for TobjInput<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(out)?;
        self.consume(count);
        Ok(count)
    }
}
