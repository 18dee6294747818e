//! Sorts the lines of a chunk into vertices and the faces of parts.

use std::collections::HashMap;

use super::corners::{Corner, corners};
use super::lines::{Line, Statement, lines};
use super::plain;
use super::segments::Segments;
use super::setting::{Counts, Part, Place, Setting};
use super::vertices;
use crate::error::{self, Result};
use crate::load::diagnostics::Diagnostics;
use crate::load::report::DropReason;

/// A chunk sorted.
#[derive(Debug, Default)]
pub struct Sorted {
    /// Its positions, texture coordinates and normals.
    pub vertices: Segments,
    /// Its faces.
    pub parts: Vec<(Part, Segments)>,
    /// The material libraries that it names.
    pub libraries: Vec<String>,
}

/// Where lines go.
#[derive(Clone, Copy, PartialEq)]
enum Target {
    Vertices,
    /// A part's number, in the chunk.
    Part(usize),
}

/// Sorts a chunk.
pub struct Sorter<'a> {
    chunk: &'a str,
    base: Place,
    so_far: Counts,
    total: Counts,
    setting: Setting,
    /// The parts of the present setting, by what faces name: they are looked up once.
    present: [Option<usize>; 4],
    numbers: HashMap<Part, usize>,
    /// Where the last line went that was kept as it is, and where it ended, or the comments after
    /// it.
    last: Option<(Target, usize)>,
    made: Sorted,
    tally: Diagnostics,
}

impl<'a> Sorter<'a> {
    /// Begins with a chunk at its place in a file that has so much vertex data in all.
    pub fn new(chunk: &'a str, base: Place, total: Counts) -> Self {
        Self {
            chunk,
            so_far: base.counts,
            setting: base.setting.clone(),
            base,
            total,
            present: [None; 4],
            numbers: HashMap::new(),
            last: None,
            made: Sorted::default(),
            tally: Diagnostics::default(),
        }
    }

    /// Sorts its lines.
    ///
    /// # Errors
    /// When a line's numbers are no numbers; the error names the line.
    pub fn sort(mut self) -> Result<(Sorted, Diagnostics)> {
        for line in lines(self.chunk) {
            if self.keep(&line) {
                continue;
            }
            self.last = None;
            let number = self.base.lines + line.number;
            self.statement(&line, number).map_err(|e| e.place(error::Place::Line(number)))?;
        }
        Ok((self.made, self.tally))
    }

    /// Keeps a line that is plain, or says nothing; whether it was one.
    fn keep(&mut self, line: &Line) -> bool {
        let start = self.base.start + line.start;
        let range = start..start + line.text.len();
        let bytes = line.text.as_bytes();
        let (kind, least, most) = match bytes {
            [b'f', b' ' | b'\t', rest @ ..] => {
                let Some((corners, has)) = plain::face(rest, self.total.of) else { return false };
                self.tally.read(corners - 2);
                let part = self.part(has);
                self.put(Target::Part(part), range);
                return true;
            }
            // With colours, each position must have one.
            [b'v', b' ' | b'\t', ..] if self.total.colored => (0, 6, 6),
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
        if !plain::numbers(rest).is_some_and(|count| (least..=most).contains(&count)) {
            return false;
        }
        self.so_far.of[kind] += 1;
        self.put(Target::Vertices, range);
        true
    }

    fn put(&mut self, target: Target, range: std::ops::Range<usize>) {
        let joins = self.last == Some((target, range.start));
        self.last = Some((target, range.end));
        self.segments(target).keep(range, joins);
    }

    fn segments(&mut self, target: Target) -> &mut Segments {
        match target {
            Target::Part(i) if i < self.made.parts.len() => &mut self.made.parts[i].1,
            _ => &mut self.made.vertices,
        }
    }

    /// The number of the part of faces with these attributes.
    fn part(&mut self, has: [bool; 2]) -> usize {
        let slot = usize::from(has[0]) + 2 * usize::from(has[1]);
        if let Some(number) = self.present[slot] {
            return number;
        }
        let mut part = Part { setting: self.setting.clone(), has };
        // Normals of their own smooth them as they should be.
        part.setting.smoothing = part.setting.smoothing.filter(|&group| group != 0 && !has[1]);
        part.setting.name = part.setting.name.filter(|name| !name.is_empty());
        part.setting.material = part.setting.material.filter(|name| !name.is_empty());
        let next = self.made.parts.len();
        let number = *self.numbers.entry(part.clone()).or_insert(next);
        if number == next {
            self.made.parts.push((part, Segments::default()));
        }
        self.present[slot] = Some(number);
        number
    }

    fn statement(&mut self, line: &Line, number: usize) -> Result<()> {
        let statement = line.statement();
        if self.setting.follow(&statement) {
            self.present = [None; 4];
            return Ok(());
        }
        let Statement { keyword, rest } = &statement;
        let at = || format!("line {number}");
        match keyword.as_ref() {
            "v" | "vt" | "vn" => {
                let kind = vertices::KINDS.iter().position(|kind| kind == keyword).unwrap_or(0);
                self.so_far.of[kind] += 1;
                let colored = self.total.colored;
                let write = |out: &mut String| vertices::write(kind, rest, colored, out);
                if !self.made.vertices.write(write)? {
                    let reason =
                        "{} lines of vertex data have a number that is broken or not finite";
                    self.tally.add(reason, 1, at);
                }
            }
            "f" | "fo" => self.face(rest, at)?,
            "mtllib" if !rest.is_empty() => self.made.libraries.push(rest.to_string()),
            "p" | "l" | "curv" | "curv2" | "surf" => {
                self.tally.read(1);
                self.tally.drop(DropReason::UnsupportedMode, 1, at);
            }
            "call" => self.tally.unsupported("{} other files (`call`) are not read", 1, at),
            keyword if SILENT.contains(&keyword) => {}
            keyword => {
                let reason = "{} lines are ignored: their first word is none of Wavefront OBJ";
                self.tally.add(reason, 1, || format!("line {number} (`{keyword}`)"));
            }
        }
        Ok(())
    }

    fn face(&mut self, rest: &str, at: impl Fn() -> String) -> Result<()> {
        let corners = corners(rest, self.so_far.of)?;
        let triangles = corners.len().saturating_sub(2).max(1) as u64;
        self.tally.read(triangles);
        if corners.len() < 3 {
            self.tally.drop(DropReason::Incomplete, triangles, at);
            return Ok(());
        }
        let is_there = |corner: &Corner, k: usize| (1..=self.total.of[k]).contains(&corner[k]);
        if !corners.iter().all(|c| is_there(c, 0)) {
            self.tally.drop(DropReason::IndexOutOfRange, triangles, at);
            return Ok(());
        }
        // What not every corner has, the face hasn't.
        let has = [1, 2].map(|k| corners.iter().all(|c| is_there(c, k)));
        let named = [1, 2].map(|k| corners.iter().any(|c| c[k] != 0));
        let reason = "{} faces do without normals or texture coordinates: at some corner they name \
                      none that is there";
        self.tally.add(reason, u64::from(named != has), at);
        let part = self.part(has);
        let write = |out: &mut String| super::corners::write(&corners, has, out);
        self.segments(Target::Part(part)).write(write);
        Ok(())
    }
}

/// Statements that change nothing here: of free-form geometry, which is warned of where it would be
/// drawn, and about display.
const SILENT: &[&str] = &[
    "",
    "vp",
    "cstype",
    "deg",
    "bmat",
    "step",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "mg",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "maplib",
    "usemap",
    "mtllib",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "csh",
];
