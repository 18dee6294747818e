//! The parser of a chunk of an OBJ file: it sorts the lines into vertex data and the faces of groups.

use std::collections::HashMap;
use std::ops::Range;

use super::face_numbers::FaceNumbers;
use super::indices::{Attributes, Corner, PlainFace, parse_face, scan_face, write_face};
use super::lexer::{Line, Statement, lines};
use super::pieces::Pieces;
use super::polypaint::Polypaint;
use super::state::{FaceGroup, FaceSettings, State, VertexCounts};
use super::vertex_data::{self, scan_numbers};
use crate::error::{self, Result};
use crate::load::diagnostics::Diagnostics;
use crate::load::report::DropReason;

/// A chunk whose lines are sorted.
#[derive(Debug, Default)]
pub struct ParsedChunk {
    /// The positions, texture coordinates and normals.
    pub vertices: Pieces,
    /// The faces of each group.
    pub groups: Vec<(FaceGroup, GroupFaces)>,
    /// The number of all faces, also of those that are dropped.
    pub face_count: u32,
    /// The names of material libraries.
    pub libraries: Vec<String>,
    /// The diagnostics.
    pub diagnostics: Diagnostics,
}

/// The faces of a group in a chunk, or in the whole file.
#[derive(Debug, Default)]
pub struct GroupFaces {
    /// The faces as tobj reads them.
    pub pieces: Pieces,
    /// Their numbers, counted from 0 at the start of the chunk or the file.
    pub numbers: FaceNumbers,
}

/// The part of the output that a line belongs to.
#[derive(Clone, Copy, PartialEq)]
enum Section {
    Vertices,
    /// The group of this index in the chunk.
    Group(usize),
}

/// The parser of a chunk.
pub struct ChunkParser<'a> {
    chunk: &'a str,
    /// The offset of the chunk, and the lines before it.
    start: State,
    /// The numbers of positions, texture coordinates and normals before the line.
    counts_so_far: [u32; 3],
    /// The numbers of vertex data in the whole file.
    total: VertexCounts,
    /// The colours of the vertices of the whole file, if comments give them.
    paint: &'a Polypaint,
    settings: FaceSettings,
    /// The indices of the groups with the current settings, by the attributes that faces name.
    current_groups: [Option<usize>; 4],
    indices: HashMap<FaceGroup, usize>,
    /// The section of the last unchanged line, and the end of that line or of the comments after
    /// it.
    last: Option<(Section, usize)>,
    parsed: ParsedChunk,
}

impl<'a> ChunkParser<'a> {
    /// Returns the parser of a chunk, given the state at its start, and the vertex data and polypaint of
    /// the whole file.
    pub fn new(chunk: &'a str, start: State, total: VertexCounts, paint: &'a Polypaint) -> Self {
        Self {
            chunk,
            counts_so_far: start.vertices.counts,
            settings: start.settings.clone(),
            start,
            total,
            paint,
            current_groups: [None; 4],
            indices: HashMap::new(),
            last: None,
            parsed: ParsedChunk::default(),
        }
    }

    /// Parses the chunk.
    ///
    /// # Errors
    /// When a line's numbers are no numbers; the error names the line.
    pub fn parse(mut self) -> Result<ParsedChunk> {
        for line in lines(self.chunk) {
            if self.add_plain(&line) {
                continue;
            }
            self.last = None;
            let number = self.start.lines + line.number;
            self.statement(&line, number)
                .map_err(|e| e.with_location(error::Location::Line(number)))?;
        }
        Ok(self.parsed)
    }

    /// Adds a line that tobj reads unchanged, or skips an empty one or a comment; returns true if
    /// the line was one of these.
    fn add_plain(&mut self, line: &Line) -> bool {
        let start = self.start.offset + line.start;
        let range = start..start + line.text.len();
        let bytes = line.text.as_bytes();
        // The kind of vertex data, and the least and the most numbers that it may have.
        let (kind, least, most) = match bytes {
            [b'f', b' ' | b'\t', rest @ ..] => {
                let Some(PlainFace { corners, attributes }) = scan_face(rest, self.total.counts)
                else {
                    return false;
                };
                self.parsed.diagnostics.read(corners - 2);
                let group = self.group(attributes);
                let number = self.next_face();
                self.parsed.groups[group].1.numbers.add(number);
                self.add_original(Section::Group(group), range);
                return true;
            }
            // With colours, each position must have one.
            [b'v', b' ' | b'\t', ..] if self.total.has_colors => (0, 6, 6),
            [b'v', b' ' | b'\t', ..] => (0, 3, 3),
            [b'v', b't', b' ' | b'\t', ..] => (1, 2, 3),
            [b'v', b'n', b' ' | b'\t', ..] => (2, 3, 3),
            [b'#', ..] | [b'\n'] | [b'\r', b'\n'] => {
                if let Some((_, end)) = &mut self.last
                    && *end == range.start
                {
                    *end = range.end;
                }
                return true;
            }
            _ => return false,
        };
        let rest = bytes.get(if kind == 0 { 1 } else { 2 }..).unwrap_or_default();
        if !scan_numbers(rest).is_some_and(|count| (least..=most).contains(&count)) {
            return false;
        }
        self.counts_so_far[kind] += 1;
        self.add_original(Section::Vertices, range);
        true
    }

    /// Adds an unchanged line to a section.
    fn add_original(&mut self, section: Section, range: Range<usize>) {
        let is_continuation = self.last == Some((section, range.start));
        self.last = Some((section, range.end));
        self.pieces(section).add_original(range, is_continuation);
    }

    fn pieces(&mut self, section: Section) -> &mut Pieces {
        match section {
            Section::Group(i) if i < self.parsed.groups.len() => {
                &mut self.parsed.groups[i].1.pieces
            }
            _ => &mut self.parsed.vertices,
        }
    }

    /// Returns the number of the face of this line.
    fn next_face(&mut self) -> u32 {
        let number = self.parsed.face_count;
        self.parsed.face_count = number.saturating_add(1);
        number
    }

    /// Returns the index of the group of faces with these attributes, in the present settings.
    fn group(&mut self, attributes: Attributes) -> usize {
        let slot = usize::from(attributes.uvs) + 2 * usize::from(attributes.normals);
        if let Some(index) = self.current_groups[slot] {
            return index;
        }
        let mut settings = self.settings.clone();
        // Normals of their own smooth faces as they should be.
        settings.smoothing = settings.smoothing.filter(|&group| group != 0 && !attributes.normals);
        settings.name = settings.name.filter(|name| !name.is_empty());
        settings.material = settings.material.filter(|name| !name.is_empty());
        let group = FaceGroup { settings, attributes };
        let next = self.parsed.groups.len();
        let index = *self.indices.entry(group.clone()).or_insert(next);
        if index == next {
            self.parsed.groups.push((group, GroupFaces::default()));
        }
        self.current_groups[slot] = Some(index);
        index
    }

    /// Applies, rewrites or drops the statement of a line.
    fn statement(&mut self, line: &Line, number: usize) -> Result<()> {
        let statement = line.statement();
        if self.settings.apply(&statement) {
            self.current_groups = [None; 4];
            return Ok(());
        }
        // Vertex data and faces are rewritten; all else that is drawn is counted and dropped.
        let Statement { keyword, rest } = &statement;
        let place = || format!("line {number}");
        let diagnostics = &mut self.parsed.diagnostics;
        match keyword.as_ref() {
            "v" | "vt" | "vn" => {
                let kind = vertex_data::KINDS.iter().position(|kind| kind == keyword).unwrap_or(0);
                let vertex = self.counts_so_far[0];
                self.counts_so_far[kind] += 1;
                let color = self.total.has_colors.then(|| self.paint.color(vertex));
                let rewrite = |out: &mut String| vertex_data::rewrite(kind, rest, color, out);
                if !self.parsed.vertices.add_rewritten(rewrite)? {
                    let reason = "{} lines of vertex data have a number that is broken, not finite or beyond 3.4e38";
                    diagnostics.add(reason, 1, place);
                }
            }
            "f" | "fo" => self.face(rest, place)?,
            "mtllib" if !rest.is_empty() => self.parsed.libraries.push(rest.to_string()),
            "p" | "l" | "curv" | "curv2" | "surf" => {
                diagnostics.read(1);
                diagnostics.drop(DropReason::UnsupportedMode, 1, place);
            }
            "call" => diagnostics.unsupported("{} other files (`call`) are not read", 1, place),
            keyword if keyword.is_empty() || IGNORED.split(' ').any(|word| word == keyword) => {}
            keyword => {
                let reason = "{} lines are ignored: their first word is none of Wavefront OBJ";
                diagnostics.add(reason, 1, || format!("line {number} (`{keyword}`)"));
            }
        }
        Ok(())
    }

    /// Rewrites a face, with absolute indices and the attributes that all of its corners have.
    fn face(&mut self, rest: &str, place: impl Fn() -> String) -> Result<()> {
        let number = self.next_face();
        let corners = parse_face(rest, self.counts_so_far)?;
        let triangles = corners.len().saturating_sub(2).max(1) as u64;
        let diagnostics = &mut self.parsed.diagnostics;
        diagnostics.read(triangles);
        if corners.len() < 3 {
            diagnostics.drop(DropReason::Incomplete, triangles, place);
            return Ok(());
        }
        let total = self.total.counts;
        let exists = |corner: &Corner, k: usize| (1..=total[k]).contains(&corner[k]);
        if !corners.iter().all(|c| exists(c, 0)) {
            diagnostics.drop(DropReason::IndexOutOfRange, triangles, place);
            return Ok(());
        }
        // An attribute that not every corner has, the face does not have.
        let [uvs, normals] = [1, 2].map(|k| corners.iter().all(|c| exists(c, k)));
        let named = [1, 2].map(|k| corners.iter().any(|c| c[k] != 0));
        let reason = "{} faces do without normals or texture coordinates: at some corner they name \
                      none that is there";
        diagnostics.add(reason, u64::from(named != [uvs, normals]), place);
        let attributes = Attributes { uvs, normals };
        let group = self.group(attributes);
        self.parsed.groups[group].1.numbers.add(number);
        let write = |out: &mut String| write_face(&corners, attributes, out);
        self.pieces(Section::Group(group)).add_rewritten(write);
        Ok(())
    }
}

/// The statements that change nothing here: those of free-form geometry, which is warned of where it
/// would be drawn, and those about display.
const IGNORED: &str = "vp cstype deg bmat step parm trim hole scrv sp end con mg bevel c_interp \
     d_interp lod maplib usemap mtllib shadow_obj trace_obj ctech stech csh";
